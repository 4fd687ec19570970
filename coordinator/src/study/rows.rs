//! Rows of the summary: shares of first failures, failed simulations, moments, derivatives.

use super::{CampaignResult, Failed};
use crate::results::summary::{
    FailureRow, Failures, FirstFailureRow, MomentsRow, SensitivityError, SensitivityRow,
};
use crate::statistics::design::InputModel;
use crate::statistics::reliability::{Condition, OutputDistribution};
use crate::statistics::sensitivity::Sensitivity;
use common::scene::Scene;
use std::collections::BTreeMap;

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
        barred_share: campaign.barred_share(),
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

/// Moments at one checkpoint: `{limit state}_mean_m` and `_std_m`, or `_rpm` for angular velocities; one that is too large for a
/// number is left out.
pub(super) fn moments(
    scene: &Scene,
    distributions: &[Vec<OutputDistribution>],
    cycles: u32,
    n: usize,
) -> MomentsRow {
    let mut row = BTreeMap::new();
    for limit in &scene.limit_states {
        let unit = scene.outputs[limit.output].kind.unit();
        let at = &distributions[limit.output][n];
        for (name, value) in [("mean", at.mean), ("std", at.std)] {
            let value = unit.to_file(value);
            if value.is_finite() {
                row.insert(unit.key(&format!("{}_{name}", limit.name)), value);
            }
        }
    }
    MomentsRow { cycles, moments: row }
}

/// A derivative in the names of the scene.
pub(super) fn sensitivity_row(
    scene: &Scene,
    curves: &[String],
    cycles: &[u32],
    row: &Sensitivity,
) -> SensitivityRow {
    let variable = &scene.variables[row.variable];
    let std = variable.distribution.parent_std();
    SensitivityRow {
        cycles: cycles[row.checkpoint],
        limit_state: curves[row.curve].clone(),
        variable: variable.name.clone(),
        d_pf_d_mean: row.to_mean.value,
        d_pf_d_std: row.to_std.value,
        standard_error: SensitivityError {
            d_pf_d_mean: row.to_mean.standard_error,
            d_pf_d_std: row.to_std.standard_error,
        },
        scaled: SensitivityError { d_pf_d_mean: row.to_mean.value * std, d_pf_d_std: row.to_std.value * std },
    }
}
