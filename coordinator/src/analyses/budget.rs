//! The cheapest accuracy that keeps the numerical errors of a scene within a budget, found by trying.
//!
//! A ladder of settings from cheap to dear is climbed, each tried at a few points; an evaluation states the errors of its own
//! values, and these are held against the budget. Rungs that cannot be enough are passed over: going from one
//! rung to another, the error falls at most by the order of the part that falls least.

use crate::farm::evaluate::{EvaluateError, Evaluator, Finished, Request};
use crate::presentation::report::format::short_percent;
use common::accuracy::{Accuracy, AccuracyNameError, NamedAccuracy};
use common::failure::SimulationFailure;
use common::outputs::Evaluation;
use common::scene::Scene;
use thiserror::Error;

/// The settings tried, from the cheapest: those that `coordinator tradeoff` finds on the front of time against error,
/// and beyond `balanced` finer ones in which every part of the error falls.
pub const LADDER: [&str; 9] = [
    "draft+step-x1.41",
    "draft",
    "draft+step-x0.71",
    "balanced",
    "jump-2000",
    "jump-1000+wear-tolerance-1e-2",
    "step-x0.71+jump-500+wear-tolerance-5e-3",
    "step-x0.5+jump-250+wear-tolerance-2e-3+samples-1200",
    "reference",
];

/// Random points at which a setting is tried for a study, beside the nominal one.
pub const RANDOM_POINTS: usize = 3;

/// Error of one output, relative to the threshold of its limit state.
#[derive(Debug, Clone, PartialEq)]
pub struct OutputShare {
    /// Name of the output.
    pub output: String,
    /// Largest stated error over all points and checkpoints that count, over the threshold [1].
    pub error: f64,
}

/// A setting that was tried.
#[derive(Debug, Clone, PartialEq)]
pub struct TriedSetting {
    /// The setting.
    pub setting: NamedAccuracy,
    /// The output with the largest error, or why a point has no result.
    pub worst: Result<OutputShare, SimulationFailure>,
    /// Longest time of an evaluation [s].
    pub seconds: f64,
}

/// The setting found, and what was tried on the way.
#[derive(Debug, Clone, PartialEq)]
pub struct ChosenSetting {
    /// Cheapest setting within the budget.
    pub setting: NamedAccuracy,
    /// All that was tried, from the cheapest; the last is the one chosen.
    pub attempts: Vec<TriedSetting>,
}

/// Why there is no setting within the budget.
#[derive(Debug, Error)]
pub enum BudgetError {
    /// None of the ladder keeps it.
    #[error(
        "no accuracy keeps the stated error below {budget}: at best {output} is known to {best} of its limit, with {setting}; \
         allow at least that"
    )]
    OutOfReach {
        /// Budget, in words.
        budget: String,
        /// Output that is over it with the best setting.
        output: String,
        /// Error reached, in words.
        best: String,
        /// With which setting.
        setting: String,
    },
    /// No setting gives a result.
    #[error("no accuracy gives a result at every point tried; with {setting}: {failure}")]
    Failed {
        /// The last that was tried.
        setting: String,
        /// What happened.
        failure: SimulationFailure,
    },
    /// The scene has no output that could be held to a budget.
    #[error("an error budget needs an output; this scene has none")]
    NothingToHold,
    /// A point got no outcome.
    #[error(transparent)]
    Evaluate(#[from] EvaluateError),
    /// A rung of the ladder is no setting.
    #[error(transparent)]
    Ladder(#[from] AccuracyNameError),
}

/// Finds the cheapest rung of `ladder` whose stated errors stay below `budget` at all `points` `(points)(d,)` [SI].
///
/// Held to the budget are the outputs of limit states, relative to their thresholds, up to the first checkpoint at which the
/// limit is passed by more than the stated error (what comes after decides no failure); in a scene without limit states,
/// every output relative to its largest value.
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
) -> Result<ChosenSetting, BudgetError> {
    if scene.outputs.is_empty() {
        return Err(BudgetError::NothingToHold);
    }
    let mut attempts: Vec<TriedSetting> = Vec::new();
    for name in ladder {
        let setting: NamedAccuracy = name.parse()?;
        if attempts.last().is_some_and(|last| cannot_be_enough(last, &setting.accuracy, budget)) {
            continue;
        }
        let attempt = attempt(scene, budget, setting, points, evaluator)?;
        tried(&attempt);
        let fits = attempt.worst.as_ref().is_ok_and(|worst| worst.error <= budget);
        attempts.push(attempt);
        if fits {
            let setting = attempts[attempts.len() - 1].setting.clone();
            return Ok(ChosenSetting { setting, attempts });
        }
    }
    Err(refusal(budget, attempts))
}

