//! Progress of a running study, for the terminal, the live page and tests.

use crate::results::summary::{ReliabilityRow, Round};

/// An event of a running study.
#[derive(Debug, Clone, PartialEq)]
pub enum Progress {
    /// A batch of evaluations starts; those found in the journal were reported before.
    BatchStarted {
        /// Evaluations after this batch.
        planned: usize,
        /// Largest number of evaluations.
        budget: usize,
        /// Purpose of the batch, e.g. `initial design`, `round 3`.
        purpose: String,
    },
    /// One evaluation ended, or was found in the journal.
    Evaluated {
        /// Evaluations finished so far.
        done: usize,
        /// True if it has no result.
        failed: bool,
        /// True if it was found in the journal.
        recalled: bool,
        /// Simulation time [s].
        wall: f64,
    },
    /// The surrogates were refitted and the population classified.
    RoundFinished(Round),
    /// R(n) and standard errors at every checkpoint after the last round, without the range of numerical errors, which
    /// is computed at the end.
    Reliability {
        /// One row per checkpoint.
        rows: Vec<ReliabilityRow>,
        /// Points of the population, or simulations.
        samples: usize,
    },
    /// All evaluations are finished; the results are being computed.
    Ending,
    /// A warning for the user.
    Warning(String),
}

/// Receives the progress of a study.
pub trait Observer {
    /// Called at every event, on the thread of the study; it must return quickly.
    fn notice(&mut self, progress: &Progress);
}

/// An observer that ignores every event.
#[derive(Debug, Default)]
pub struct Silent;

impl Observer for Silent {
    fn notice(&mut self, _progress: &Progress) {}
}
