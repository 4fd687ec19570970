//! Distributions that samples leave possible, of a family that was fitted to them.
//!
//! For y = location + scale z the fit of n values has pivots: (location' - location) / scale and scale' / scale have distributions
//! that do not depend on location and scale. Samples z* of the standard distribution with the fit (a, b) give
//!
//!   scale = scale' / b,   location = location' - a scale,
//!
//! whose quantiles are exact confidence bounds of the parameters and of every quantile, for any n. Of an empirical distribution the
//! mean and the standard deviation are those of samples drawn with replacement, and its shape stays: an approximation, which
//! needs many samples.
//!
//! # Source
//! Lawless (2003), Statistical Models and Methods for Lifetime Data, 2nd edition, section E.5 and appendix E; Efron (1979), Bootstrap methods:
//! another look at the jackknife, The Annals of Statistics 7(1).

use crate::design::with_moments;
use common::random::{Distribution, Extreme, Family, Tail};
use rand::{Rng, RngExt};

/// Most attempts for one draw: samples whose distribution does not exist are drawn again.
const ATTEMPTS: usize = 100;

/// `count` distributions that the samples `(n,)` with their fitted distribution `fitted` leave possible; those that the
/// family does not allow are replaced by `fitted`.
pub fn fitted_draws(
    family: Option<Family>,
    fitted: &Distribution,
    samples: &[f64],
    count: usize,
    rng: &mut impl Rng,
) -> Vec<Distribution> {
    let draw = |rng: &mut dyn Rng| match family {
        Some(family) => by_pivots(family, samples, rng),
        None => by_moments(fitted, samples, rng),
    };
    (0..count).map(|_| (0..ATTEMPTS).find_map(|_| draw(rng)).unwrap_or_else(|| fitted.clone())).collect()
}

fn by_pivots(family: Family, samples: &[f64], rng: &mut dyn Rng) -> Option<Distribution> {
    let y = family.transformed(samples);
    let of_samples = family.standard_fit(&y);
    let standard = family.standard();
    let mut z = || standard.at(rng.random::<f64>().max(f64::EPSILON / 4.0), Tail::Lower);
    let pivot = family.standard_fit(&(0..y.len()).map(|_| z()).collect::<Vec<f64>>());
    let scale = of_samples.scale / pivot.scale;
    let location = of_samples.location - pivot.location * scale;
    // Values whose fit has this location and scale.
    let value = |y: &f64| {
        let y = location + scale * (y - of_samples.location) / of_samples.scale;
        match family {
            Family::Normal | Family::Exponential | Family::Gumbel(Extreme::Maxima) => y,
            Family::Gumbel(Extreme::Minima) => -y,
            Family::Lognormal => y.exp(),
            Family::Weibull => (-y).exp(),
        }
    };
    family.fit(&y.iter().map(value).collect::<Vec<f64>>()).ok().filter(|law| law.std().is_finite())
}

fn by_moments(fitted: &Distribution, samples: &[f64], rng: &mut dyn Rng) -> Option<Distribution> {
    let n = samples.len();
    let drawn: Vec<f64> = (0..n).map(|_| samples[rng.random_range(0..n)]).collect();
    let mean = drawn.iter().sum::<f64>() / n as f64;
    let variance = drawn.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / (n - 1) as f64;
    with_moments(fitted, mean, variance.sqrt(), [false; 2]).ok()
}
