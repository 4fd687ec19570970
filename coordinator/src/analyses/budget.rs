//! The cheapest accuracy that keeps the numerical errors of a scene within a budget.
//!
//! Tries settings from the cheapest to the most expensive at a few sample points and compares the errors that the
//! evaluations state with the budget. A setting that cannot be sufficient is skipped: with e the stated error of the last
//! setting of the same warm-up and p_i the order of the error part i [1], a step from h_i to h_i' leaves at least
//!
//!   e min_i (h_i' / h_i)^p_i
//!
//! where h_i are the time step (p = 4, as `step_tolerance`), the wear step and the sample distance (p = 2) and the wear
//! tolerance (p = 1). Valid while every part is in its asymptotic range.
//!
//! # Source
//! Orders of the error parts: measured by `coordinator tradeoff`; asymptotic expansion of the global error, Hairer,
//! Norsett, Wanner (1993), Solving Ordinary Differential Equations I, section II.8.

use crate::farm::evaluate::{EvaluateError, Evaluator, Request};
use crate::presentation::report::format::short_percent;
use common::accuracy::{Accuracy, AccuracyNameError, NamedAccuracy};
use common::failure::SimulationFailure;
use common::outputs::Evaluation;
use common::scene::{LimitState, Scene};
use thiserror::Error;

/// The settings from the cheapest on: the best that `coordinator tradeoff` finds for their time and, beyond `balanced`, one with a whole
/// cycle of warm-up, for motions that settle slowly on new bores, and finer ones in which every part of the error decreases.
pub const LADDER: [&str; 10] = [
    "draft+step-x1.41",
    "draft",
    "draft+step-x0.71",
    "balanced",
    "balanced+warm-up-1",
    "jump-2000",
    "jump-1000+wear-tolerance-1e-2",
    "step-x0.71+jump-500+wear-tolerance-5e-3",
    "step-x0.5+jump-250+wear-tolerance-2e-3+samples-1000",
    "reference",
];

/// Number of random points at which a setting is tried for a study, in addition to the nominal point.
pub const RANDOM_POINTS: usize = 3;

/// Error of one output, relative to the threshold of its limit state.
#[derive(Debug, Clone, PartialEq)]
pub struct OutputShare {
    /// Name of the output.
    pub output: String,
    /// Largest stated error over all points and counted checkpoints, over the threshold [1].
    pub error: f64,
}

/// Result of one setting.
#[derive(Debug, Clone, PartialEq)]
pub struct TriedSetting {
    /// The setting that was tried.
    pub setting: NamedAccuracy,
    /// The output with the largest error, or the failure of a simulation.
    pub worst: Result<OutputShare, SimulationFailure>,
}

