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
mod optimum;
mod problem;
mod problem_costs;
mod problem_file;
mod reliability;
mod report;
mod result;
mod solve;
#[cfg(test)]
mod tests;
mod trust;

pub use campaign::StudyBasis;
pub use optimum::optimise;
pub use problem::{DesignProblem, DesignQuantity, QuantityKind, ReliabilityTarget};
pub use problem_file::read as read_problem;
pub use report::answer;
pub use result::OptimisationResult;

use super::error::AnalysisError;
use crate::study::{ObservedOutcome, SampleRequest};

/// Simulates samples: outcomes in the order of the requests, complete in the sense of
/// [`complete_outcomes`](crate::study::complete_outcomes).
pub type Simulate<'a> = dyn FnMut(&[SampleRequest]) -> Result<Vec<ObservedOutcome>, AnalysisError> + 'a;
