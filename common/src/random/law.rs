//! What every law of a random variable answers, and what parameters it refuses.

use super::standard_normal::{standard_normal_cdf, standard_normal_quantile};
use thiserror::Error;

/// Probability beyond which an unbounded law is not looked at when a scene is checked: fewer than one point of a
/// population of a million lies there.
pub(super) const REMOTE: f64 = 1e-6;

/// A law of one continuous random variable X; probabilities keep their digits in the tail they are small in.
///
/// The parameters that derivatives refer to are the mean and the standard deviation of X (of the parent for the
/// truncated normal).
pub(super) trait Law {
    /// Density f(x) [1/unit of the variable]; zero outside the support.
    fn pdf(&self, x: f64) -> f64;

    /// F(x) = P(X <= x) [1].
    fn cdf(&self, x: f64) -> f64;

    /// 1 - F(x) [1].
    fn survival(&self, x: f64) -> f64;

    /// F^-1(p), p in [0, 1] [unit of the variable].
    fn quantile(&self, p: f64) -> f64;

    /// F^-1(1 - q), q in [0, 1] [unit of the variable].
    fn upper_quantile(&self, q: f64) -> f64;

    /// E[X] [unit of the variable].
    fn mean(&self) -> f64;

    /// sqrt(Var[X]) [unit of the variable].
    fn std(&self) -> f64;

    /// Closed interval outside of which X never is [unit of the variable].
    fn support(&self) -> (f64, f64);

    /// Scores d ln f(x) / dp for the mean and the standard deviation `(2,)` [1/unit of the variable].
    fn scores(&self, x: f64) -> [f64; 2];

    /// dF(x) / dp for the mean and the standard deviation `(2,)` [1/unit of the variable].
    fn cdf_derivatives(&self, x: f64) -> [f64; 2];

    /// The extreme values to count with: a bound that the law reaches, else where 1e-6 of X lies beyond.
    fn limits(&self) -> (f64, f64) {
        (self.quantile(REMOTE), self.upper_quantile(REMOTE))
    }

    /// x with F(x) = Phi(u).
    fn at_standard_normal(&self, u: f64) -> f64 {
        if u <= 0.0 {
            self.quantile(standard_normal_cdf(u))
        } else {
            self.upper_quantile(standard_normal_cdf(-u))
        }
    }

    /// u with Phi(u) = F(x).
    fn to_standard_normal(&self, x: f64) -> f64 {
        let below = self.cdf(x);
        if below <= 0.5 {
            standard_normal_quantile(below)
        } else {
            -standard_normal_quantile(self.survival(x))
        }
    }
}

/// Parameters that make no distribution.
#[derive(Debug, Clone, Copy, PartialEq, Error)]
pub enum LawError {
    /// A parameter outside the open interval that it may have.
    #[error("{parameter} = {value} is out of range, allowed: {}", interval(*.above, *.below))]
    OutOfRange {
        /// Its name: `mean`, `std`, ...
        parameter: &'static str,
        /// Its value.
        value: f64,
        /// The value must be larger.
        above: f64,
        /// The value must be smaller.
        below: f64,
    },
    /// Bounds that do not enclose what they should.
    #[error("the bounds {lower} and {upper} do not enclose the {parameter} {value}")]
    NotEnclosed {
        /// What they should enclose: `mean` or `mode`.
        parameter: &'static str,
        /// Its value.
        value: f64,
        /// Lower bound.
        lower: f64,
        /// Upper bound.
        upper: f64,
    },
}

fn interval(above: f64, below: f64) -> String {
    match (above.is_finite(), below.is_finite()) {
        (true, true) => format!("> {above} and < {below}"),
        (true, false) => format!("> {above}, finite"),
        (false, true) => format!("< {below}, finite"),
        (false, false) => "any finite number".to_owned(),
    }
}

/// `value`, if it lies strictly between `above` and `below`.
pub(super) fn between(parameter: &'static str, value: f64, above: f64, below: f64) -> Result<f64, LawError> {
    if value.is_finite() && above < value && value < below {
        Ok(value)
    } else {
        Err(LawError::OutOfRange { parameter, value, above, below })
    }
}

/// A finite mean and a positive standard deviation.
pub(super) fn moments(mean: f64, std: f64) -> Result<(f64, f64), LawError> {
    let mean = between("mean", mean, f64::NEG_INFINITY, f64::INFINITY)?;
    Ok((mean, between("std", std, 0.0, f64::INFINITY)?))
}

/// Chain rule: d/dp = sum_q d/dq dq/dp, with `by_own` the derivatives to a law's own two parameters q and `own` the
/// rows dq/dmean, dq/dstd.
pub(super) fn chain(by_own: [f64; 2], own: [[f64; 2]; 2]) -> [f64; 2] {
    [0, 1].map(|p| by_own[0] * own[0][p] + by_own[1] * own[1][p])
}
