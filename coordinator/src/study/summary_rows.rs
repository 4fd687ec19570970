//! Rows of the summary by the surrogates at the end of a study: their predictions for their own simulations, each from all others;
//! and Sobol indices of the limit states' outputs, with their errors by sampling and by the surrogates.
//!
//! The most probable failure of each limit state: of all failed points of a population the one with the highest density in the space
//! of independent standard normals, the one nearest to its origin. The point of the first order reliability method (FORM) is the
//! limit of this one for a large population.
//!
//! # Source
//! Hasofer, Lind (1974), Exact and invariant second-moment code format, Journal of the Engineering Mechanics Division 100(1).

use super::mode_results::ModeResults;
use super::plan::ResponseLayout;
use super::{CampaignResult, Surrogate};
use crate::results::summary::{SobolError, SobolRow};
use crate::results::summary_rows::{CoordinateRow, FailurePointRow, PredictionRow};
use crate::statistics::design::Population;
use crate::statistics::learning::Mode;
use crate::statistics::sensitivity::{SAMPLES, Sampled, Sobol, sobol_indices, surrogate_errors};
use crate::statistics::surrogate::Kriging;
use common::random::RandomVariable;
use common::scene::{Fails, LimitState, Scene};
use faer::{Mat, MatRef};

/// Groups of results that are left out in turn to estimate the error by the surrogate.
const GROUPS: usize = 8;
/// Points of each sample by which that is done: the differences of indices over the same points scatter little.
const FEWER: usize = 1024;

/// Number of simulations that exceeded a limit at a checkpoint.
pub(super) fn simulations_beyond_a_limit(scene: &Scene, learned: &CampaignResult) -> usize {
    let modes = ResponseLayout::from_scene(scene).modes;
    let last = scene.life.checkpoints().len() - 1;
    let response = |mode: &Mode| (mode.threshold, learned.observations.running_maxima(mode.output));
    let responses: Vec<_> = modes.iter().map(response).collect();
    let exceeds = |i: &usize| responses.iter().any(|(threshold, largest)| largest[(*i, last)] >= *threshold);
    (0..learned.observations.len()).filter(exceeds).count()
}

/// One row per limit state, at the checkpoint at which the system's R is nearest 1/2.
pub(super) fn predictions(scene: &Scene, learned: &CampaignResult) -> Vec<PredictionRow> {
    let modes = ResponseLayout::from_scene(scene).modes;
    let n = learned.assessment.governing;
    let cycles = scene.life.checkpoints()[n];
    let limits = scene.limit_states.iter().zip(modes).zip(&learned.assessment.surrogates).enumerate();
    let row = |(s, ((limit, mode), surrogate)): (usize, ((&LimitState, Mode), &Surrogate))| {
        let unit = scene.outputs[limit.output].kind.unit();
        // Responses that fail below their threshold are learned with the opposite sign; of two limits, distances from their middle.
        let sign = if limit.fails == Fails::Below { -1.0 } else { 1.0 };
        let shown = |response: f64| unit.to_file(sign * response);
        let observations = learned.observations.design_of(s);
        let points = observations.points();
        let results = ModeResults::new(&observations, &points, &mode);
        let scale = surrogate.scale_of(&results.values);
        let learned = results.in_scale(scale);
        let learned_values = learned.as_ref().unwrap_or(&results).learned().0.as_ref();
        let left_out = surrogate.model.left_out(learned_values, n);
        let factor = surrogate.inflation().sqrt();
        PredictionRow {
            limit_state: limit.name.clone(),
            cycles,
            unit: unit.suffix().to_owned(),
            simulated: results.values.col(n).iter().map(|value| shown(*value)).collect(),
            predicted: left_out.iter().map(|one| shown(scale.value(one.mean))).collect(),
            std: left_out
                .iter()
                .map(|one| unit.to_file(factor * one.std * scale.slope(scale.value(one.mean))))
                .collect(),
            q2: surrogate.model.leave_one_out(learned_values)[n].q2,
        }
    };
    let all = limits.map(row);
    all.filter(|row| row.std.iter().chain(&row.predicted).all(|value| value.is_finite())).collect()
}

