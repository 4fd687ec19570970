//! The exploring points of a campaign: in turn in a gap near a limit, in a gap of the bulk, and where the predicted variance is
//! largest; where failures are rare, in turn the point of the rim that is farthest from all results, and two gaps of the bulk, since what
//! seems rare may lie there unseen. See [`crate::statistics::learning::widest_gap`] and [`crate::statistics::learning::explore`].

use super::campaign::Campaign;
use super::requests::PendingSample;
use crate::statistics::design::{Stream, open_stream};
use crate::statistics::learning::{Gap, draw_rim};
use std::ops::Range;

/// A place that an exploring point fills.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum ExploredPlace {
    Gap(Gap),
    /// The largest predicted variance.
    Variance,
    /// The rim of the population, where rare failures lie.
    Rim,
}

/// Places that exploring takes in turn.
const TURNS: [ExploredPlace; 4] = [
    ExploredPlace::Gap(Gap::Limit),
    ExploredPlace::Gap(Gap::Bulk),
    ExploredPlace::Variance,
    ExploredPlace::Gap(Gap::Bulk),
];
/// Places that it takes in turn where failures are rare.
const RARE: [ExploredPlace; 3] =
    [ExploredPlace::Gap(Gap::Bulk), ExploredPlace::Rim, ExploredPlace::Gap(Gap::Bulk)];

impl Campaign {
    /// The exploring points with these numbers since a rule was met: of the population, where failures are rare of its bulk and rim.
    pub(super) fn explore(&mut self, numbers: Range<usize>) -> Vec<PendingSample> {
        if numbers.is_empty() {
            return vec![];
        }
        let round = u32::try_from(self.rounds.len()).unwrap_or(u32::MAX);
        let assessment = self.assessment.as_mut().expect("all outcomes have been assessed");
        let Self { classified, requests, data, problem, plan, .. } = self;
        let (inputs, failed) = (&problem.inputs, assessment.governing_failed());
        let barred = assessment.feasibility.barred_share(classified.unconditional());
        let is_rare = classified.is_rare(plan, failed, barred);
        let pf = classified.condition.probability * failed.max(1.0 / classified.population.len() as f64);
        let rim =
            is_rare.then(|| draw_rim(inputs, pf, &mut open_stream(plan.settings.seed, Stream::Rim(round))));
        let mut rng = open_stream(plan.settings.seed, Stream::Gaps(round));
        let at = |z: Vec<f64>| PendingSample { exploring: true, ..PendingSample::at(z, inputs) };
        let mut chosen: Vec<PendingSample> = Vec::new();
        for number in numbers {
            let own = chosen.iter().map(|pending| pending.z.as_slice());
            let pending: Vec<Vec<f64>> =
                requests.points_under_way().chain(own).map(<[f64]>::to_vec).collect();
            let known = data.explored_with_factors().into_iter();
            let known = known.chain(pending.iter().map(|z| (z.as_slice(), 1.0)));
            let place = if is_rare { RARE[number % RARE.len()] } else { TURNS[number % TURNS.len()] };
            let (population, requested) = (&classified.population, &requests.requested);
            let member = match place {
                ExploredPlace::Variance => {
                    let explored =
                        data.explored().into_iter().chain(pending.iter().cloned()).collect::<Vec<_>>();
                    assessment.explore(population, requested, &explored)
                }
                ExploredPlace::Gap(gap) if !classified.is_conditional() => {
                    assessment.fill_gap(population, Some(requested), known, gap, &mut rng)
                }
                ExploredPlace::Gap(gap) => {
                    // The bulk is that of all points, not of those near the limit.
                    let all = classified.unconditional();
                    let found = assessment.fill_gap(all, None, known, gap, &mut rng);
                    chosen.extend(found.map(|j| at(all.standardised(j).to_vec())));
                    continue;
                }
                ExploredPlace::Rim => {
                    let found = assessment.explore_rim(rim.as_deref().unwrap_or_default(), known);
                    chosen.extend(found.map(|z| PendingSample { beyond: true, ..at(z) }));
                    continue;
                }
            };
            let Some(j) = member else { continue };
            // A result near a limit may well lie on its other side, and is no test: it joins the surrogates.
            let exploring = place != ExploredPlace::Gap(Gap::Limit);
            chosen.push(PendingSample { exploring, ..requests.take(classified, j) });
        }
        chosen
    }
}
