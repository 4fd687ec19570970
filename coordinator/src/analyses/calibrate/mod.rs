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
#[cfg(test)]
mod tests;

pub use design::{CalibrationSettings, calibrate};
pub use report::{CalibrationResult, answer};
pub use space::Space;
pub use target_file::{CalibrationTargets, Target, of_parameters, read as read_targets};
