//! Contact of a worker with a coordinator whose evaluations need licences.
//!
//! The coordinator gives the licences of a lost worker to others after a while. So a worker that runs such evaluations
//! sends a claim every two seconds, and ends them when no claim has been answered for [`LICENCE_CONTACT`]. If the worker is
//! stopped (SIGSTOP), its simulator ends them shortly after.

use common::external::SlotError;
use common::failure::SimulationFailure;
use common::wire::{LICENCE_CONTACT, Outcome, Task};
use std::time::{Duration, Instant};

/// Interval of claims while evaluations under licences run.
const INTERVAL: Duration = Duration::from_secs(2);
/// Time after [`LICENCE_CONTACT`] at which the simulator ends the evaluations if this process has not.
const MARGIN: Duration = Duration::from_millis(500);

/// Contact with one coordinator.
#[derive(Default)]
pub(super) struct LicenceContact {
    /// Whether the evaluations of this coordinator need licences.
    licensed: bool,
    /// Time at which the last answered claim was sent: the coordinator has had contact since.
    answered: Option<Instant>,
    /// The limit that the simulator has.
    limit: Option<Instant>,
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

    /// Time at which the simulator must end `running` tasks, if it has changed.
    pub(crate) fn new_limit(&mut self, running: usize) -> Option<Option<Instant>> {
        let limit =
            self.answered.filter(|_| self.licensed && running > 0).map(|at| at + LICENCE_CONTACT + MARGIN);
        (std::mem::replace(&mut self.limit, limit) != limit).then_some(limit)
    }

    /// Registers that running tasks are ended.
    pub(crate) fn end(&mut self, tasks: impl Iterator<Item = Task>) {
        self.ended.extend(tasks);
        tracing::warn!("{} evaluations that need licences end: no coordinator answers", self.ended.len());
    }

    /// True if the outcome is that of a task that was stopped: here, without contact or since the worker leaves, or by the
    /// simulator at the limit of the contact. A stopped task says nothing about the simulator.
    pub(crate) fn take_ended(&mut self, outcome: &Outcome, leaving_since: Option<Instant>) -> bool {
        let at = self.ended.iter().position(|ended| ended.same_work(&outcome.task));
        let was_ended = at.map(|at| self.ended.swap_remove(at)).is_some() || leaving_since.is_some();
        (was_ended && outcome.is_unusable()) || is_stopped(outcome)
    }
}

fn is_stopped(outcome: &Outcome) -> bool {
    let stopped = SlotError::Stopped.to_string();
    matches!(&outcome.result, Err(SimulationFailure::SimulatorUnusable { reason }) if *reason == stopped)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::service::practice_tests::job;

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
        let unusable = || Err(SimulationFailure::SimulatorUnusable { reason: "no licence file".into() });
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
        // One that the simulator has stopped is no report of the simulator.
        let reason = SlotError::Stopped.to_string();
        let stopped = outcome(3.0, Err(SimulationFailure::SimulatorUnusable { reason }));
        assert!(contact.take_ended(&stopped, None));
    }

    #[test]
    fn the_limit_of_the_simulator_follows_the_last_answered_claim() {
        let start = Instant::now();
        let mut contact = LicenceContact::default();
        contact.on_reply(start);
        contact.on_work(false);
        assert_eq!(contact.new_limit(1), None);
        contact.on_work(true);
        let limit = start + LICENCE_CONTACT + MARGIN;
        assert_eq!((contact.new_limit(0), contact.new_limit(1)), (None, Some(Some(limit))));
        assert_eq!(contact.new_limit(2), None);
        contact.on_reply(start + INTERVAL);
        assert_eq!(contact.new_limit(1), Some(Some(limit + INTERVAL)));
        assert_eq!(contact.new_limit(0), Some(None));
    }
}