/// Sobol indices of the limit states' outputs themselves, neither of their running maxima nor of their distances from a middle, at
/// the checkpoints of the grid; none for dependent variables. The surrogate of a limit state, which learns these, predicts
/// the output from the same simulations.
pub(super) fn sobol(scene: &Scene, campaign: &CampaignResult) -> Vec<SobolRow> {
    // For dependent variables the indices are no shares of the variance.
    if !campaign.classified.unconditional().inputs.copula.is_independent() {
        return Vec::new();
    }
    (0..scene.limit_states.len()).flat_map(|s| sobol_of(scene, campaign, s)).collect()
}

/// Sobol indices of the output of limit state `s`.
fn sobol_of(scene: &Scene, campaign: &CampaignResult, s: usize) -> Vec<SobolRow> {
    let limit = &scene.limit_states[s];
    let (cycles, population) = (scene.life.checkpoints(), campaign.classified.unconditional());
    let grid = &campaign.assessment.grid;
    let (Some(&first), Some(&last)) = (grid.first(), grid.last()) else { return Vec::new() };
    let observations = campaign.observations.design_of(s);
    let (points, values) = (observations.points(), observations.values(limit.output));
    let surrogate = &campaign.assessment.surrogates[s];
    let (mut model, scale) = (surrogate.model.clone(), surrogate.scale_of(&values));
    let values = scale.learned_values(&values);
    model.set_values(values.as_ref());
    let indices_by = |model: &Kriging, samples: usize| {
        let dual = model.dual();
        let predict = |points: MatRef<'_, f64>| {
            let all = model.predict_means(points, &dual, first..last + 1);
            Mat::from_fn(grid.len(), points.ncols(), |o, j| scale.value(all[(grid[o] - first, j)]))
        };
        sobol_indices(population, samples, grid.len(), &predict)
    };
    let indices = indices_by(&model, SAMPLES);
    let without = |group: usize| {
        let kept: Vec<usize> = (0..points.ncols()).filter(|i| i % GROUPS != group).collect();
        model.conditioned_on(points.as_ref(), values.as_ref(), &kept).ok()
    };
    let without: Vec<Vec<Vec<Sobol>>> =
        (0..GROUPS).filter_map(|group| Some(indices_by(&without(group)?, FEWER))).collect();
    let errors = surrogate_errors(&indices_by(&model, FEWER), &without);
    let mut rows = Vec::new();
    for ((n, variables), errors) in grid.iter().zip(indices).zip(errors) {
        let of_variables = scene.variables.iter().zip(variables).zip(errors);
        rows.extend(of_variables.map(|((variable, sobol), (first_order, total))| SobolRow {
            cycles: cycles[*n],
            limit_state: limit.name.clone(),
            variable: variable.name.clone(),
            first_order: sobol.first_order.value,
            total: sobol.total.value,
            standard_error: SobolError {
                first_order: sobol.first_order.standard_error.hypot(first_order),
                total: sobol.total.standard_error.hypot(total),
            },
        }));
    }
    rows
}

/// Least number of points that have failed at the checkpoint of the most probable failure: early failures are what a study is made for,
/// and the nearest of twenty does not depend on a single one.
const LEAST: usize = 20;

