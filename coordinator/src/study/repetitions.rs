//! The further evaluations of outliers within a campaign of learning.

use super::outliers::{ENOUGH, Outlier, agreed, decided};
use super::requests::PendingSample;
use super::surrogates::SurrogateState;
use super::{Assessment, Campaign, ObservedOutcome, Step};

impl Campaign {
    /// Notes the outliers of an assessment that have not been evaluated again, the farthest first, as far as the budget allows; true if there
    /// are any.
    pub(super) fn note_outliers(&mut self, assessment: &Assessment) -> bool {
        let exact = self.plan.is_exact;
        let confirmed =
            self.data.outliers.iter().filter(|known| agreed(&known.evaluations, exact) == Some(0));
        let room = ENOUGH.saturating_sub(confirmed.count()).min(self.budget_left());
        let mut found: Vec<Outlier> = Vec::new();
        for (mode, surrogate) in assessment.surrogates.iter().enumerate() {
            let observations = self.data.observations.design_of(mode);
            for (checkpoint, i, distance) in surrogate.outliers.iter().copied() {
                let Some((z, observed)) = observations.result(i) else { continue };
                match found.iter_mut().find(|known| known.z == z) {
                    Some(known) if known.distance < distance => {
                        (known.mode, known.checkpoint, known.distance) = (mode, checkpoint, distance);
                    }
                    Some(_) => {}
                    None if self.data.outliers.iter().any(|known| known.z == z) => {}
                    None => found.push(Outlier {
                        mode,
                        checkpoint,
                        distance,
                        z: z.to_vec(),
                        evaluations: vec![Ok(observed.clone())],
                    }),
                }
            }
        }
        found.sort_by(|a, b| b.distance.total_cmp(&a.distance));
        found.truncate(room);
        let any = !found.is_empty();
        self.data.outliers.extend(found);
        any
    }

    /// The step that evaluates open outliers again or waits for that; `None` without any, or if the budget is spent.
    pub(super) fn repeat_outliers(&mut self) -> Option<Step> {
        if self.requests.is_repeating() {
            return Some(Step::Wait);
        }
        let inputs = &self.problem.inputs;
        let open = self.data.outliers.iter().filter(|outlier| outlier.is_open(self.plan.is_exact));
        let again = open.map(|outlier| PendingSample {
            not_by: outlier.workers(),
            ..PendingSample::at(outlier.z.clone(), inputs)
        });
        let chunk: Vec<PendingSample> = again.take(self.budget_left()).collect();
        (!chunk.is_empty()).then(|| self.requests.begin(chunk))
    }

    /// Records a further evaluation of an outlier. If the outlier is not what two evaluations agree on, learning begins anew on the results
    /// without it.
    pub(super) fn record_repetition(&mut self, z: &[f64], outcome: ObservedOutcome) {
        let exact = self.plan.is_exact;
        let Some(outlier) = self.data.outliers.iter_mut().find(|outlier| outlier.z == z) else { return };
        outlier.evaluations.push(outcome);
        let worker = &outlier.workers()[0];
        if outlier.is_open(exact) || agreed(&outlier.evaluations, exact) == Some(0) {
            let same = if outlier.is_open(exact) { "differs from" } else { "confirms" };
            tracing::info!("a further evaluation {same} an outlier by worker {worker}");
            return;
        }
        let output = self.problem.modes[outlier.mode].output;
        let value = |one: &ObservedOutcome| {
            one.as_ref().map_or(f64::NAN, |one| one.running_maximum(output)[outlier.checkpoint])
        };
        let values: Vec<f64> = outlier.evaluations.iter().map(value).collect();
        tracing::warn!(
            "an outlier by worker {worker} is left out: {} further evaluations contradict it (values {values:?} in SI, the outlier first)",
            values.len() - 1
        );
        match decided(&outlier.evaluations, exact) {
            Ok(used) => self.data.observations.replace(z, Some(used)),
            Err(cause) => {
                self.data.observations.replace(z, None);
                self.data.add_failed(z.to_vec(), cause, false, false);
            }
        }
        self.surrogates = SurrogateState::new(self.problem.modes.len());
        self.stopping.reset(false);
        self.classified.require_another_draw();
    }
}

