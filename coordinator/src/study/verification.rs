//! Validation of surrogates against simulations that they were not fitted to, point by point.
//!
//! The surrogates of a study are those it ended with: its learning is repeated from the stored outcomes, so that forms,
//! lengths and the results they were fitted to are the same to the last bit. An exploring result that confirmed the
//! surrogates is in none of them.
//!
//! A study estimates R(n) over its population, direct Monte Carlo over other samples. The difference of the two
//! estimates is mostly sampling error: 5000 samples leave a standard error of 0.007 where R = 1/2. Here the surrogates
//! classify the very points that were simulated, so that the sampling error cancels and the error of the surrogates
//! remains. With N points and the indicator 1(.), both [1]:
//!
//!   D_j = 1(simulated not failed) - 1(predicted not failed),   difference = mean D_j,   standard error = sqrt(Var D_j / N).
//!
//! # Source
//! The standard error of paired differences is that of common random numbers: Glasserman (2003), Monte Carlo Methods in
//! Financial Engineering, Springer.

use super::observations::{Observations, Observed, ObservedOutcome};
use super::plan::ResponseLayout;
use super::result::curve_names;
use super::surrogates::{FitOptions, Surrogate, fit_surrogates};
use super::{Campaign, CampaignError, Method, Plan, Problem, SampleRequest, Settings};
use crate::statistics::design::InputModel;
use crate::statistics::learning::{Mode, with_system};
use crate::statistics::surrogate::Effort;
use common::scene::Scene;
use faer::Mat;
use serde::Serialize;

/// Sample and simulated outputs of one point.
#[derive(Debug, Clone)]
pub struct SimulatedPoint {
    /// Values of the random variables `(d,)`, SI.
    pub sample: Vec<f64>,
    /// Simulated histories, per output of the scene.
    pub observed: Observed,
}

/// Comparison of surrogates and simulations at the same points.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Verification {
    /// Simulations the surrogates were fitted to.
    pub learned_from: usize,
    /// Simulations they were compared with.
    pub points: usize,
    /// Accuracy of the surrogate of each limit state.
    pub surrogates: Vec<Verified>,
    /// Limit states, in the scene's order, and the system last as `total`; the order of the arrays in `rows`.
    pub curves: Vec<String>,
    /// Checkpoints at which some points have failed, but not all.
    pub rows: Vec<VerifiedRow>,
}

/// Accuracy of one surrogate at points that it was not fitted to.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Verified {
    /// Name of the limit state.
    pub limit_state: String,
    /// Names of kernel and trend.
    pub form: String,
    /// Q2 = 1 - sum of squared errors / sum of squared deviations, smallest over the checkpoints it was fitted on [1].
    pub q2: f64,
    /// Smallest leave-one-out Q2 over the points and checkpoints it was fitted to [1].
    pub q2_leave_one_out: f64,
    /// Mean over those checkpoints and the points of (error / predicted standard deviation, noise included)^2 [1].
    pub variance_ratio: f64,
}

/// Reliabilities by simulation and by surrogate at one checkpoint.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct VerifiedRow {
    /// Checkpoint of life [cycles].
    pub cycles: u32,
    /// R by simulation, per curve [1].
    pub simulated: Vec<f64>,
    /// R by surrogate, per curve [1].
    pub predicted: Vec<f64>,
    /// Standard error of their difference, per curve [1].
    pub standard_error: Vec<f64>,
}

impl Verification {
    /// Largest difference of any curve at any checkpoint [1].
    pub fn largest_difference(&self) -> f64 {
        let largest_of_row = |row: &VerifiedRow| {
            row.simulated.iter().zip(&row.predicted).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
        };
        self.rows.iter().map(largest_of_row).fold(0.0, f64::max)
    }
}

/// Outcome of one evaluation of a study.
#[derive(Debug, Clone)]
pub struct StoredOutcome {
    /// Values of the random variables `(d,)`, SI.
    pub sample: Vec<f64>,
    /// Simulated histories per output of the scene, or the failure.
    pub outcome: ObservedOutcome,
}