/// One row per limit state with failures, at the first checkpoint by which twenty points have failed, or the last one.
/// `first_failures` `(modes)(points,)` are indices of checkpoints; m if never.
pub(super) fn failure_points(
    scene: &Scene,
    sampled: &Sampled<'_>,
    first_failures: &[Vec<u32>],
) -> Vec<FailurePointRow> {
    let cycles = scene.life.checkpoints();
    let limits = scene.limit_states.iter().zip(first_failures);
    let row = |(limit, first): (&LimitState, &Vec<u32>)| {
        let count = |n: usize| first.iter().filter(|at| **at as usize <= n).count();
        let last = cycles.len() - 1;
        let n = (0..last).find(|n| count(*n) >= LEAST).unwrap_or(last);
        let failed = sampled.points.iter().zip(first).filter(|(_, at)| **at as usize <= n);
        let normals = failed.map(|(point, _)| (*point, normals(sampled.population, *point)));
        let distances = normals.map(|(point, (u, distance))| (distance, point, u));
        let (distance, point, normals) =
            distances.filter(|(distance, ..)| distance.is_finite()).min_by(|a, b| a.0.total_cmp(&b.0))?;
        let coordinates = scene.variables.iter().zip(sampled.population.physical(point)).zip(normals);
        let coordinate = |((variable, value), normal): ((&RandomVariable, f64), f64)| CoordinateRow {
            variable: variable.name.clone(),
            value,
            normal,
        };
        Some(FailurePointRow {
            limit_state: limit.name.clone(),
            cycles: cycles[n],
            failed: sampled.probability * count(n) as f64 / first.len().max(1) as f64,
            distance,
            variables: coordinates.map(coordinate).collect(),
        })
    };
    limits.filter_map(row).collect()
}

/// The correlated standard normals of a point `(d,)`, and its distance from the origin of the independent ones [1].
fn normals(population: &Population, point: usize) -> (Vec<f64>, f64) {
    let inputs = &population.inputs;
    let normals = inputs.normals(&population.physical(point));
    let distance = inputs.copula.decorrelate(&normals).iter().map(|v| v * v).sum::<f64>().sqrt();
    (normals, distance)
}

#[cfg(test)]
mod tests {
    use super::*;
    use common::scene::SceneSource;

    /// Of two independent normals whose sum fails above 2 sqrt(2), the nearest failure is at (2, 2) / sqrt(2) standard deviations.
    #[test]
    fn the_nearest_failure_of_a_sum_lies_on_the_diagonal() {
        let text = "scene = { name = \"s\" }\nsimulator = { program = [\"s\"] }\noutputs = [{ name = \"a\" }]\n\
                    limit_states = [{ name = \"high\", output = \"a\", threshold = 5 }]\n\
                    life = { cycles = 3, checkpoint_every = 1 }\n\
                    variables = [{ name = \"x\", mean = 10, std = 2, distribution = \"normal\" },\n\
                    { name = \"y\", mean = -1, std = 0.5, distribution = \"normal\" }]\n";
        let scene = SceneSource::parse(text, "s").unwrap().nominal().clone();
        let population = Population::draw(crate::study::Problem::from_scene(&scene).inputs, 100_000, 3);
        let points: Vec<usize> = (0..population.len()).collect();
        let bound = 2.0 * 2.0f64.sqrt();
        // Few fail at the first checkpoint, P(v > 2) at the second, all at the last.
        let first = |j: usize| {
            let sum: f64 = population.standardised(j).iter().sum();
            if sum > 6.0 {
                0
            } else if sum > bound {
                1
            } else {
                2
            }
        };
        let first_failures = vec![points.iter().map(|j| first(*j)).collect::<Vec<u32>>()];
        let sampled = Sampled { population: &population, points: &points, probability: 1.0 };
        let [row] = &failure_points(&scene, &sampled, &first_failures)[..] else { panic!("one row") };
        assert_eq!((row.limit_state.as_str(), row.cycles), ("high", 2));
        assert!((row.failed - 0.02275).abs() < 4.0 * (0.02275f64 / 1e5).sqrt(), "{}", row.failed);
        assert!(row.distance >= 2.0 && row.distance < 2.05, "{}", row.distance);
        for (found, (mean, std)) in row.variables.iter().zip([(10.0, 2.0), (-1.0, 0.5)]) {
            assert!((found.value - mean - std * found.normal).abs() < 1e-9, "{found:?}");
            assert!((found.normal - 2.0f64.sqrt()).abs() < 0.5, "{found:?}");
        }
        let nothing = vec![vec![3; points.len()]];
        assert!(failure_points(&scene, &sampled, &nothing).is_empty());
    }
}
