//! Errors of the analyses.

use crate::farm::evaluate::EvaluateError;
use crate::statistics::surrogate::SurrogateError;
use crate::study::{CampaignError, StudyError};
use common::random::LawError;
use common::scene::Faults;
use thiserror::Error;

/// Reasons why an analysis that simulates, or that assesses simulations of a study, has no result.
#[derive(Debug, Error)]
pub enum AnalysisError {
    /// A scene, or a file that goes with it, is not valid.
    #[error(transparent)]
    Scene(#[from] Faults),
    /// The evaluator failed or was interrupted.
    #[error(transparent)]
    Evaluate(#[from] EvaluateError),
    /// Learning cannot continue.
    #[error(transparent)]
    Campaign(#[from] CampaignError),
    /// The results of the study cannot be assessed.
    #[error(transparent)]
    Study(#[from] StudyError),
    /// A design has a distribution that does not exist.
    #[error("the distribution of a variable does not exist at a design: {0}")]
    Law(#[from] LawError),
    /// Too few simulations succeeded for a fit.
    #[error("{0}")]
    TooFew(String),
    /// A surrogate could not be fitted.
    #[error(transparent)]
    Surrogate(#[from] SurrogateError),
}

/// A question that has no answer: the option that asks it, with its value, and what is allowed or missing.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
#[error("{option}: {fault}")]
pub struct RefusedQuestion {
    /// The option, `--NAME VALUE`, or the subject.
    pub option: String,
    /// What is wrong with it, in words.
    pub fault: String,
}

impl RefusedQuestion {
    /// A question that is refused for this fault.
    pub fn new(option: impl Into<String>, fault: impl Into<String>) -> Self {
        Self { option: option.into(), fault: fault.into() }
    }
}
