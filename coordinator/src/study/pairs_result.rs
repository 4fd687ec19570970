//! What the pairs of a study gave, for its summary.

use super::correction::Correction;
use super::{CampaignResult, Settings};
use crate::results::level_summary::{DifferenceRow, LevelsRow};
use crate::results::summary::StudySummary;
use common::scene::{LimitState, Scene};

/// What the pairs of a study gave.
#[derive(Debug)]
pub(super) struct PairsResult {
    pub(super) correction: Option<Correction>,
    /// Simulations at finer levels, failed ones included.
    pub(super) evaluations: usize,
    /// Those without a result.
    pub(super) failed: usize,
}

impl PairsResult {
    /// Adds the levels and their differences to the summary.
    pub fn add_to(
        &self,
        summary: &mut StudySummary,
        scene: &Scene,
        settings: &Settings,
        learned: &CampaignResult,
    ) {
        let finer = settings.finer_levels(scene);
        if finer.is_empty() {
            return;
        }
        let n = learned.assessment.governing;
        let row = |limit: &LimitState| {
            let figures = self.correction.as_ref()?.figures(limit.output, n, limit.threshold);
            let share =
                |value: f64| if limit.threshold == 0.0 { value } else { value / limit.threshold.abs() };
            Some(DifferenceRow {
                limit_state: limit.name.clone(),
                cycles: scene.life.checkpoints()[n],
                form: figures.form.to_owned(),
                correction: share(figures.correction),
                error: share(figures.error),
                rough: share(figures.rough),
                order: figures.order,
            })
        };
        let working = &settings.accuracy.setting;
        summary.evaluations.total += self.evaluations;
        summary.evaluations.failed += self.failed;
        summary.levels = Some(LevelsRow {
            names: std::iter::once(working).chain(&finer).map(|level| level.name.clone()).collect(),
            pairs: self
                .correction
                .as_ref()
                .map_or([0; 2], |correction| [correction.pairs, correction.thirds]),
            evaluations: self.evaluations,
            failed: self.failed,
            differences: scene.limit_states.iter().filter_map(row).collect(),
        });
    }
}
