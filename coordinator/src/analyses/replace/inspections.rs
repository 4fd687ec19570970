//! Replacement above a measured level: lives and measured outputs of a population by the surrogates of a study, and the level
//! and the last age with the least cost per cycle for every schedule of inspections.

use crate::analyses::error::RefusedQuestion;
use crate::statistics::design::{Population, deviation};
use crate::statistics::replacement::{InspectedSamples, PolicyCosts, PolicyOutcome, best_policy, outcome_of};
use crate::study::LifeModel;
use common::scene::{Fails, Scene};
use serde::Serialize;

/// Number of units.
const UNITS: usize = 20_000;
/// Most inspections in the life studied.
const MOST: usize = 500;

/// Inspections whose level is sought.
#[derive(Debug, Clone, PartialEq)]
pub struct InspectionPlan {
    /// Index of the limit state whose failures count; `None`: those of all.
    pub limit_state: Option<usize>,
    /// Index of the output that is measured.
    pub output: usize,
    /// Standard deviation of the measurement's error [unit of the output].
    pub error: f64,
    /// Schedules that are compared.
    pub schedules: Vec<Schedule>,
    /// Costs of replacements and inspections.
    pub costs: PolicyCosts,
}

/// Lives of inspections.
#[derive(Debug, Clone, PartialEq)]
pub enum Schedule {
    /// At all multiples of a distance [cycles].
    Every(f64),
    /// At these lives, increasing [cycles].
    At(Vec<f64>),
}

impl Schedule {
    /// Lives of the inspections of `output` within the study [cycles].
    fn lives(&self, model: &LifeModel, output: usize) -> Result<Vec<f64>, RefusedQuestion> {
        let (beginning, end) = (model.beginning(output), model.end());
        let (asked, allowed) = match self {
            Self::Every(every) => {
                let least = beginning.max(end / MOST as f64);
                if (least..=end).contains(every) {
                    let count = (end / every * (1.0 + 1e-9)).floor() as usize;
                    return Ok((1..=count).map(|k| (k as f64 * every).min(end)).collect());
                }
                let most = format!("at most {MOST} inspections in the life studied");
                (format!("--inspect-every {every}"), format!("{least} to {end} cycles, {most}"))
            }
            Self::At(lives) => {
                let rising = lives.windows(2).all(|pair| pair[0] < pair[1]);
                let wrong = |life: &&f64| !(beginning..=end).contains(life) || !rising || **life == 0.0;
                let Some(life) = lives.iter().find(wrong) else { return Ok(lives.clone()) };
                let range = format!("increasing lives from {beginning} to {end} cycles, the first above 0");
                (format!("--inspect-at {life}"), range)
            }
        };
        Err(RefusedQuestion::new(asked, format!("allowed: {allowed}")))
    }
}

/// The best policy for one schedule of inspections.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct InspectionRow {
    /// Distance of the inspections [cycles]; `null` for given lives.
    pub every: Option<f64>,
    /// Name of the output that is measured.
    pub output: String,
    /// Replace from this value on (below it, if the output fails below) [unit of the output]; `null` if only the age counts.
    pub level: Option<f64>,
    /// Of an output with two thresholds: replace from this value down, too [unit of the output]; absent otherwise.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub lower_level: Option<f64>,
    /// Age at which a unit is replaced in any case [cycles].
    pub age: f64,
    /// Costs and frequencies of the policy.
    #[serde(flatten)]
    pub outcome: PolicyOutcome,
}

/// The best policy for every schedule, in their order.
///
/// # Errors
/// [`RefusedQuestion`] if a schedule does not fit into the life studied.
pub fn inspect(
    scene: &Scene,
    model: &LifeModel,
    plan: &InspectionPlan,
    seed: u64,
) -> Result<Vec<InspectionRow>, RefusedQuestion> {
    let times = |schedule: &Schedule| schedule.lives(model, plan.output);
    let schedules: Vec<Vec<f64>> = plan.schedules.iter().map(times).collect::<Result<_, _>>()?;
    let population = Population::draw(&model.inputs, UNITS, seed);
    let width = model.deviations();
    let deviations: Vec<f64> = (0..UNITS).flat_map(|j| (0..width).map(move |s| deviation(s, j))).collect();
    let responses = model.respond(population.columns(0..UNITS), &deviations, &[plan.output]);
    let limit_states = model.limit_states();
    let life = |own: &[f64]| match plan.limit_state {
        Some(limit_state) => own[limit_state],
        None => own.iter().copied().fold(f64::INFINITY, f64::min),
    };
    let lives: Vec<f64> = responses.lives.chunks_exact(limit_states).map(life).collect();
    // The limit state whose response the level is of: one with two thresholds, or else one that fails below.
    let mut watching =
        scene.limit_states.iter().filter(|l| l.output == plan.output && l.fails != Fails::Above);
    let limit = watching.clone().find(|l| l.middle().is_some()).or_else(|| watching.next());
    let two_sided = limit.is_some_and(|limit| limit.middle().is_some());
    let response = |value: f64| limit.map_or(value, |limit| limit.response(value));
    // Values of the output at a level of the response: the upper one, and the lower one of two.
    let level_of = |response: f64| match limit.map(|limit| limit.middle()) {
        None => (response, None),
        Some(None) => (-response, None),
        Some(Some(middle)) => (middle + response, Some(middle - response)),
    };
    let row = |(schedule, times): (&Schedule, Vec<f64>)| {
        let value = |j: usize, t: &f64| response(model.value_at(plan.output, &responses.histories[0], j, *t));
        let values = (0..UNITS).flat_map(|j| times.iter().map(move |t| value(j, t))).collect();
        let samples = InspectedSamples { lives: lives.clone(), times, values, error: plan.error, two_sided };
        let policy @ (level, last) = best_policy(&samples, &plan.costs)?;
        let outcome = outcome_of(&samples, policy, &plan.costs);
        let (level, lower_level) = level_of(level);
        let by_level = outcome.by_level > 0.0;
        Some(InspectionRow {
            every: if let Schedule::Every(every) = schedule { Some(*every) } else { None },
            output: scene.outputs[plan.output].name.clone(),
            level: by_level.then_some(level),
            lower_level: lower_level.filter(|_| by_level),
            age: samples.times[last],
            outcome,
        })
    };
    Ok(plan.schedules.iter().zip(schedules).filter_map(row).collect())
}
