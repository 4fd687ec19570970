//! What a study has learned, as plain numbers from which another program predicts failures: the means of the running maxima of every
//! limit state over life, and how uncertain they are.

use super::life_model::History;
use super::{CampaignResult, LifeModel};
use crate::statistics::surrogate::ExplicitMean;
use common::scene::Scene;
use serde::{Deserialize, Serialize};

/// Most weights of all limit states: about 800 kB as text.
const MOST_WEIGHTS: usize = 40_000;

/// Least number of times at which a response is predicted.
const LEAST_TIMES: usize = 8;

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
    /// Variance factor [1] as a line over the squared norm of the scaled point: its value at 0, and its slope.
    pub variance: (f64, f64),
    /// Threshold of the response [unit of the output].
    pub threshold: f64,
    /// True if the output has so few values that another threshold would need another fit.
    pub is_coarse: bool,
}

impl ExplicitModel {
    /// The limit states of a campaign; `None` if its simulations are too many for a short text.
    pub(super) fn new(scene: &Scene, learned: &CampaignResult) -> Option<Self> {
        let model = LifeModel::new(scene, learned);
        let weights = |history: &History| history.model.points() * history.model.sides();
        let rows: usize = model.modes.iter().map(|mode| weights(&mode.history)).sum();
        let most = (MOST_WEIGHTS / rows.max(1)).min(model.times.len() + 1);
        let population = &learned.classified.population;
        let points = population.columns(0..population.len().min(POINTS));
        let modes = model.modes.iter().zip(&learned.assessment.modes).zip(&learned.assessment.surrogates);
        let limit_states = modes.map(|((mode, classified), surrogate)| {
            let history = &mode.history;
            let (all, sides) = (history.scale.len(), history.model.sides());
            let kept = most.min(all);
            let chosen: Vec<usize> = (0..kept).map(|k| k * (all - 1) / (kept - 1).max(1)).collect();
            let outputs: Vec<usize> =
                (0..sides).flat_map(|side| chosen.iter().map(move |n| side * all + n)).collect();
            let time = |n: &usize| match n.checked_sub(usize::from(history.has_start)) {
                Some(n) => model.times[n],
                None => 0.0,
            };
            let mean = history.model.explicit_mean(&outputs);
            let norm = |point: faer::ColRef<'_, f64>| -> f64 {
                point.iter().zip(&mean.factors).map(|(z, factor)| (z * factor).powi(2)).sum()
            };
            let norms: Vec<f64> = points.col_iter().map(norm).collect();
            ExplicitLimitState {
                times: chosen.iter().map(time).collect(),
                std: chosen.iter().map(|n| history.scale[*n]).collect(),
                variance: line(&norms, &classified.variance_factor),
                mean,
                threshold: mode.threshold,
                is_coarse: surrogate.threshold.jump > 0.0,
            }
        });
        let simulated = (0..scene.variables.len()).map(|k| model.simulated_range(k)).collect();
        (most >= LEAST_TIMES.min(model.times.len()))
            .then(|| Self { simulated, limit_states: limit_states.collect() })
    }
}

/// The line of least squares of y `(n,)` over x `(n,)`: its value at 0, and its slope.
fn line(x: &[f64], y: &[f64]) -> (f64, f64) {
    let n = x.len().max(1) as f64;
    let pairs = || x.iter().zip(y);
    let (mx, my) = (x.iter().sum::<f64>() / n, pairs().map(|(_, y)| y).sum::<f64>() / n);
    let squares: f64 = x.iter().map(|x| (x - mx).powi(2)).sum();
    let products: f64 = pairs().map(|(x, y)| (x - mx) * (y - my)).sum();
    let slope = if squares > 0.0 { products / squares } else { 0.0 };
    (my - slope * mx, slope)
}
