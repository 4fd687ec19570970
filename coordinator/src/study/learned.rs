//! What a campaign comes to.

use super::failures::Failed;
use super::observations::Observations;
use super::populations::LookedAt;
use super::round::Assessment;
use super::step::Stop;
use crate::results::summary::Round;

/// What a campaign learned.
#[derive(Debug)]
pub struct Learned {
    /// The population that was classified at the end, and what it is conditional on.
    pub looked_at: LookedAt,
    /// All results.
    pub observations: Observations,
    /// The last round's surrogates and classification.
    pub assessment: Assessment,
    /// All rounds.
    pub rounds: Vec<Round>,
    /// Evaluations, failed ones included.
    pub evaluations: usize,
    /// Simulations that failed for good.
    pub failed: Vec<Failed>,
    /// Why it ended.
    pub stop: Stop,
}
