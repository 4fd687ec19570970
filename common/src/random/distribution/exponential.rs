//! The exponential distribution, and the Weibull distribution, a power of an exponential variable.

use super::law::{Law, LawError, REMOTE, between, chain, moments, tilted};
use crate::random::standard::{Standard, Tail};
use serde::{Deserialize, Serialize};
use statrs::function::gamma::digamma;

/// E[t^3] of the standardised exponential variable.
const SKEWNESS: f64 = 2.0;
/// E[t^4] of the standardised exponential variable.
const KURTOSIS: f64 = 9.0;

/// Exponential distribution that begins at a lower bound.
///
/// | | |
/// |---|---|
/// | parameters | lower, std > 0, in the unit of the variable |
/// | support | x >= lower |
/// | density | f(x) = exp(-e) / std with e = (x - lower) / std |
/// | distribution function | F(x) = 1 - exp(-e) |
/// | moments | mean = lower + std, variance = std^2; E[t^3] = 2 and E[t^4] = 9 of the standardised t = e - 1 |
///
/// Its scores hold the lower bound fixed: see `law::tilted`.
///
/// # Source
/// Johnson, Kotz, Balakrishnan (1994), Continuous Univariate Distributions, vol. 1, chapter 19.
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

/// Range of the coefficient of variation; beyond, powers lose their digits (shapes of 1282 and 0.24).
const COEFFICIENT_OF_VARIATION: (f64, f64) = (1e-3, 10.0);

/// Weibull distribution of minima, as used for strengths and lives, with a mean and a standard deviation.
///
/// | | |
/// |---|---|
/// | parameters | mean > 0 and std of X, 0.001 < std / mean < 10, in the unit of the variable: the moments |
/// | support | x > 0 |
/// | density | f(x) = (k / l) (x / l)^(k - 1) exp(-(x / l)^k), shape k [1], scale l [unit of the variable] |
/// | distribution function | F(x) = 1 - exp(-(x / l)^k) |
/// | moments | with w = 1 / k: mean = l Gamma(1 + w), ln(1 + (std / mean)^2) = ln Gamma(1 + 2 w) - 2 ln Gamma(1 + w) |
///
/// The last equation rises with w and is solved for it once.
///
/// # Source
/// Johnson, Kotz, Balakrishnan (1994), Continuous Univariate Distributions, vol. 1, chapter 21.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Weibull {
    mean: f64,
    std: f64,
    scale: f64,
    shape: f64,
}

/// ln Gamma(1 + 2 w) - 2 ln Gamma(1 + w) = ln(E[X^2] / E[X]^2) [1].
///
/// Below w = 0.01, where the difference loses its digits, from its series: the sum over n >= 2 of
/// zeta(n) (-w)^n (2^n - 2) / n.
fn log_second_moment(w: f64) -> f64 {
    // zeta(2), ..., zeta(8).
    const ZETA: [f64; 7] = [
        1.644_934_066_848_226_4,
        1.202_056_903_159_594_3,
        1.082_323_233_711_138_2,
        1.036_927_755_143_37,
        1.017_343_061_984_449,
        1.008_349_277_381_922_8,
        1.004_077_356_197_944_3,
    ];
    if w >= 0.01 {
        return libm::lgamma(1.0 + 2.0 * w) - 2.0 * libm::lgamma(1.0 + w);
    }
    let term = |(i, zeta): (usize, &f64)| {
        let n = (i + 2) as i32;
        zeta * (-w).powi(n) * (2.0_f64.powi(n) - 2.0) / f64::from(n)
    };
    ZETA.iter().enumerate().map(term).sum()
}

impl Weibull {
    pub(super) fn new(mean: f64, std: f64) -> Result<Self, LawError> {
        let mean = between("mean", mean, 0.0, f64::INFINITY)?;
        let (least, most) = COEFFICIENT_OF_VARIATION;
        let std = between("std", std, least * mean, most * mean)?;
        let target = libm::log1p((std / mean) * (std / mean));
        // The interval contains every w allowed; bisection to the last bit.
        let (mut low, mut high) = (5e-4, 5.0);
        let middle = |low: f64, high: f64| Some(0.5 * (low + high)).filter(|w| low < *w && *w < high);
        while let Some(w) = middle(low, high) {
            if log_second_moment(w) < target { low = w } else { high = w }
        }
        let w = 0.5 * (low + high);
        Ok(Self { mean, std, scale: mean / libm::tgamma(1.0 + w), shape: 1.0 / w })
    }

