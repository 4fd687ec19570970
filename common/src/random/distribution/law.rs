//! The functions that every distribution implements, and the parameters and measured values that it rejects.
//!
//! Values are transformed to and from standard normals by inversion, x = F^-1(Phi(u)): from the lower tail for u <= 0,
//! from the upper tail for u > 0, so that both keep their digits.
//!
//! # Source
//! Devroye (1986), Non-Uniform Random Variate Generation, section II.2 (inversion).

use crate::random::standard::{Tail, standard_normal_cdf, standard_normal_quantile};
use thiserror::Error;

/// Tail probability at which unbounded distributions are cut when a scene is checked: one point of a population of a
/// million lies beyond.
pub(super) const REMOTE: f64 = 1e-6;

/// The law of one continuous random variable X; a probability keeps its digits in the tail where it is small.
///
/// Derivatives refer to the mean and the standard deviation of X (of the parent for the truncated normal).
pub trait Law {
    /// Density f(x) [1/unit of the variable]; zero outside the support, infinite at the value of a constant. The jumps of an
    /// empirical distribution at equal values are not in it.
    fn pdf(&self, x: f64) -> f64;

    /// P(X <= x) of the lower tail, P(X > x) of the upper one [1]; at a jump of an empirical distribution its middle.
    fn probability(&self, x: f64, tail: Tail) -> f64;

    /// The x at which the tail has the probability p in [0, 1] [unit of the variable], never outside the support; infinite at
    /// the ends of an unbounded distribution.
    fn at(&self, p: f64, tail: Tail) -> f64;

    /// Distribution function F(x) = P(X <= x) [1].
    fn cdf(&self, x: f64) -> f64 {
        self.probability(x, Tail::Lower)
    }

    /// 1 - F(x) [1].
    fn survival(&self, x: f64) -> f64 {
        self.probability(x, Tail::Upper)
    }

    /// Quantile F^-1(p), p in [0, 1] [unit of the variable]. With p uniform this is sampling by inverse transform.
    fn quantile(&self, p: f64) -> f64 {
        self.at(p, Tail::Lower)
    }

    /// Quantile F^-1(1 - q), q in [0, 1] [unit of the variable], with the digits that 1 - q has lost.
    fn upper_quantile(&self, q: f64) -> f64 {
        self.at(q, Tail::Upper)
    }

    /// Mean `E[X]` and standard deviation `sqrt(Var[X])` [unit of the variable].
    fn mean_and_std(&self) -> (f64, f64);

    /// Mean `E[X]` [unit of the variable].
    fn mean(&self) -> f64 {
        self.mean_and_std().0
    }

    /// Standard deviation `sqrt(Var[X])` [unit of the variable].
    fn std(&self) -> f64 {
        self.mean_and_std().1
    }

    /// Location that X is standardised by: its mean, of the parent for the truncated normal [unit of the variable].
    fn parent_mean(&self) -> f64 {
        self.mean()
    }

    /// Standard deviation that derivatives refer to: of X, of the parent for the truncated normal; 0 for a constant [unit of
    /// the variable].
    fn given_std(&self) -> f64 {
        self.std()
    }

    /// Closed interval of the possible values of X, `(lower, upper)`; infinite where there is no bound [unit of the variable].
    fn support(&self) -> (f64, f64) {
        (f64::NEG_INFINITY, f64::INFINITY)
    }

    /// Scores d ln f(x) / dp for the mean and the standard deviation `(2,)` [1/unit of the variable], bounds held fixed.
    ///
    /// For uniform, exponential and triangular distributions, whose bounds would move with the mean: the score of the
    /// least change of the density, at fixed bounds, that moves the mean or the standard deviation alone (`tilted`
    /// derives it). 0 for a constant.
    fn scores(&self, x: f64) -> [f64; 2];

    /// [`Self::scores`] for many values: what does not depend on the value is computed once.
    fn score_function(&self) -> Box<dyn Fn(f64) -> [f64; 2] + '_> {
        Box::new(|x| self.scores(x))
    }

    /// dF(x) / dp for the mean and the standard deviation `(2,)` [1/unit of the variable], in the same sense as the scores: the
    /// integrals of score times density from the lower end to x.
    fn cdf_derivatives(&self, x: f64) -> [f64; 2];

    /// The smallest and the largest value that a scene must admit, `(lower, upper)`: a bound that was chosen, else the
    /// 1e-6 or 1 - 1e-6 quantile [unit of the variable].
    fn limits(&self) -> (f64, f64) {
        match self.support() {
            (lower, upper) if lower.is_finite() && upper.is_finite() => (lower, upper),
            _ => (self.quantile(REMOTE), self.upper_quantile(REMOTE)),
        }
    }

    /// The x with F(x) = Phi(u), u a standard normal [unit of the variable]; digits are kept in both tails.
    #[expect(
        clippy::wrong_self_convention,
        reason = "the value comes from a standard normal, not from the law"
    )]
    fn from_standard_normal(&self, u: f64) -> f64 {
        if u <= 0.0 {
            self.quantile(standard_normal_cdf(u))
        } else {
            self.upper_quantile(standard_normal_cdf(-u))
        }
    }

    /// The standard normal u with Phi(u) = F(x) [1]; infinite at the bounds of a bounded distribution, 0 for a constant.
    fn to_standard_normal(&self, x: f64) -> f64 {
        let below = self.cdf(x);
        if below <= 0.5 {
            standard_normal_quantile(below)
        } else {
            -standard_normal_quantile(self.survival(x))
        }
    }
}

