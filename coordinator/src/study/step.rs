//! The steps of a campaign, and the reasons for its end.

use crate::statistics::learning::Rule;
use crate::statistics::surrogate::SurrogateError;
use common::failure::SimulationFailure;
use thiserror::Error;

/// One requested simulation.
#[derive(Debug, Clone, PartialEq)]
pub struct SampleRequest {
    /// Values of the random variables `(d,)` [SI].
    pub sample: Vec<f64>,
    /// True for the repetition of a failed simulation, at a stricter setting.
    pub stricter: bool,
    /// Level of accuracy, 0 for the working accuracy of the study.
    pub level: u8,
    /// Workers that have evaluated the sample before, one for each time: another one repeats it where one is connected.
    pub not_by: Vec<String>,
}

impl SampleRequest {
    /// A first simulation of a sample `(d,)` [SI] at the working accuracy.
    pub fn new(sample: Vec<f64>) -> Self {
        Self { sample, stricter: false, level: 0, not_by: vec![] }
    }
}

/// The next step of a campaign.
#[derive(Debug, Clone, PartialEq)]
pub enum Step {
    /// Simulate these samples and record their outcomes in the same order ([`super::Campaign::record`]);
    /// further steps may be requested meanwhile.
    Evaluate(Vec<SampleRequest>),
    /// Record the outcomes of the oldest chunk under way.
    Wait,
    /// Learning has ended.
    Done,
}

/// Reason for the end of learning.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum StopReason {
    /// A stopping rule held.
    Rule(Rule),
    /// The budget of evaluations is spent.
    Budget,
}

/// Reason why a campaign cannot continue.
#[derive(Debug, Error)]
pub enum CampaignError {
    /// The nominal mechanism cannot be simulated, which is found out before any other sample is.
    #[error("the nominal mechanism cannot be simulated: {cause}{}", advice(cause))]
    Nominal {
        /// Cause of the failure.
        cause: SimulationFailure,
    },
    /// Too few simulations of the initial design gave a result for a surrogate.
    #[error(
        "{results} of {total} simulations gave a result, too few for a surrogate; {count} failed like this: {cause}"
    )]
    TooFewResults {
        /// Number of results.
        results: usize,
        /// Number of simulated samples.
        total: usize,
        /// Number of failures of the most frequent kind.
        count: usize,
        /// The first failure of that kind.
        cause: SimulationFailure,
    },
    /// More than the allowed share of the simulations failed.
    #[error("{failed} of {total} simulations failed, {count} of them like this: {cause}")]
    TooManyFailures {
        /// Number of failed simulations.
        failed: usize,
        /// Number of simulated samples.
        total: usize,
        /// Number of failures of the most frequent kind.
        count: usize,
        /// The first failure of that kind.
        cause: SimulationFailure,
    },
    /// A surrogate could not be fitted.
    #[error("surrogate of limit state {mode}: {source}")]
    Surrogate {
        /// Index of the limit state, from 0.
        mode: usize,
        /// Error of the fit.
        source: SurrogateError,
    },
}

/// What a user can do about the failure of the first simulation.
fn advice(cause: &SimulationFailure) -> &'static str {
    match cause {
        SimulationFailure::TimedOut { .. } => {
            "; a program has to flush its output after every reply, and a slow one needs a longer simulator.timeout"
        }
        _ => "",
    }
}
