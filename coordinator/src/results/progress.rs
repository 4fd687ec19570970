//! What a study tells whoever watches: the terminal, a test, a log.

use crate::results::summary::{ReliabilityRow, Round};

/// Something happened in a study.
#[derive(Debug, Clone, PartialEq)]
pub enum Progress {
    /// A batch goes out; `planned` evaluations are known of so far, `budget` is the bound. What the campaign file
    /// holds of it was told before.
    BatchStarted {
        /// Size of the batch.
        size: usize,
        /// Evaluations after this batch.
        planned: usize,
        /// Bound on evaluations.
        budget: usize,
        /// What the batch is for, e.g. `initial design`, `round 3`.
        purpose: String,
    },
    /// One evaluation ended (or was found in the campaign file).
    Evaluated {
        /// Evaluations done.
        done: usize,
        /// Whether it failed.
        failed: bool,
        /// Whether it came from the campaign file.
        recalled: bool,
        /// Simulation time [s].
        wall: f64,
    },
    /// The surrogates were refitted and the population classified.
    RoundFinished(Round),
    /// What is known of the reliability after the last round: R(n) and standard errors at every checkpoint, from
    /// `samples` points or simulations; numerical errors are counted at the end.
    Reliability {
        /// One row per checkpoint.
        rows: Vec<ReliabilityRow>,
        /// Points of the population, or simulations.
        samples: usize,
    },
    /// Everything is evaluated; the results are being worked out.
    Ending,
    /// A warning for the user.
    Warning(String),
}

/// Watches a study.
pub trait Observer {
    /// Takes notice; must not block for long.
    fn notice(&mut self, progress: &Progress);
}

/// Watches nothing.
#[derive(Debug, Default)]
pub struct Silent;

impl Observer for Silent {
    fn notice(&mut self, _progress: &Progress) {}
}
