//! Lives and responses over life of single points by the surrogates of a campaign.
//!
//! The response of a point is its predicted mean plus its deviation, a standard normal number of its own for every limit
//! state, times the predicted standard deviation, as in the classification: the deviation lasts for life. An output that a
//! limit state watches has the deviation of that limit state, away from the middle of two thresholds on the side where it ends; any
//! other output has one of its own, and the correlation lengths of the first limit state. Lives come from the running maxima, as those of the study; an output is predicted itself.
//!
//! What a study has learned, as plain numbers from which another program predicts failures: the means of the running maxima of every
//! limit state over life, and how uncertain they are.
//!
//! # Source
//! Straub, Papaioannou (2015), Bayesian updating with structural reliability methods, Journal of Engineering Mechanics
//! 141(3), for likelihoods by a surrogate; the persistent deviation is this project's own, see `deviation.rs`.

use super::plan::ResponseLayout;
use super::{CampaignResult, Observations, Surrogate};
use crate::statistics::design::InputModel;
use crate::statistics::learning::{Classification, Mode};
use crate::statistics::reliability::{ErrorLine, PredictedHistory};
use crate::statistics::surrogate::{ExplicitMean, ResponseScale};
use common::scene::{Fails, LimitState, Scene};
use faer::{Mat, MatRef};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

/// Number of points predicted together.
const BLOCK: usize = 512;

/// Predictor of lives and responses of single points.
#[derive(Debug)]
pub struct LifeModel {
    /// The random variables.
    pub inputs: InputModel,
    /// Smallest and largest simulated value of each random variable, standardised `(d,)` [1].
    simulated: Vec<(f64, f64)>,
    /// Checkpoints `(m,)` [cycles].
    times: Vec<f64>,
    /// The running maxima of the responses of the limit states, with their thresholds [unit of the output].
    modes: Vec<(PredictedHistory, f64)>,
    outputs: Vec<OutputModel>,
}

/// One output of the scene.
#[derive(Debug)]
struct OutputModel {
    history: PredictedHistory,
    /// Limit state whose prediction has the same correlation, and index of its deviation.
    mode: usize,
    deviation: usize,
    /// Limit state that watches the output.
    limit: Option<LimitState>,
    /// Stated error over the value at each checkpoint `(m,)`.
    errors: Vec<ErrorLine>,
    /// Standard deviation of the simulations' noise at each checkpoint `(m,)` [unit of the output, or 1 of logarithms].
    noise: Vec<f64>,
}

/// The history with values `(n, m)` at the checkpoints and, where they are known, at the start of life, by the form of a surrogate.
fn with_values(
    surrogate: &Surrogate,
    values: &Mat<f64>,
    start: Option<Vec<f64>>,
    by: f64,
) -> PredictedHistory {
    let (mut model, learned) = (surrogate.model.clone(), surrogate.scale_of(values));
    let is_learned = |start: &Vec<f64>| start.iter().all(|y| learned.learned(*y).is_finite());
    let common = start.as_ref().and_then(|start| start.iter().all(|y| *y == start[0]).then_some(start[0]));
    let start = start.filter(is_learned);
    let shift = usize::from(start.is_some());
    let value = |i: usize, n: usize| match &start {
        Some(start) if n == 0 => learned.learned(start[i]),
        _ => learned.learned(values[(i, n - shift)]),
    };
    model.set_values(Mat::from_fn(values.nrows(), values.ncols() + shift, value).as_ref());
    PredictedHistory { learned, start: common, ..PredictedHistory::new(model, start.is_some(), by) }
}

