//! Times of a run of a study while it is in progress, added to those of the runs before it.

use crate::farm::evaluate::EvaluateError;
use crate::results::journal::Journal;
use crate::results::timing::Timing;
use std::collections::BTreeSet;
use std::time::{Duration, Instant};

/// Shortest time between two notes in the journal: a killed run loses no more of its time than this.
const NOTE_EVERY: Duration = Duration::from_secs(5);

/// Times of the run in progress.
#[derive(Debug)]
pub(super) struct RunTimes {
    started: Instant,
    noted: Instant,
    /// Time the learner took.
    pub learner: Duration,
    /// Time in which no evaluation was under way.
    pub idle: Duration,
    /// Times of the runs before this one.
    pub earlier: Timing,
    /// Number of slots.
    slots: u32,
    /// Workers that simulated in this run.
    workers: BTreeSet<String>,
}

impl RunTimes {
    /// Starts the clock of a run whose evaluator has this number of slots.
    pub fn start(slots: u32) -> Self {
        let (started, zero) = (Instant::now(), Duration::ZERO);
        let (earlier, workers) = (Timing::default(), BTreeSet::new());
        Self { started, noted: started, learner: zero, idle: zero, earlier, slots, workers }
    }

    /// Counts a worker that simulated in this run.
    pub fn add_worker(&mut self, name: &str) {
        self.workers.insert(name.to_owned());
    }

    /// Times of the study, the runs before this one included; `simulation` [s] is that of all evaluations.
    pub fn study(&self, simulation: f64) -> Timing {
        self.earlier.with_run(&Timing {
            total: self.started.elapsed().as_secs_f64(),
            simulation,
            surrogate: self.learner.as_secs_f64(),
            idle: self.idle.as_secs_f64() * f64::from(self.slots),
            runs: 1,
            workers: u32::try_from(self.workers.len()).unwrap_or(u32::MAX),
        })
    }

    /// Notes the times of the study in the journal, at most every five seconds unless the run ends.
    ///
    /// # Errors
    /// [`EvaluateError::Record`].
    pub fn note(
        &mut self,
        journal: &mut dyn Journal,
        simulation: f64,
        ends: bool,
    ) -> Result<(), EvaluateError> {
        if !ends && self.noted.elapsed() < NOTE_EVERY {
            return Ok(());
        }
        self.noted = Instant::now();
        journal.note_times(&self.study(simulation))
    }
}
