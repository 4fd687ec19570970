//! Checks the outcome of an evaluation before a study uses it.

use super::observations::ObservedOutcome;
use super::{Observed, StudyError};
use crate::farm::evaluate::Finished;
use common::scene::Scene;

/// Largest size of a value [unit of the output]: beyond about 1e154 the square of a double is infinite, and with it variances and
/// surrogates.
const LARGEST: f64 = 1e150;

/// Checks that the histories and their stated errors have the shape of the scene, are finite, as the values in the first
/// cycle, that none is beyond [`LARGEST`], and that no error is negative. An evaluation that states no errors counts as exact.
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
        if let Some(n) = history.iter().position(|value| value.abs() > LARGEST) {
            return malformed(format!(
                "{} is {:e} at {} cycles, allowed: up to {LARGEST:e}, whose square is still a number",
                output(o),
                history[n],
                checkpoints[n]
            ));
        }
    }
    let in_first_cycle = evaluation.start.iter().take(outputs).enumerate();
    for (o, start) in in_first_cycle.filter_map(|(o, start)| Some((o, (*start)?))) {
        if start.is_nan() || start.abs() > LARGEST {
            return malformed(format!("{} is {start} in the first cycle", output(o)));
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_study;
    use common::outputs::Evaluation;

    #[test]
    fn issue_values_without_a_square_made_a_study_unreadable() {
        let scene = test_study::scene();
        let checkpoints = scene.life.checkpoints();
        let said = |value: f64| {
            let histories = vec![vec![value; checkpoints.len()]; scene.outputs.len()];
            let evaluation = Evaluation::from_histories(checkpoints.clone(), histories);
            let finished = Finished { id: 7, outcome: Ok(evaluation), worker: "a/0".into(), wall: 1.0 };
            checked(finished, &scene, &checkpoints).map_err(|error| error.to_string())
        };
        assert!(said(-1e149).is_ok());
        let error = said(-1e300).unwrap_err();
        assert!(error.contains("is -1e300 at") && error.contains("allowed: up to 1e150"), "{error}");
    }

    #[test]
    fn issue_a_first_cycle_without_a_finite_value_counted_for_the_reliability() {
        let scene = test_study::scene();
        let checkpoints = scene.life.checkpoints();
        let said = |start: f64| {
            let histories = vec![vec![1.0; checkpoints.len()]; scene.outputs.len()];
            let mut evaluation = Evaluation::from_histories(checkpoints.clone(), histories);
            evaluation.start = vec![None, Some(start)];
            let finished = Finished { id: 7, outcome: Ok(evaluation), worker: "a/0".into(), wall: 1.0 };
            checked(finished, &scene, &checkpoints).map_err(|error| error.to_string())
        };
        assert!(said(2.0).is_ok());
        for start in [f64::NAN, f64::INFINITY] {
            let error = said(start).unwrap_err();
            assert!(error.contains("in the first cycle"), "{error}");
        }
    }
}
