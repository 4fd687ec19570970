//! The exploring points of a campaign: in turn in a gap near a limit, in a gap of the bulk, and where the predicted variance is
//! largest; where failures are rare those of the rim that are farthest from all results. See
//! [`crate::statistics::learning::widest_gap`] and [`crate::statistics::learning::explore`].

use super::campaign::Campaign;
use super::requests::PendingSample;
use crate::statistics::design::{Stream, open_stream};
use crate::statistics::learning::{Gap, draw_rim};
use std::ops::Range;

/// Places that exploring takes in turn; `None` is the largest predicted variance.
const TURNS: [Option<Gap>; 4] = [Some(Gap::Limit), Some(Gap::Bulk), None, Some(Gap::Bulk)];

impl Campaign {
    /// The exploring points with these numbers since a rule was met: of the population, or of the rim where failures are rare.
    pub(super) fn explore(&mut self, numbers: Range<usize>) -> Vec<PendingSample> {
        if numbers.is_empty() {
            return vec![];
        }
        let round = u32::try_from(self.rounds.len()).unwrap_or(u32::MAX);
        let assessment = self.assessment.as_mut().expect("all outcomes have been assessed");
        let Self { classified, requests, data, problem, plan, .. } = self;
        let failed = assessment.governing_failed();
        let barred = assessment.feasibility.barred_share(classified.unconditional());
        if !classified.is_rare(plan, failed, barred) {
            let mut rng = open_stream(plan.settings.seed, Stream::Gaps(round));
            let mut chosen: Vec<PendingSample> = Vec::new();
            for number in numbers {
                let own = chosen.iter().map(|pending| pending.z.as_slice());
                let pending: Vec<Vec<f64>> =
                    requests.points_under_way().chain(own).map(<[f64]>::to_vec).collect();
                let (population, requested) = (&classified.population, &requests.requested);
                let place = TURNS[number % TURNS.len()];
                let found = match place {
                    Some(place) => {
                        let known = data.explored_with_factors().into_iter();
                        let known = known.chain(pending.iter().map(|z| (z.as_slice(), 1.0)));
                        assessment.fill_gap(population, requested, known, place, &mut rng)
                    }
                    None => {
                        let mut known = data.explored();
                        known.extend(pending);
                        assessment.explore(population, requested, &known)
                    }
                };
                let Some(j) = found else { continue };
                // A result near a limit may well lie on its other side, and is no test: it joins the surrogates.
                let exploring = place != Some(Gap::Limit);
                chosen.push(PendingSample { exploring, ..requests.take(classified, j) });
            }
            return chosen;
        }
        let pf = classified.condition.probability * failed.max(1.0 / classified.population.len() as f64);
        let rim = draw_rim(&problem.inputs, pf, &mut open_stream(plan.settings.seed, Stream::Rim(round)));
        let under_way = requests.points_under_way().map(|z| (z, 1.0));
        let known = data.explored_with_factors().into_iter().chain(under_way);
        let pending =
            |z: Vec<f64>| PendingSample { exploring: true, ..PendingSample::at(z, &problem.inputs) };
        assessment.explore_rim(rim, known, numbers.len()).into_iter().map(pending).collect()
    }
}
