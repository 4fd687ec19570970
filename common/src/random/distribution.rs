//! Distributions of one continuous random variable, by name, and the functions that each of them has.
//!
//! A distribution is given by the mean and the standard deviation of the variable itself (of the parent for the
//! truncated normal), with bounds and mode where it needs them. Derivatives refer to the same two parameters. Each
//! distribution has a file below, which states its density, parameters, support and moments with their source.
//!
//! A new one takes three files: its own with `impl Law`, this one (module, variant, constructor, `law`), and
//! `scene/variable_law.rs` (its word and keys in a scene).

mod beta;
mod constant;
mod empirical;
mod exponential;
mod gumbel;
mod law;
mod normal;
#[cfg(test)]
mod tests;
mod truncated_normal;
mod uniform;

pub use gumbel::Extreme;
pub use law::{FitError, Law, LawError};

use serde::{Deserialize, Serialize};
use std::ops::Deref;

/// A distribution of one continuous random variable; x, bounds, mean and standard deviation are in the variable's
/// unit.
///
/// ```
/// use common::random::Distribution;
///
/// // The radius of a bore: normal, cut at three standard deviations [m].
/// let radius = Distribution::truncated_normal(1.5e-3, 2e-6, 1.494e-3, 1.506e-3)?;
/// assert!((radius.quantile(0.5) - 1.5e-3).abs() < 1e-12);
/// // The quantile function inverts the distribution function.
/// let x = radius.quantile(0.9);
/// assert!((radius.cdf(x) - 0.9).abs() < 1e-12);
/// # Ok::<(), common::random::LawError>(())
/// ```
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub enum Distribution {
    /// A normal distribution, the parent, restricted to an interval.
    TruncatedNormal(truncated_normal::TruncatedNormal),
    /// Normal, without bounds.
    Normal(normal::Normal),
    /// The logarithm of the variable is normal.
    Lognormal(normal::Lognormal),
    /// Constant density between two bounds.
    Uniform(uniform::Uniform),
    /// Extreme value distribution of type I, of maxima or of minima.
    Gumbel(gumbel::Gumbel),
    /// Extreme value distribution of minima that are bounded by zero, with two parameters.
    Weibull(exponential::Weibull),
    /// Exponential, shifted to begin at a lower bound.
    Exponential(exponential::Exponential),
    /// Beta between two bounds.
    Beta(beta::Beta),
    /// Density that rises linearly to the mode and falls linearly from it.
    Triangular(uniform::Triangular),
    /// One value with probability one: a variable held fixed.
    Constant(constant::Constant),
    /// Measured values, with straight lines between them.
    Empirical(empirical::Empirical),
}

/// Constructors. Arguments are in the unit of the variable.
///
/// # Errors
/// [`LawError`]: a standard deviation that is not positive, bounds that do not enclose the mean, or what else the
/// distribution does not allow.
impl Distribution {
    /// A normal parent with `mean` and `std`, cut to [lower, upper]; the mean lies strictly between the bounds.
    pub fn truncated_normal(mean: f64, std: f64, lower: f64, upper: f64) -> Result<Self, LawError> {
        truncated_normal::TruncatedNormal::new(mean, std, lower, upper).map(Self::TruncatedNormal)
    }

    /// Normal with `mean` and `std`.
    pub fn normal(mean: f64, std: f64) -> Result<Self, LawError> {
        normal::Normal::new(mean, std).map(Self::Normal)
    }

    /// Lognormal with the `mean` > 0 and `std` of the variable, not of its logarithm.
    pub fn lognormal(mean: f64, std: f64) -> Result<Self, LawError> {
        normal::Lognormal::new(mean, std).map(Self::Lognormal)
    }

    /// Uniform between `lower` and `upper`.
    pub fn uniform(lower: f64, upper: f64) -> Result<Self, LawError> {
        uniform::Uniform::new(lower, upper).map(Self::Uniform)
    }

    /// Uniform between mean - sqrt(3) std and mean + sqrt(3) std.
    pub fn uniform_by_moments(mean: f64, std: f64) -> Result<Self, LawError> {
        uniform::Uniform::by_moments(mean, std).map(Self::Uniform)
    }

    /// Gumbel of maxima or of minima with `mean` and `std`.
    pub fn gumbel(mean: f64, std: f64, extreme: Extreme) -> Result<Self, LawError> {
        gumbel::Gumbel::new(mean, std, extreme).map(Self::Gumbel)
    }

