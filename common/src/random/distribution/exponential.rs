//! The exponential distribution, shifted to begin at a lower bound.
//!
//! | | |
//! |---|---|
//! | parameters | lower, std > 0, in the unit of the variable |
//! | support | x >= lower |
//! | density | f(x) = exp(-e) / std with e = (x - lower) / std |
//! | distribution function | F(x) = 1 - exp(-e) |
//! | moments | mean = lower + std, variance = std^2; E[t^3] = 2 and E[t^4] = 9 of the standardised t = e - 1 |
//!
//! Its scores hold the lower bound fixed: see `law::tilted`.
//!
//! # Source
//! Johnson, Kotz, Balakrishnan (1994), Continuous Univariate Distributions, vol. 1, chapter 19.

use super::law::{Law, LawError, REMOTE, between, moments, tilted};
use crate::random::standard::{Standard, Tail};
use serde::{Deserialize, Serialize};

/// E[t^3] of the standardised variable.
const SKEWNESS: f64 = 2.0;
/// E[t^4] of the standardised variable.
const KURTOSIS: f64 = 9.0;

/// Exponential distribution that begins at a lower bound.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Exponential {
    lower: f64,
    std: f64,
}

impl Exponential {
    /// The one that begins at mean - std.
    pub(super) fn by_moments(mean: f64, std: f64) -> Result<Self, LawError> {
        let (mean, std) = moments(mean, std)?;
        Ok(Self { lower: mean - std, std })
    }

    /// The one that begins at `lower`; its standard deviation is mean - lower.
    pub(super) fn by_lower(mean: f64, lower: f64) -> Result<Self, LawError> {
        let mean = between("mean", mean, f64::NEG_INFINITY, f64::INFINITY)?;
        let lower = between("lower", lower, f64::NEG_INFINITY, mean)?;
        Ok(Self { lower, std: mean - lower })
    }

    /// e = (x - lower) / std [1], not below zero.
    fn e(&self, x: f64) -> f64 {
        ((x - self.lower) / self.std).max(0.0)
    }
}

impl Law for Exponential {
    fn pdf(&self, x: f64) -> f64 {
        if x < self.lower { 0.0 } else { libm::exp(-self.e(x)) / self.std }
    }

    fn probability(&self, x: f64, tail: Tail) -> f64 {
        Standard::Exponential.probability(self.e(x), tail)
    }

    fn at(&self, p: f64, tail: Tail) -> f64 {
        self.lower + self.std * Standard::Exponential.at(p, tail)
    }

    fn mean_and_std(&self) -> (f64, f64) {
        (self.lower + self.std, self.std)
    }

    fn support(&self) -> (f64, f64) {
        (self.lower, f64::INFINITY)
    }

    fn limits(&self) -> (f64, f64) {
        (self.lower, self.upper_quantile(REMOTE))
    }

    fn scores(&self, x: f64) -> [f64; 2] {
        let t = self.e(x) - 1.0;
        tilted(t, t * t - 1.0, self.std, SKEWNESS, KURTOSIS)
    }

    fn cdf_derivatives(&self, x: f64) -> [f64; 2] {
        // Integrals of (e - 1) exp(-e) and (e^2 - 2 e) exp(-e) from 0 to e.
        let e = self.e(x);
        let tail = libm::exp(-e);
        tilted(-e * tail, -e * e * tail, self.std, SKEWNESS, KURTOSIS)
    }
}
