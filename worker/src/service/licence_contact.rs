//! Contact of a worker with a coordinator whose evaluations need licences.
//!
//! The coordinator gives the licences of a lost worker to others after a while. So a worker that runs such evaluations
//! sends a claim every two seconds, and ends them when no claim has been answered for [`LICENCE_CONTACT`].

use common::wire::{LICENCE_CONTACT, Outcome, Task};
use std::time::{Duration, Instant};

/// Interval of claims while evaluations under licences run.
const INTERVAL: Duration = Duration::from_secs(2);

/// Contact with one coordinator.
#[derive(Default)]
pub(super) struct LicenceContact {
    /// Whether the evaluations of this coordinator need licences.
    licensed: bool,
    /// Time at which the last answered claim was sent: the coordinator has had contact since.
    answered: Option<Instant>,
    /// Tasks that were ended without contact and whose slots have not returned yet.
    ended: Vec<Task>,
}

impl LicenceContact {
    /// Registers a reply to the claim sent at `since`.
    pub(crate) fn on_reply(&mut self, since: Instant) {
        self.answered = Some(since);
    }

    /// Registers tasks from the coordinator.
    pub(crate) fn on_work(&mut self, licensed: bool) {
        self.licensed = licensed;
    }

    /// Time of the next claim for the contact that `running` tasks require, if they do.
    pub(crate) fn next_claim(&self, running: usize) -> Option<Instant> {
        self.answered.filter(|_| self.licensed && running > 0).map(|at| at + INTERVAL)
    }

    /// True if there are `running` tasks that must end.
    pub(crate) fn is_lost(&self, now: Instant, running: usize) -> bool {
        let silent = |at: Instant| now.saturating_duration_since(at) >= LICENCE_CONTACT;
        self.licensed && running > 0 && self.answered.is_some_and(silent)
    }

    /// Registers that running tasks are ended.
    pub(crate) fn end(&mut self, tasks: impl Iterator<Item = Task>) {
        self.ended.extend(tasks);
        tracing::warn!("{} evaluations that need licences end: no coordinator answers", self.ended.len());
    }

    /// True if the outcome is that of a task that was ended here, without contact or since the worker leaves.
    pub(crate) fn take_ended(&mut self, outcome: &Outcome, leaving_since: Option<Instant>) -> bool {
        let at = self.ended.iter().position(|ended| ended.same_work(&outcome.task));
        let was_ended = at.map(|at| self.ended.swap_remove(at)).is_some() || leaving_since.is_some();
        was_ended && outcome.is_unusable()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::service::practice::job;
    use common::failure::SimulationFailure;

    #[test]
    fn only_evaluations_under_licences_end_without_contact() {
        let start = Instant::now();
        let later = start + LICENCE_CONTACT;
        let mut contact = LicenceContact::default();
        contact.on_reply(start);
        contact.on_work(false);
        assert!(!contact.is_lost(later, 1) && contact.next_claim(1).is_none());
        contact.on_work(true);
        assert_eq!((contact.next_claim(0), contact.next_claim(2)), (None, Some(start + INTERVAL)));
        assert!(contact.is_lost(later, 1) && !contact.is_lost(later, 0));
        assert!(!contact.is_lost(later - Duration::from_millis(1), 1));
        // The time of the claim counts, not that of its reply.
        contact.on_reply(start + INTERVAL);
        assert!(!contact.is_lost(later, 1) && contact.is_lost(later + INTERVAL, 1));
    }

    #[test]
    fn an_ended_task_returns_once() {
        let unusable = || Err(SimulationFailure::SimulatorUnusable { reason: "stopped".into() });
        let outcome = |x: f64, result| Outcome { task: job(x).task, worker: "w/0".into(), wall: 1.0, result };
        let (ended, other) = (outcome(1.0, unusable()), outcome(2.0, unusable()));
        let mut contact = LicenceContact::default();
        contact.end(std::iter::once(ended.task.clone()));
        assert!(!contact.take_ended(&other, None) && contact.take_ended(&other, Some(Instant::now())));
        assert!(contact.take_ended(&ended, None) && !contact.take_ended(&ended, None));
        // One that has finished before it was stopped counts.
        contact.end(std::iter::once(ended.task.clone()));
        let finished = outcome(1.0, Err(SimulationFailure::TimedOut { seconds: 1.0 }));
        assert!(!contact.take_ended(&finished, None) && !contact.take_ended(&ended, None));
    }
}