    /// Weibull of minima, from zero on; mean > 0, 0.001 < std / mean < 10.
    pub fn weibull(mean: f64, std: f64) -> Result<Self, LawError> {
        exponential::Weibull::new(mean, std).map(Self::Weibull)
    }

    /// Exponential from mean - std on.
    pub fn exponential(mean: f64, std: f64) -> Result<Self, LawError> {
        exponential::Exponential::by_moments(mean, std).map(Self::Exponential)
    }

    /// Exponential from `lower` on; its standard deviation is mean - lower.
    pub fn exponential_from(lower: f64, mean: f64) -> Result<Self, LawError> {
        exponential::Exponential::by_lower(mean, lower).map(Self::Exponential)
    }

    /// Beta on [lower, upper]; `std` such that both shape parameters lie between 0.05 and 10000.
    pub fn beta(mean: f64, std: f64, lower: f64, upper: f64) -> Result<Self, LawError> {
        beta::Beta::new(mean, std, lower, upper).map(Self::Beta)
    }

    /// Triangular; lower <= mode <= upper.
    pub fn triangular(lower: f64, mode: f64, upper: f64) -> Result<Self, LawError> {
        uniform::Triangular::new(lower, mode, upper).map(Self::Triangular)
    }

    /// The finite `value` with probability one.
    pub fn constant(value: f64) -> Result<Self, LawError> {
        constant::Constant::new(value).map(Self::Constant)
    }

    /// The empirical distribution of measured values `(n,)`; at least three, of which two differ.
    pub fn empirical(samples: &[f64]) -> Result<Self, FitError> {
        empirical::Empirical::new(samples).map(Self::Empirical)
    }
}

impl Deref for Distribution {
    type Target = dyn Law;

    /// The functions of the distribution.
    fn deref(&self) -> &Self::Target {
        match self {
            Self::TruncatedNormal(law) => law,
            Self::Normal(law) => law,
            Self::Lognormal(law) => law,
            Self::Uniform(law) => law,
            Self::Gumbel(law) => law,
            Self::Weibull(law) => law,
            Self::Exponential(law) => law,
            Self::Beta(law) => law,
            Self::Triangular(law) => law,
            Self::Constant(law) => law,
            Self::Empirical(law) => law,
        }
    }
}

impl Distribution {
    /// Its word in scenes and result files, e.g. `truncated-normal`.
    pub fn word(&self) -> &'static str {
        self.words().0
    }

    /// The name of the distribution for people, e.g. `truncated normal`.
    pub fn name(&self) -> &'static str {
        self.words().1
    }

    fn words(&self) -> (&'static str, &'static str) {
        match self {
            Self::TruncatedNormal(_) => ("truncated-normal", "truncated normal"),
            Self::Normal(_) => ("normal", "normal"),
            Self::Lognormal(_) => ("lognormal", "lognormal"),
            Self::Uniform(_) => ("uniform", "uniform"),
            Self::Gumbel(law) if law.extreme == Extreme::Maxima => ("gumbel", "Gumbel"),
            Self::Gumbel(_) => ("gumbel-minima", "Gumbel of minima"),
            Self::Weibull(_) => ("weibull", "Weibull"),
            Self::Exponential(_) => ("exponential", "exponential"),
            Self::Beta(_) => ("beta", "beta"),
            Self::Triangular(_) => ("triangular", "triangular"),
            Self::Constant(_) => ("constant", "constant"),
            Self::Empirical(_) => ("empirical", "empirical"),
        }
    }

    /// The likeliest value of a triangular distribution, which its moments and bounds state only together [unit of the
    /// variable]; `None` for others.
    pub fn mode(&self) -> Option<f64> {
        match self {
            Self::Triangular(law) => Some(law.mode),
            _ => None,
        }
    }

    /// True if the variable has one value only.
    pub fn is_constant(&self) -> bool {
        matches!(self, Self::Constant(_))
    }

    /// Scale by which the variable is standardised: the standard deviation, of the parent for the truncated normal;
    /// 1 for a constant, whose distance from its location is 0 whatever divides it [unit of the variable].
    pub fn parent_std(&self) -> f64 {
        if self.is_constant() { 1.0 } else { self.given_std() }
    }
}
