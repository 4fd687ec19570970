//! Replacement above a measured level: lives and measured outputs of a population by the surrogates of a study, and the level
//! and the last age with the least cost per cycle for every distance of inspections.

use super::ReplacementError;
use crate::statistics::design::{Population, Stream, deviation, open_stream};
use crate::statistics::replacement::{InspectedSamples, PolicyCosts, PolicyOutcome, best_policy, outcome_of};
use crate::study::LifeModel;
use common::scene::{Fails, Scene};
use rand_distr::{Distribution, StandardNormal};
use serde::Serialize;

/// Number of units.
const UNITS: usize = 20_000;
/// Most inspections in the life studied.
const MOST: usize = 500;

/// Inspections whose level is sought.
#[derive(Debug, Clone, PartialEq)]
pub struct InspectionPlan {
    /// Index of the output that is measured.
    pub output: usize,
    /// Standard deviation of the measurement's error [unit of the output].
    pub error: f64,
    /// Distances of inspections [cycles].
    pub every: Vec<f64>,
    /// Costs.
    pub costs: PolicyCosts,
}

/// The best policy for one distance of inspections.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct InspectionRow {
    /// Distance of the inspections [cycles].
    pub every: f64,
    /// Name of the output that is measured.
    pub output: String,
    /// Replace from this value on (below it, if the output fails below) [unit of the output]; `null` if only the age counts.
    pub level: Option<f64>,
    /// Age at which a unit is replaced in any case [cycles].
    pub age: f64,
    /// Cost per cycle.
    pub cost_rate: f64,
    /// Its standard error by the number of units.
    pub standard_error: f64,
    /// Share of the units that fail before they are replaced [1].
    pub failed: f64,
    /// Share of the units that are replaced because of the level [1].
    pub by_level: f64,
    /// Mean life of a unit until its replacement or failure [cycles].
    pub mean_life: f64,
    /// Mean number of inspections of a unit.
    pub inspections: f64,
}

/// The best policy for every distance of inspections, in their order.
///
/// # Errors
/// [`ReplacementError::Every`].
pub fn inspect(
    scene: &Scene,
    model: &LifeModel,
    plan: &InspectionPlan,
    seed: u64,
) -> Result<Vec<InspectionRow>, ReplacementError> {
    let (beginning, end) = (model.beginning(plan.output), model.end());
    for every in &plan.every {
        let least = beginning.max(end / MOST as f64);
        if !(*every >= least && *every <= end) {
            return Err(ReplacementError::Every { every: *every, least, most: end, count: MOST });
        }
    }
    let population = Population::draw(model.inputs(), UNITS, seed);
    let width = model.deviations();
    let deviations: Vec<f64> = (0..UNITS).flat_map(|j| (0..width).map(move |s| deviation(s, j))).collect();
    let responses = model.respond(population.columns(0..UNITS), &deviations, &[plan.output]);
    let limit_states = model.limit_states();
    let life = |own: &[f64]| own.iter().copied().fold(f64::INFINITY, f64::min);
    let lives: Vec<f64> = responses.lives.chunks_exact(limit_states).map(life).collect();
    let below = scene.limit_states.iter().any(|l| l.output == plan.output && l.fails == Fails::Below);
    let sign = if below { -1.0 } else { 1.0 };
    let row = |every: &f64| {
        let count = (end / every * (1.0 + 1e-9)).floor() as usize;
        let times: Vec<f64> = (1..=count).map(|k| (k as f64 * every).min(end)).collect();
        let mut rng = open_stream(seed, Stream::Curve);
        let mut values = Vec::with_capacity(UNITS * count);
        for j in 0..UNITS {
            for t in &times {
                let noise: f64 = StandardNormal.sample(&mut rng);
                let value = model.value_at(plan.output, &responses.histories[0], j, *t);
                values.push(sign * (value + plan.error * noise));
            }
        }
        let samples = InspectedSamples { lives: lives.clone(), times, values };
        let policy = best_policy(&samples, &plan.costs)?;
        let outcome: PolicyOutcome = outcome_of(&samples, &policy, &plan.costs);
        Some(InspectionRow {
            every: *every,
            output: scene.outputs[plan.output].name.clone(),
            level: (outcome.by_level > 0.0).then_some(sign * policy.level),
            age: samples.times[policy.last],
            cost_rate: outcome.cost_rate,
            standard_error: outcome.standard_error,
            failed: outcome.failed,
            by_level: outcome.by_level,
            mean_life: outcome.mean_life,
            inspections: outcome.inspections,
        })
    };
    Ok(plan.every.iter().filter_map(row).collect())
}
