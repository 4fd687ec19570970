//! Rare events: where failures are too few in any population that can be classified, the population is
//! replaced by samples conditional on an intermediate event, drawn on the surrogates.
//!
//! The event is the last level but one of a subset simulation. Its samples, and points along random directions from the
//! origin, show the regions of the event, and importance sampling over all of them gives its probability and the
//! population. Where that finds no sufficient mixture, as with many variables, the samples are those of a larger
//! subset simulation. The response of either is the largest over the limit states of
//!
//!   y = (mean - threshold) / sigma + 2 s,
//!
//! with the mean of the prediction (largest over the checkpoints), the process standard deviation sigma at
//! the end of life and the predicted standard deviation s in units of sigma. With the means alone a second
//! region of failures that no simulation has come near may be missing from every level, and learning would
//! stop without it; with the upper bound it stays among the samples until the surrogates know it.
//!
//! A share p of the conditional population stands for the probability P(level) p, because every failure has
//! passed the level. The level is drawn anew as the surrogates learn.
//!
//! # Source
//! Huang, Chen, Zhu (2016), Assessing small failure probabilities by AK-SS: an active learning method
//! combining Kriging and subset simulation, Structural Safety 59.

use super::surrogates::Surrogate;
use crate::statistics::design::Population;
use crate::statistics::learning::UNCERTAIN;
use crate::statistics::reliability::{Condition, ImportanceSampling, Responses, Subset, SubsetSimulation};
use faer::MatRef;
use rand::Rng;
use rand_distr::{Distribution, StandardNormal};
use rayon::prelude::*;

/// Most levels, for probabilities down to 1e-12.
const LEVELS: usize = 12;
/// Number of points predicted together.
const BLOCK: usize = 512;
/// Samples of a level of the subset simulation that looks for the event.
const SEARCH: usize = 20_000;
/// Random directions in which the event is looked for, and steps along each.
const DIRECTIONS: (usize, usize) = (512, 36);
/// Length of a step: the reliability index of a plane limit there, with the other variables as large as they usually
/// are.
const STEP: f64 = 0.25;
/// Coefficient of variation of an importance sampling above which subset simulation is tried [1].
const SUFFICIENT: f64 = 0.1;

/// Draws a population of the same variables conditional on the last intermediate event, with `samples` points
/// at each level, and returns it with that event.
pub(super) fn conditional_population(
    population: &Population,
    surrogates: &[Surrogate],
    samples: usize,
    rng: &mut impl Rng,
) -> (Population, Condition) {
    let (d, inputs) = (population.dimension(), &population.inputs);
    let standardised = |u: &[f64]| inputs.standardise(&inputs.from_independent_normals(u));
    let respond = |u: &[f64]| -> Vec<f64> {
        let block = |u: &[f64]| -> Vec<f64> {
            let z: Vec<f64> = u.chunks_exact(d).flat_map(standardised).collect();
            let points = MatRef::from_column_major_slice(&z, d, u.len() / d);
            let mut largest = vec![f64::NEG_INFINITY; u.len() / d];
            for surrogate in surrogates {
                let model = &surrogate.model;
                let prediction = model.predict(points);
                // In units of the spread at the end of life, so that limit states of any unit compete.
                let sigma = model.sigma2.last().map_or(1.0, |s| s.sqrt()).max(f64::MIN_POSITIVE);
                for (j, y) in largest.iter_mut().enumerate() {
                    let reached = prediction.mean.col(j).iter().copied().fold(f64::NEG_INFINITY, f64::max);
                    let std = prediction.variance_factor[j].sqrt();
                    *y = y.max((reached - surrogate.threshold.value) / sigma + UNCERTAIN * std);
                }
            }
            largest
        };
        u.par_chunks(BLOCK * d).flat_map_iter(block).collect()
    };
    let subset = conditional_samples(d, samples, rng, &respond);
    let z = subset.u.chunks_exact(d).flat_map(standardised).collect();
    let condition = Condition {
        probability: subset.probability,
        cov: subset.cov,
        gamma: subset.gamma,
        levels: subset.levels.len(),
    };
    (population.with_descendants(z, subset.origin), condition)
}

/// Samples in independent standard normals conditional on the last intermediate event.
fn conditional_samples(
    variables: usize,
    samples: usize,
    rng: &mut impl Rng,
    respond: &Responses<'_>,
) -> Subset {
    let search = SubsetSimulation { variables, samples: SEARCH, most_levels: LEVELS }.run(rng, respond);
    let sampled = search.levels.last().and_then(|last| {
        // Levels that do not come to the limit say nothing of a region elsewhere that does. Beyond a kink failures may
        // lie outside the last level where the surrogates are too sure, so the event is the level before.
        let before = search.levels.len().checked_sub(2).map_or(*last, |place| search.levels[place]);
        let level = if search.failed_share() > 0.0 { before } else { 0.0 };
        let known = [search.u.clone(), along_directions(variables, rng)].concat();
        let mut sampled = ImportanceSampling { variables, samples, level }.run(known, rng, respond)?;
        sampled.levels.clone_from(&search.levels);
        Some(sampled)
    });
    if let Some(sampled) = sampled.filter(|sampled| sampled.cov <= SUFFICIENT) {
        return sampled;
    }
    SubsetSimulation { variables, samples, most_levels: LEVELS }.run(rng, respond)
}

/// Points along random directions from the origin `(k, d)` row-major.
fn along_directions(variables: usize, rng: &mut impl Rng) -> Vec<f64> {
    let (directions, steps) = DIRECTIONS;
    let mut points = Vec::with_capacity(directions * steps * variables);
    for _ in 0..directions {
        let direction: Vec<f64> = (0..variables).map(|_| StandardNormal.sample(rng)).collect();
        let length = direction.iter().map(|u| u * u).sum::<f64>().sqrt().max(f64::MIN_POSITIVE);
        for step in 1..=steps {
            let index = STEP * step as f64;
            let radius = (index * index + variables as f64 - 1.0).sqrt();
            points.extend(direction.iter().map(|u| radius * u / length));
        }
    }
    points
}
