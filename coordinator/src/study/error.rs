//! Reasons why a study has no result.
//!
//! Checks outcomes of evaluations before a study records or uses them.

use super::{CampaignError, SettingError};
use crate::farm::evaluate::{EvaluateError, Finished, Request};
use crate::results::journal::Journal;
use crate::statistics::surrogate::SurrogateError;
use common::evaluation_shape::EvaluationShape;
use common::scene::Scene;
use thiserror::Error;

/// Reason why a study has no result.
#[derive(Debug, Error)]
pub enum StudyError {
    /// The settings do not make a study.
    #[error(transparent)]
    Setting(#[from] SettingError),
    /// An evaluation was not possible or could not be recorded.
    #[error(transparent)]
    Evaluate(#[from] EvaluateError),
    /// Learning cannot continue.
    #[error(transparent)]
    Campaign(CampaignError),
    /// A surrogate could not be fitted.
    #[error("surrogate of limit state {limit_state}: {source}")]
    Surrogate {
        /// Name of the limit state.
        limit_state: String,
        /// Error of the fit.
        source: SurrogateError,
    },
    /// An outcome does not have the shape of the scene, or contains a value that is not finite.
    #[error("evaluation {id} by {worker} does not fit the scene: {what}")]
    Malformed {
        /// Number of the request.
        id: u64,
        /// Name of the worker that sent the outcome.
        worker: String,
        /// Description of the misfit.
        what: String,
    },
}

impl StudyError {
    /// The error of a campaign of `scene`, with the name of the limit state that it concerns.
    pub fn from_campaign(error: CampaignError, scene: &Scene) -> Self {
        match error {
            CampaignError::Surrogate { mode, source } => {
                Self::Surrogate { limit_state: scene.limit_states[mode].name.clone(), source }
            }
            error => Self::Campaign(error),
        }
    }
}

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