/// Compares the surrogates that a study ended with, from its outcomes in the order of their requests, with `unseen`.
/// `None` if they are not the outcomes that this version would have requested.
///
/// # Errors
/// [`CampaignError`].
pub fn verify_study(
    scene: &Scene,
    settings: &Settings,
    stored: &[StoredOutcome],
    unseen: &[SimulatedPoint],
) -> Result<Option<Verification>, CampaignError> {
    let surrogates = repeat_learning(scene, settings, stored)?;
    Ok(surrogates.map(|surrogates| {
        let learned_from = surrogates[0].model.points();
        compare(scene, &surrogates, learned_from, unseen)
    }))
}

/// Repeats the learning of a study from its outcomes and returns its last surrogates; `None` if another sample than the
/// stored one is requested.
fn repeat_learning(
    scene: &Scene,
    settings: &Settings,
    stored: &[StoredOutcome],
) -> Result<Option<Vec<Surrogate>>, CampaignError> {
    let responses = ResponseLayout::from_scene(scene);
    let mut campaign = Campaign::new(Problem::from_scene(scene), Plan::new(settings, scene));
    let (mut left, mut same) = (stored.iter(), true);
    // A study that was interrupted has fewer outcomes than requests.
    let recalled = |requests: &[SampleRequest]| -> Result<Vec<ObservedOutcome>, CampaignError> {
        let found: Vec<&StoredOutcome> = left.by_ref().take(requests.len()).collect();
        same &= found.iter().zip(requests).all(|(stored, request)| stored.sample == request.sample);
        let complete = |stored: &StoredOutcome| stored.outcome.clone().map(|o| responses.complete(o));
        Ok(if same { found.into_iter().map(complete).collect() } else { vec![] })
    };
    campaign.run(recalled, |_| {})?;
    Ok(Some(campaign.surrogates.models).filter(|surrogates| same && !surrogates.is_empty()))
}

/// Fits surrogates to `learned`, in one fit from several starts, and compares them with `unseen`.
///
/// # Errors
/// [`CampaignError::Surrogate`].
pub fn verify(
    scene: &Scene,
    settings: &Settings,
    learned: &[SimulatedPoint],
    unseen: &[SimulatedPoint],
) -> Result<Verification, CampaignError> {
    let responses = ResponseLayout::from_scene(scene);
    let learned = observations(scene, &responses, learned);
    let Settings { forms, stated_errors, method, .. } = *settings;
    let options = FitOptions {
        forms,
        stated_errors,
        effort: Effort::MultiStart,
        as_published: method == Method::AkMcs,
    };
    let fitted = fit_surrogates(&learned, &responses.modes, (&[], None), options)?;
    Ok(compare(scene, &fitted, learned.len(), unseen))
}

/// Compares surrogates, fitted to `learned_from` simulations, with `unseen`.
fn compare(
    scene: &Scene,
    fitted: &[Surrogate],
    learned_from: usize,
    unseen: &[SimulatedPoint],
) -> Verification {
    let responses = ResponseLayout::from_scene(scene);
    let unseen = observations(scene, &responses, unseen);
    let unseen_points = unseen.points();
    let m = scene.life.checkpoints().len();
    let mut predicted: Vec<Vec<u32>> = Vec::new();
    let mut surrogates = Vec::new();
    for ((mode, surrogate), limit) in responses.modes.iter().zip(fitted).zip(&scene.limit_states) {
        let prediction = surrogate.model.predict(unseen_points.as_ref());
        let values = unseen.running_maxima(mode.output);
        predicted.push(firsts(unseen.len(), m, |j, n| prediction.mean[(n, j)] >= surrogate.threshold.value));
        surrogates.push(verified(
            &limit.name,
            surrogate,
            &prediction.mean,
            &prediction.variance_factor,
            &values,
        ));
    }
    let simulated = first_failures_of(&responses, &unseen, m);
    Verification {
        learned_from,
        points: unseen.len(),
        surrogates,
        curves: curve_names(scene),
        rows: rows(&scene.life.checkpoints(), simulated, predicted),
    }
}

/// The simulations in the form that a campaign receives, `(N,)`.
pub fn completed(scene: &Scene, simulated: &[SimulatedPoint]) -> Vec<Observed> {
    let responses = ResponseLayout::from_scene(scene);
    simulated.iter().map(|point| responses.complete(point.observed.clone())).collect()
}

