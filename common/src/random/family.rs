//! Families of distributions with two parameters, fitted to measured values by maximum likelihood.
//!
//! Each family is a location and a scale of a standard distribution, of the values or of their logarithms: y = location + scale z.
//!
//! | family | y | standard distribution of z | location, scale of largest likelihood |
//! |---|---|---|---|
//! | normal, lognormal | x, ln x | Phi(z) | mean, standard deviation with divisor n |
//! | Gumbel of maxima, of minima | x, -x | exp(-exp(-z)) | scale = mean y - sum y e^(-y / scale) / sum e^(-y / scale), location = -scale ln(mean e^(-y / scale)) |
//! | Weibull | -ln x | exp(-exp(-z)) | as Gumbel; shape = 1 / scale, scale of x = e^(-location) |
//! | exponential | x | 1 - exp(-z) | 0, mean |
//!
//! # Source
//! Johnson, Kotz, Balakrishnan (1994, 1995), Continuous Univariate Distributions, vol. 1, chapters 13, 14, 19, 21, vol. 2, chapter 22.

use super::distribution::{Distribution, Extreme, FitError};
use super::standard::Standard;
use std::f64::consts::EULER_GAMMA;

/// Fewest values of a fit with two parameters.
const FEWEST: usize = 5;

/// A family of distributions that can be fitted.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Family {
    /// Normal, without bounds.
    Normal,
    /// The logarithm is normal.
    Lognormal,
    /// Weibull of minima from zero on.
    Weibull,
    /// Gumbel of maxima or minima.
    Gumbel(Extreme),
    /// Exponential from zero on.
    Exponential,
}

impl Family {
    /// Every family by the word of a scene for it, in the order of messages.
    pub const WORDS: [(&'static str, Self); 6] = [
        ("normal", Self::Normal),
        ("lognormal", Self::Lognormal),
        ("weibull", Self::Weibull),
        ("gumbel", Self::Gumbel(Extreme::Maxima)),
        ("gumbel-minima", Self::Gumbel(Extreme::Minima)),
        ("exponential", Self::Exponential),
    ];

    /// The word of a scene for it.
    pub fn word(self) -> &'static str {
        Self::WORDS.iter().find(|(_, family)| *family == self).map_or("", |(word, _)| word)
    }

    /// The distribution of this family with the largest likelihood of the samples `(n,)`.
    ///
    /// # Errors
    /// [`FitError`].
    pub fn fit(self, samples: &[f64]) -> Result<Distribution, FitError> {
        if samples.len() < FEWEST {
            return Err(FitError::TooFew { found: samples.len(), least: FEWEST });
        }
        let positive = matches!(self, Self::Lognormal | Self::Weibull | Self::Exponential);
        if let Some(place) = samples.iter().position(|x| positive && *x <= 0.0) {
            return Err(FitError::NotPositive(place));
        }
        if samples.iter().all(|x| *x == samples[0]) {
            return Err(FitError::AllEqual);
        }
        let (location, scale) = self.standard_fit(&self.transformed(samples));
        Ok(match self {
            Self::Normal => Distribution::normal(location, scale),
            Self::Lognormal => {
                let mean = libm::exp(location + 0.5 * scale * scale);
                Distribution::lognormal(mean, mean * libm::expm1(scale * scale).sqrt())
            }
            Self::Weibull => {
                let half = libm::lgamma(1.0 + scale);
                let mean = libm::exp(half - location);
                let ratio = libm::expm1(libm::lgamma(1.0 + 2.0 * scale) - 2.0 * half);
                Distribution::weibull(mean, mean * ratio.max(0.0).sqrt())
            }
            Self::Gumbel(extreme) => {
                let mean = location + EULER_GAMMA * scale;
                let gumbel_std = std::f64::consts::PI / 6.0_f64.sqrt() * scale;
                let mean = if extreme == Extreme::Maxima { mean } else { -mean };
                Distribution::gumbel(mean, gumbel_std, extreme)
            }
            Self::Exponential => Distribution::exponential_from(0.0, scale),
        }?)
    }

    /// The values y of the samples `(n,)`.
    pub fn transformed(self, samples: &[f64]) -> Vec<f64> {
        let y = |x: f64| match self {
            Self::Normal | Self::Exponential | Self::Gumbel(Extreme::Maxima) => x,
            Self::Gumbel(Extreme::Minima) => -x,
            Self::Lognormal => libm::log(x),
            Self::Weibull => -libm::log(x),
        };
        samples.iter().map(|x| y(*x)).collect()
    }

    /// Location and scale of largest likelihood in y = location + scale z of the values y `(n,)`, which are not all equal [unit of y].
    pub fn standard_fit(self, y: &[f64]) -> (f64, f64) {
        let n = y.len() as f64;
        let mean = y.iter().sum::<f64>() / n;
        match self.standard() {
            Standard::Normal => {
                let variance = y.iter().map(|y| (y - mean) * (y - mean)).sum::<f64>() / n;
                (mean, variance.sqrt())
            }
            Standard::Exponential => (0.0, mean),
            Standard::Gumbel => gumbel_fit(y, mean),
        }
    }

