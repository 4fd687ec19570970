//! One weighted population for many sets of parameters: its points, and R(n) and lives of every set.

use super::space::proposal;
use crate::analyses::update::Prior;
use crate::statistics::design::{InputModel, Stream, open_stream};
use crate::statistics::updating::{ConfidentReliability, CurveDraws, Reweighting, fitted_draws};
use crate::study::{LEVELS, LifeModel};
use common::random::Distribution;
use common::scene::{MeasuredVariable, Scene};
use rayon::prelude::*;

/// Sets of parameters, and points of the population.
const SETS: usize = 500;
const POINTS: usize = 20_000;
/// Sets of parameters whose weights are held at once.
const BLOCK: usize = 32;

/// The model whose changed variables have the distributions of their points.
pub fn model_of(model: LifeModel, indices: &[usize], proposals: &[Distribution]) -> LifeModel {
    let mut laws = model.inputs.variables().to_vec();
    for (k, law) in indices.iter().zip(proposals) {
        laws[*k] = law.clone();
    }
    let inputs = InputModel::new(laws, model.inputs.copula.clone());
    model.redistributed(inputs)
}

/// A population with its lives and its places in the tables of the weights.
pub struct WeightedPopulation<'a> {
    /// The points with their responses.
    pub prior: Prior<'a>,
    /// Weights under changed distributions.
    pub reweighting: Reweighting,
    /// The points as places in their tables.
    pub points: Vec<f64>,
    /// Life of each point by any limit state `(N,)` [cycles].
    pub lives: Vec<f64>,
}

impl<'a> WeightedPopulation<'a> {
    /// `count` points of the population of `model`, whose variables `indices` will be changed.
    pub fn new(model: &'a LifeModel, indices: &[usize], wanted: Vec<usize>, count: usize, seed: u64) -> Self {
        let laws: Vec<_> = indices.iter().map(|k| model.inputs.variables()[*k].clone()).collect();
        let prior = Prior::new(model, wanted, count, seed);
        let reweighting = Reweighting::new(indices.to_vec(), &laws);
        let points = reweighting.points(&prior.states, model.inputs.dimension() + model.deviations());
        let of_point = |lives: &[f64]| lives.iter().copied().fold(f64::INFINITY, f64::min);
        let lives = prior.responses.lives.chunks_exact(model.limit_states()).map(of_point).collect();
        Self { prior, reweighting, points, lives }
    }

    /// R at the checkpoints and the lives at the levels of a study under the sets of distributions `(weight, (K,))`. `of_set` receives
    /// index and weights `(N,)` of every set.
    pub fn curves(
        &self,
        scene: &Scene,
        sets: &[(f64, Vec<Distribution>)],
        mut of_set: impl FnMut(usize, &[f64]),
    ) -> CurveDraws {
        let cycles = scene.life.checkpoints().into_iter().map(f64::from).collect();
        let mut draws = CurveDraws::new(cycles, LEVELS.to_vec());
        let order = CurveDraws::order(&self.lives);
        for (block, sets) in sets.chunks(BLOCK).enumerate() {
            let weights: Vec<Vec<f64>> =
                sets.par_iter().map(|(_, laws)| self.reweighting.weights(laws, &self.points)).collect();
            for (place, ((weight, _), points)) in sets.iter().zip(&weights).enumerate() {
                draws.add(*weight, &self.lives, &order, points);
                of_set(block * BLOCK + place, points);
            }
        }
        draws
    }
}

/// The variables of a scene that measured samples gave.
///
/// # Errors
/// The names of those that are correlated, whose samples say nothing alone.
pub fn uncertain_fits<'m>(
    model: &LifeModel,
    measured: &'m [MeasuredVariable],
    scene: &Scene,
) -> Result<Vec<(usize, &'m MeasuredVariable)>, Vec<&'m str>> {
    let index = |name: &str| scene.variables.iter().position(|variable| variable.name == name);
    let all: Vec<_> = measured.iter().filter_map(|own| Some((index(&own.name)?, own))).collect();
    let correlated = all.iter().filter(|(k, _)| model.inputs.copula.is_correlated(*k));
    let correlated: Vec<&str> = correlated.map(|(_, own)| own.name.as_str()).collect();
    if correlated.is_empty() { Ok(all) } else { Err(correlated) }
}

/// R and lives of `scene` at a confidence in (0, 1), with what the samples of `fits` leave open; the responses are those of `model`.
pub fn fitted_reliability(
    scene: &Scene,
    model: LifeModel,
    fits: &[(usize, &MeasuredVariable)],
    confidence: f64,
    seed: u64,
) -> ConfidentReliability {
    let mut rng = open_stream(seed, Stream::Parameters(0));
    let drawn = fits.iter().map(|(_, m)| fitted_draws(m.family, &m.distribution, &m.samples, SETS, &mut rng));
    let draws: Vec<Vec<Distribution>> = drawn.collect();
    let moments = |law: &Distribution| (1.0, [law.parent_mean(), law.given_std()]);
    let proposed = |((_, m), draws): (&(usize, &MeasuredVariable), &Vec<Distribution>)| {
        proposal(&m.distribution, None, &draws.iter().map(moments).collect::<Vec<_>>())
    };
    let proposals: Vec<Distribution> = fits.iter().zip(&draws).map(proposed).collect();
    let indices: Vec<usize> = fits.iter().map(|(k, _)| *k).collect();
    let model = model_of(model, &indices, &proposals);
    let population = WeightedPopulation::new(&model, &indices, vec![], POINTS, seed);
    let sets: Vec<(f64, Vec<Distribution>)> =
        (0..SETS).map(|t| (1.0, draws.iter().map(|of_variable| of_variable[t].clone()).collect())).collect();
    population.curves(scene, &sets, |_, _| {}).at_confidence(confidence)
}