#[cfg(test)]
mod tests {
    use super::super::from_results_tests::{plan, problem};
    use super::*;
    use crate::study::{CampaignResult, Observed};
    use common::failure::SimulationFailure;
    use std::collections::HashMap;

    /// Learns a response whose evaluation `wrong` is off by the factors, one for each evaluation of that sample.
    fn learn(wrong: usize, factors: &[f64]) -> (CampaignResult, Vec<(Vec<f64>, ObservedOutcome)>) {
        let mut evaluated = Vec::new();
        let (mut counts, mut wrong_sample) = (HashMap::new(), vec![]);
        let simulate = |x: &[f64]| {
            if evaluated.len() == wrong {
                wrong_sample = x.to_vec();
            }
            let count: &mut usize =
                counts.entry(x.iter().map(|x| x.to_bits()).collect::<Vec<_>>()).or_default();
            let factor = if x == wrong_sample { factors.get(*count).copied().unwrap_or(1.0) } else { 1.0 };
            *count += 1;
            let outcome = if factor.is_nan() {
                Err(SimulationFailure::NotModelled { what: "this sample".into() })
            } else {
                let life = (1..=10).map(|n| factor * (x[0] + 0.2 * f64::from(n) * x[1]));
                Ok(Observed::exact(vec![life.collect()]))
            };
            evaluated.push((x.to_vec(), outcome.clone()));
            outcome
        };
        let learned = Campaign::new(problem(5.0, 0.5), plan(2_000, 36)).learn_from(simulate, |_| {}).unwrap();
        (learned, evaluated)
    }

    fn largest_difference(one: &CampaignResult, other: &CampaignResult) -> f64 {
        super::super::round::largest_change(&one.assessment.curves, &other.assessment.curves)
    }

    #[test]
    fn issue_an_outlier_is_evaluated_again_and_what_two_evaluations_agree_on_is_used() {
        let (right, _) = learn(usize::MAX, &[]);
        assert!(right.outliers.is_empty());
        // Wrong once; wrong at the second time only, of a value that is an outlier itself.
        let (once, evaluated) = learn(7, &[100.0]);
        assert_eq!(once.outliers.len(), 1);
        assert_eq!(once.outliers[0].evaluations.len(), 3);
        assert!(largest_difference(&once, &right) < 2e-3, "{}", largest_difference(&once, &right));
        // From its stored outcomes, and with the wrong value believed.
        let stored =
            Campaign::with_results(problem(5.0, 0.5), plan(2_000, evaluated.len()), evaluated.clone());
        let stored = stored.learn_from(|_| unreachable!("no budget"), |_| {}).unwrap();
        assert!(largest_difference(&stored, &right) < 2e-3);
        let mut samples: Vec<Vec<f64>> = Vec::new();
        let first = |(x, _): &(Vec<f64>, ObservedOutcome)| {
            let is_new = !samples.contains(x);
            samples.push(x.clone());
            is_new
        };
        let believed: Vec<_> = evaluated.into_iter().filter(first).collect();
        let believed = Campaign::with_results(problem(5.0, 0.5), plan(2_000, believed.len()), believed);
        let believed = believed.learn_from(|_| unreachable!("no budget"), |_| {}).unwrap();
        assert!(largest_difference(&believed, &right) > 2e-2, "{}", largest_difference(&believed, &right));
    }

    #[test]
    fn a_persistent_extreme_is_kept_and_a_sample_without_two_equal_results_fails() {
        let (kept, evaluated) = learn(7, &[100.0; 3]);
        assert_eq!((kept.outliers[0].evaluations.len(), kept.failed.len()), (2, 0));
        let extreme = evaluated[7].1.as_ref().unwrap();
        assert!((0..kept.observations.len()).any(|i| kept.observations.result(i).unwrap().1 == extreme));
        let (kept, _) = learn(7, &[100.0, 1.0, 100.0]);
        assert_eq!(agreed(&kept.outliers[0].evaluations, true), Some(0));
        for factors in [[100.0, 2.0, 3.0], [100.0, f64::NAN, f64::NAN]] {
            let (failed, _) = learn(7, &factors);
            assert_eq!((failed.outliers[0].evaluations.len(), failed.failed.len()), (3, 1), "{factors:?}");
        }
    }
}