    /// The standard distribution of z.
    pub fn standard(self) -> Standard {
        match self {
            Self::Normal | Self::Lognormal => Standard::Normal,
            Self::Exponential => Standard::Exponential,
            Self::Gumbel(_) | Self::Weibull => Standard::Gumbel,
        }
    }
}

/// Scale and location of a Gumbel distribution of maxima by Newton's method within a bracket.
fn gumbel_fit(y: &[f64], mean: f64) -> (f64, f64) {
    let n = y.len() as f64;
    let least = y.iter().copied().fold(f64::INFINITY, f64::min);
    let variance = y.iter().map(|y| (y - mean) * (y - mean)).sum::<f64>() / n;
    // Weights are those of the distance from the least value, so that none overflows.
    let sums = |scale: f64| {
        y.iter().fold([0.0; 3], |[w, wy, wyy], y| {
            let above = y - least;
            let weight = libm::exp(-above / scale);
            [w + weight, wy + weight * above, wyy + weight * above * above]
        })
    };
    // The scale is at most mean - least: there the residual is not positive.
    let (mut low, mut high) = (0.0, mean - least);
    let mut scale = (6.0 * variance).sqrt() / std::f64::consts::PI;
    for _ in 0..100 {
        scale = if scale > low && scale < high { scale } else { 0.5 * (low + high) };
        let [w, wy, wyy] = sums(scale);
        let weighted = wy / w;
        let residual = mean - least - weighted - scale;
        if residual > 0.0 {
            low = scale
        } else {
            high = scale
        }
        let slope = -1.0 - (wyy / w - weighted * weighted) / (scale * scale);
        let next = scale - residual / slope;
        if (next - scale).abs() <= 1e-14 * scale {
            break;
        }
        scale = next;
    }
    let [w, ..] = sums(scale);
    (least - scale * libm::log(w / n), scale)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::LawError;

    /// Quantiles of a distribution at the middle of n equal steps: their fit is near to it.
    fn regular(law: &Distribution, n: u32) -> Vec<f64> {
        (0..n).map(|k| law.quantile((f64::from(k) + 0.5) / f64::from(n))).collect()
    }

    #[test]
    fn a_family_is_found_again() {
        for (family, law) in [
            (Family::Normal, Distribution::normal(20e-6, 2e-6)),
            (Family::Lognormal, Distribution::lognormal(20e-6, 5e-6)),
            (Family::Weibull, Distribution::weibull(300.0, 80.0)),
            (Family::Weibull, Distribution::weibull(300.0, 2.0)),
            (Family::Gumbel(Extreme::Maxima), Distribution::gumbel(-4.0, 0.5, Extreme::Maxima)),
            (Family::Gumbel(Extreme::Minima), Distribution::gumbel(-4.0, 0.5, Extreme::Minima)),
            (Family::Exponential, Distribution::exponential_from(0.0, 7.0)),
        ] {
            let law = law.unwrap();
            let fitted = family.fit(&regular(&law, 4000)).unwrap();
            assert!((fitted.mean() / law.mean() - 1.0).abs() < 2e-3, "{family:?}: {fitted:?}");
            assert!((fitted.std() / law.std() - 1.0).abs() < 5e-3, "{family:?}: {fitted:?}");
        }
    }

    /// No distribution of the family with other moments has a larger likelihood.
    #[test]
    fn the_likelihood_is_the_largest() {
        let samples = [21.0, 18.4, 25.1, 19.9, 20.3, 31.0, 22.2, 17.5, 23.8];
        let log_likelihood = |law: &Distribution| samples.iter().map(|x| law.pdf(*x).ln()).sum::<f64>();
        type Make = fn(f64, f64) -> Result<Distribution, LawError>;
        let families: [(Family, Make); 5] = [
            (Family::Normal, Distribution::normal),
            (Family::Lognormal, Distribution::lognormal),
            (Family::Weibull, Distribution::weibull),
            (Family::Gumbel(Extreme::Maxima), |mean, std| Distribution::gumbel(mean, std, Extreme::Maxima)),
            (Family::Gumbel(Extreme::Minima), |mean, std| Distribution::gumbel(mean, std, Extreme::Minima)),
        ];
        for (family, make) in families {
            let best = family.fit(&samples).unwrap();
            let reached = log_likelihood(&best);
            for (by, and) in [(1.01, 1.0), (0.99, 1.0), (1.0, 1.03), (1.0, 0.97)] {
                let other = make(best.mean() * by, best.std() * and).unwrap();
                assert!(log_likelihood(&other) < reached, "{family:?}: {other:?} against {best:?}");
            }
        }
    }

    #[test]
    fn what_cannot_be_fitted_is_refused() {
        assert_eq!(Family::Normal.fit(&[1.0; 4]), Err(FitError::TooFew { found: 4, least: 5 }));
        assert_eq!(Family::Normal.fit(&[1.0; 9]), Err(FitError::AllEqual));
        let with_zero = [1.0, 2.0, 0.0, 3.0, 4.0];
        assert_eq!(Family::Weibull.fit(&with_zero), Err(FitError::NotPositive(2)));
        assert!(Family::Gumbel(Extreme::Maxima).fit(&with_zero).is_ok());
    }
}
