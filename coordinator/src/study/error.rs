//! Reasons why a study has no result.

use super::settings::SettingError;
use super::step::CampaignError;
use crate::farm::evaluate::EvaluateError;
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
    Campaign(#[from] CampaignError),
    /// The evaluator ended without the outcome of a request.
    #[error("evaluation {id} has no outcome")]
    Unanswered {
        /// Number of the request.
        id: u64,
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
