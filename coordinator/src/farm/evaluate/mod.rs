//! How a study has samples evaluated, whoever does the work: a closure in unit tests, the worker's library in
//! process, workers over Zenoh, a program or server of somebody else.

pub mod external;
pub mod local;
mod process;
mod program;
mod queue;
mod reply;
mod slots;
mod umbridge;

pub use process::kill_all;

use common::accuracy::Accuracy;
use common::failure::SimulationFailure;
use common::outputs::Evaluation;
use external::SimulatorError;
use std::time::Duration;
use thiserror::Error;

/// What comes of a sample; a failed simulation is an outcome, not an error.
pub type Outcome = Result<Evaluation, SimulationFailure>;

/// One evaluation a study asks for.
#[derive(Debug, Clone, PartialEq)]
pub struct Request {
    /// Number of the evaluation in its campaign, from 0, unique; the order of requests, not of replies.
    pub id: u64,
    /// Values of the scene's random variables `(d,)`, SI.
    pub sample: Vec<f64>,
    /// Whether the settled first cycle is wanted too.
    pub with_first_cycle: bool,
    /// Numerical settings, where they are not those the evaluator was made with.
    pub accuracy: Option<Accuracy>,
}

/// One evaluation that has ended.
#[derive(Debug, Clone, PartialEq)]
pub struct Finished {
    /// The request's number.
    pub id: u64,
    /// What came of it.
    pub outcome: Outcome,
    /// Who did it, e.g. `host-4711/0`.
    pub worker: String,
    /// How long the simulation took there [s].
    pub wall: f64,
}

/// Why a batch could not be evaluated to its end.
#[derive(Debug, Error)]
pub enum EvaluateError {
    /// The user asked to stop; everything recorded so far is safe.
    #[error("interrupted")]
    Interrupted,
    /// An evaluation got no outcome although it was tried again and again: an infrastructure failure, or a
    /// sample that kills its worker.
    #[error("evaluation {id} was given up: {reason}")]
    GivenUp {
        /// Number of the evaluation.
        id: u64,
        /// Why.
        reason: String,
    },
    /// The transport broke.
    #[error("transport: {0}")]
    Transport(String),
    /// The simulator that the scene names cannot be used.
    #[error(transparent)]
    Simulator(#[from] SimulatorError),
    /// The caller could not record an outcome.
    #[error("an outcome could not be recorded: {0}")]
    Record(String),
}

/// What an evaluator is to begin.
#[derive(Debug, Clone, PartialEq)]
pub enum Next {
    /// These, beside whatever is under way.
    Begin(Vec<Request>),
    /// Nothing now; more may come.
    Later,
    /// Nothing any more.
    End,
}

/// What an evaluator works on: requests come while others are under way, outcomes go as they arrive.
pub trait Pursuit {
    /// What to begin. Asked after every outcome, and at least every [`LOOK_UP`] until it answers [`Next::End`].
    ///
    /// # Errors
    /// Why the evaluator is to end.
    fn next(&mut self) -> Result<Next, EvaluateError>;

    /// Takes an outcome, durable once this returns `Ok`: only then may it be acknowledged to a worker.
    ///
    /// # Errors
    /// Why the evaluator is to end.
    fn record(&mut self, finished: Finished) -> Result<(), EvaluateError>;

    /// Takes several outcomes, all of them durable once this returns `Ok`.
    ///
    /// # Errors
    /// Why the evaluator is to end; some of them may be durable.
    fn record_all(&mut self, finished: Vec<Finished>) -> Result<(), EvaluateError> {
        finished.into_iter().try_for_each(|finished| self.record(finished))
    }
}

/// How often an evaluator looks what to begin, and whether the user wants to stop.
pub const LOOK_UP: Duration = Duration::from_millis(10);

/// Evaluates samples.
pub trait Evaluator {
    /// Evaluates every request of the pursuit, in any order, each exactly once, until no more come and none is under way.
    ///
    /// # Errors
    /// [`EvaluateError`]; outcomes recorded before it stay valid.
    fn pursue(&mut self, pursuit: &mut dyn Pursuit) -> Result<(), EvaluateError>;

    /// Evaluates the requests of `batch` and no others; calls `record` on each outcome as it arrives.
    ///
    /// # Errors
    /// Those of [`Evaluator::pursue`].
    fn evaluate(
        &mut self,
        batch: &[Request],
        record: &mut dyn FnMut(Finished) -> Result<(), EvaluateError>,
    ) -> Result<(), EvaluateError> {
        self.pursue(&mut Batch { requests: Some(batch.to_vec()), record })
    }
}

/// A pursuit of requests that are all known.
struct Batch<'a> {
    requests: Option<Vec<Request>>,
    record: &'a mut dyn FnMut(Finished) -> Result<(), EvaluateError>,
}

impl Pursuit for Batch<'_> {
    fn next(&mut self) -> Result<Next, EvaluateError> {
        Ok(self.requests.take().map_or(Next::End, Next::Begin))
    }

    fn record(&mut self, finished: Finished) -> Result<(), EvaluateError> {
        (self.record)(finished)
    }
}

/// What is left to begin of a pursuit, for evaluators: takes all there is now.
#[derive(Debug, Default)]
pub(crate) struct Beginnings {
    ended: bool,
}

impl Beginnings {
    /// Requests to begin now.
    pub fn take(&mut self, pursuit: &mut dyn Pursuit) -> Result<Vec<Request>, EvaluateError> {
        let mut all = Vec::new();
        while !self.ended {
            match pursuit.next()? {
                Next::Begin(requests) => all.extend(requests),
                Next::Later => break,
                Next::End => self.ended = true,
            }
        }
        Ok(all)
    }

    /// Begins nothing more, whatever comes.
    pub fn end(&mut self) {
        self.ended = true;
    }

    /// Whether no more will come.
    pub fn ended(&self) -> bool {
        self.ended
    }
}
