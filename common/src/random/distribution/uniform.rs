//! The uniform distribution between two bounds.
//!
//! | | |
//! |---|---|
//! | parameters | lower < upper, in the unit of the variable |
//! | support | [lower, upper] |
//! | density | f(x) = 1 / (upper - lower) |
//! | distribution function | F(x) = (x - lower) / (upper - lower) |
//! | mean, variance | (lower + upper) / 2, (upper - lower)^2 / 12; E[t^4] = 9/5 of the standardised t |
//!
//! Its scores hold the bounds fixed: see `law::tilted`.
//!
//! # Source
//! Johnson, Kotz, Balakrishnan (1995), Continuous Univariate Distributions, vol. 2, chapter 26.

use super::law::{Law, LawError, between, moments, tilted};
use crate::random::standard::Tail;
use serde::{Deserialize, Serialize};

/// E[t^4] of the standardised variable.
const KURTOSIS: f64 = 1.8;

/// Uniform distribution between two bounds.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Uniform {
    lower: f64,
    upper: f64,
}

impl Uniform {
    pub(super) fn new(lower: f64, upper: f64) -> Result<Self, LawError> {
        let lower = between("lower", lower, f64::NEG_INFINITY, f64::INFINITY)?;
        Ok(Self { lower, upper: between("upper", upper, lower, f64::INFINITY)? })
    }

    /// The one with bounds at mean -+ sqrt(3) std.
    pub(super) fn by_moments(mean: f64, std: f64) -> Result<Self, LawError> {
        let (mean, std) = moments(mean, std)?;
        let half = 3.0_f64.sqrt() * std;
        Self::new(mean - half, mean + half)
    }

    fn width(&self) -> f64 {
        self.upper - self.lower
    }

    /// t = (x - mean) / std [1].
    fn t(&self, x: f64) -> f64 {
        (x - self.mean()) / self.std()
    }
}

impl Law for Uniform {
    fn pdf(&self, x: f64) -> f64 {
        if x < self.lower || x > self.upper { 0.0 } else { 1.0 / self.width() }
    }

    fn probability(&self, x: f64, tail: Tail) -> f64 {
        let part = if tail == Tail::Lower { x - self.lower } else { self.upper - x };
        (part / self.width()).clamp(0.0, 1.0)
    }

    fn at(&self, p: f64, tail: Tail) -> f64 {
        match tail {
            Tail::Lower => (self.lower + p * self.width()).min(self.upper),
            Tail::Upper => (self.upper - p * self.width()).max(self.lower),
        }
    }

    fn mean_and_std(&self) -> (f64, f64) {
        (self.lower + 0.5 * self.width(), self.width() / 12.0_f64.sqrt())
    }

    fn support(&self) -> (f64, f64) {
        (self.lower, self.upper)
    }

    fn scores(&self, x: f64) -> [f64; 2] {
        let t = self.t(x);
        tilted(t, t * t - 1.0, self.std(), 0.0, KURTOSIS)
    }

    fn cdf_derivatives(&self, x: f64) -> [f64; 2] {
        let root = 3.0_f64.sqrt();
        let t = self.t(x).clamp(-root, root);
        // Integrals of t and t^2 - 1 over the density 1 / (2 sqrt(3)) from -sqrt(3) to t.
        let (linear, quadratic) = (0.5 * (t * t - 3.0), t * (t * t / 3.0 - 1.0));
        tilted(linear / (2.0 * root), quadratic / (2.0 * root), self.std(), 0.0, KURTOSIS)
    }
}
