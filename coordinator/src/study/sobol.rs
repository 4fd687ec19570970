//! Sobol indices of the limit states' outputs, with their errors by sampling and by the surrogates: rows of the summary.

use super::{CampaignResult, Surrogate};
use crate::results::summary::{SobolError, SobolRow};
use crate::statistics::sensitivity::{SAMPLES, Sobol, sobol_indices, surrogate_errors};
use crate::statistics::surrogate::Kriging;
use common::scene::{LimitState, Scene};
use faer::{Mat, MatRef};

/// Groups of results that are left out in turn to estimate the error by the surrogate.
const GROUPS: usize = 8;
/// Points of each sample by which that is done: the differences of indices over the same points scatter little.
const FEWER: usize = 1024;

/// Sobol indices of the limit states' outputs themselves, neither of their running maxima nor of their distances from a middle, at
/// the checkpoints of the grid; none for dependent variables. The surrogate of a limit state, which learns these, predicts
/// the output from the same simulations.
pub(super) fn sobol(scene: &Scene, campaign: &CampaignResult) -> Vec<SobolRow> {
    // For dependent variables the indices are no shares of the variance.
    let population = campaign.classified.unconditional();
    if !population.inputs().copula().is_independent() {
        return Vec::new();
    }
    let limits = scene.limit_states.iter().zip(&campaign.assessment.surrogates);
    limits.flat_map(|(limit, surrogate)| of_limit_state(scene, campaign, limit, surrogate)).collect()
}

fn of_limit_state(
    scene: &Scene,
    campaign: &CampaignResult,
    limit: &LimitState,
    surrogate: &Surrogate,
) -> Vec<SobolRow> {
    let (cycles, population) = (scene.life.checkpoints(), campaign.classified.unconditional());
    let grid = &campaign.assessment.grid;
    let (Some(&first), Some(&last)) = (grid.first(), grid.last()) else { return Vec::new() };
    let indices_by = |model: &Kriging, samples: usize| {
        let dual = model.dual();
        let predict = |points: MatRef<'_, f64>| {
            let all = model.predict_means(points, &dual, first..last + 1);
            Mat::from_fn(grid.len(), points.ncols(), |o, j| all[(grid[o] - first, j)])
        };
        sobol_indices(population, samples, grid.len(), &predict)
    };
    let (points, values) = (campaign.observations.points(), campaign.observations.values(limit.output));
    let mut model = surrogate.model.clone();
    model.set_values(values.as_ref());
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
