//! Pauses after claims without reply, with a spread so that many workers do not return at the same time.

use common::wire::WorkerId;
use std::hash::{DefaultHasher, Hash, Hasher};
use std::time::Duration;

/// First pause after a claim without reply; it doubles each time. Short enough that a restarted coordinator has its workers
/// within a second.
const FIRST: Duration = Duration::from_millis(50);
/// Longest pause after a claim without reply.
const LONGEST: Duration = Duration::from_millis(400);

/// The next pause of a worker.
pub(super) struct Backoff {
    worker: WorkerId,
    pause: Duration,
}

impl Backoff {
    /// The first pause of a worker.
    pub(crate) fn new(worker: &WorkerId) -> Self {
        Self { worker: worker.clone(), pause: FIRST }
    }

    /// Starts with the first pause again: a reply has arrived.
    pub(crate) fn reset(&mut self) {
        self.pause = FIRST;
    }

    /// The pause after claim number `sequence`.
    pub(crate) fn next(&mut self, sequence: u64) -> Duration {
        let pause = self.spread(self.pause, sequence);
        self.pause = (2 * self.pause).min(LONGEST);
        pause
    }

    /// `pause` reduced by up to a quarter, by a hash of worker and claim.
    pub(crate) fn spread(&self, pause: Duration, sequence: u64) -> Duration {
        let mut hasher = DefaultHasher::new();
        (&self.worker, sequence).hash(&mut hasher);
        let share = (hasher.finish() % 1024) as f64 / 1024.0;
        pause.mul_f64(1.0 - 0.25 * share)
    }
}