/// Index of the first checkpoint by which each simulation has failed, m if never, `(limit states)(N,)`.
pub fn first_failures(scene: &Scene, simulated: &[SimulatedPoint]) -> Vec<Vec<u32>> {
    let responses = ResponseLayout::from_scene(scene);
    let all = observations(scene, &responses, simulated);
    first_failures_of(&responses, &all, scene.life.checkpoints().len())
}

fn first_failures_of(responses: &ResponseLayout, simulated: &Observations, m: usize) -> Vec<Vec<u32>> {
    let first_failures_of_mode = |mode: &Mode| {
        let values = simulated.running_maxima(mode.output);
        firsts(simulated.len(), m, |j, n| values[(j, n)] >= mode.threshold)
    };
    responses.modes.iter().map(first_failures_of_mode).collect()
}

/// First checkpoint by which each point has failed.
fn firsts(points: usize, m: usize, failed: impl Fn(usize, usize) -> bool) -> Vec<u32> {
    let first = |j| (0..m).find(|n| failed(j, *n)).unwrap_or(m) as u32;
    (0..points).map(first).collect()
}

/// The simulations as observations; all count as initial design, since no learning follows.
fn observations(scene: &Scene, responses: &ResponseLayout, simulated: &[SimulatedPoint]) -> Observations {
    let inputs = InputModel::from_scene(scene);
    let mut all = Observations::new(inputs.dimension());
    for point in simulated {
        all.add(&inputs.standardise(&point.sample), responses.complete(point.observed.clone()));
    }
    all.close_design();
    all
}

fn verified(
    limit_state: &str,
    surrogate: &Surrogate,
    mean: &Mat<f64>,
    variance_factor: &[f64],
    values: &Mat<f64>,
) -> Verified {
    let model = &surrogate.model;
    let n = values.nrows() as f64;
    let noise = model.correlation().noise();
    let (mut q2, mut ratio) = (1.0_f64, 0.0);
    for o in &surrogate.fitted_on {
        let centre = values.col(*o).iter().sum::<f64>() / n;
        let (mut errors, mut deviations) = (0.0, 0.0);
        for (j, factor) in variance_factor.iter().enumerate() {
            let error = (values[(j, *o)] - mean[(*o, j)]).powi(2);
            errors += error;
            deviations += (values[(j, *o)] - centre).powi(2);
            ratio += error / (model.sigma2()[*o] * (factor + noise)).max(f64::MIN_POSITIVE);
        }
        q2 = q2.min(if deviations > 0.0 { 1.0 - errors / deviations } else { 1.0 });
    }
    Verified {
        limit_state: limit_state.to_owned(),
        form: format!("{}, {} trend", model.correlation().kernel.name(), model.trend().name()),
        q2,
        q2_leave_one_out: surrogate.leave_one_out.iter().map(|l| l.q2).fold(1.0, f64::min),
        variance_ratio: ratio / (n * surrogate.fitted_on.len() as f64),
    }
}

/// First failures per limit state `(modes)(N,)` as reliabilities over life.
fn rows(cycles: &[u32], simulated: Vec<Vec<u32>>, predicted: Vec<Vec<u32>>) -> Vec<VerifiedRow> {
    let m = cycles.len();
    let (simulated, predicted) = (with_system(simulated), with_system(predicted));
    let points = simulated[0].len() as f64;
    let survives = |first: u32, n: usize| f64::from(u8::from(first as usize > n));
    let row = |n: usize| {
        let reliability = |firsts: &[Vec<u32>]| -> Vec<f64> {
            let share = |first: &Vec<u32>| first.iter().map(|f| survives(*f, n)).sum::<f64>() / points;
            firsts.iter().map(share).collect()
        };
        let standard_error = |(a, b): (&Vec<u32>, &Vec<u32>)| {
            let differences = || a.iter().zip(b).map(|(a, b)| survives(*a, n) - survives(*b, n));
            let mean = differences().sum::<f64>() / points;
            (differences().map(|d| (d - mean).powi(2)).sum::<f64>() / points / points).sqrt()
        };
        VerifiedRow {
            cycles: cycles[n],
            simulated: reliability(&simulated),
            predicted: reliability(&predicted),
            standard_error: simulated.iter().zip(&predicted).map(standard_error).collect(),
        }
    };
    let open = |row: &VerifiedRow| row.simulated.iter().chain(&row.predicted).any(|r| *r > 0.0 && *r < 1.0);
    (0..m).map(row).filter(open).collect()
}
