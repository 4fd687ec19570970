//! Outliers among the results, and their further evaluations: a value that no other result makes probable may be the error of a machine or
//! of a simulator, or an extreme of the response.
//!
//! A value y of the running maximum at a checkpoint is an outlier where |y - median| > [`OUTLIER`] (y_75 - y_25) over the results of the initial design: those
//! of learning gather at the limit. Its sample
//! is evaluated a second time, by another worker where one is connected. If the two agree, it stays; otherwise a third evaluation decides,
//! and what two of the three agree on is used. Where no two agree the sample counts as failed. After [`ENOUGH`] confirmed outliers extreme
//! values count as a property of the response.

use super::observations::ObservedOutcome;
use crate::farm::evaluate::agree;
use crate::results::summary_rows::{OutlierEvaluation, OutlierRow};
use common::failure::SimulationFailure;
use common::scene::Scene;

/// Interquartile ranges from the median beyond which a value is an outlier [1]: 40 standard deviations of normal values.
const OUTLIER: f64 = 30.0;
/// Confirmed outliers after which no more are evaluated again.
pub(super) const ENOUGH: usize = 5;
/// Most evaluations of one sample.
const MOST: usize = 3;

/// An outlier and the evaluations of its sample.
#[derive(Debug, Clone)]
pub struct Outlier {
    /// Index of the limit state.
    pub(super) mode: usize,
    /// Index of the checkpoint with the largest distance.
    pub(super) checkpoint: usize,
    /// Distance from the median over the interquartile range [1].
    pub(super) distance: f64,
    /// Standardised point `(d,)` [1].
    pub(super) z: Vec<f64>,
    /// Its evaluations, that of the outlier first.
    pub(super) evaluations: Vec<ObservedOutcome>,
}

impl Outlier {
    /// True if no two evaluations agree and there may be another one.
    pub(super) fn is_open(&self, exact: bool) -> bool {
        agreed(&self.evaluations, exact).is_none() && self.evaluations.len() < MOST
    }

    /// Workers of its evaluations; empty names where they are not known.
    pub(super) fn workers(&self) -> Vec<String> {
        let worker = |outcome: &ObservedOutcome| {
            let source = outcome.as_ref().ok().and_then(|observed| observed.source.as_ref());
            source.map(|source| source.worker.clone()).unwrap_or_default()
        };
        self.evaluations.iter().map(worker).collect()
    }

    /// The outlier in the names of the scene; results agree if they are `exact` or within their errors.
    pub(super) fn row(&self, scene: &Scene, exact: bool) -> OutlierRow {
        let limit = &scene.limit_states[self.mode];
        let used = agreed(&self.evaluations, exact).map(|k| &self.evaluations[k]);
        let evaluation = |(outcome, worker): (&ObservedOutcome, String)| {
            let observed = outcome.as_ref().ok();
            let source = observed.and_then(|observed| observed.source.as_ref());
            OutlierEvaluation {
                number: source.map(|source| source.evaluation),
                worker,
                value: observed.map(|observed| {
                    let value = observed.histories[limit.output][self.checkpoint];
                    scene.outputs[limit.output].kind.unit().to_file(value)
                }),
                used: used.is_some_and(|used| outcomes_agree(used, outcome, exact)),
            }
        };
        OutlierRow {
            limit_state: limit.name.clone(),
            cycles: scene.life.checkpoints()[self.checkpoint],
            distance: self.distance,
            evaluations: self.evaluations.iter().zip(self.workers()).map(evaluation).collect(),
        }
    }
}

/// Whether two evaluations of one sample have the same outcome.
fn outcomes_agree(one: &ObservedOutcome, other: &ObservedOutcome, exact: bool) -> bool {
    match (one, other) {
        (Ok(one), Ok(other)) => {
            agree((&one.histories, &one.errors), (&other.histories, &other.errors), exact)
        }
        (one, other) => one.is_err() && other.is_err(),
    }
}

/// The first of the evaluations of one sample that another one agrees with, as an index.
pub(super) fn agreed(evaluations: &[ObservedOutcome], exact: bool) -> Option<usize> {
    let repeated = |k: &usize| {
        let later = &evaluations[k + 1..];
        later.iter().any(|other| outcomes_agree(&evaluations[*k], other, exact))
    };
    (0..evaluations.len()).find(repeated)
}

/// The outcome of a sample by all its evaluations: what two agree on, the first one while there are fewer than three, otherwise a failure.
pub(super) fn decided(evaluations: &[ObservedOutcome], exact: bool) -> ObservedOutcome {
    match agreed(evaluations, exact) {
        None if evaluations.len() >= MOST => Err(SimulationFailure::Reported {
            message: format!("{MOST} evaluations of this sample have different results"),
        }),
        k => evaluations[k.unwrap_or(0)].clone(),
    }
}

/// The values beyond [`OUTLIER`] as `(index, distance from the median over the interquartile range [1])`; none where most are equal. The first
/// `initial` values are those of the initial design.
pub(super) fn outliers(values: &[f64], initial: usize) -> Vec<(usize, f64)> {
    let mut sorted = values[..initial.clamp(1, values.len())].to_vec();
    sorted.sort_unstable_by(f64::total_cmp);
    let quantile = |share: f64| sorted[(share * (sorted.len() - 1) as f64).round() as usize];
    let (median, range) = (quantile(0.5), quantile(0.75) - quantile(0.25));
    let distances = values.iter().map(|y| (y - median).abs() / range).enumerate();
    distances.filter(|(_, distance)| range > 0.0 && *distance > OUTLIER).collect()
}

#[cfg(test)]
mod tests {
    use super::outliers;

    #[test]
    fn issue_one_value_of_sixty_a_hundred_times_too_large_was_believed() {
        let mut values: Vec<f64> = (0..60).map(|k| 1.0 + 0.01 * f64::from(k)).collect();
        assert_eq!(outliers(&values, 60), []);
        values[7] *= 100.0;
        assert!(matches!(outliers(&values, 60)[..], [(7, distance)] if distance > 300.0));
        assert_eq!(outliers(&[0.0, 0.0, 0.0, 0.0, 1.0], 5), [], "flags");
    }

    #[test]
    fn issue_results_gathered_at_the_limit_made_outliers_of_the_others() {
        let spread = (0..20).map(|k| 0.1 * f64::from(k));
        let values: Vec<f64> = spread.chain((0..60).map(|k| 1.0 + 1e-4 * f64::from(k))).collect();
        assert_eq!(outliers(&values, 20), []);
        assert!(!outliers(&values, 80).is_empty());
    }
}