/// The running maximum of the response of a limit state, from the start of life where that is known. Without it the model is the one
/// fitted, or, with `anew`, that form conditioned on all values at once.
pub(super) fn history_of_mode(
    surrogate: &Surrogate,
    observations: &Observations,
    output: usize,
    anew: bool,
) -> PredictedHistory {
    let inflation = surrogate.inflation();
    let mut model = surrogate.model.clone();
    if let Some(sides) = observations.sides(output) {
        let with_start = sides.with_start();
        if let Some(values) = with_start.as_ref().or(anew.then_some(&sides.values)) {
            model.set_sides(values.as_ref());
        }
        return PredictedHistory::new(model, with_start.is_some(), inflation);
    }
    let start = observations.starts(output);
    if start.is_none() && !anew {
        return PredictedHistory {
            learned: surrogate.scale,
            ..PredictedHistory::new(model, false, inflation)
        };
    }
    with_values(surrogate, &observations.running_maxima(output), start, inflation)
}

/// Lives and responses at b points.
#[derive(Debug, Clone, Default)]
pub struct LifeResponses {
    /// Lives by each limit state, infinite beyond the last checkpoint `(b, limit states)` row-major [cycles].
    pub lives: Vec<f64>,
    /// Histories of the outputs asked for `(outputs)(b, values)` row-major [unit of the output].
    pub histories: Vec<Vec<f64>>,
}

impl LifeModel {
    /// The predictor by the surrogates of a campaign on `scene`.
    pub fn new(scene: &Scene, learned: &CampaignResult) -> Self {
        let surrogates = &learned.assessment.surrogates;
        let layout = ResponseLayout::from_scene(scene);
        let mode = |(s, (mode, surrogate)): (usize, (&Mode, &Surrogate))| {
            let observations = learned.observations.design_of(s);
            let history = history_of_mode(surrogate, &observations, mode.output, true);
            (history, surrogate.scale.value(surrogate.threshold.value))
        };
        let modes: Vec<_> = layout.modes.iter().zip(surrogates).enumerate().map(mode).collect();
        let mut deviations = modes.len();
        let mut output = |output: usize| {
            let watching = scene.limit_states.iter().position(|limit| limit.output == output);
            let mode = watching.unwrap_or(0);
            let deviation = watching.unwrap_or(deviations);
            deviations += usize::from(watching.is_none());
            let observations = learned.observations.design_of(mode);
            let (values, surrogate) = (observations.values(output), &surrogates[mode]);
            let inflation = match watching {
                Some(_) => surrogate.inflation(),
                None => own_inflation(surrogate, &values),
            };
            let history = with_values(surrogate, &values, observations.starts(output), inflation);
            let noise = history.model.correlation.noise();
            let first = usize::from(history.has_start);
            OutputModel {
                mode,
                deviation,
                limit: watching.map(|s| scene.limit_states[s].clone()),
                errors: ErrorLine::by_checkpoint(values.as_ref(), observations.errors(output).as_ref()),
                noise: history.model.sigma2[first..].iter().map(|s| (s * noise).sqrt()).collect(),
                history,
            }
        };
        let outputs = (0..scene.outputs.len()).map(&mut output).collect();
        let times = scene.life.checkpoints().into_iter().map(f64::from).collect();
        let inputs = learned.classified.population.inputs.clone();
        Self { inputs, simulated: learned.observations.ranges(), times, modes, outputs }
    }

    /// The predictor for random variables with other distributions, in the same coordinates.
    #[must_use]
    pub fn redistributed(self, inputs: InputModel) -> Self {
        Self { inputs: inputs.standardised_as(&self.inputs), ..self }
    }

    /// Smallest and largest simulated value of random variable `k`, within the bounds of its distribution [SI].
    pub fn simulated_range(&self, k: usize) -> (f64, f64) {
        let (low, high) = self.simulated[k];
        (self.inputs.physical_value(k, low), self.inputs.physical_value(k, high))
    }

    /// Number of limit states.
    pub fn limit_states(&self) -> usize {
        self.modes.len()
    }

    /// Number of deviations of a point.
    pub fn deviations(&self) -> usize {
        self.modes.len() + self.outputs.iter().filter(|output| output.deviation >= self.modes.len()).count()
    }

    /// Earliest life at which an output is known [cycles].
    pub fn beginning(&self, output: usize) -> f64 {
        let history = &self.outputs[output].history;
        if history.has_start || history.start.is_some() { 0.0 } else { self.times[0] }
    }

