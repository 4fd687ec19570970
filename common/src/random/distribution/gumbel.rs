//! The Gumbel distribution: extreme value distribution of type I, of maxima or of minima.
//!
//! | | |
//! |---|---|
//! | parameters | mean, std > 0, in the unit of the variable: the moments |
//! | support | all real numbers |
//! | scale, location | s = sqrt(6) std / pi, l = mean - gamma s, gamma Euler's constant |
//! | density of maxima | f(x) = exp(-z - exp(-z)) / s with z = (x - l) / s |
//! | distribution function of maxima | F(x) = exp(-exp(-z)) |
//!
//! X is Gumbel of minima if -X is Gumbel of maxima.
//!
//! # Source
//! Johnson, Kotz, Balakrishnan (1995), Continuous Univariate Distributions, vol. 2, chapter 22.

use super::law::{Law, LawError, moments};
use crate::random::standard::{Standard, Tail};
use serde::{Deserialize, Serialize};
use std::f64::consts::EULER_GAMMA;

/// The extremes that a Gumbel distribution describes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum Extreme {
    /// Largest values: the long tail is the upper one.
    Maxima,
    /// Smallest values: the long tail is the lower one.
    Minima,
}

/// Gumbel distribution with a mean and a standard deviation.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Gumbel {
    mean: f64,
    std: f64,
    pub(super) extreme: Extreme,
}

/// s / std = sqrt(6) / pi [1].
const SCALE: f64 = 0.779_696_801_233_675_7;

impl Gumbel {
    pub(super) fn new(mean: f64, std: f64, extreme: Extreme) -> Result<Self, LawError> {
        let (mean, std) = moments(mean, std)?;
        Ok(Self { mean, std, extreme })
    }

    /// +1 for maxima, -1 for minima.
    fn sign(&self) -> f64 {
        if self.extreme == Extreme::Maxima { 1.0 } else { -1.0 }
    }

    fn scale(&self) -> f64 {
        SCALE * self.std
    }

    /// z of x, of -x for minima [1].
    fn z(&self, x: f64) -> f64 {
        self.sign() * (x - self.mean) / self.scale() + EULER_GAMMA
    }

    /// The tail of the standard distribution that is this one of X.
    fn tail(&self, tail: Tail) -> Tail {
        if self.extreme == Extreme::Maxima { tail } else { tail.other() }
    }
}

impl Law for Gumbel {
    fn pdf(&self, x: f64) -> f64 {
        let z = self.z(x);
        libm::exp(-z - libm::exp(-z)) / self.scale()
    }

    fn probability(&self, x: f64, tail: Tail) -> f64 {
        Standard::Gumbel.probability(self.z(x), self.tail(tail))
    }

    fn at(&self, p: f64, tail: Tail) -> f64 {
        let z = Standard::Gumbel.at(p, self.tail(tail));
        self.mean + self.sign() * self.scale() * (z - EULER_GAMMA)
    }

    fn mean_and_std(&self) -> (f64, f64) {
        (self.mean, self.std)
    }

    fn scores(&self, x: f64) -> [f64; 2] {
        let z = self.z(x);
        let by_location = 1.0 - libm::exp(-z);
        let by_scale = z * by_location - 1.0;
        let scale = self.scale();
        [self.sign() * by_location / scale, (by_scale - EULER_GAMMA * by_location) / self.std]
    }

    fn cdf_derivatives(&self, x: f64) -> [f64; 2] {
        let f = self.pdf(x);
        // F moves with the value that stays at the same z: dx/dmean = 1, dx/dstd = (x - mean) / std.
        [-f, -f * (x - self.mean) / self.std]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::PI;

    #[test]
    fn closed_forms() {
        assert!((SCALE - 6.0_f64.sqrt() / PI).abs() < 1e-15);
        // The location is the mode, F there is 1/e, and the median is l - s ln ln 2.
        let g = Gumbel::new(10.0, 2.0, Extreme::Maxima).unwrap();
        let s = g.scale();
        let l = 10.0 - EULER_GAMMA * s;
        assert!((g.cdf(l) - (-1.0_f64).exp()).abs() < 1e-15);
        assert!((g.quantile(0.5) - (l - s * 2.0_f64.ln().ln())).abs() < 1e-13);
        assert!(g.pdf(l) > g.pdf(l + 1e-3) && g.pdf(l) > g.pdf(l - 1e-3));
        let m = Gumbel::new(-10.0, 2.0, Extreme::Minima).unwrap();
        assert_eq!((m.cdf(-l), m.pdf(-l)), (g.survival(l), g.pdf(l)));
    }
}
