//! Checks outcomes of evaluations before a study records or uses them.

use super::StudyError;
use crate::farm::evaluate::{EvaluateError, Finished, Request};
use crate::results::journal::Journal;
use common::evaluation_shape::EvaluationShape;

/// Checks that an outcome fits the scene.
///
/// # Errors
/// [`StudyError::Malformed`].
pub(super) fn check(outcome: &Finished, shape: &EvaluationShape) -> Result<(), StudyError> {
    let misfit = outcome.outcome.as_ref().ok().and_then(|evaluation| shape.misfit(evaluation));
    let malformed = |what| StudyError::Malformed { id: outcome.id, worker: outcome.worker.clone(), what };
    misfit.map_or(Ok(()), |what| Err(malformed(what)))
}

/// The outcome of a request in the journal. One that does not fit the scene, as earlier versions have recorded them, is set
/// aside, so that the request is evaluated again.
///
/// # Errors
/// Those of the journal.
pub(super) fn recalled(
    journal: &mut dyn Journal,
    request: &Request,
    shape: &EvaluationShape,
) -> Result<Option<Finished>, EvaluateError> {
    let Some(found) = journal.finished(request)? else { return Ok(None) };
    let Err(misfit) = check(&found, shape) else { return Ok(Some(found)) };
    tracing::warn!("{misfit}; it is set aside, and the sample is evaluated again");
    journal.set_aside(request.id, &misfit.to_string())?;
    Ok(None)
}
