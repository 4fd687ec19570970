//! Random numbers, directions and variables of which problems are drawn.

use super::response::dot;
use common::random::{Distribution, Extreme};
use rand::{Rng, RngExt};
use rand_distr::{Distribution as _, StandardNormal};
use std::f64::consts::TAU;

/// A number whose logarithm is uniform between those of `least` and `most`.
pub fn log_uniform(rng: &mut impl Rng, least: f64, most: f64) -> f64 {
    rng.random_range(least.ln()..most.ln()).exp()
}

/// A number between two bounds.
pub fn rng_range(rng: &mut impl Rng, least: f64, most: f64) -> f64 {
    rng.random_range(least..most)
}

/// A phase between 0 and a full turn [rad].
pub fn phase(rng: &mut impl Rng) -> f64 {
    rng.random_range(0.0..TAU)
}

/// The vector w `(d,)` times a factor.
pub fn scaled(w: &[f64], factor: f64) -> Vec<f64> {
    w.iter().map(|w| factor * w).collect()
}

/// A unit vector `(d,)`.
pub fn direction(rng: &mut impl Rng, d: usize) -> Vec<f64> {
    let w: Vec<f64> = (0..d).map(|_| StandardNormal.sample(rng)).collect();
    scaled(&w, 1.0 / dot(&w, &w).sqrt())
}

/// `count` unit vectors `(d,)`; orthogonal up to the dimension, arbitrary beyond it.
pub fn directions(rng: &mut impl Rng, d: usize, count: usize) -> Vec<Vec<f64>> {
    let mut found: Vec<Vec<f64>> = Vec::with_capacity(count);
    while found.len() < count {
        let mut w = direction(rng, d);
        if found.len() < d {
            for before in &found {
                let along = dot(&w, before);
                w.iter_mut().zip(before).for_each(|(w, b)| *w -= along * b);
            }
            let length = dot(&w, &w).sqrt();
            w = scaled(&w, 1.0 / length);
        }
        found.push(w);
    }
    found
}

/// Normal variables of random means and standard deviations.
pub fn normals(rng: &mut impl Rng, d: usize) -> Vec<Distribution> {
    let mut one = || {
        let std = log_uniform(rng, 1e-3, 1e3);
        Distribution::normal(std * rng.random_range(-5.0..20.0), std)
            .expect("a standard deviation above zero")
    };
    (0..d).map(|_| one()).collect()
}

/// Normal variables in six of ten problems, else a mixture of distributions.
pub fn mixture(rng: &mut impl Rng, d: usize) -> Vec<Distribution> {
    if rng.random_bool(0.6) {
        return normals(rng, d);
    }
    let mut one = || {
        let (mean, cov) = (log_uniform(rng, 1e-3, 1e3), rng.random_range(0.05..0.4));
        let std = cov * mean;
        match rng.random_range(0..5) {
            0 => Distribution::normal(mean, std),
            1 => Distribution::lognormal(mean, std),
            2 => Distribution::uniform_by_moments(mean, std),
            3 => Distribution::gumbel(mean, std, Extreme::Maxima),
            _ => Distribution::weibull(mean, std),
        }
        .expect("a mean above zero and a moderate standard deviation")
    };
    (0..d).map(|_| one()).collect()
}
