//! The standard distributions whose location and scale others are, of the variable or of a function of it, and the two tails
//! of a distribution.
//!
//! | standard distribution | F(z) | z of the probability p |
//! |---|---|---|
//! | normal | Phi(z) | Phi^-1(p) |
//! | Gumbel of maxima | exp(-exp(-z)) | -ln(-ln p) |
//! | exponential | 1 - exp(-z) | -ln(1 - p) |
//!
//! # Source
//! Johnson, Kotz, Balakrishnan (1994, 1995), Continuous Univariate Distributions, vol. 1, chapters 13, 19, vol. 2, chapter 22.

use super::standard_normal::{standard_normal_cdf, standard_normal_quantile};

/// A tail of a distribution: each has its probabilities with all digits where they are small.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Tail {
    /// The values up to one.
    Lower,
    /// The values above it.
    Upper,
}

impl Tail {
    /// The other tail.
    #[must_use]
    pub fn other(self) -> Self {
        match self {
            Self::Lower => Self::Upper,
            Self::Upper => Self::Lower,
        }
    }
}

/// A standard distribution.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Standard {
    /// Of mean 0 and variance 1.
    Normal,
    /// Of maxima, with location 0 and scale 1.
    Gumbel,
    /// From 0 on, of mean 1.
    Exponential,
}

impl Standard {
    /// Probability of the tail at z [1].
    pub fn probability(self, z: f64, tail: Tail) -> f64 {
        match (self, tail) {
            (Self::Normal, Tail::Lower) => standard_normal_cdf(z),
            (Self::Normal, Tail::Upper) => standard_normal_cdf(-z),
            (Self::Gumbel, Tail::Lower) => libm::exp(-libm::exp(-z)),
            (Self::Gumbel, Tail::Upper) => -libm::expm1(-libm::exp(-z)),
            (Self::Exponential, Tail::Lower) => -libm::expm1(-z.max(0.0)),
            (Self::Exponential, Tail::Upper) => libm::exp(-z.max(0.0)),
        }
    }

    /// The z at which the tail has the probability p in [0, 1] [1].
    pub fn at(self, p: f64, tail: Tail) -> f64 {
        match (self, tail) {
            (Self::Normal, Tail::Lower) => standard_normal_quantile(p),
            (Self::Normal, Tail::Upper) => -standard_normal_quantile(p),
            (Self::Gumbel, Tail::Lower) => -libm::log(-libm::log(p)),
            (Self::Gumbel, Tail::Upper) => -libm::log(-libm::log1p(-p)),
            (Self::Exponential, Tail::Lower) => -libm::log1p(-p),
            (Self::Exponential, Tail::Upper) => -libm::log(p),
        }
    }
}
