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
mod fit_error;
mod gumbel;
mod law;
mod lognormal;
mod normal;
#[cfg(test)]
mod tests;
mod tilted;
mod triangular;
mod truncated_normal;
mod uniform;
mod weibull;

pub use beta::Beta;
pub use constant::Constant;
pub use empirical::Empirical;
pub use exponential::Exponential;
pub use fit_error::FitError;
pub use gumbel::{Extreme, Gumbel};
pub use law::LawError;
pub use lognormal::Lognormal;
pub use normal::Normal;
pub use triangular::Triangular;
pub use truncated_normal::TruncatedNormal;
pub use uniform::Uniform;
pub use weibull::Weibull;

use law::Law;
use serde::{Deserialize, Serialize};

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
    TruncatedNormal(TruncatedNormal),
    /// Normal, without bounds.
    Normal(Normal),
    /// The logarithm of the variable is normal.
    Lognormal(Lognormal),
    /// Constant density between two bounds.
    Uniform(Uniform),
    /// Extreme value distribution of type I, of maxima or of minima.
    Gumbel(Gumbel),
    /// Extreme value distribution of minima that are bounded by zero, with two parameters.
    Weibull(Weibull),
    /// Exponential, shifted to begin at a lower bound.
    Exponential(Exponential),
    /// Beta between two bounds.
    Beta(Beta),
    /// Density that rises linearly to the mode and falls linearly from it.
    Triangular(Triangular),
    /// One value with probability one: a variable held fixed.
    Constant(Constant),
    /// Measured values, with straight lines between them.
    Empirical(Empirical),
}

/// Constructors. Arguments are in the unit of the variable.
///
/// # Errors
/// [`LawError`]: a standard deviation that is not positive, bounds that do not enclose the mean, or what else the
/// distribution does not allow.
impl Distribution {
    /// A normal parent with `mean` and `std`, cut to [lower, upper]; the mean lies strictly between the bounds.
    pub fn truncated_normal(mean: f64, std: f64, lower: f64, upper: f64) -> Result<Self, LawError> {
        TruncatedNormal::new(mean, std, lower, upper).map(Self::TruncatedNormal)
    }

    /// Normal with `mean` and `std`.
    pub fn normal(mean: f64, std: f64) -> Result<Self, LawError> {
        Normal::new(mean, std).map(Self::Normal)
    }

    /// Lognormal with the `mean` > 0 and `std` of the variable, not of its logarithm.
    pub fn lognormal(mean: f64, std: f64) -> Result<Self, LawError> {
        Lognormal::new(mean, std).map(Self::Lognormal)
    }

    /// Uniform between `lower` and `upper`.
    pub fn uniform(lower: f64, upper: f64) -> Result<Self, LawError> {
        Uniform::new(lower, upper).map(Self::Uniform)
    }

    /// Uniform between mean - sqrt(3) std and mean + sqrt(3) std.
    pub fn uniform_by_moments(mean: f64, std: f64) -> Result<Self, LawError> {
        Uniform::by_moments(mean, std).map(Self::Uniform)
    }

    /// Gumbel of maxima or of minima with `mean` and `std`.
    pub fn gumbel(mean: f64, std: f64, extreme: Extreme) -> Result<Self, LawError> {
        Gumbel::new(mean, std, extreme).map(Self::Gumbel)
    }

    /// Weibull of minima, from zero on; mean > 0, 0.001 < std / mean < 10.
    pub fn weibull(mean: f64, std: f64) -> Result<Self, LawError> {
        Weibull::new(mean, std).map(Self::Weibull)
    }

    /// Exponential from mean - std on.
    pub fn exponential(mean: f64, std: f64) -> Result<Self, LawError> {
        Exponential::by_moments(mean, std).map(Self::Exponential)
    }

    /// Exponential from `lower` on; its standard deviation is mean - lower.
    pub fn exponential_from(lower: f64, mean: f64) -> Result<Self, LawError> {
        Exponential::by_lower(mean, lower).map(Self::Exponential)
    }

    /// Beta on [lower, upper]; `std` such that both shape parameters lie between 0.05 and 10000.
    pub fn beta(mean: f64, std: f64, lower: f64, upper: f64) -> Result<Self, LawError> {
        Beta::new(mean, std, lower, upper).map(Self::Beta)
    }

    /// Triangular; lower <= mode <= upper.
    pub fn triangular(lower: f64, mode: f64, upper: f64) -> Result<Self, LawError> {
        Triangular::new(lower, mode, upper).map(Self::Triangular)
    }

    /// The finite `value` with probability one.
    pub fn constant(value: f64) -> Result<Self, LawError> {
        Constant::new(value).map(Self::Constant)
    }

    /// The empirical distribution of measured values `(n,)`; at least three, of which two differ.
    pub fn empirical(samples: &[f64]) -> Result<Self, FitError> {
        Empirical::new(samples).map(Self::Empirical)
    }
}

impl Distribution {
    fn law(&self) -> &dyn Law {
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

    /// The name of the distribution for people, e.g. `truncated normal`.
    pub fn name(&self) -> &'static str {
        self.law().name()
    }

