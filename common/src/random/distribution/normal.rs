//! The normal and the lognormal distribution.

use super::law::{Law, LawError, between, chain, moments};
use crate::random::standard::{Standard, Tail, standard_normal_pdf};
use serde::{Deserialize, Serialize};

/// Normal distribution with a mean and a standard deviation.
///
/// | | |
/// |---|---|
/// | parameters | mean, std > 0, in the unit of the variable: the moments |
/// | support | all real numbers |
/// | density | f(x) = phi(z) / std with z = (x - mean) / std |
/// | distribution function | F(x) = Phi(z) |
///
/// # Source
/// Johnson, Kotz, Balakrishnan (1994), Continuous Univariate Distributions, vol. 1, chapter 13.
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

/// Lognormal distribution, ln X is normal, with the mean and standard deviation of the variable itself, not of its logarithm.
///
/// | | |
/// |---|---|
/// | parameters | mean > 0 and std > 0 of X, in the unit of the variable: the moments |
/// | support | x > 0 |
/// | of ln X | zeta^2 = ln(1 + (std / mean)^2), lambda = ln mean - zeta^2 / 2: its variance and mean [1] |
/// | density | f(x) = phi(z) / (zeta x) with z = (ln x - lambda) / zeta |
/// | distribution function | F(x) = Phi(z) |
///
/// # Source
/// Johnson, Kotz, Balakrishnan (1994), Continuous Univariate Distributions, vol. 1, chapter 14.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Lognormal {
    mean: f64,
    std: f64,
    /// Mean of ln X [1].
    lambda: f64,
    /// Standard deviation of ln X [1].
    zeta: f64,
}

impl Lognormal {
    pub(super) fn new(mean: f64, std: f64) -> Result<Self, LawError> {
        let mean = between("mean", mean, 0.0, f64::INFINITY)?;
        let std = between("std", std, 0.0, f64::INFINITY)?;
        let zeta2 = libm::log1p((std / mean) * (std / mean));
        Ok(Self { mean, std, lambda: libm::log(mean) - 0.5 * zeta2, zeta: zeta2.sqrt() })
    }

    fn z(&self, x: f64) -> f64 {
        (libm::log(x.max(f64::MIN_POSITIVE)) - self.lambda) / self.zeta
    }

    /// Rows d lambda and d zeta, each by mean and std `(2, 2)`.
    fn own(&self) -> [[f64; 2]; 2] {
        let cv = self.std / self.mean;
        let by_cv = 2.0 * cv / (1.0 + cv * cv);
        let zeta2 = [-by_cv * cv / self.mean, by_cv / self.mean];
        [[1.0 / self.mean - 0.5 * zeta2[0], -0.5 * zeta2[1]], zeta2.map(|d| 0.5 * d / self.zeta)]
    }
}

impl Law for Lognormal {
    fn pdf(&self, x: f64) -> f64 {
        if x <= 0.0 { 0.0 } else { standard_normal_pdf(self.z(x)) / (self.zeta * x) }
    }

    fn probability(&self, x: f64, tail: Tail) -> f64 {
        Standard::Normal.probability(if x <= 0.0 { f64::NEG_INFINITY } else { self.z(x) }, tail)
    }

    fn at(&self, p: f64, tail: Tail) -> f64 {
        self.from_standard_normal(Standard::Normal.at(p, tail))
    }

    fn mean_and_std(&self) -> (f64, f64) {
        (self.mean, self.std)
    }

    fn support(&self) -> (f64, f64) {
        (0.0, f64::INFINITY)
    }

    fn scores(&self, x: f64) -> [f64; 2] {
        let z = self.z(x);
        chain([z / self.zeta, (z * z - 1.0) / self.zeta], self.own())
    }

    fn cdf_derivatives(&self, x: f64) -> [f64; 2] {
        let z = self.z(x);
        let slope = standard_normal_pdf(z) / self.zeta;
        chain([-slope, -z * slope], self.own())
    }

    fn from_standard_normal(&self, u: f64) -> f64 {
        libm::exp(self.lambda + self.zeta * u)
    }

    fn to_standard_normal(&self, x: f64) -> f64 {
        self.z(x)
    }
}
