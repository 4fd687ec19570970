//! What a campaign asks for, and why it ends.

use crate::statistics::learning::Rule;
use crate::statistics::surrogate::SurrogateError;
use common::failure::SimulationFailure;
use thiserror::Error;

/// One simulation a campaign asks for.
#[derive(Debug, Clone, PartialEq)]
pub struct Ask {
    /// Values of the random variables `(d,)` [SI].
    pub sample: Vec<f64>,
    /// Whether the simulation failed before and is wanted at a stricter setting.
    pub stricter: bool,
}

/// What the campaign wants next.
#[derive(Debug, Clone, PartialEq)]
pub enum Step {
    /// Simulate these, then [`super::Campaign::tell`] the outcomes in the same order; meanwhile ask for more.
    Evaluate(Vec<Ask>),
    /// The outcomes of the chunk that was asked for first.
    Wait,
    /// Nothing: learning has ended.
    Done,
}

/// Why learning ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Stop {
    /// A stopping rule held.
    Rule(Rule),
    /// The budget of evaluations is spent.
    Budget,
}

/// Why a campaign cannot go on.
#[derive(Debug, Error)]
pub enum CampaignError {
    /// More than the allowed share of the simulations failed.
    #[error("{failed} of {total} simulations failed, {count} of them like this: {cause}")]
    TooManyFailures {
        /// Failed.
        failed: usize,
        /// Simulated.
        total: usize,
        /// Failures of the commonest kind.
        count: usize,
        /// The first of them.
        cause: SimulationFailure,
    },
    /// A surrogate could not be made.
    #[error("surrogate of limit state {mode}: {source}")]
    Surrogate {
        /// Index of the limit state, from 0.
        mode: usize,
        /// Why.
        source: SurrogateError,
    },
}
