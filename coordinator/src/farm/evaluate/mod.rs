//! The interface between a study and what evaluates its samples: threads of this process, workers over Zenoh, an
//! external program, or a model server.

pub mod external;
pub mod local;

use common::accuracy::Accuracy;
use common::external::SlotError;
use common::failure::SimulationFailure;
use common::outputs::Evaluation;
use std::time::Duration;
use thiserror::Error;

/// Result of one sample. A failed simulation is a result, not an error of the evaluator.
pub type EvaluationResult = Result<Evaluation, SimulationFailure>;

/// One evaluation requested by a study.
#[derive(Debug, Clone, PartialEq)]
pub struct Request {
    /// Number of the evaluation in its campaign, from 0, unique, in the order of requests.
    pub id: u64,
    /// Values of the scene's random variables `(d,)`, SI.
    pub sample: Vec<f64>,
    /// Whether the settled first cycle is to be returned too.
    pub with_first_cycle: bool,
    /// Numerical settings, if they differ from those of the evaluator.
    pub accuracy: Option<Accuracy>,
    /// Level of accuracy in its study: 0 for the working accuracy, also where a failed evaluation is repeated.
    pub level: u8,
    /// Workers that have evaluated this sample before, one for each time: the evaluation is repeated by another one where one is connected.
    pub not_by: Vec<String>,
}

impl Request {
    /// A request without the first cycle, at an accuracy of its own.
    pub fn at(id: u64, sample: Vec<f64>, accuracy: Accuracy) -> Self {
        Self { id, sample, with_first_cycle: false, accuracy: Some(accuracy), level: 0, not_by: vec![] }
    }

    /// True for the repetition of a failed evaluation at a stricter setting.
    pub fn is_stricter(&self) -> bool {
        self.accuracy.is_some() && self.level == 0
    }
}

/// A finished evaluation.
#[derive(Debug, Clone, PartialEq)]
pub struct Finished {
    /// Number of the request.
    pub id: u64,
    /// Evaluation, or the failure of the simulation.
    pub outcome: EvaluationResult,
    /// Worker and slot, e.g. `host-4711/0`.
    pub worker: String,
    /// Wall time of the simulation [s].
    pub wall: f64,
}

/// Reasons for an evaluator to end before its source is exhausted.
#[derive(Debug, Error)]
pub enum EvaluateError {
    /// The user stopped the study; everything recorded so far is kept.
    #[error("interrupted")]
    Interrupted,
    /// An evaluation was tried the allowed number of times without an outcome: an infrastructure failure, or a
    /// sample that crashes its worker. Its number, and the number of attempts and how they ended.
    #[error("evaluation {0} was given up: {1}")]
    GivenUp(u64, String),
    /// The evaluator returned an outcome of this number that was not requested.
    #[error("evaluation {0} was not requested")]
    UnrequestedOutcome(u64),
    /// The evaluator ended without an outcome of the request of this number.
    #[error("evaluation {0} has no outcome")]
    NoOutcome(u64),
    /// The simulator named by the scene cannot be used, or a thread that evaluates or dispatches requests cannot be started or has ended
    /// without reporting why.
    #[error(transparent)]
    Slot(SlotError),
    /// The source could not record an outcome.
    #[error("an outcome could not be recorded: {0}")]
    Record(Box<dyn std::error::Error + Send + Sync>),
}

impl From<SlotError> for EvaluateError {
    fn from(error: SlotError) -> Self {
        match error {
            SlotError::Stopped => Self::Interrupted,
            other => Self::Slot(other),
        }
    }
}

/// Answer of a source that is asked for requests.
#[derive(Debug, Clone, PartialEq)]
pub enum Demand {
    /// Start these, in addition to those already running.
    Begin(Vec<Request>),
    /// Nothing at present; more requests may follow.
    Later,
    /// No further requests: the source is exhausted.
    End,
}

/// Supplies requests to an evaluator, also while others are running, and records their outcomes.
pub trait RequestSource {
    /// Requests to start now. Called after every outcome, and at least every [`POLL_INTERVAL`], until it returns
    /// [`Demand::End`].
    ///
    /// # Errors
    /// An error ends the evaluator, which returns it.
    fn next(&mut self) -> Result<Demand, EvaluateError>;

    /// Records one outcome. The outcome is durable when this returns `Ok`; only then is it acknowledged to a worker.
    ///
    /// # Errors
    /// An error ends the evaluator, which returns it.
    fn record(&mut self, finished: Finished) -> Result<(), EvaluateError>;

