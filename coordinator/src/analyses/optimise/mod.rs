//! Optimisation: the cheapest design whose reliability reaches its targets.
//!
//! ```text
//! problem -> surrogates of the study -> cheapest design on them -> simulations there -> better surrogates
//!                    ^------------------------ until optimum and reliability agree ----------'
//! ```
//!
//! The surrogates of a study describe its responses, whatever the distribution of the variables, so that the reliability of
//! any design near the simulated region follows without a simulation ([`reliability`](self)); the optimum found on them is
//! then confirmed by a campaign at that design, whose simulations improve the surrogates just there.
//!
//! Quantities of a design are means, standard deviations and tolerances of random variables, and the design variables of the
//! study.

mod campaign;
mod context;
mod design_variables;
mod finding;
mod optimum;
mod problem;
mod problem_costs;
mod problem_file;
mod reliability;
mod report;
mod result;
mod settings;
mod solve;
#[cfg(test)]
mod tests;
mod trust;

pub use campaign::StudyBasis;
pub use optimum::{OptimisationProgress, optimise};
pub use problem::{DesignProblem, DesignQuantity, Grade, QuantityKind, ReliabilityTarget, StudiedDesigns};
pub use problem_file::read as read_problem;
pub use report::answer;
pub use result::{
    Advice, Bound, FrontPoint, Grades, OptimisationResult, OptimisedQuantity, OptimisedTarget, Simulations,
    TargetState,
};
pub use settings::design_settings;

use crate::farm::evaluate::EvaluateError;
use crate::study::{CampaignError, ObservedOutcome, SampleRequest, StudyError};
use common::random::LawError;
use thiserror::Error;

/// Simulates samples: outcomes in the order of the requests, complete in the sense of
/// [`complete_outcomes`](crate::study::complete_outcomes).
pub type Simulate<'a> = dyn FnMut(&[SampleRequest]) -> Result<Vec<ObservedOutcome>, OptimiseError> + 'a;

/// Reasons why an optimisation fails.
#[derive(Debug, Error)]
pub enum OptimiseError {
    /// A design has a distribution that does not exist.
    #[error("the distribution of a variable does not exist at a design: {0}")]
    Law(#[from] LawError),
    /// A campaign at a design cannot continue.
    #[error(transparent)]
    Campaign(#[from] CampaignError),
    /// The evaluator failed or was interrupted.
    #[error(transparent)]
    Evaluate(#[from] EvaluateError),
    /// An outcome does not fit the scene, or is missing.
    #[error(transparent)]
    Study(StudyError),
}

impl From<StudyError> for OptimiseError {
    fn from(error: StudyError) -> Self {
        match error {
            StudyError::Evaluate(error) => Self::Evaluate(error),
            StudyError::Campaign(error) => Self::Campaign(error),
            error => Self::Study(error),
        }
    }
}
