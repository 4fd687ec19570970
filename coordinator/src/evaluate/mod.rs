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

/// Evaluates samples.
pub trait Evaluator {
    /// Evaluates the requests of `first` and every further one that `record` answers, in any order, each exactly once; ends when
    /// nothing is left to do. Calls `record` on each outcome as it arrives; the requests it answers begin while
    /// the others are under way, so that nobody waits for the slowest of a batch. An outcome counts as delivered (and
    /// may be acknowledged to a worker) only after `record` returned `Ok`.
    ///
    /// # Errors
    /// [`EvaluateError`]; outcomes recorded before it stay valid.
    fn pursue(
        &mut self,
        first: Vec<Request>,
        record: &mut dyn FnMut(Finished) -> Result<Vec<Request>, EvaluateError>,
    ) -> Result<(), EvaluateError>;

    /// Evaluates the requests of `batch` and no others.
    ///
    /// # Errors
    /// Those of [`Evaluator::pursue`].
    fn evaluate(
        &mut self,
        batch: &[Request],
        record: &mut dyn FnMut(Finished) -> Result<(), EvaluateError>,
    ) -> Result<(), EvaluateError> {
        self.pursue(batch.to_vec(), &mut |finished| {
            record(finished)?;
            Ok(Vec::new())
        })
    }
}
