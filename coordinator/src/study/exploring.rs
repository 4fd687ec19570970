//! The exploring points of a campaign: those of largest predicted variance in the population, or where failures are
//! rare those of the rim that are farthest from all results, see [`crate::statistics::learning::explore`].

use super::campaign::Campaign;
use super::requests::PendingSample;
use crate::statistics::design::{Stream, open_stream};
use crate::statistics::learning::draw_rim;

impl Campaign {
    /// The next `count` exploring points: of the population, or of the rim where failures are rare.
    pub(super) fn explore(&mut self, count: usize) -> Vec<PendingSample> {
        if count == 0 {
            return vec![];
        }
        let assessment = self.progress.assessment.as_mut().expect("all outcomes have been assessed");
        let Self { classified, requests, data, problem, plan, .. } = self;
        let failed = assessment.governing_failed();
        let barred = assessment.feasibility.barred_share(classified.unconditional());
        if !classified.is_rare(plan, failed, barred) {
            let mut known = data.explored();
            known.extend(requests.points_under_way().map(<[f64]>::to_vec));
            let chosen = assessment.explore(&classified.population, &requests.requested, &known, count);
            let exploring = |j| PendingSample { exploring: true, ..requests.take(classified, j) };
            return chosen.into_iter().map(exploring).collect();
        }
        let pf = classified.condition.probability * failed.max(1.0 / classified.population.len() as f64);
        let round = u32::try_from(self.progress.rounds.len()).unwrap_or(u32::MAX);
        let rim = draw_rim(&problem.inputs, pf, &mut open_stream(plan.settings.seed, Stream::Rim(round)));
        let under_way = requests.points_under_way().map(|z| (z, 1.0));
        let known = data.explored_with_factors().into_iter().chain(under_way);
        let pending = |z: Vec<f64>| {
            let sample = problem.inputs.to_physical(&z);
            PendingSample { z, sample, member: None, stricter: false, exploring: true }
        };
        assessment.explore_rim(rim, known, count).into_iter().map(pending).collect()
    }
}
