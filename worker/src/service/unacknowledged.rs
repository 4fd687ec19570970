//! Finished outcomes that were not acknowledged. Each is offered at once, then again after growing pauses: a
//! coordinator that does not know the task yet (after its restart) will ask for it later.

use common::wire::{Outcome, Task, TaskKey, codec};
use std::time::{Duration, Instant};

/// Outcomes in one claim together, unless a single one is larger [bytes].
const CLAIM_BYTES: usize = 1 << 20;

const FIRST_PAUSE: Duration = Duration::from_secs(1);
const LONGEST_PAUSE: Duration = Duration::from_secs(30);

struct Entry {
    outcome: Outcome,
    bytes: usize,
    due: Instant,
    pause: Duration,
}

/// The outcomes a worker still has.
#[derive(Default)]
pub(super) struct UnacknowledgedResults(Vec<Entry>);

impl UnacknowledgedResults {
    pub fn len(&self) -> usize {
        self.0.len()
    }

    /// Size of all [bytes].
    pub fn bytes(&self) -> usize {
        self.0.iter().map(|entry| entry.bytes).sum()
    }

    pub fn keys(&self) -> impl Iterator<Item = TaskKey> {
        self.0.iter().map(|entry| entry.outcome.task.key)
    }

    pub fn push(&mut self, outcome: Outcome, now: Instant) {
        let bytes = codec::encoded_size(&outcome).unwrap_or(CLAIM_BYTES);
        self.0.push(Entry { outcome, bytes, due: now, pause: FIRST_PAUSE });
    }

    /// Whether the outcome of this very work is there; if so it is due at once.
    pub fn resend_if_held(&mut self, task: &Task, now: Instant) -> bool {
        let found = self.0.iter_mut().find(|entry| entry.outcome.task.same_work(task));
        found.map(|entry| entry.due = now).is_some()
    }

    /// When the next one is to be offered.
    pub fn next_due(&self) -> Option<Instant> {
        self.0.iter().map(|entry| entry.due).min()
    }

    /// What to offer now, within the size of a claim; the rest keeps its turn.
    pub fn offer(&mut self, now: Instant) -> Vec<Outcome> {
        let mut offered = Vec::new();
        let mut bytes = 0;
        for entry in self.0.iter_mut().filter(|entry| entry.due <= now) {
            if !offered.is_empty() && bytes + entry.bytes > CLAIM_BYTES {
                break;
            }
            bytes += entry.bytes;
            entry.due = now + entry.pause;
            entry.pause = (2 * entry.pause).min(LONGEST_PAUSE);
            offered.push(entry.outcome.clone());
        }
        offered
    }

    pub fn forget(&mut self, acknowledged: &[TaskKey]) {
        self.0.retain(|entry| !acknowledged.contains(&entry.outcome.task.key));
    }

    /// Nobody heard the last offer, or somebody new may listen: all are due again.
    pub fn resend_all(&mut self, now: Instant) {
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
        let task = Task { key, attempt: 1, sample: vec![], with_first_cycle: false, accuracy: None };
        Outcome { task, worker: "w".into(), wall: 0.0, result }
    }

    fn numbers(outcomes: &[Outcome]) -> Vec<u64> {
        outcomes.iter().map(|outcome| outcome.task.key.task).collect()
    }

    #[test]
    fn an_outcome_is_offered_again_with_growing_pauses_until_acknowledged() {
        let start = Instant::now();
        let mut held = UnacknowledgedResults::default();
        held.push(outcome(1, 10), start);
        let mut offers = vec![];
        for second in 0..100 {
            if !held.offer(start + Duration::from_secs(second)).is_empty() {
                offers.push(second);
            }
        }
        assert_eq!(offers, [0, 1, 3, 7, 15, 31, 61, 91]);
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
        assert_eq!(numbers(&held.offer(start)), [1]);
        assert_eq!(numbers(&held.offer(start)), [2, 3]);
        assert_eq!(numbers(&held.offer(start)), [] as [u64; 0]);
        held.resend_all(start);
        assert_eq!(numbers(&held.offer(start)), [1]);
    }
}
