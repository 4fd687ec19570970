//! Reasons why a study has no result.

use super::settings::SettingError;
use super::step::CampaignError;
use crate::farm::evaluate::EvaluateError;
use crate::statistics::surrogate::SurrogateError;
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
