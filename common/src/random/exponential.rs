//! The exponential distribution from a lower end on.
//!
//! f(x) = exp(-(x - lower) / std) / std for x >= lower, with mean = lower + std. Its scores hold the lower end fixed:
//! see `tilted`.

use super::law::{Law, LawError, REMOTE, between, moments};
use super::tilted::tilted;
use serde::{Deserialize, Serialize};

/// E[t^3] and E[t^4].
const SKEWNESS: f64 = 2.0;
const KURTOSIS: f64 = 9.0;

/// Exponential, shifted to begin at `lower`.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Exponential {
    lower: f64,
    std: f64,
}

impl Exponential {
    /// It begins at mean - std.
    pub(super) fn by_moments(mean: f64, std: f64) -> Result<Self, LawError> {
        let (mean, std) = moments(mean, std)?;
        Ok(Self { lower: mean - std, std })
    }

    /// Its standard deviation is mean - lower.
    pub(super) fn by_lower(mean: f64, lower: f64) -> Result<Self, LawError> {
        let mean = between("mean", mean, f64::NEG_INFINITY, f64::INFINITY)?;
        let lower = between("lower", lower, f64::NEG_INFINITY, mean)?;
        Ok(Self { lower, std: mean - lower })
    }

    /// (x - lower) / std, not below zero.
    fn e(&self, x: f64) -> f64 {
        ((x - self.lower) / self.std).max(0.0)
    }
}

impl Law for Exponential {
    fn pdf(&self, x: f64) -> f64 {
        if x < self.lower { 0.0 } else { libm::exp(-self.e(x)) / self.std }
    }

    fn cdf(&self, x: f64) -> f64 {
        -libm::expm1(-self.e(x))
    }

    fn survival(&self, x: f64) -> f64 {
        libm::exp(-self.e(x))
    }

    fn quantile(&self, p: f64) -> f64 {
        self.lower - self.std * libm::log1p(-p)
    }

    fn upper_quantile(&self, q: f64) -> f64 {
        self.lower - self.std * libm::log(q)
    }

    fn mean(&self) -> f64 {
        self.lower + self.std
    }

    fn std(&self) -> f64 {
        self.std
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
