//! A distribution of a random variable: which law, and what every law answers.
//!
//! Laws are given by the mean and the standard deviation of the variable itself, of the parent for the truncated
//! normal, with bounds and mode where they need them. Derivatives refer to the same two parameters.

use super::law::{Law, LawError};
use super::truncated_normal::TruncatedNormal;
use super::{Beta, Constant, Exponential, Extreme, Gumbel, Lognormal, Normal, Triangular, Uniform, Weibull};
use serde::{Deserialize, Serialize};

/// A distribution.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub enum Distribution {
    /// Normal(mean, std) of the untruncated parent, cut to [lower, upper].
    TruncatedNormal {
        /// Mean of the parent.
        mean: f64,
        /// Standard deviation of the parent.
        std: f64,
        /// Lower bound.
        lower: f64,
        /// Upper bound.
        upper: f64,
    },
    /// Normal.
    Normal(Normal),
    /// Lognormal.
    Lognormal(Lognormal),
    /// Uniform.
    Uniform(Uniform),
    /// Gumbel, of maxima or minima.
    Gumbel(Gumbel),
    /// Weibull of minima, two parameters.
    Weibull(Weibull),
    /// Exponential, from a lower end on.
    Exponential(Exponential),
    /// Beta between bounds.
    Beta(Beta),
    /// Triangular.
    Triangular(Triangular),
    /// No distribution at all: always the same value.
    Constant(Constant),
}

/// Runs an expression with the law of a distribution.
macro_rules! with_law {
    ($distribution:expr, $law:ident => $answer:expr) => {
        match $distribution {
            Distribution::TruncatedNormal { mean, std, lower, upper } => {
                let $law = TruncatedNormal { mean, std, lower, upper };
                $answer
            }
            Distribution::Normal($law) => $answer,
            Distribution::Lognormal($law) => $answer,
            Distribution::Uniform($law) => $answer,
            Distribution::Gumbel($law) => $answer,
            Distribution::Weibull($law) => $answer,
            Distribution::Exponential($law) => $answer,
            Distribution::Beta($law) => $answer,
            Distribution::Triangular($law) => $answer,
            Distribution::Constant($law) => $answer,
        }
    };
}

/// Making one.
///
/// Arguments are in the unit of the variable.
///
/// # Errors
/// [`LawError`]: a standard deviation that is not positive, bounds that do not enclose the mean, or what else the law
/// does not allow.
impl Distribution {
    /// Normal(mean, std) of the parent cut to [lower, upper]; the mean lies strictly between the bounds.
    pub fn truncated_normal(mean: f64, std: f64, lower: f64, upper: f64) -> Result<Self, LawError> {
        TruncatedNormal::new(mean, std, lower, upper)?;
        Ok(Self::TruncatedNormal { mean, std, lower, upper })
    }

    /// Normal.
    pub fn normal(mean: f64, std: f64) -> Result<Self, LawError> {
        Normal::new(mean, std).map(Self::Normal)
    }

    /// Lognormal; mean > 0.
    pub fn lognormal(mean: f64, std: f64) -> Result<Self, LawError> {
        Lognormal::new(mean, std).map(Self::Lognormal)
    }

    /// Uniform between two bounds.
    pub fn uniform(lower: f64, upper: f64) -> Result<Self, LawError> {
        Uniform::new(lower, upper).map(Self::Uniform)
    }

    /// Uniform between mean - sqrt(3) std and mean + sqrt(3) std.
    pub fn uniform_by_moments(mean: f64, std: f64) -> Result<Self, LawError> {
        Uniform::by_moments(mean, std).map(Self::Uniform)
    }

    /// Gumbel of maxima or of minima.
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

    /// Beta on [lower, upper]; std so that both its exponents lie between 0.05 and 10000.
    pub fn beta(mean: f64, std: f64, lower: f64, upper: f64) -> Result<Self, LawError> {
        Beta::new(mean, std, lower, upper).map(Self::Beta)
    }

    /// Triangular; lower <= mode <= upper.
    pub fn triangular(lower: f64, mode: f64, upper: f64) -> Result<Self, LawError> {
        Triangular::new(lower, mode, upper).map(Self::Triangular)
    }

    /// Always `value`.
    pub fn constant(value: f64) -> Result<Self, LawError> {
        Constant::new(value).map(Self::Constant)
    }
}

