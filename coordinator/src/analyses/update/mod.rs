//! Single units from what was measured of them: reliability, remaining life and variables of every unit of a fleet, from the
//! surrogates of a finished study, without a simulation.
//!
//! ```text
//! units.csv -> observations -> weights over the population, or sequential Monte Carlo -> R(n), remaining life, variables
//! ```
//!
//! A measured output counts with the error of its measurement, the surrogate's, and the numerical error of the simulations. A
//! measurement alone does not say that the unit has not failed; `survived` does.

mod contradictions;
mod fleet;
mod observation;
mod predictor;
mod result;
#[cfg(test)]
mod tests;
mod text;
mod unit_file;

pub use fleet::{FleetSettings, update};
pub(in crate::analyses) use fleet::{evidence_of, outputs_of, posterior, warning};
pub use observation::{FleetData, Moment, Observable, Observation, ObservedUnit, Quantity, UnknownParameter};
pub(in crate::analyses) use predictor::Prior;
pub use result::{ObservationRow, UnitReport};
pub use text::answer;
pub(in crate::analyses) use text::counted_units;
pub(in crate::analyses) use unit_file::WIDE;
#[cfg(test)]
pub(in crate::analyses) use unit_file::parse as parse_fleet;
pub use unit_file::read as read_fleet;