    /// Records several outcomes, all durable when this returns `Ok`.
    ///
    /// # Errors
    /// An error ends the evaluator, which returns it; some of the outcomes may be durable.
    fn record_all(&mut self, finished: Vec<Finished>) -> Result<(), EvaluateError> {
        finished.into_iter().try_for_each(|finished| self.record(finished))
    }
}

/// Interval at which an evaluator polls its source and the user's stop request.
pub const POLL_INTERVAL: Duration = Duration::from_millis(10);

/// Evaluates the requests of a source.
pub trait Evaluator {
    /// Runs until the source is exhausted and every request has been evaluated exactly once, in any order.
    ///
    /// # Errors
    /// [`EvaluateError`]; outcomes recorded before it stay valid.
    fn run(&mut self, source: &mut dyn RequestSource) -> Result<(), EvaluateError>;

    /// Number of evaluations that can run at once now.
    fn concurrency(&self) -> u32 {
        1
    }

    /// Evaluates the requests of `batch` and calls `record` with each outcome as it arrives.
    ///
    /// # Errors
    /// Those of [`Evaluator::run`].
    fn evaluate(
        &mut self,
        batch: &[Request],
        record: &mut dyn FnMut(Finished) -> Result<(), EvaluateError>,
    ) -> Result<(), EvaluateError> {
        self.run(&mut Batch { requests: Some(batch.to_vec()), record })
    }

    /// Evaluates the requests of `batch`, whose numbers follow each other, and calls `progress` with each outcome as it arrives. The
    /// outcomes are in the order of the requests, `None` where an error, which is returned too, ended the evaluator before.
    fn outcomes(
        &mut self,
        batch: &[Request],
        progress: &mut dyn FnMut(&Finished),
    ) -> (Vec<Option<Finished>>, Result<(), EvaluateError>) {
        let first = batch.first().map_or(0, |request| request.id);
        let mut found = vec![None; batch.len()];
        let end = self.evaluate(batch, &mut |finished: Finished| {
            let place = usize::try_from(finished.id.wrapping_sub(first)).ok();
            let Some(place) = place.and_then(|place| found.get_mut(place)) else {
                return Err(EvaluateError::UnrequestedOutcome(finished.id));
            };
            progress(&finished);
            *place = Some(finished);
            Ok(())
        });
        (found, end)
    }
}

/// A source whose requests are all known at the start.
struct Batch<'a> {
    requests: Option<Vec<Request>>,
    record: &'a mut dyn FnMut(Finished) -> Result<(), EvaluateError>,
}

impl RequestSource for Batch<'_> {
    fn next(&mut self) -> Result<Demand, EvaluateError> {
        Ok(self.requests.take().map_or(Demand::End, Demand::Begin))
    }

    fn record(&mut self, finished: Finished) -> Result<(), EvaluateError> {
        (self.record)(finished)
    }
}

/// Requests that a source wants to be started now; none once it is exhausted.
pub(crate) fn next_requests(
    source: &mut dyn RequestSource,
    exhausted: &mut bool,
) -> Result<Vec<Request>, EvaluateError> {
    let mut all = Vec::new();
    while !*exhausted {
        match source.next()? {
            Demand::Begin(requests) => all.extend(requests),
            Demand::Later => break,
            Demand::End => *exhausted = true,
        }
    }
    Ok(all)
}

/// Difference of results of external simulators beyond their stated errors that counts as none, relative to the values [1].
const SAME: f64 = 1e-9;

/// Histories of an evaluation and their stated errors, both `(outputs)(m,)` [unit of the output]; without stated errors the latter are empty.
pub type HistoriesWithErrors<'a> = (&'a [Vec<f64>], &'a [Vec<f64>]);

/// True if two evaluations agree: to the last bit if results are `exact`, as those of the built-in simulator are, otherwise within the sum
/// of their stated errors and 1e-9 of the larger value.
pub fn agree(one: HistoriesWithErrors<'_>, other: HistoriesWithErrors<'_>, exact: bool) -> bool {
    if exact {
        return one == other;
    }
    let error =
        |of: &[Vec<f64>], k: usize, j: usize| of.get(k).and_then(|e| e.get(j)).copied().unwrap_or(0.0);
    one.0.iter().zip(other.0).enumerate().all(|(k, (a, b))| {
        a.iter().zip(b).enumerate().all(|(j, (a, b))| {
            (a - b).abs() <= error(one.1, k, j) + error(other.1, k, j) + SAME * a.abs().max(b.abs())
        })
    })
}