    /// Last checkpoint [cycles].
    pub fn end(&self) -> f64 {
        self.times[self.times.len() - 1]
    }

    /// Lives, and histories of `wanted` outputs, at standardised points `(d, b)` with `deviations` `(b, deviations)`
    /// row-major [1].
    pub fn respond(&self, points: MatRef<'_, f64>, deviations: &[f64], wanted: &[usize]) -> LifeResponses {
        let width = self.deviations();
        let of_block = |start: usize| {
            let count = BLOCK.min(points.ncols() - start);
            let own = &deviations[start * width..(start + count) * width];
            self.respond_block(points.subcols(start, count), own, wanted)
        };
        let blocks = (0..points.ncols()).into_par_iter().step_by(BLOCK);
        let parts: Vec<LifeResponses> = blocks.map(of_block).collect();
        let mut all = LifeResponses { lives: vec![], histories: wanted.iter().map(|_| vec![]).collect() };
        for part in parts {
            all.lives.extend(part.lives);
            all.histories.iter_mut().zip(part.histories).for_each(|(all, part)| all.extend(part));
        }
        all
    }

    fn respond_block(&self, points: MatRef<'_, f64>, deviations: &[f64], wanted: &[usize]) -> LifeResponses {
        let (b, width) = (points.ncols(), self.deviations());
        let predictions: Vec<_> =
            self.modes.iter().map(|(history, _)| history.model.predict(points)).collect();
        let std = |mode: usize, j: usize| predictions[mode].variance_factor[j].max(0.0).sqrt();
        let mut values = Vec::new();
        let mut lives = Vec::with_capacity(b * self.modes.len());
        for j in 0..b {
            for (s, (history, threshold)) in self.modes.iter().enumerate() {
                let in_sigma = std(s, j) * deviations[j * width + s];
                let means = predictions[s].mean.col_as_slice(j);
                let reached = history.reached(means, in_sigma, *threshold, &mut values);
                lives.push(reached.map_or(f64::INFINITY, |k| self.life(history, *threshold, &values, k)));
            }
        }
        let history = |output: &usize| {
            let OutputModel { history, mode, deviation, limit, .. } = &self.outputs[*output];
            let means = history.model.predict_means(points, &history.dual, 0..history.scale.len());
            let mut all = Vec::with_capacity(b * history.scale.len());
            for j in 0..b {
                let column = means.col_as_slice(j);
                let sign = limit.as_ref().map_or(1.0, |limit| sign_of_deviation(limit, column));
                let in_sigma = sign * std(*mode, j) * deviations[j * width + deviation];
                all.extend(history.values(column, in_sigma));
            }
            all
        };
        LifeResponses { lives, histories: wanted.iter().map(history).collect() }
    }

    /// Life of a running maximum that reaches its threshold by checkpoint `k` [cycles].
    fn life(&self, history: &PredictedHistory, threshold: f64, values: &[f64], k: usize) -> f64 {
        let before = if k == 0 { 0.0 } else { self.times[k - 1] };
        let share = history.track(&self.times, values).crossing(k, threshold).best;
        before + share * (self.times[k] - before)
    }

    /// Value of `output` of point `j` at a life between [`LifeModel::beginning`] and [`LifeModel::end`], from its histories
    /// `(b, values)` [unit of the output]; not a number outside.
    pub fn value_at(&self, output: usize, histories: &[f64], j: usize, life: f64) -> f64 {
        let history = &self.outputs[output].history;
        let own = &histories[j * history.scale.len()..(j + 1) * history.scale.len()];
        history.track(&self.times, own).value_at(life).unwrap_or(f64::NAN)
    }

