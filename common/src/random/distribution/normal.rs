//! The normal distribution.
//!
//! | | |
//! |---|---|
//! | parameters | mean, std > 0, in the unit of the variable: the moments |
//! | support | all real numbers |
//! | density | f(x) = phi(z) / std with z = (x - mean) / std |
//! | distribution function | F(x) = Phi(z) |
//!
//! # Source
//! Johnson, Kotz, Balakrishnan (1994), Continuous Univariate Distributions, vol. 1, chapter 13.

use super::law::{Law, LawError, moments};
use crate::random::standard::{Standard, Tail, standard_normal_pdf};
use serde::{Deserialize, Serialize};

/// Normal distribution with a mean and a standard deviation.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Normal {
    mean: f64,
    std: f64,
}

impl Normal {
    pub(super) fn new(mean: f64, std: f64) -> Result<Self, LawError> {
        let (mean, std) = moments(mean, std)?;
        Ok(Self { mean, std })
    }

    fn z(&self, x: f64) -> f64 {
        (x - self.mean) / self.std
    }
}

impl Law for Normal {
    fn pdf(&self, x: f64) -> f64 {
        standard_normal_pdf(self.z(x)) / self.std
    }

    fn probability(&self, x: f64, tail: Tail) -> f64 {
        Standard::Normal.probability(self.z(x), tail)
    }

    fn at(&self, p: f64, tail: Tail) -> f64 {
        self.mean + self.std * Standard::Normal.at(p, tail)
    }

    fn mean_and_std(&self) -> (f64, f64) {
        (self.mean, self.std)
    }

    fn scores(&self, x: f64) -> [f64; 2] {
        let z = self.z(x);
        [z / self.std, (z * z - 1.0) / self.std]
    }

    fn cdf_derivatives(&self, x: f64) -> [f64; 2] {
        let (z, f) = (self.z(x), self.pdf(x));
        [-f, -z * f]
    }

    fn from_standard_normal(&self, u: f64) -> f64 {
        self.mean + self.std * u
    }

    fn to_standard_normal(&self, x: f64) -> f64 {
        self.z(x)
    }
}
