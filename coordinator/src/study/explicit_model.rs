//! What a study has learned, as plain numbers from which another program predicts failures: the means of the running maxima of every
//! limit state over life, and how uncertain they are.

use super::life_model::{History, ModeModel};
use super::{CampaignResult, LifeModel, Surrogate};
use crate::statistics::learning::Classification;
use crate::statistics::surrogate::ExplicitMean;
use common::scene::Scene;
use serde::{Deserialize, Serialize};

/// Most weights of all limit states: about 800 kB as text.
const MOST_WEIGHTS: usize = 40_000;

/// Points of the population by which the variance is described.
const POINTS: usize = 2000;

/// Limit states by plain numbers.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ExplicitModel {
    /// Smallest and largest simulated value of each random variable `(d,)` [SI].
    pub simulated: Vec<(f64, f64)>,
    /// Limit states in the order of the scene.
    pub limit_states: Vec<ExplicitLimitState>,
}

/// One limit state by plain numbers: it fails when a response reaches the threshold.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ExplicitLimitState {
    /// Times of the responses, increasing; 0 for the start of life `(m,)` [cycles].
    pub times: Vec<f64>,
    /// Responses at these times: `m` of them, or `2 m` of two sides, the first side first.
    pub mean: ExplicitMean,
    /// Predicted standard deviations where the variance factor is 1 `(m,)` [unit of the output].
    pub std: Vec<f64>,
    /// Variance factor over the squared norm of the scaled point [1]: the proportion of least squares over the population.
    pub variance: f64,
    /// Threshold of the response [unit of the output].
    pub threshold: f64,
    /// True if the output has so few values that another threshold would need another fit.
    pub is_coarse: bool,
}

impl ExplicitModel {
    /// The limit states of a campaign, of many simulations at fewer times.
    pub(super) fn new(scene: &Scene, learned: &CampaignResult) -> Self {
        let model = LifeModel::new(scene, learned);
        let weights = |h: &History| h.model.points() * h.model.sides() * h.scale.len();
        let step = 1 + model.modes.iter().map(|mode| weights(&mode.history)).sum::<usize>() / MOST_WEIGHTS;
        let population = &learned.classified.population;
        let points = population.columns(0..population.len().min(POINTS));
        let modes = model.modes.iter().zip(&learned.assessment.modes).zip(&learned.assessment.surrogates);
        let limit_state = |((mode, classified), surrogate): ((&ModeModel, &Classification), &Surrogate)| {
            let history = &mode.history;
            let all = history.scale.len();
            // The end of life is among them.
            let kept = || (0..all).filter(move |n| (all - 1 - n).is_multiple_of(step));
            let mut times = model.times.clone();
            times.splice(0..0, history.has_start.then_some(0.0));
            let outputs: Vec<usize> =
                (0..history.model.sides()).flat_map(|side| kept().map(move |n| side * all + n)).collect();
            let mean = history.model.explicit_mean(&outputs);
            let norm = |point: faer::ColRef<'_, f64>| -> f64 {
                point.iter().zip(&mean.factors).map(|(z, factor)| (z * factor).powi(2)).sum()
            };
            let norms: Vec<f64> = points.col_iter().map(norm).collect();
            let products = norms.iter().zip(&classified.variance_factor).map(|(norm, factor)| norm * factor);
            let squares = norms.iter().map(|norm| norm * norm).sum::<f64>();
            ExplicitLimitState {
                times: kept().map(|n| times[n]).collect(),
                std: kept().map(|n| history.scale[n]).collect(),
                variance: products.sum::<f64>() / squares.max(f64::MIN_POSITIVE),
                mean,
                threshold: mode.threshold,
                is_coarse: surrogate.threshold.jump > 0.0,
            }
        };
        Self {
            simulated: (0..scene.variables.len()).map(|k| model.simulated_range(k)).collect(),
            limit_states: modes.map(limit_state).collect(),
        }
    }
}
