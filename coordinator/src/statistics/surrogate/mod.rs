//! Surrogates: Kriging with a constant or linear trend and an anisotropic Gaussian or Matern correlation.
//!
//! All outputs of one limit state (its checkpoints) share one correlation: one factorisation serves them all, and
//! the lengths are estimated from all of them together; whether separate ones would do better is measured. Kernel and trend
//! are chosen by cross-validation. The errors that the simulations state give each point a noise of its own. Everything
//! works in standardised inputs; matrices of points are `(d, n)` with one point a column.

mod bounds;
mod cache;
#[cfg(test)]
mod cache_tests;
mod choice;
mod correlation;
mod cross_validation;
mod descent;
mod exponential;
mod extended;
mod factor;
mod fit;
mod form;
mod kernel;
mod kriging;
mod leave_one_out;
mod likelihood;
mod noise;
mod posterior;
mod sharing;
mod starts;
mod trend;

pub use cache::{BlockPrediction, PredictionCache, Update};
pub use choice::{Candidate, Chosen, Incumbent, fit_surrogate};
pub use correlation::{Correlation, correlation_matrix, cross_correlation};
pub use cross_validation::CrossValidation;
pub use fit::{Effort, Fitted, TrainingSet, fit_correlation};
pub use form::{Form, FormSettings};
pub use kernel::Kernel;
pub use kriging::{Kriging, Prediction};
pub use leave_one_out::LeaveOneOut;
pub use likelihood::{Likelihood, LikelihoodValue};
pub use noise::{NoiseShape, StatedErrors};
pub use posterior::Posterior;
pub use sharing::{Sharing, compare_sharing};
pub use trend::Trend;

use thiserror::Error;

/// Why a surrogate could not be made.
#[derive(Debug, Error, Clone, PartialEq)]
pub enum SurrogateError {
    /// Too few points for a trend and a variance.
    #[error("a surrogate needs at least 3 points, there are {points}")]
    TooFewPoints {
        /// Points given.
        points: usize,
    },
    /// The correlation matrix stays indefinite although the nugget was raised to its bound.
    #[error(
        "the correlation matrix of {points} points has no Cholesky factor (pivot {pivot}) even with nugget {nugget}"
    )]
    NotPositiveDefinite {
        /// Points.
        points: usize,
        /// Pivot at which it failed.
        pivot: usize,
        /// Nugget at the last attempt.
        nugget: f64,
    },
}