impl Distribution {
    /// The law in words, e.g. `truncated normal`.
    pub fn law(&self) -> &'static str {
        match self {
            Self::TruncatedNormal { .. } => "truncated normal",
            Self::Normal(_) => "normal",
            Self::Lognormal(_) => "lognormal",
            Self::Uniform(_) => "uniform",
            Self::Gumbel(gumbel) => gumbel.law(),
            Self::Weibull(_) => "Weibull",
            Self::Exponential(_) => "exponential",
            Self::Beta(_) => "beta",
            Self::Triangular(_) => "triangular",
            Self::Constant(_) => "constant",
        }
    }

    /// Whether the variable never changes.
    pub fn is_constant(&self) -> bool {
        matches!(self, Self::Constant(_))
    }

    /// Location by which the variable is standardised: the mean, of the parent for the truncated normal [unit of the
    /// variable].
    pub fn parent_mean(&self) -> f64 {
        match self {
            Self::TruncatedNormal { mean, .. } => *mean,
            _ => self.mean(),
        }
    }

    /// Scale by which the variable is standardised: the standard deviation, of the parent for the truncated normal;
    /// 1 for a constant, whose distance from its location is 0 whatever divides it [unit of the variable].
    pub fn parent_std(&self) -> f64 {
        match self {
            Self::TruncatedNormal { std, .. } => *std,
            Self::Constant(_) => 1.0,
            _ => self.std(),
        }
    }

    /// The standard deviation that derivatives refer to: of the parent for the truncated normal, else of the variable;
    /// 0 for a constant [unit of the variable].
    pub fn given_std(&self) -> f64 {
        match self {
            Self::TruncatedNormal { std, .. } => *std,
            _ => self.std(),
        }
    }

    /// Density f(x) [1/unit of the variable]; zero outside the support, infinite at the value of a constant.
    pub fn pdf(&self, x: f64) -> f64 {
        with_law!(*self, law => law.pdf(x))
    }

    /// Distribution function F(x) [1].
    pub fn cdf(&self, x: f64) -> f64 {
        with_law!(*self, law => law.cdf(x))
    }

    /// 1 - F(x) [1], relative accuracy kept in the upper tail.
    pub fn survival(&self, x: f64) -> f64 {
        with_law!(*self, law => law.survival(x))
    }

    /// Quantile F^-1(p) for p in [0, 1] [unit of the variable], never outside the support; infinite at the ends of an
    /// unbounded law.
    ///
    /// With p uniform this is sampling by inverse transform.
    pub fn quantile(&self, p: f64) -> f64 {
        with_law!(*self, law => law.quantile(p))
    }

    /// Quantile F^-1(1 - q) for q in [0, 1] [unit of the variable], with the digits that 1 - q has lost.
    pub fn upper_quantile(&self, q: f64) -> f64 {
        with_law!(*self, law => law.upper_quantile(q))
    }

    /// The value x with F(x) = Phi(u), u a standard normal [unit of the variable]; digits are kept in both tails.
    pub fn from_standard_normal(&self, u: f64) -> f64 {
        with_law!(*self, law => law.at_standard_normal(u))
    }

    /// The standard normal u with Phi(u) = F(x) [1]; infinite at the bounds of a bounded law, 0 for a constant.
    pub fn to_standard_normal(&self, x: f64) -> f64 {
        with_law!(*self, law => law.to_standard_normal(x))
    }

    /// Mean of the variable [unit of the variable].
    pub fn mean(&self) -> f64 {
        with_law!(*self, law => law.mean())
    }

    /// Standard deviation of the variable [unit of the variable].
    pub fn std(&self) -> f64 {
        with_law!(*self, law => law.std())
    }

    /// Closed interval outside of which the variable never is; infinite ends where there is none [unit of the
    /// variable].
    pub fn support(&self) -> (f64, f64) {
        with_law!(*self, law => law.support())
    }

    /// The least and the largest value to count with: a bound that somebody set, else the quantile of one in a
    /// million [unit of the variable].
    pub fn limits(&self) -> (f64, f64) {
        with_law!(*self, law => law.limits())
    }

    /// Scores d ln f(x) / d mean and d ln f(x) / d std `(2,)` [1/unit of the variable], bounds held fixed.
    ///
    /// Of uniform, exponential and triangular laws, whose bounds would move with the mean: the score of the least
    /// change of the density, at fixed bounds, that moves the mean or the standard deviation alone (the module `tilted`
    /// derives it). 0 for a constant.
    pub fn scores(&self, x: f64) -> [f64; 2] {
        with_law!(*self, law => law.scores(x))
    }

    /// d ln f(x) / d mean [1/unit of the variable], the first of [`Distribution::scores`].
    pub fn score_mean(&self, x: f64) -> f64 {
        self.scores(x)[0]
    }

    /// d ln f(x) / d std [1/unit of the variable], the second of [`Distribution::scores`].
    pub fn score_std(&self, x: f64) -> f64 {
        self.scores(x)[1]
    }

    /// dF(x) / d mean and dF(x) / d std `(2,)` [1/unit of the variable], in the same sense as the scores: the
    /// integrals of score times density from the lower end to x.
    pub fn cdf_derivatives(&self, x: f64) -> [f64; 2] {
        with_law!(*self, law => law.cdf_derivatives(x))
    }
}