/// The share of an error that remains at least when `from` is refined to `to`: that of the part that falls most, by its
/// order. Time steps are of fourth order, wear steps of second, as their samples are; what else changes may take all.
fn least_remainder(from: &Accuracy, to: &Accuracy) -> f64 {
    if from.warm_up != to.warm_up || from.tier != to.tier {
        return 0.0;
    }
    let square = |a: f64, b: f64| (b / a) * (b / a);
    [
        to.step_tolerance / from.step_tolerance,
        square(f64::from(from.cycle_jump), f64::from(to.cycle_jump)),
        square(to.wear_samples as f64, from.wear_samples as f64),
        to.wear_tolerance / from.wear_tolerance,
    ]
    .into_iter()
    .fold(1.0, f64::min)
}

fn cannot_be_enough(last: &TriedSetting, next: &Accuracy, budget: f64) -> bool {
    let error = last.worst.as_ref().map_or(0.0, |worst| worst.error);
    error * least_remainder(&last.setting.accuracy, next) > budget
}

/// Tries a setting: at the nominal point first, and elsewhere only if it holds there.
fn attempt(
    scene: &Scene,
    budget: f64,
    setting: NamedAccuracy,
    points: &[Vec<f64>],
    evaluator: &mut dyn Evaluator,
) -> Result<TriedSetting, BudgetError> {
    let mut worst = OutputShare { output: scene.outputs[0].name.clone(), error: 0.0 };
    let mut longest = 0.0_f64;
    let (nominal, others) = points.split_at(points.len().min(1));
    for batch in [nominal, others] {
        let requests: Vec<Request> = (0..)
            .zip(batch)
            .map(|(id, sample)| Request {
                id,
                sample: sample.clone(),
                with_first_cycle: false,
                accuracy: Some(setting.accuracy),
            })
            .collect();
        let mut outcomes: Vec<Finished> = Vec::new();
        evaluator.evaluate(&requests, &mut |finished| {
            outcomes.push(finished);
            Ok(())
        })?;
        // Whichever came first, the same failure is reported.
        outcomes.sort_by_key(|finished| finished.id);
        for finished in outcomes {
            longest = longest.max(finished.wall);
            match finished.outcome {
                Ok(evaluation) => {
                    for found in shares(scene, &evaluation) {
                        worst = if found.error > worst.error { found } else { worst };
                    }
                }
                Err(failure) => return Ok(TriedSetting { setting, worst: Err(failure), seconds: longest }),
            }
        }
        if worst.error > budget {
            break;
        }
    }
    Ok(TriedSetting { setting, worst: Ok(worst), seconds: longest })
}

/// Stated error of every output that is held to a budget; see [`choose_setting`].
pub fn shares(scene: &Scene, evaluation: &Evaluation) -> Vec<OutputShare> {
    let of = |k: usize, scale: f64, counted: usize| OutputShare {
        output: scene.outputs[k].name.clone(),
        error: evaluation.errors[k].iter().take(counted).fold(0.0, |a: f64, e| a.max(e / scale)),
    };
    if scene.limit_states.is_empty() {
        let largest =
            |k: usize| evaluation.histories[k].iter().fold(f64::MIN_POSITIVE, |a, x| a.max(x.abs()));
        return (0..scene.outputs.len()).map(|k| of(k, largest(k), usize::MAX)).collect();
    }
    let passed = |k: usize, threshold: f64| {
        let mut values = evaluation.histories[k].iter().zip(&evaluation.errors[k]);
        values.position(|(value, error)| value - error >= threshold).map_or(usize::MAX, |n| n + 1)
    };
    let limits = scene.limit_states.iter();
    limits.map(|limit| of(limit.output, limit.threshold, passed(limit.output, limit.threshold))).collect()
}

fn refusal(budget: f64, attempts: Vec<TriedSetting>) -> BudgetError {
    let results = attempts.iter().filter_map(|a| Some((a.worst.as_ref().ok()?, &a.setting.name)));
    let best = results.min_by(|a, b| a.0.error.total_cmp(&b.0.error));
    if let Some((worst, setting)) = best {
        return BudgetError::OutOfReach {
            budget: short_percent(budget),
            output: worst.output.clone(),
            best: short_percent(worst.error),
            setting: setting.clone(),
        };
    }
    match attempts.into_iter().next_back() {
        Some(TriedSetting { setting, worst: Err(failure), .. }) => {
            BudgetError::Failed { setting: setting.name, failure }
        }
        _ => BudgetError::NothingToHold,
    }
}

#[cfg(test)]
mod tests;
