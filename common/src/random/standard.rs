//! The standard distributions whose location and scale others are, of the variable or of a function of it, and the two tails
//! of a distribution.
//!
//! | standard distribution | F(z) | z of the probability p |
//! |---|---|---|
//! | normal | Phi(z) | Phi^-1(p) |
//! | Gumbel of maxima | exp(-exp(-z)) | -ln(-ln p) |
//! | exponential | 1 - exp(-z) | -ln(1 - p) |
//!
//! Of the standard normal distribution N(0, 1) also the density phi(z) = exp(-z^2 / 2) / sqrt(2 pi), and
//! Phi(z) = erfc(-z / sqrt(2)) / 2, Phi^-1(p) = -sqrt(2) erfc^-1(2 p).
//!
//! # Source
//! Johnson, Kotz, Balakrishnan (1994, 1995), Continuous Univariate Distributions, vol. 1, chapters 13, 19, vol. 2, chapter 22.
//! `erfc` is that of the crate `libm`, its inverse that of `statrs`.

use statrs::function::erf::erfc_inv;
use std::f64::consts::{FRAC_1_SQRT_2, PI, SQRT_2};

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

/// Standard normal density phi(z) [1] at z [1].
pub fn standard_normal_pdf(z: f64) -> f64 {
    libm::exp(-0.5 * z * z) / (2.0 * PI).sqrt()
}

/// Standard normal distribution function Phi(z) [1] at z [1], relative accuracy kept in the lower tail.
pub fn standard_normal_cdf(z: f64) -> f64 {
    0.5 * libm::erfc(-z * FRAC_1_SQRT_2)
}

/// Probability Phi(b) - Phi(a) [1] of a standard normal variable between a and b, computed in the tail where it has most digits.
pub fn standard_normal_mass(a: f64, b: f64) -> f64 {
    if a > 0.0 {
        standard_normal_cdf(-a) - standard_normal_cdf(-b)
    } else {
        standard_normal_cdf(b) - standard_normal_cdf(a)
    }
}

/// Standard normal quantile Phi^-1(p) [1] for p in [0, 1]; infinite at the ends.
///
/// One Newton step on the distribution function removes the rounding of the rational approximation; in the tails
/// beyond |z| = 8 the step is omitted, since Phi has too few digits there to improve it.
pub fn standard_normal_quantile(p: f64) -> f64 {
    let z = -SQRT_2 * erfc_inv(2.0 * p);
    if z.abs() < 8.0 { z - (standard_normal_cdf(z) - p) / standard_normal_pdf(z) } else { z }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn standard_normal_quantile_round_trip_in_both_tails() {
        for z in [-7.5, -5.0, -1.0, -1e-3, 0.0, 0.7, 3.0] {
            assert!(
                (standard_normal_quantile(standard_normal_cdf(z)) - z).abs()
                    < 1e-12 * (1.0 + z.abs()) / (1.0 - standard_normal_cdf(z))
            );
        }
    }
}
