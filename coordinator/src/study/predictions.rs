//! Predictions of the surrogates at the end of a study for their own simulations, each from all others: rows of the summary.

use super::plan::ResponseLayout;
use super::surrogates::ModeResults;
use super::{CampaignResult, Surrogate};
use crate::results::point_summary::PredictionRow;
use crate::statistics::learning::Mode;
use common::scene::{Fails, LimitState, Scene};

/// Number of simulations that exceeded a limit at a checkpoint.
pub(super) fn simulations_beyond_a_limit(scene: &Scene, learned: &CampaignResult) -> usize {
    let modes = ResponseLayout::from_scene(scene).modes;
    let last = scene.life.checkpoints().len() - 1;
    let responses =
        modes.iter().map(|mode| (mode.threshold, learned.observations.running_maxima(mode.output)));
    let responses: Vec<_> = responses.collect();
    let exceeds = |i: &usize| responses.iter().any(|(threshold, largest)| largest[(*i, last)] >= *threshold);
    (0..learned.observations.len()).filter(exceeds).count()
}

/// One row per limit state, at the checkpoint at which the system's R is nearest 1/2.
pub(super) fn predictions(scene: &Scene, learned: &CampaignResult) -> Vec<PredictionRow> {
    let modes = ResponseLayout::from_scene(scene).modes;
    let (n, points) = (learned.assessment.governing, learned.observations.points());
    let cycles = scene.life.checkpoints()[n];
    let limits = scene.limit_states.iter().zip(modes).zip(&learned.assessment.surrogates);
    let row = |((limit, mode), surrogate): ((&LimitState, Mode), &Surrogate)| {
        let unit = scene.outputs[limit.output].kind.unit();
        // Responses that fail below their threshold are learned with the opposite sign; of two limits, distances from their middle.
        let sign = if limit.fails == Fails::Below { -1.0 } else { 1.0 };
        let shown = |response: f64| unit.to_file(sign * response);
        let results = ModeResults::new(&learned.observations, &points, &mode);
        let learned_values = results.learned().0.as_ref();
        let left_out = surrogate.model.left_out(learned_values, n);
        let factor = surrogate.inflation().sqrt();
        PredictionRow {
            limit_state: limit.name.clone(),
            cycles,
            unit: unit.suffix().to_owned(),
            simulated: results.values.col(n).iter().map(|value| shown(*value)).collect(),
            predicted: left_out.iter().map(|one| shown(one.mean)).collect(),
            std: left_out.iter().map(|one| unit.to_file(factor * one.std)).collect(),
            q2: surrogate.model.leave_one_out(learned_values)[n].q2,
        }
    };
    let all = limits.map(row);
    all.filter(|row| row.std.iter().chain(&row.predicted).all(|value| value.is_finite())).collect()
}
