//! The part of a study that decides what is simulated.

use super::campaign::Campaign;
use super::interim::InterimResult;
use super::observations::ObservedOutcome;
use super::step::{CampaignError, Step};
use crate::results::summary::Round;

/// Decides what is simulated: an ask-and-tell interface over chunks of samples, in order.
pub(super) trait Learner: Send {
    /// Returns the next step, see [`Step`].
    fn next_step(&mut self) -> Result<Step, CampaignError>;
    /// Records the outcomes of the oldest chunk.
    fn record(&mut self, outcomes: Vec<ObservedOutcome>) -> Result<(), CampaignError>;
    /// The rounds so far.
    fn rounds(&self) -> &[Round];
    /// The purpose of the next chunk in words, for progress messages.
    fn purpose(&self) -> String;
    /// The reliability after the last round, for progress messages; called when a round has ended.
    fn interim(&self) -> Option<InterimResult>;
    /// Indices of the limit states whose outputs were the same in every simulation so far.
    fn constant_limit_states(&self) -> Vec<usize> {
        vec![]
    }
}

impl Learner for Campaign {
    fn next_step(&mut self) -> Result<Step, CampaignError> {
        Campaign::next_step(self)
    }

    fn record(&mut self, outcomes: Vec<ObservedOutcome>) -> Result<(), CampaignError> {
        Campaign::record(self, outcomes)
    }

    fn rounds(&self) -> &[Round] {
        Campaign::rounds(self)
    }

    fn purpose(&self) -> String {
        match self.rounds().len() {
            0 if self.evaluations() == 0 => "nominal point".to_owned(),
            0 => "initial design".to_owned(),
            round => format!("round {round}"),
        }
    }

    fn interim(&self) -> Option<InterimResult> {
        Campaign::interim(self)
    }

    fn constant_limit_states(&self) -> Vec<usize> {
        Campaign::constant_limit_states(self)
    }
}