    /// Standard deviation of the error of a value at a life, besides that of the surrogate: the stated numerical error of the
    /// simulations (if `numerical`) or their noise, whichever is larger, at the nearer checkpoint [unit of the output].
    pub fn error_at(&self, output: usize, value: f64, life: f64, numerical: bool) -> f64 {
        let OutputModel { errors, noise, history, .. } = &self.outputs[output];
        let distance = |n: &usize| (self.times[*n] - life).abs();
        let nearest = (0..self.times.len()).min_by(|a, b| distance(a).total_cmp(&distance(b)));
        let stated = |n: usize| if numerical { errors[n].evaluate(value) } else { 0.0 };
        nearest.map_or(0.0, |n| stated(n).max(history.learned.slope(value) * noise[n]))
    }
}

/// Sign of an output's deviation where its response, see [`LimitState::response`], has a positive one; `means` is its history.
fn sign_of_deviation(limit: &LimitState, means: &[f64]) -> f64 {
    let end = means.last().copied().unwrap_or(0.0);
    match (limit.fails, limit.middle()) {
        (Fails::Below, _) => -1.0,
        (_, Some(middle)) if end < middle => -1.0,
        _ => 1.0,
    }
}

/// Factor on the predicted variances of an output with the correlation of another one, from leave-one-out errors [1].
fn own_inflation(surrogate: &Surrogate, values: &Mat<f64>) -> f64 {
    let mut model = surrogate.model.clone();
    let values = surrogate.scale_of(values).learned_values(values);
    model.set_values(values.as_ref());
    let all = model.leave_one_out(values.as_ref());
    let mean = all.iter().map(|l| l.variance_ratio).sum::<f64>() / all.len().max(1) as f64;
    if mean.is_finite() { mean.max(1.0) } else { 1.0 }
}

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
    /// Responses at these times, or their logarithms: `m` of them, or `2 m` of two sides, the first side first.
    pub mean: ExplicitMean,
    /// Predicted standard deviations where the variance factor is 1 `(m,)` [unit of the output, or 1 of logarithms].
    pub std: Vec<f64>,
    /// Variance factor over the squared norm of the scaled point [1]: the proportion of least squares over the population.
    pub variance: f64,
    /// Threshold of the response [unit of the output].
    pub threshold: f64,
    /// True if the output has so few values that another threshold would need another fit.
    pub is_coarse: bool,
    /// True if `mean` and `std` are those of the logarithms of the response.
    #[serde(default)]
    pub logarithms: bool,
    /// Response at the start of life, if it is that of all points [unit of the output].
    #[serde(default)]
    pub start: Option<f64>,
}

impl ExplicitModel {
    /// The limit states of a campaign, of many simulations at fewer times.
    pub(super) fn new(scene: &Scene, learned: &CampaignResult) -> Self {
        let model = LifeModel::new(scene, learned);
        let weights = |h: &PredictedHistory| h.model.points() * h.model.sides() * h.scale.len();
        let step = 1 + model.modes.iter().map(|(history, _)| weights(history)).sum::<usize>() / MOST_WEIGHTS;
        let population = &learned.classified.population;
        let points = population.columns(0..population.len().min(POINTS));
        let modes = model.modes.iter().zip(&learned.assessment.modes).zip(&learned.assessment.surrogates);
        let limit_state =
            |((mode, classified), surrogate): ((&(PredictedHistory, f64), &Classification), &Surrogate)| {
                let (history, threshold) = mode;
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
                let products =
                    norms.iter().zip(&classified.variance_factor).map(|(norm, factor)| norm * factor);
                let squares = norms.iter().map(|norm| norm * norm).sum::<f64>();
                ExplicitLimitState {
                    times: kept().map(|n| times[n]).collect(),
                    std: kept().map(|n| history.scale[n]).collect(),
                    variance: products.sum::<f64>() / squares.max(f64::MIN_POSITIVE),
                    mean,
                    threshold: *threshold,
                    is_coarse: surrogate.threshold.jump > 0.0,
                    logarithms: history.learned == ResponseScale::Logarithms,
                    start: history.start,
                }
            };
        Self {
            simulated: (0..scene.variables.len()).map(|k| model.simulated_range(k)).collect(),
            limit_states: modes.map(limit_state).collect(),
        }
    }
}
