//! Finished outcomes that are not acknowledged yet. Each is sent at once, then again after growing pauses: a coordinator
//! that has restarted may not have requested the task again yet.

use common::wire::codec::Encoded;
use common::wire::{Outcome, Task, TaskKey};
use std::time::{Duration, Instant};

/// Size of the outcomes in one claim [bytes]; a single larger outcome is sent alone.
const CLAIM_BYTES: usize = 1 << 20;

/// Pause before an outcome is sent for the second time; it doubles each time.
const FIRST_PAUSE: Duration = Duration::from_secs(1);
/// Longest pause between two sends of an outcome.
const LONGEST_PAUSE: Duration = Duration::from_secs(30);

struct Entry {
    outcome: Outcome,
    bytes: usize,
    due: Instant,
    pause: Duration,
}

/// Outcomes kept until their acknowledgement.
#[derive(Default)]
pub(super) struct UnacknowledgedResults(Vec<Entry>);

impl UnacknowledgedResults {
    /// Number of outcomes.
    pub(crate) fn len(&self) -> usize {
        self.0.len()
    }

    /// Encoded size of all outcomes [bytes].
    pub(crate) fn bytes(&self) -> usize {
        self.0.iter().map(|entry| entry.bytes).sum()
    }

    /// Tasks of the outcomes.
    pub(crate) fn keys(&self) -> impl Iterator<Item = TaskKey> {
        self.0.iter().map(|entry| entry.outcome.task.key)
    }

    /// Adds an outcome, to be sent with the next claim.
    pub(crate) fn push(&mut self, outcome: Outcome, now: Instant) {
        let bytes = outcome.encoded_size().unwrap_or(CLAIM_BYTES);
        self.0.push(Entry { outcome, bytes, due: now, pause: FIRST_PAUSE });
    }

    /// Schedules the outcome of this task to be sent at once; false if there is none.
    pub(crate) fn resend_if_held(&mut self, task: &Task, now: Instant) -> bool {
        let found = self.0.iter_mut().find(|entry| entry.outcome.task.same_work(task));
        found.map(|entry| entry.due = now).is_some()
    }

    /// Time of the next send; `None` without outcomes.
    pub(crate) fn next_due(&self) -> Option<Instant> {
        self.0.iter().map(|entry| entry.due).min()
    }

    /// Outcomes to send now, within the size of a claim; the others stay due.
    pub(crate) fn take_due(&mut self, now: Instant) -> Vec<Outcome> {
        let mut due = Vec::new();
        let mut bytes = 0;
        for entry in self.0.iter_mut().filter(|entry| entry.due <= now) {
            if !due.is_empty() && bytes + entry.bytes > CLAIM_BYTES {
                break;
            }
            bytes += entry.bytes;
            entry.due = now + entry.pause;
            entry.pause = (2 * entry.pause).min(LONGEST_PAUSE);
            due.push(entry.outcome.clone());
        }
        due
    }

    /// Removes acknowledged outcomes.
    pub(crate) fn forget(&mut self, acknowledged: &[TaskKey]) {
        self.0.retain(|entry| !acknowledged.contains(&entry.outcome.task.key));
    }

    /// Schedules all outcomes to be sent at once: the last claim was lost, or the coordinator has restarted.
    pub(crate) fn resend_all(&mut self, now: Instant) {
        for entry in &mut self.0 {
            (entry.due, entry.pause) = (now, FIRST_PAUSE);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use common::failure::SimulationFailure;

    fn outcome(task: u64, bytes: usize) -> Outcome {
        let key = TaskKey { campaign: 1, task };
        let result = Err(SimulationFailure::NotModelled { what: "x".repeat(bytes) });
        let task =
            Task { key, attempt: 1, sample: vec![], with_first_cycle: false, accuracy: None, level: 0 };
        Outcome { task, worker: "w".into(), wall: 0.0, result }
    }

    fn numbers(outcomes: &[Outcome]) -> Vec<u64> {
        outcomes.iter().map(|outcome| outcome.task.key.task).collect()
    }

    #[test]
    fn an_outcome_is_sent_again_with_growing_pauses_until_acknowledged() {
        let start = Instant::now();
        let mut held = UnacknowledgedResults::default();
        held.push(outcome(1, 10), start);
        let mut sent = vec![];
        for second in 0..100 {
            if !held.take_due(start + Duration::from_secs(second)).is_empty() {
                sent.push(second);
            }
        }
        assert_eq!(sent, [0, 1, 3, 7, 15, 31, 61, 91]);
        held.forget(&[TaskKey { campaign: 1, task: 1 }]);
        assert_eq!((held.len(), held.next_due()), (0, None));
    }

    #[test]
    fn a_claim_holds_what_fits_and_at_least_one() {
        let start = Instant::now();
        let mut held = UnacknowledgedResults::default();
        held.push(outcome(1, 2 * CLAIM_BYTES), start);
        held.push(outcome(2, CLAIM_BYTES / 2), start);
        held.push(outcome(3, CLAIM_BYTES / 3), start);
        assert_eq!(numbers(&held.take_due(start)), [1]);
        assert_eq!(numbers(&held.take_due(start)), [2, 3]);
        assert_eq!(numbers(&held.take_due(start)), [] as [u64; 0]);
        held.resend_all(start);
        assert_eq!(numbers(&held.take_due(start)), [1]);
    }
}
