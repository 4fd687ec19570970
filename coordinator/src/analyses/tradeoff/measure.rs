//! Evaluations of several settings at several points by any evaluator.

use crate::farm::evaluate::{EvaluateError, Evaluator, Finished, Request};
use common::accuracy::{AccuracyNameError, NamedAccuracy};

/// Settings and points to be measured.
#[derive(Debug, Clone, PartialEq)]
pub struct TradeoffPlan {
    /// The setting that all others are compared with, which is measured in addition.
    pub reference: NamedAccuracy,
    /// Settings to compare with it.
    pub settings: Vec<NamedAccuracy>,
    /// Values of the random variables `(points)(d,)` [SI]: first the nominal point, then random ones.
    pub points: Vec<Vec<f64>>,
}

/// Evaluations of the reference and of every setting.
#[derive(Debug, Clone, PartialEq)]
pub struct Measurement {
    /// Evaluations of the reference at the points with complete evaluations, the first ones of the plan `(points,)`.
    pub reference: Vec<Finished>,
    /// Evaluations of every setting of the plan at these points `(settings)(points,)`.
    pub settings: Vec<Vec<Finished>>,
}

impl TradeoffPlan {
    /// The requests of the plan, point by point, so that complete points can be compared after an interruption: number (1 + settings) point + k is the reference for k = 0, else setting k - 1.
    fn requests(&self) -> Vec<Request> {
        let accuracies = || [&self.reference].into_iter().chain(&self.settings).map(|named| named.accuracy);
        let jobs = self.points.iter().flat_map(|point| accuracies().map(move |a| (point, a)));
        (0..).zip(jobs).map(|(id, (point, accuracy))| Request::at(id, point.clone(), accuracy)).collect()
    }

    /// Evaluates all settings at all points. If the evaluator ends early, the complete points are returned with its error.
    pub fn measure(
        &self,
        evaluator: &mut dyn Evaluator,
        progress: &mut dyn FnMut(String),
    ) -> (Measurement, Result<(), EvaluateError>) {
        let requests = self.requests();
        let per_point = 1 + self.settings.len();
        let mut done = 0;
        let (finished, end) = evaluator.outcomes(&requests, &mut |finished| {
            let k = finished.id as usize;
            done += 1;
            let setting = (k % per_point).checked_sub(1).map_or(&self.reference, |s| &self.settings[s]);
            let (point, seconds) = (k / per_point, finished.wall);
            let all = requests.len();
            progress(format!("{done}/{all} evaluations: {} at point {point}, {seconds:.2} s", setting.name));
        });
        let points = finished.chunks(per_point).map_while(|point| point.iter().cloned().collect());
        let points: Vec<Vec<Finished>> = points.collect();
        let column = |k: usize| points.iter().map(|point| point[k].clone()).collect();
        let (reference, settings) = (column(0), (1..per_point).map(column).collect());
        (Measurement { reference, settings }, end)
    }
}

/// The presets and the combinations that have been on a Pareto front: enough to characterise a scene.
pub const QUICK: [&str; 10] = [
    "draft",
    "balanced",
    "draft+step-x1.41",
    "draft+step-x1.1",
    "draft+step-x0.71",
    "step-x1.41",
    "step-x0.71",
    "step-x0.71+jump-2000",
    "jump-8000",
    "jump-2000",
];

/// Single parameters, a row each, then combinations, in addition to [`QUICK`]; a new parameter needs a word in [`NamedAccuracy`] and a
/// row here.
const MORE: [&[&str]; 8] = [
    &["step-x2", "step-x0.5"],
    &["jump-100", "jump-250", "jump-500", "jump-1000"],
    &["wear-tolerance-5e-3", "wear-tolerance-1e-2", "wear-tolerance-5e-2"],
    &["samples-50", "samples-100", "samples-400", "samples-1000"],
    &["warm-up-0.02", "warm-up-0.2", "warm-up-1"],
    &["dynamic"],
    &["draft+step-x2", "draft+step-x0.84", "draft+samples-50", "draft+wear-tolerance-5e-2"],
    &["step-x0.84", "step-x0.71+jump-1000", "step-x0.5+jump-500+wear-tolerance-5e-3"],
];

