//! R at a confidence where distributions were fitted to few samples: the parameters that the samples leave possible, through to R.

use super::population::{WeightedPopulation, model_of};
use super::space::proposal;
use crate::statistics::design::{Stream, open_stream};
use crate::statistics::updating::{ConfidentReliability, fitted_draws};
use crate::study::LifeModel;
use common::random::Distribution;
use common::scene::{MeasuredVariable, Scene};

/// Sets of parameters, and points of the population.
const SETS: usize = 500;
const POINTS: usize = 20_000;

/// The variables of a scene that measured samples gave, without those that are correlated, whose samples say nothing alone.
pub fn uncertain_fits<'m>(
    model: &LifeModel,
    measured: &'m [MeasuredVariable],
    scene: &Scene,
) -> Vec<(usize, &'m MeasuredVariable)> {
    let index =
        |own: &MeasuredVariable| scene.variables.iter().position(|variable| variable.name == own.name);
    let all = measured.iter().filter_map(|own| Some((index(own)?, own)));
    all.filter(|(k, _)| !model.inputs().copula().is_correlated(*k)).collect()
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
    let draws: Vec<Vec<Distribution>> = fits
        .iter()
        .map(|(_, m)| fitted_draws(m.family, &m.distribution, &m.samples, SETS, &mut rng))
        .collect();
    let moments = |law: &Distribution| (1.0, [law.parent_mean(), law.given_std()]);
    let proposals: Vec<Distribution> = fits
        .iter()
        .zip(&draws)
        .map(|((_, m), draws)| {
            proposal(&m.distribution, None, &draws.iter().map(moments).collect::<Vec<_>>())
        })
        .collect();
    let indices: Vec<usize> = fits.iter().map(|(k, _)| *k).collect();
    let model = model_of(model, &indices, &proposals);
    let population = WeightedPopulation::new(&model, &indices, vec![], POINTS, seed);
    let sets: Vec<(f64, Vec<Distribution>)> =
        (0..SETS).map(|t| (1.0, draws.iter().map(|of_variable| of_variable[t].clone()).collect())).collect();
    population.curves(scene, &sets, |_, _| {}).at_confidence(confidence)
}
