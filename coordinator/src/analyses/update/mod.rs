//! Single units from what was measured of them: reliability, remaining life and variables of every unit of a fleet, from the
//! surrogates of a finished study, without a simulation.
//!
//! ```text
//! units.csv -> observations -> weights over the population, or sequential Monte Carlo -> R(n), remaining life, variables
//! ```
//!
//! A measured output counts with the error of its measurement, the surrogate's, and the numerical error of the simulations. A
//! measurement alone does not say that the unit has not failed; `survived` does.

mod fleet;
mod observation;
mod predictor;
mod result;
#[cfg(test)]
mod tests;
mod text;
mod unit_file;

pub use fleet::{FleetSettings, update};
pub use observation::{Observation, ObservedUnit, Quantity};
pub use result::{FleetReport, ObservationRow, RemainingLife, UnitReport, UpdatedVariable};
pub use text::{csv, text};
pub use unit_file::{parse as parse_units, read as read_units};

use std::fmt;
use thiserror::Error;

/// A fault in a file of units.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct UnitFault {
    /// Line of the file, from 1.
    pub line: u64,
    /// Name of the column.
    pub column: &'static str,
    /// Fault and allowed values.
    pub what: String,
}

/// All faults of a file of units.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct UnitFaults {
    /// Path of the file.
    pub file: String,
    /// The faults, in the order of their lines.
    pub faults: Vec<UnitFault>,
}

impl fmt::Display for UnitFaults {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let line = |fault: &UnitFault| {
            format!("{}, line {}, column {}: {}", self.file, fault.line, fault.column, fault.what)
        };
        f.write_str(&self.faults.iter().map(line).collect::<Vec<_>>().join("\n"))
    }
}

/// Reasons why units cannot be updated.
#[derive(Debug, Error)]
pub enum UpdateError {
    /// The file cannot be read.
    #[error(
        "{file} cannot be read: {why}; expected is a CSV file of observations, see `coordinator update --help`"
    )]
    Read {
        /// Path of the file.
        file: String,
        /// Why it cannot be read.
        why: String,
    },
    /// The file is faulty.
    #[error("{0}")]
    Units(UnitFaults),
}