/// Parameters for which a distribution does not exist.
#[derive(Debug, Clone, Copy, PartialEq, Error)]
pub enum LawError {
    /// A parameter outside the open interval that it may have.
    #[error("{parameter} = {value} is out of range, allowed: {}", interval(*.above, *.below))]
    OutOfRange {
        /// Name of the parameter: `mean`, `std`, ...
        parameter: &'static str,
        /// Value given [unit of the variable].
        value: f64,
        /// Lower end of the allowed interval, excluded [unit of the variable].
        above: f64,
        /// Upper end of the allowed interval, excluded [unit of the variable].
        below: f64,
    },
    /// Bounds that do not enclose the mean or the mode.
    #[error("the bounds {lower} and {upper} do not enclose the {parameter} {value}")]
    NotEnclosed {
        /// Parameter that they should enclose: `mean` or `mode`.
        parameter: &'static str,
        /// Value of that parameter [unit of the variable].
        value: f64,
        /// Lower bound [unit of the variable].
        lower: f64,
        /// Upper bound [unit of the variable].
        upper: f64,
    },
}

/// Why a distribution cannot be taken from measured values.
#[derive(Debug, Clone, Copy, PartialEq, Error)]
pub enum FitError {
    /// Fewer values than the distribution needs.
    #[error("has {found} values, at least {least} are needed")]
    TooFew {
        /// Number of values.
        found: usize,
        /// Fewest values that it needs.
        least: usize,
    },
    /// All values are equal.
    #[error("all values are equal: leave the variable out")]
    AllEqual,
    /// A value that is not positive in a family of positive values. Holds the index of the value.
    #[error("value {} is not positive", .0 + 1)]
    NotPositive(usize),
    /// The fitted parameters are outside the range of the distribution.
    #[error(transparent)]
    Law(#[from] LawError),
}

fn interval(above: f64, below: f64) -> String {
    match (above.is_finite(), below.is_finite()) {
        (true, true) => format!("> {above} and < {below}"),
        (true, false) => format!("> {above}, finite"),
        (false, true) => format!("< {below}, finite"),
        (false, false) => "any finite number".to_owned(),
    }
}

/// Returns `value` if it is finite and lies strictly between `above` and `below`.
pub(super) fn between(parameter: &'static str, value: f64, above: f64, below: f64) -> Result<f64, LawError> {
    if value.is_finite() && above < value && value < below {
        Ok(value)
    } else {
        Err(LawError::OutOfRange { parameter, value, above, below })
    }
}

/// Returns mean and std if the mean is finite and the standard deviation positive and finite.
pub(super) fn moments(mean: f64, std: f64) -> Result<(f64, f64), LawError> {
    let mean = between("mean", mean, f64::NEG_INFINITY, f64::INFINITY)?;
    Ok((mean, between("std", std, 0.0, f64::INFINITY)?))
}

/// Chain rule d/dp = sum_q d/dq dq/dp from the two natural parameters q of a distribution to p = (mean, std): `by_own`
/// has the derivatives by q `(2,)`, `own` the rows dq/dmean, dq/dstd `(2, 2)`.
pub(super) fn chain(by_own: [f64; 2], own: [[f64; 2]; 2]) -> [f64; 2] {
    [0, 1].map(|p| by_own[0] * own[0][p] + by_own[1] * own[1][p])
}

/// Scores of distributions whose support would move with their mean or standard deviation.
///
/// Where the support depends on a parameter (uniform, shifted exponential), the derivative of a probability has a
/// term at the moving end, which no score function carries; where the density vanishes there (triangular), the score
/// exists but has no variance. For these distributions the support is held fixed, and mean and standard deviation
/// change by the least change of the density: of all densities with the new moments, the one nearest to f in the sense
/// of Kullback and Leibler, f_new(x) ~ f(x) exp(c1 x + c2 x^2). To first order, with t = (x - mean) / std, skewness
/// g = E[t^3], kurtosis k = E[t^4] and D = k - 1 - g^2:
///
/// ```text
/// s_mean = ((k - 1) t - g (t^2 - 1)) / (D std),   s_std = 2 ((t^2 - 1) - g t) / (D std)   [1/unit of the variable]
/// ```
///
/// They satisfy E[s] = 0, E[s_mean X] = 1, E[s_mean (X - mean)^2] = 0, E[s_std X] = 0, E[s_std (X - mean)^2] = 2 std,
/// and are the ordinary scores if f is normal. Valid for any f with finite fourth moment and D > 0.
///
/// # Source
/// Lemaitre, Sergienko, Arnaud, Bousquet, Gamboa, Iooss (2015), Density modification-based reliability sensitivity
/// analysis, Journal of Statistical Computation and Simulation; the derivative at no change is derived here.
///
/// Combines t and t^2 - 1 at a point into the two scores, or their integrals over the density into dF/dmean and dF/dstd
/// `(2,)` [1/unit of the variable]; `std` [unit of the variable].
pub(super) fn tilted(linear: f64, quadratic: f64, std: f64, skewness: f64, kurtosis: f64) -> [f64; 2] {
    let g = skewness;
    let scale = 1.0 / ((kurtosis - 1.0 - g * g) * std);
    [((kurtosis - 1.0) * linear - g * quadratic) * scale, 2.0 * (quadratic - g * linear) * scale]
}
