//! Checks the outcome of an evaluation before a study uses it.

use super::observations::ObservedOutcome;
use super::{Observed, StudyError};
use crate::farm::evaluate::Finished;
use common::scene::Scene;

/// Checks that the histories and their stated errors have the shape of the scene, are finite, and that no
/// error is negative. An evaluation that states no errors counts as exact.
pub(super) fn checked(
    outcome: Finished,
    scene: &Scene,
    checkpoints: &[u32],
) -> Result<ObservedOutcome, StudyError> {
    let outputs = scene.outputs.len();
    let output = |o: usize| format!("output \"{}\"", scene.outputs[o].name);
    let Finished { id, worker, outcome, .. } = outcome;
    let evaluation = match outcome {
        Ok(evaluation) => evaluation,
        Err(failure) => return Ok(Err(failure)),
    };
    let malformed = |what: String| Err(StudyError::Malformed { id, worker, what });
    if evaluation.cycles != checkpoints {
        return malformed(format!("{} checkpoints, not {}", evaluation.cycles.len(), checkpoints.len()));
    }
    if evaluation.histories.len() != outputs {
        return malformed(format!("{} outputs, not {outputs}", evaluation.histories.len()));
    }
    for (o, history) in evaluation.histories.iter().enumerate() {
        if history.len() != checkpoints.len() {
            return malformed(format!("{} has {} values", output(o), history.len()));
        }
        if let Some(n) = history.iter().position(|value| !value.is_finite()) {
            return malformed(format!("{} is {} at {} cycles", output(o), history[n], checkpoints[n]));
        }
    }
    if !evaluation.errors.is_empty() && evaluation.errors.len() != outputs {
        return malformed(format!("errors of {} outputs, not {outputs}", evaluation.errors.len()));
    }
    for (o, errors) in evaluation.errors.iter().enumerate() {
        if errors.len() != checkpoints.len() {
            return malformed(format!("{} has {} stated errors", output(o), errors.len()));
        }
        if let Some(n) = errors.iter().position(|error| !(error.is_finite() && *error >= 0.0)) {
            return malformed(format!(
                "the stated error of {} is {} at {} cycles",
                output(o),
                errors[n],
                checkpoints[n]
            ));
        }
    }
    Ok(Ok(Observed::from_evaluation(evaluation)))
}