/// The settings of these names.
///
/// # Errors
/// [`AccuracyNameError`] for a name without meaning.
pub fn settings<'n>(
    names: impl IntoIterator<Item = &'n str>,
) -> Result<Vec<NamedAccuracy>, AccuracyNameError> {
    names.into_iter().map(str::parse).collect()
}

/// Names of the whole grid.
pub fn full() -> impl Iterator<Item = &'static str> {
    QUICK.into_iter().chain(MORE.into_iter().flatten().copied())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::farm::evaluate::local::LocalEvaluator;
    use common::failure::SimulationFailure;
    use common::outputs::Evaluation;
    use std::sync::Arc;
    use std::sync::atomic::{AtomicBool, Ordering};

    fn plan() -> TradeoffPlan {
        let settings = super::super::settings(["draft", "jump-250"]).expect("names of settings");
        let reference = "reference".parse().expect("a preset");
        TradeoffPlan { reference, settings, points: vec![vec![1.0], vec![2.0], vec![3.0]] }
    }

    /// Repeats the request in the outcome.
    fn echo(request: &Request) -> Result<Evaluation, SimulationFailure> {
        let jump = request.accuracy.expect("every request has an accuracy").cycle_jump;
        Err(SimulationFailure::NotModelled { what: format!("{jump} at {}", request.sample[0]) })
    }

    fn said(measured: &[Finished]) -> Vec<String> {
        measured.iter().map(|m| m.outcome.as_ref().unwrap_err().to_string()).collect()
    }

    #[test]
    fn every_setting_meets_every_point() {
        let mut seen = Vec::new();
        let (found, end) = plan().measure(&mut LocalEvaluator::new(2, echo), &mut |text| {
            let (count, what) = text.split_once(" evaluations: ").expect("a count");
            seen.push(what.split(',').next().expect("setting and point").to_owned());
            assert_eq!(count, format!("{}/9", seen.len()));
        });
        assert!(end.is_ok());
        assert_eq!(found.reference.len(), 3);
        for (measured, jump) in [
            (&found.reference, common::accuracy::Accuracy::reference().cycle_jump),
            (&found.settings[0], common::accuracy::Accuracy::draft().cycle_jump),
            (&found.settings[1], 250),
        ] {
            for (point, said) in said(measured).iter().enumerate() {
                assert!(said.contains(&format!("{jump} at {}", point + 1)), "{said}");
            }
        }
        seen.sort();
        seen.dedup();
        assert_eq!(seen.len(), 9);
    }

    #[test]
    fn an_interruption_leaves_the_points_that_are_complete() {
        let interrupted = Arc::new(AtomicBool::new(false));
        let mut evaluator = LocalEvaluator::new(1, echo).interrupted_by(Arc::clone(&interrupted));
        // Five of nine evaluations: one point, and a part of the second.
        let (found, end) = plan().measure(&mut evaluator, &mut |text| {
            interrupted.store(text.starts_with("5/9 "), Ordering::Relaxed);
        });
        assert!(matches!(end, Err(EvaluateError::Interrupted)));
        assert_eq!((found.reference.len(), found.settings[1].len()), (1, 1));
    }

    #[test]
    fn every_setting_is_another_one_and_two_are_presets() {
        let all = settings(full()).expect("every name has a meaning");
        for (k, one) in all.iter().enumerate() {
            let twin = all[..k].iter().find(|other| other.accuracy == one.accuracy);
            assert!(twin.is_none(), "{} is {}", one.name, twin.map_or("", |t| &t.name));
        }
        assert_eq!(all.iter().filter(|s| s.is_preset()).count(), 2);
        assert!(settings(["draft", "drfat"]).is_err());
    }
}