    /// x / l [1].
    fn ratio(&self, x: f64) -> f64 {
        x.max(f64::MIN_POSITIVE) / self.scale
    }

    /// Cumulative hazard (x / l)^k = -ln(1 - F) [1].
    fn hazard(&self, x: f64) -> f64 {
        libm::pow(self.ratio(x), self.shape)
    }

    /// Rows d scale and d shape, each by mean and std `(2, 2)`.
    fn own(&self) -> [[f64; 2]; 2] {
        let (w, cv) = (1.0 / self.shape, self.std / self.mean);
        let moment_slope = 2.0 * (digamma(1.0 + 2.0 * w) - digamma(1.0 + w));
        let by_cv = 2.0 * cv / (1.0 + cv * cv) / moment_slope;
        let w_by = [-by_cv * cv / self.mean, by_cv / self.mean];
        let along = self.scale * digamma(1.0 + w);
        let scale_by = [self.scale / self.mean - along * w_by[0], -along * w_by[1]];
        [scale_by, w_by.map(|d| -self.shape * self.shape * d)]
    }
}

impl Law for Weibull {
    fn pdf(&self, x: f64) -> f64 {
        if x <= 0.0 {
            return 0.0;
        }
        let hazard = self.hazard(x);
        self.shape * hazard / x * libm::exp(-hazard)
    }

    fn probability(&self, x: f64, tail: Tail) -> f64 {
        Standard::Exponential.probability(if x <= 0.0 { 0.0 } else { self.hazard(x) }, tail)
    }

    fn at(&self, p: f64, tail: Tail) -> f64 {
        self.scale * libm::pow(Standard::Exponential.at(p, tail), 1.0 / self.shape)
    }

    fn mean_and_std(&self) -> (f64, f64) {
        (self.mean, self.std)
    }

    fn support(&self) -> (f64, f64) {
        (0.0, f64::INFINITY)
    }

    fn scores(&self, x: f64) -> [f64; 2] {
        let (hazard, log) = (self.hazard(x), libm::log(self.ratio(x)));
        let by_scale = self.shape * (hazard - 1.0) / self.scale;
        let by_shape = 1.0 / self.shape + log * (1.0 - hazard);
        chain([by_scale, by_shape], self.own())
    }

    fn cdf_derivatives(&self, x: f64) -> [f64; 2] {
        let (hazard, log) = (self.hazard(x), libm::log(self.ratio(x)));
        let slope = hazard * libm::exp(-hazard);
        chain([-self.shape / self.scale * slope, log * slope], self.own())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn closed_forms() {
        // Shape 1 is the exponential, shape 2 the Rayleigh distribution: mean sqrt(pi) / 2, variance 1 - pi / 4.
        let e = Weibull::new(3.0, 3.0).unwrap();
        assert!((e.shape - 1.0).abs() < 1e-12 && (e.scale - 3.0).abs() < 1e-12, "{e:?}");
        let pi = std::f64::consts::PI;
        let r = Weibull::new(pi.sqrt() / 2.0, (1.0 - pi / 4.0).sqrt()).unwrap();
        assert!((r.shape - 2.0).abs() < 1e-12 && (r.scale - 1.0).abs() < 1e-12, "{r:?}");
        assert!((r.cdf(1.0) - (1.0 - (-1.0_f64).exp())).abs() < 1e-12);
    }

    #[test]
    fn the_series_continues_the_difference() {
        for w in [0.01, 0.01 - 1e-12] {
            let exact = libm::lgamma(1.0 + 2.0 * w) - 2.0 * libm::lgamma(1.0 + w);
            assert!((log_second_moment(w) / exact - 1.0).abs() < 1e-11, "{w}");
        }
        // Narrow laws: w = sqrt(6) / pi cv to first order.
        let narrow = Weibull::new(1.0, 2e-3).unwrap();
        assert!((1.0 / narrow.shape / (2e-3 * 6.0_f64.sqrt() / std::f64::consts::PI) - 1.0).abs() < 5e-3);
    }
}
