//! Calibration: fits free parameters of a scene to measured or published values.
//!
//! ```text
//! targets -> space -> simulations (workers) -> responses (surrogates) -> least squares -> report
//!              ^-------- closer to the optimum, round by round --------'
//! ```
//!
//! Simulations are expensive and statistics need thousands of them, so one design serves all: points spread over the free
//! parameters and the random variables together. Surrogates of the responses that the targets need are fitted to it and
//! predict mean, spread and reliability at any parameters without another simulation. Each round adds points around the
//! optimum of the previous one.
//!
//! A fitted quantity is not a prediction; the report marks the free parameters.

mod design;
mod least_squares;
mod report;
mod responses;
mod space;
mod target_file;
mod targets;
#[cfg(test)]
mod tests;

pub use design::{CalibrationProgress, CalibrationSettings, calibrate};
pub use report::{CalibrationResult, Conflict, FittedParameter, FittedTarget, TargetCost, answer};
pub use space::{FreeParameter, ParameterKind, Space};
pub use target_file::{of_parameters, read as read_targets};
pub use targets::{CalibrationTargets, OutputStatistic, Target, TargetQuantity};

use crate::farm::evaluate::EvaluateError;
use crate::statistics::surrogate::SurrogateError;
use common::scene::Faults;
use thiserror::Error;

/// Reasons why a calibration fails.
#[derive(Debug, Error)]
pub enum CalibrationError {
    /// The file of targets is faulty, or the free parameters do not fit the scene.
    #[error(transparent)]
    Scene(#[from] Faults),
    /// The evaluator failed or was interrupted.
    #[error(transparent)]
    Evaluate(#[from] EvaluateError),
    /// Too few simulations gave a result.
    #[error(
        "{succeeded} of {all} simulations gave a result, fewer than the {least} that {dimension} variables and parameters need"
    )]
    TooFew {
        /// Simulations with a result.
        succeeded: usize,
        /// Number of all simulations.
        all: usize,
        /// Smallest number required.
        least: usize,
        /// Number of random variables and free parameters.
        dimension: usize,
    },
    /// A response cannot be modelled.
    #[error(transparent)]
    Surrogate(#[from] SurrogateError),
}