/// An error of [`choose_setting`].
#[derive(Debug, Error)]
pub enum BudgetError {
    /// No setting keeps the budget.
    #[error("no accuracy keeps the stated error below {0}")]
    OutOfReach(String),
    /// No setting gives a result.
    #[error("no accuracy gives a result at every point; with {0}: {1}")]
    Failed(String, SimulationFailure),
    /// The scene has no output.
    #[error("an error budget needs an output; this scene has none")]
    NothingToHold,
    /// The evaluations were interrupted or cannot be distributed.
    #[error(transparent)]
    Evaluate(#[from] EvaluateError),
    /// A name of the ladder is not a setting.
    #[error(transparent)]
    Ladder(#[from] AccuracyNameError),
}

/// Finds the cheapest setting of `ladder` whose stated errors stay below `budget` at all `points` `(points)(d,)` [SI].
///
/// The budget applies to the outputs of limit states, relative to their thresholds, up to the first checkpoint at which the
/// limit is exceeded by more than the stated error (later values decide no failure); in a scene without limit states, to
/// every output relative to its largest value. `tried` receives each result.
///
/// # Errors
/// [`BudgetError`].
pub fn choose_setting(
    scene: &Scene,
    budget: f64,
    ladder: &[&str],
    points: &[Vec<f64>],
    evaluator: &mut dyn Evaluator,
    tried: &mut dyn FnMut(&TriedSetting),
) -> Result<NamedAccuracy, BudgetError> {
    if scene.outputs.is_empty() {
        return Err(BudgetError::NothingToHold);
    }
    let mut attempts: Vec<TriedSetting> = Vec::new();
    for name in ladder {
        let setting: NamedAccuracy = name.parse()?;
        let warm_up = setting.accuracy.warm_up;
        let comparable = attempts.iter().rfind(|attempt| attempt.setting.accuracy.warm_up == warm_up);
        let left = |TriedSetting { setting: last, worst }: &TriedSetting| {
            Some(worst.as_ref().ok()?.error * least_remainder(&last.accuracy, &setting.accuracy))
        };
        if comparable.and_then(left).is_some_and(|error| error > budget) {
            continue;
        }
        let attempt = attempt(scene, budget, setting.clone(), points, evaluator)?;
        tried(&attempt);
        let fits = attempt.worst.as_ref().is_ok_and(|worst| worst.error <= budget);
        attempts.push(attempt);
        if fits {
            return Ok(setting);
        }
    }
    Err(refusal(budget, attempts))
}

/// Smallest share of an error that can remain when `from` is refined to `to` [1]; zero if the tier or the warm-up
/// changes, which have no order.
fn least_remainder(from: &Accuracy, to: &Accuracy) -> f64 {
    if from.warm_up != to.warm_up || from.tier != to.tier {
        return 0.0;
    }
    let square = |a: f64, b: f64| (b / a) * (b / a);
    let steps = to.step_tolerance / from.step_tolerance;
    let jumps = square(f64::from(from.cycle_jump), f64::from(to.cycle_jump));
    let samples = square(to.wear_samples as f64, from.wear_samples as f64);
    let wear = to.wear_tolerance / from.wear_tolerance;
    [steps, jumps, samples, wear].into_iter().fold(1.0, f64::min)
}

/// Tries a setting at the nominal point and, if it keeps the budget there, at the other points.
fn attempt(
    scene: &Scene,
    budget: f64,
    setting: NamedAccuracy,
    points: &[Vec<f64>],
    evaluator: &mut dyn Evaluator,
) -> Result<TriedSetting, BudgetError> {
    let mut worst = OutputShare { output: scene.outputs[0].name.clone(), error: 0.0 };
    let (nominal, others) = points.split_at(points.len().min(1));
    for batch in [nominal, others] {
        let request = |(id, sample): (u64, &Vec<f64>)| Request::at(id, sample.clone(), setting.accuracy);
        let requests: Vec<Request> = (0..).zip(batch).map(request).collect();
        // The reported failure does not depend on the order of arrival.
        let (outcomes, end) = evaluator.outcomes(&requests, &mut |_| ());
        end?;
        for finished in outcomes.into_iter().flatten() {
            let found = match finished.outcome {
                Ok(evaluation) => shares(scene, &evaluation),
                Err(failure) => return Ok(TriedSetting { setting, worst: Err(failure) }),
            };
            worst = found
                .into_iter()
                .fold(worst, |worst, next| if next.error > worst.error { next } else { worst });
        }
        if worst.error > budget {
            break;
        }
    }
    Ok(TriedSetting { setting, worst: Ok(worst) })
}

/// Stated error of every output to which the budget applies; see [`choose_setting`].
pub fn shares(scene: &Scene, evaluation: &Evaluation) -> Vec<OutputShare> {
    let share = |k: usize, scale: f64, counted: usize| OutputShare {
        output: scene.outputs[k].name.clone(),
        error: evaluation.errors[k].iter().take(counted).fold(0.0, |a: f64, e| a.max(e / scale)),
    };
    if scene.limit_states.is_empty() {
        let largest =
            |k: usize| evaluation.histories[k].iter().fold(f64::MIN_POSITIVE, |a, x| a.max(x.abs()));
        return (0..scene.outputs.len()).map(|k| share(k, largest(k), usize::MAX)).collect();
    }
    let passed = |limit: &LimitState| {
        let mut values = evaluation.histories[limit.output].iter().zip(&evaluation.errors[limit.output]);
        let threshold = limit.response_threshold();
        let first = values.position(|(value, error)| limit.response(*value) - error >= threshold);
        first.map_or(usize::MAX, |n| n + 1)
    };
    let limits = scene.limit_states.iter();
    limits.map(|limit| share(limit.output, limit.scale(), passed(limit))).collect()
}

/// What may help where finer settings do not.
const NOT_FINER: &str = "; finer settings hardly lessen this error: if it is of the wear, raise `control_points`, which no \
                         accuracy changes; if it is of the motion, see whether `coordinator simulate` finds that it has not settled";
/// Share of the error of the coarsest setting above which the finer ones count as of little use [1].
const LITTLE: f64 = 0.5;

fn refusal(budget: f64, attempts: Vec<TriedSetting>) -> BudgetError {
    let results: Vec<_> =
        attempts.iter().filter_map(|a| Some((a.worst.as_ref().ok()?, &a.setting.name))).collect();
    let best = results.iter().min_by(|a, b| a.0.error.total_cmp(&b.0.error));
    if let Some((worst, setting)) = best {
        let coarsest = results.iter().filter(|(of, _)| of.output == worst.output).map(|(of, _)| of.error);
        let is_flat = worst.error > LITTLE * coarsest.fold(0.0, f64::max);
        let (budget, best) = (short_percent(budget), short_percent(worst.error));
        return BudgetError::OutOfReach(format!(
            "{budget}: the best setting, {setting}, gives {} to {best} of its limit; allow at least {best}{}",
            worst.output,
            if is_flat { NOT_FINER } else { "" }
        ));
    }
    match attempts.into_iter().next_back() {
        Some(TriedSetting { setting, worst: Err(failure) }) => BudgetError::Failed(setting.name, failure),
        _ => BudgetError::NothingToHold,
    }
}

#[cfg(test)]
mod tests;