    /// Its word in scenes and result files, e.g. `truncated-normal`.
    pub fn word(&self) -> &'static str {
        match self {
            Self::TruncatedNormal(_) => "truncated-normal",
            Self::Normal(_) => "normal",
            Self::Lognormal(_) => "lognormal",
            Self::Uniform(_) => "uniform",
            Self::Gumbel(law) => law.word(),
            Self::Weibull(_) => "weibull",
            Self::Exponential(_) => "exponential",
            Self::Beta(_) => "beta",
            Self::Triangular(_) => "triangular",
            Self::Constant(_) => "constant",
            Self::Empirical(_) => "empirical",
        }
    }

    /// The likeliest value of a triangular distribution, which its moments and bounds state only together [unit of the
    /// variable]; `None` for others.
    pub fn mode(&self) -> Option<f64> {
        match self {
            Self::Triangular(law) => Some(law.mode()),
            _ => None,
        }
    }

    /// True if the variable has one value only.
    pub fn is_constant(&self) -> bool {
        matches!(self, Self::Constant(_))
    }

    /// Location by which the variable is standardised: the mean, of the parent for the truncated normal [unit of the
    /// variable].
    pub fn parent_mean(&self) -> f64 {
        self.law().parent_mean()
    }

    /// Scale by which the variable is standardised: the standard deviation, of the parent for the truncated normal;
    /// 1 for a constant, whose distance from its location is 0 whatever divides it [unit of the variable].
    pub fn parent_std(&self) -> f64 {
        if self.is_constant() { 1.0 } else { self.law().given_std() }
    }

    /// The standard deviation that derivatives refer to: of the parent for the truncated normal, else of the variable;
    /// 0 for a constant [unit of the variable].
    pub fn given_std(&self) -> f64 {
        self.law().given_std()
    }

    /// Density f(x) [1/unit of the variable]; zero outside the support, infinite at the value of a constant. The jumps of an
    /// empirical distribution at equal values are not in it.
    pub fn pdf(&self, x: f64) -> f64 {
        self.law().pdf(x)
    }

    /// Distribution function F(x) = P(X <= x) [1], relative accuracy kept in the lower tail; at a jump of an empirical
    /// distribution its middle.
    pub fn cdf(&self, x: f64) -> f64 {
        self.law().cdf(x)
    }

    /// 1 - F(x) [1], relative accuracy kept in the upper tail.
    pub fn survival(&self, x: f64) -> f64 {
        self.law().survival(x)
    }

    /// Quantile F^-1(p) for p in [0, 1] [unit of the variable], never outside the support; infinite at the ends of an
    /// unbounded distribution.
    ///
    /// With p uniform this is sampling by inverse transform.
    pub fn quantile(&self, p: f64) -> f64 {
        self.law().quantile(p)
    }

    /// Quantile F^-1(1 - q) for q in [0, 1] [unit of the variable], with the digits that 1 - q has lost.
    pub fn upper_quantile(&self, q: f64) -> f64 {
        self.law().upper_quantile(q)
    }

    /// The value x with F(x) = Phi(u), u a standard normal [unit of the variable]; digits are kept in both tails.
    pub fn from_standard_normal(&self, u: f64) -> f64 {
        self.law().at_standard_normal(u)
    }

    /// The standard normal u with Phi(u) = F(x) [1]; infinite at the bounds of a bounded distribution, 0 for a
    /// constant.
    pub fn to_standard_normal(&self, x: f64) -> f64 {
        self.law().to_standard_normal(x)
    }

    /// Mean `E[X]` [unit of the variable].
    pub fn mean(&self) -> f64 {
        self.law().mean()
    }

    /// Standard deviation `sqrt(Var[X])` [unit of the variable].
    pub fn std(&self) -> f64 {
        self.law().std()
    }

    /// Closed interval of the values that are possible, `(lower, upper)`; infinite where there is no bound [unit of
    /// the variable].
    pub fn support(&self) -> (f64, f64) {
        self.law().support()
    }

    /// The smallest and the largest value that a scene must admit, `(lower, upper)`: a bound that was chosen, else the
    /// 1e-6 or 1 - 1e-6 quantile [unit of the variable].
    pub fn limits(&self) -> (f64, f64) {
        self.law().limits()
    }

    /// Scores d ln f(x) / d mean and d ln f(x) / d std `(2,)` [1/unit of the variable], bounds held fixed.
    ///
    /// For uniform, exponential and triangular distributions, whose bounds would move with the mean: the score of the
    /// least change of the density, at fixed bounds, that moves the mean or the standard deviation alone (the module
    /// `tilted` derives it). 0 for a constant.
    pub fn scores(&self, x: f64) -> [f64; 2] {
        self.law().scores(x)
    }

    /// [`Self::scores`] for many values: what does not depend on the value is computed once.
    pub fn score_function(&self) -> Box<dyn Fn(f64) -> [f64; 2] + '_> {
        self.law().score_function()
    }

    /// dF(x) / d mean and dF(x) / d std `(2,)` [1/unit of the variable], in the same sense as the scores: the
    /// integrals of score times density from the lower end to x.
    pub fn cdf_derivatives(&self, x: f64) -> [f64; 2] {
        self.law().cdf_derivatives(x)
    }
}
