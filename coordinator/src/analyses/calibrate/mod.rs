//! Free parameters of a scene fitted to what was measured or published.
//!
//! ```text
//! targets -> space -> simulations (workers) -> responses (surrogates) -> least squares -> report
//!              ^-------- closer to the optimum, round by round --------'
//! ```
//!
//! Simulations are dear and statistics take thousands of them, so one design serves all: points spread over the free
//! parameters and the random variables together. Surrogates of every response that a target looks at are fitted to it, and
//! give mean, spread and reliability at any parameters without another simulation. Each round adds points around the optimum
//! of the one before.
//!
//! Nothing that was fitted here is a prediction; the report marks what was free.

mod design;
mod least_squares;
mod report;
mod responses;
mod space;
mod targets;
#[cfg(test)]
mod tests;

pub use design::{Calibration, Progress, calibrate};
pub use report::{Conflict, FittedParameter, FittedTarget, Outcome, markdown};
pub use space::{Free, Space};
pub use targets::{Looks, Target, Targets, parse as parse_targets, read as read_targets};

use crate::farm::evaluate::EvaluateError;
use crate::statistics::surrogate::SurrogateError;
use common::scene::Faults;
use thiserror::Error;

/// Why there is no calibration.
#[derive(Debug, Error)]
pub enum CalibrationError {
    /// The file of targets is faulty.
    #[error("{file}: {key}: {what}")]
    Targets {
        /// Which file.
        file: String,
        /// Where in it.
        key: String,
        /// What is wrong, and what is allowed.
        what: String,
    },
    /// The free parameters do not fit the scene.
    #[error(transparent)]
    Scene(#[from] Faults),
    /// The evaluations came to an end.
    #[error(transparent)]
    Evaluate(#[from] EvaluateError),
    /// Too few simulations gave a result.
    #[error(
        "{succeeded} of {all} simulations gave a result, fewer than the {least} that {dimension} variables and parameters take"
    )]
    TooFew {
        /// Those that did.
        succeeded: usize,
        /// All.
        all: usize,
        /// Fewest.
        least: usize,
        /// Number of random variables and free parameters.
        dimension: usize,
    },
    /// A response cannot be modelled.
    #[error(transparent)]
    Surrogate(#[from] SurrogateError),
}
