//! Surrogates: Kriging with a constant or linear trend, an anisotropic Gaussian or Matern correlation, and
//! noise.
//!
//! All outputs of one limit state (its checkpoints) share one correlation: one factorisation serves them all,
//! and the lengths are estimated from all of them together; [`compare_sharing`] measures whether separate
//! lengths would do better. Kernel and trend are chosen by cross-validation. The errors that simulations
//! state give each point its own noise. Inputs are standardised; a matrix of points is `(d, n)` with one
//! point per column, values are `(n, m)` with one output per column.
//!
//! | file | computes |
//! |---|---|
//! | `kernel`, `correlation` | correlation functions and matrices |
//! | `trend` | generalised least squares of the trend |
//! | `kriging`, `extended` | conditioning, prediction, also of a response that is the larger of two; further points at the same lengths |
//! | `likelihood`, `bounds`, `fit` | maximum likelihood of the lengths |
//! | `noise` | noise in proportion to stated errors |
//! | `response_scale` | values or their logarithms as what is learned |
//! | `leave_one_out`, `cross_validation`, `choice` | quality and choice of the form |
//! | `explicit` | the mean as plain numbers |
//! | `posterior`, `cache` | joint posterior of a pool, cached predictions of a population |
//!
//! # Example
//! ```
//! use statistics::surrogate::{Effort, FormSettings, TrainingSet, fit_surrogate};
//! use faer::Mat;
//!
//! // 30 points of y = sin(x_1) + x_2 / 2 in [-2, 2]^2.
//! let sequence = |i: usize, step: f64| 4.0 * ((i + 1) as f64 * step).fract() - 2.0;
//! let points = Mat::from_fn(2, 30, |k, i| sequence(i, [0.754877666, 0.569840296][k]));
//! let values = Mat::from_fn(30, 1, |i, _| points[(0, i)].sin() + 0.5 * points[(1, i)]);
//! let training = TrainingSet { points: points.as_ref(), values: values.as_ref(), noise: None, is_exact: false };
//! let chosen = fit_surrogate(training, FormSettings::default(), None, Effort::MultiStart)?;
//!
//! let prediction = chosen.model.predict(Mat::from_fn(2, 1, |k, _| [0.3, -1.2][k]).as_ref());
//! assert!((prediction.mean[(0, 0)] - (0.3f64.sin() - 0.6)).abs() < 1e-2);
//! let std = (chosen.model.sigma2[0] * prediction.variance_factor[0]).sqrt();
//! assert!(std < 1e-2);
//! # Ok::<(), statistics::surrogate::SurrogateError>(())
//! ```
//!
//! # Source
//! Sacks, Welch, Mitchell, Wynn (1989), Design and analysis of computer experiments, Statistical Science
//! 4(4); Rasmussen, Williams (2006), Gaussian Processes for Machine Learning. Each file names its own
//! sources.

mod bounds;
mod cache;
#[cfg(test)]
mod cache_tests;
mod choice;
mod correlation;
mod cross_validation;
mod explicit;
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
mod response_scale;
mod trend;

pub use cache::PredictionCache;
pub use choice::{Chosen, compare_sharing, fit_surrogate};
pub use correlation::{Correlation, correlation_matrix};
pub use cross_validation::CrossValidation;
pub use explicit::ExplicitMean;
pub use fit::{Effort, Fitted, TrainingSet, fit_correlation};
pub use form::{Form, FormSettings};
pub use kernel::Kernel;
pub use kriging::{Kriging, Prediction};
pub use leave_one_out::{LeaveOneOut, LeftOut};
pub use likelihood::Likelihood;
pub use noise::{NoiseShape, StatedErrors};
pub use posterior::Posterior;
pub use response_scale::ResponseScale;
pub use trend::Trend;

use thiserror::Error;

/// Reason why a surrogate could not be made.
#[derive(Debug, Error, Clone, PartialEq)]
pub enum SurrogateError {
    /// There are too few points for a trend and a variance.
    #[error("a surrogate needs at least 3 points, there are {points}")]
    TooFewPoints {
        /// Number of points given.
        points: usize,
    },
    /// The correlation matrix stays indefinite although the nugget was raised to its bound.
    #[error(
        "the correlation matrix of {points} points has no Cholesky factor (pivot {pivot}) even with nugget {nugget}"
    )]
    NotPositiveDefinite {
        /// Number of points.
        points: usize,
        /// Index of the pivot at which the factorisation failed.
        pivot: usize,
        /// Nugget at the last attempt [1].
        nugget: f64,
    },
}
