//! Rare events: where failures are too few in any population that can be classified, the population is replaced by
//! samples conditional on an intermediate event, drawn by subset simulation on the surrogates.
//!
//! The levels are of what may be: mean + 2 standard deviations of the prediction. By the means alone a second region of
//! failures that no simulation has come near may be left out of every level, and the stop be false; with the bound it stays among
//! the samples until it is known.
//!
//! Everything a campaign does with a population it then does with this one; a share p of it stands for the probability
//! P(level) p, since whoever fails has passed the level. As the surrogates learn, the level is drawn anew.
//!
//! Source: subset simulation on a surrogate, Huang, Chen, Zhu (2016), AK-SS.

use super::plan::Problem;
use super::surrogates::Surrogate;
use crate::statistics::design::{Population, Stream, open_stream};
use crate::statistics::learning::UNCERTAIN;
use crate::statistics::reliability::{Condition, subset_simulation};
use faer::MatRef;
use rayon::prelude::*;

/// Samples of a level: a probability of 1e-9 is then known to about 6 %.
const SAMPLES: usize = 100_000;
/// Most levels: down to 1e-12.
const LEVELS: usize = 12;
/// Points predicted together.
const BLOCK: usize = 512;

/// A population of the same variables conditional on the last intermediate event, and what that is.
pub(super) fn conditional_population(
    problem: &Problem,
    population: &Population,
    surrogates: &[Surrogate],
    (seed, draw): (u64, u32),
) -> (Population, Condition) {
    let (d, inputs) = (population.dimension(), population.inputs());
    let standardised = |u: &[f64]| inputs.standardise(&inputs.from_independent_normals(u));
    let respond = |u: &[f64]| -> Vec<f64> {
        let block = |u: &[f64]| -> Vec<f64> {
            let z: Vec<f64> = u.chunks_exact(d).flat_map(standardised).collect();
            let points = MatRef::from_column_major_slice(&z, d, u.len() / d);
            let mut largest = vec![f64::NEG_INFINITY; u.len() / d];
            for (surrogate, mode) in surrogates.iter().zip(&problem.modes) {
                let model = &surrogate.model;
                let prediction = model.predict(points);
                // In units of the spread at the end of life, so that limit states of any unit compete.
                let sigma = model.sigma2().last().map_or(1.0, |s| s.sqrt()).max(f64::MIN_POSITIVE);
                for (j, y) in largest.iter_mut().enumerate() {
                    let reached = prediction.mean.col(j).iter().copied().fold(f64::NEG_INFINITY, f64::max);
                    let doubt = prediction.variance_factor[j].sqrt();
                    *y = y.max((reached - mode.threshold) / sigma + UNCERTAIN * doubt);
                }
            }
            largest
        };
        u.par_chunks(BLOCK * d).flat_map_iter(block).collect()
    };
    let mut rng = open_stream(seed, Stream::Subset(draw));
    let subset = subset_simulation((d, SAMPLES, LEVELS), &mut rng, &respond);
    let z = subset.u.chunks_exact(d).flat_map(standardised).collect();
    let condition = Condition {
        probability: subset.probability,
        cov: subset.cov,
        gamma: subset.gamma,
        levels: subset.levels.len(),
    };
    (population.with_points(z), condition)
}
