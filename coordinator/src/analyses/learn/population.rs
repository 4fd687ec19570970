//! One weighted population for many sets of parameters: its points, and R(n) and lives of every set.

use crate::analyses::update::Prior;
use crate::statistics::design::InputModel;
use crate::statistics::updating::{CurveDraws, PointPlaces, Reweighting};
use crate::study::{LEVELS, LifeModel};
use common::random::Distribution;
use common::scene::Scene;
use rayon::prelude::*;

/// Sets of parameters whose weights are held at once.
const BLOCK: usize = 32;

/// The model whose changed variables have the distributions of their points.
pub fn model_of(model: LifeModel, indices: &[usize], proposals: &[Distribution]) -> LifeModel {
    let mut laws = model.inputs().variables().to_vec();
    for (k, law) in indices.iter().zip(proposals) {
        laws[*k] = law.clone();
    }
    let inputs = InputModel::new(laws, model.inputs().copula().clone());
    model.redistributed(inputs)
}

/// A population with its lives and its places in the tables of the weights.
pub struct WeightedPopulation<'a> {
    /// The points with their responses.
    pub prior: Prior<'a>,
    /// Weights under changed distributions.
    pub reweighting: Reweighting,
    /// The points as places in their tables.
    pub points: PointPlaces,
    /// Life of each point by any limit state `(N,)` [cycles].
    pub lives: Vec<f64>,
}

impl<'a> WeightedPopulation<'a> {
    /// `count` points of the population of `model`, whose variables `indices` will be changed.
    pub fn new(model: &'a LifeModel, indices: &[usize], wanted: Vec<usize>, count: usize, seed: u64) -> Self {
        let laws: Vec<Distribution> =
            indices.iter().map(|k| model.inputs().variables()[*k].clone()).collect();
        let prior = Prior::new(model, wanted, count, seed);
        let reweighting = Reweighting::new(indices.to_vec(), &laws);
        let points = reweighting.points(&prior.states, model.inputs().dimension() + model.deviations());
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
