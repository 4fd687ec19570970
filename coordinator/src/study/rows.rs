//! Parts of a result that are read off what was learned: Sobol indices, what fails first, simulations without a result.

use super::{Failed, Learned};
use crate::results::summary::{FailureRow, Failures, FirstFailureRow, SobolError, SobolRow};
use crate::statistics::reliability::Condition;
use crate::statistics::sensitivity::sobol_indices;
use common::scene::Scene;
use faer::{Mat, MatRef};
use std::collections::BTreeMap;

/// Sobol indices of the limit states' outputs at the checkpoints that matter.
pub(super) fn sobol(scene: &Scene, learned: &Learned) -> Vec<SobolRow> {
    let cycles = scene.life.checkpoints();
    let population = learned.looked_at.unconditional();
    // Shares of the variance are no shares where variables depend on each other.
    if !population.inputs().copula().is_independent() {
        return Vec::new();
    }
    let grid = &learned.assessment.grid;
    let (Some(&first), Some(&last)) = (grid.first(), grid.last()) else { return Vec::new() };
    let mut rows = Vec::new();
    for (limit, surrogate) in scene.limit_states.iter().zip(&learned.assessment.surrogates) {
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

/// What failed first of the samples that have failed by one checkpoint.
pub(super) fn first_failure(
    names: &[String],
    killers: &[Vec<f64>],
    condition: &Condition,
    cycles: u32,
    n: usize,
) -> FirstFailureRow {
    let share = |(name, shares): (&String, &Vec<f64>)| (name.clone(), condition.probability * shares[n]);
    FirstFailureRow {
        cycles,
        together: condition.probability * killers[names.len()][n],
        first: names.iter().zip(killers).map(share).collect(),
    }
}

/// The simulations without a result, and how much of the population they stand for.
pub(super) fn failures(scene: &Scene, learned: &Learned) -> Failures {
    let sample = |z: &[f64]| -> BTreeMap<String, f64> {
        let values = learned.looked_at.population.inputs().to_physical(z);
        scene.variables.iter().zip(values).map(|(variable, x)| (variable.name.clone(), x)).collect()
    };
    let failure = |failed: &Failed| FailureRow { cause: failed.cause.to_string(), sample: sample(&failed.z) };
    Failures {
        barred_share: learned.assessment.feasibility.barred_share(learned.looked_at.unconditional()),
        simulations: learned.failed.iter().map(failure).collect(),
    }
}
