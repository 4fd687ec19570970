//! Rows of the summary that follow from a campaign's result: Sobol indices, shares of first failures, failed
//! simulations.

use super::{CampaignResult, Failed};
use crate::results::summary::{FailureRow, Failures, FirstFailureRow, SobolError, SobolRow};
use crate::statistics::design::InputModel;
use crate::statistics::reliability::Condition;
use crate::statistics::sensitivity::sobol_indices;
use common::scene::Scene;
use faer::{Mat, MatRef};
use std::collections::BTreeMap;

/// Sobol indices of the limit states' outputs at the checkpoints of the grid; none for dependent variables.
pub(super) fn sobol(scene: &Scene, campaign: &CampaignResult) -> Vec<SobolRow> {
    let cycles = scene.life.checkpoints();
    let population = campaign.classified.unconditional();
    // For dependent variables the indices are no shares of the variance.
    if !population.inputs().copula().is_independent() {
        return Vec::new();
    }
    let grid = &campaign.assessment.grid;
    let (Some(&first), Some(&last)) = (grid.first(), grid.last()) else { return Vec::new() };
    let mut rows = Vec::new();
    for (limit, surrogate) in scene.limit_states.iter().zip(&campaign.assessment.surrogates) {
        let (model, dual) = (&surrogate.model, surrogate.model.dual());
        let predict = |points: MatRef<'_, f64>| {
            let all = model.predict_means(points, &dual, first..last + 1);
            Mat::from_fn(grid.len(), points.ncols(), |o, j| all[(grid[o] - first, j)])
        };
        let indices = sobol_indices(population, grid.len(), &predict);
        for (n, variables) in grid.iter().zip(indices) {
            rows.extend(scene.variables.iter().zip(variables).map(|(variable, sobol)| SobolRow {
                cycles: cycles[*n],
                limit_state: limit.name.clone(),
                variable: variable.name.clone(),
                first_order: sobol.first_order.value,
                total: sobol.total.value,
                standard_error: SobolError {
                    first_order: sobol.first_order.standard_error,
                    total: sobol.total.standard_error,
                },
            }));
        }
    }
    rows
}

/// Shares of first failures by checkpoint `n`; `shares` `(modes + 1, m)` as from
/// [`crate::statistics::reliability::LifeCounts::first_failure_shares`].
pub(super) fn first_failure(
    names: &[String],
    shares: &[Vec<f64>],
    condition: &Condition,
    cycles: u32,
    n: usize,
) -> FirstFailureRow {
    let share = |(name, curve): (&String, &Vec<f64>)| (name.clone(), condition.probability * curve[n]);
    FirstFailureRow {
        cycles,
        together: condition.probability * shares[names.len()][n],
        first: names.iter().zip(shares).map(share).collect(),
    }
}

/// The failed simulations, and the share of the population they represent.
pub(super) fn failures(scene: &Scene, campaign: &CampaignResult) -> Failures {
    let inputs = campaign.classified.population.inputs();
    Failures {
        barred_share: campaign.assessment.feasibility.barred_share(campaign.classified.unconditional()),
        simulations: failure_rows(scene, inputs, &campaign.failed),
    }
}

/// The failed simulations with their causes and samples.
pub(super) fn failure_rows(scene: &Scene, inputs: &InputModel, failed: &[Failed]) -> Vec<FailureRow> {
    let sample = |z: &[f64]| -> BTreeMap<String, f64> {
        let values = inputs.to_physical(z);
        scene.variables.iter().zip(values).map(|(variable, x)| (variable.name.clone(), x)).collect()
    };
    let row = |failed: &Failed| FailureRow { cause: failed.cause.to_string(), sample: sample(&failed.z) };
    failed.iter().map(row).collect()
}
