//! One weighted population for many sets of parameters: its points, and R(n) and lives of every set.

use super::space::proposal;
use crate::analyses::update::Prior;
use crate::statistics::design::{InputModel, Stream, open_stream};
use crate::statistics::updating::{
    ConfidentLimitState, ConfidentReliability, CurveDraws, Reweighting, fitted_draws,
};
use crate::study::{LEVELS, LifeModel};
use common::random::{Correlation, Distribution, GaussianCopula};
use common::scene::{LimitState, MeasuredVariable, Scene};
use rayon::prelude::*;

/// Sets of parameters, and points of the population.
const SETS: usize = 500;
const POINTS: usize = 20_000;
/// Sets of parameters whose weights are held at once.
const BLOCK: usize = 32;

/// The model whose changed variables have the distributions of their points, independent of each other; no variable of `scene` beside
/// them is correlated with one.
pub fn model_of(model: LifeModel, scene: &Scene, indices: &[usize], proposals: &[Distribution]) -> LifeModel {
    let is_kept = |c: &&Correlation| !indices.contains(&c.first) && !indices.contains(&c.second);
    let kept: Vec<Correlation> = scene.correlations.iter().filter(is_kept).copied().collect();
    let mut laws = model.inputs.variables().to_vec();
    for (k, law) in indices.iter().zip(proposals) {
        laws[*k] = law.clone();
    }
    let copula = GaussianCopula::new(laws.len(), &kept).expect("a part of correlations that exist");
    model.redistributed(InputModel::new(laws, copula))
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

    /// R at the checkpoints and the lives at the levels of a study under the sets of distributions `(weight, K variables)`. `of_set` receives
    /// index and weights `(N,)` of every set.
    pub fn curves(
        &self,
        scene: &Scene,
        sets: &[(f64, InputModel)],
        mut of_set: impl FnMut(usize, &[f64]),
    ) -> PopulationCurves {
        let cycles: Vec<f64> = scene.life.checkpoints().into_iter().map(f64::from).collect();
        let states = self.prior.model.limit_states();
        let own = |s: usize| self.prior.responses.lives.iter().skip(s).step_by(states).copied();
        let first = |s: usize| {
            own(s).zip(&self.lives).map(|(own, life)| if own <= *life { own } else { f64::INFINITY })
        };
        let by_state = |s: usize| [own(s).collect(), first(s).collect()];
        let by = if states > 1 { 0..states } else { 0..0 };
        let lives = std::iter::once(self.lives.clone()).chain(by.flat_map(by_state));
        let ordered: Vec<_> = lives.map(|lives: Vec<f64>| (CurveDraws::order(&lives), lives)).collect();
        let mut draws = vec![CurveDraws::new(cycles, LEVELS.to_vec()); ordered.len()];
        for (block, sets) in sets.chunks(BLOCK).enumerate() {
            let weights: Vec<Vec<f64>> =
                sets.par_iter().map(|(_, laws)| self.reweighting.weights(laws, &self.points)).collect();
            draws.par_iter_mut().zip(&ordered).for_each(|(draws, (order, lives))| {
                let sets = sets.iter().zip(&weights);
                sets.for_each(|((weight, _), points)| draws.add(*weight, lives, order, points));
            });
            weights.iter().enumerate().for_each(|(place, points)| of_set(block * BLOCK + place, points));
        }
        PopulationCurves(draws)
    }
}

/// Curves of many sets of parameters: by any limit state, then of each, where there are several, those by it alone and of the units that
/// have not failed first by it.
pub struct PopulationCurves(Vec<CurveDraws>);

impl PopulationCurves {
    /// Those by any limit state.
    pub fn total(&self) -> &CurveDraws {
        &self.0[0]
    }

    /// The bounds at a confidence C in (0, 1).
    pub fn at_confidence(&self, scene: &Scene, confidence: f64) -> ConfidentReliability {
        let of = |(limit, draws): (&LimitState, &[CurveDraws])| {
            let ConfidentReliability { reliability, lives, .. } = draws[0].at_confidence(confidence);
            let (limit_state, first_failures) = (limit.name.clone(), draws[1].failed(confidence));
            ConfidentLimitState { limit_state, reliability, lives, first_failures }
        };
        let limit_states = scene.limit_states.iter().zip(self.0[1..].chunks_exact(2)).map(of).collect();
        ConfidentReliability { limit_states, ..self.total().at_confidence(confidence) }
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
    let model = model_of(model, scene, &indices, &proposals);
    let population = WeightedPopulation::new(&model, &indices, vec![], POINTS, seed);
    let set = |t: usize| draws.iter().map(|of_variable| of_variable[t].clone()).collect::<Vec<_>>();
    let sets: Vec<(f64, InputModel)> = (0..SETS).map(|t| (1.0, InputModel::from(&set(t)))).collect();
    population.curves(scene, &sets, |_, _| {}).at_confidence(scene, confidence)
}
