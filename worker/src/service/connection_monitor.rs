//! Monitors the connection to a coordinator: warns the user while it is silent, and gives up after a time limit.
//!
//! # Licence contact
//! Contact of a worker with a coordinator whose evaluations need licences.
//!
//! The coordinator gives the licences of a lost worker to others after a while. So a worker that runs such evaluations
//! sends a claim every two seconds, and ends them when no claim has been answered for [`LICENCE_CONTACT`]. If the worker is
//! stopped (SIGSTOP), its simulator ends them shortly after.
//!
//! # The worker's own campaign
//! The campaign that a worker works for, as far as its coordinator has told: behind a router a claim may reach the coordinator of another
//! study, whose end is none for this worker.

use super::ServiceError;
use common::external::SlotError;
use common::failure::SimulationFailure;
use common::wire::{LICENCE_CONTACT, Outcome, Task, WorkOrder};
use std::time::{Duration, Instant};

/// Interval of warnings while no coordinator answers.
const WARN_EVERY: Duration = Duration::from_secs(5);

/// Silence of one coordinator.
pub(super) struct ConnectionMonitor {
    endpoint: String,
    give_up_after: Option<Duration>,
    silent_since: Option<Instant>,
    warned_at: Option<Instant>,
    last_reason: String,
    was_connected: bool,
}

impl ConnectionMonitor {
    /// A monitor for the coordinator at `endpoint`; `give_up_after` bounds the silence, `None`: no bound.
    pub(crate) fn new(endpoint: &str, give_up_after: Option<Duration>) -> Self {
        Self {
            endpoint: endpoint.to_owned(),
            give_up_after,
            silent_since: None,
            warned_at: None,
            last_reason: "no answer".into(),
            was_connected: false,
        }
    }

    /// Registers an answer of the coordinator: the silence ends.
    pub(crate) fn on_answer(&mut self) {
        if !self.was_connected {
            tracing::info!("connected to the coordinator at {}", self.endpoint);
        } else if self.warned_at.is_some() {
            tracing::info!("the coordinator at {} answers again", self.endpoint);
        }
        self.was_connected = true;
        (self.silent_since, self.warned_at) = (None, None);
    }

    /// Registers an attempt without answer, started at `since`.
    pub(crate) fn on_failure(&mut self, since: Instant, reason: String) {
        tracing::debug!("no answer from {}: {reason}", self.endpoint);
        self.on_silence(since, Some(reason));
    }

    /// Registers that an attempt has had no answer since `since`, with the reason if one is known.
    pub(crate) fn on_silence(&mut self, since: Instant, reason: Option<String>) {
        self.silent_since = self.silent_since.or(Some(since));
        if let Some(reason) = reason {
            self.last_reason = reason;
        }
    }

    /// Warns the user every five seconds of silence.
    ///
    /// # Errors
    /// [`ServiceError::Unreachable`] once the silence exceeds `give_up_after`.
    pub(crate) fn check(&mut self, now: Instant) -> Result<(), ServiceError> {
        let Some(since) = self.silent_since else { return Ok(()) };
        let silence = now.saturating_duration_since(since);
        if self.give_up_after.is_some_and(|limit| silence >= limit) {
            return Err(ServiceError::Unreachable {
                endpoint: self.endpoint.clone(),
                seconds: silence.as_secs_f64(),
                last_reason: self.last_reason.clone(),
            });
        }
        let warn_at = self.warned_at.unwrap_or(since) + WARN_EVERY;
        if now >= warn_at {
            self.warned_at = Some(now);
            tracing::warn!(
                "no coordinator has answered at {} for {:.0} s ({}); trying again",
                self.endpoint,
                silence.as_secs_f64(),
                self.last_reason
            );
        }
        Ok(())
    }
}

/// Interval of claims while evaluations under licences run.
const INTERVAL: Duration = Duration::from_secs(2);
/// Time after [`LICENCE_CONTACT`] at which the simulator ends the evaluations if this process has not.
const MARGIN: Duration = Duration::from_millis(500);

/// Contact with one coordinator.
#[derive(Default)]
pub(super) struct LicenceContact {
    /// Whether the evaluations of this coordinator need licences.
    pub(super) licensed: bool,
    /// Time at which the last answered claim was sent: the coordinator has had contact since.
    pub(super) answered: Option<Instant>,
    /// The limit that the simulator has.
    limit: Option<Instant>,
    /// Tasks that were ended without contact and whose slots have not returned yet.
    ended: Vec<Task>,
}

impl LicenceContact {
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

/// Time for which the end of another campaign is no reason to leave.
const END_OF_ANOTHER: Duration = Duration::from_secs(10);

/// Campaign of the tasks last received.
#[derive(Debug, Default)]
pub(super) struct OwnCampaign {
    number: Option<u64>,
    /// When a claim was first answered with the end of another campaign.
    another_ended: Option<Instant>,
}

impl OwnCampaign {
    /// Notes the campaign of tasks that have arrived.
    pub fn on_order(&mut self, order: &WorkOrder) {
        self.number = order.tasks.first().map(|task| task.key.campaign).or(self.number);
        self.another_ended = None;
    }

    /// True if a campaign is, as far as is known, that of this worker.
    pub fn is(&self, campaign: u64) -> bool {
        self.number.is_none_or(|own| own == campaign)
    }

    /// True if the end of `campaign` is a reason to leave, as the reply to a claim says.
    pub fn end(&mut self, campaign: u64, now: Instant) -> bool {
        let is_own = self.is(campaign);
        let since = *self.another_ended.get_or_insert(now);
        if !is_own && now.saturating_duration_since(since) < END_OF_ANOTHER {
            tracing::warn!(
                "the end of another study (campaign {campaign:x}) is ignored: one router serves one coordinator"
            );
            return false;
        }
        *self = Self::default();
        true
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn silence_counts_from_the_first_failure_and_ends_with_an_answer() {
        let start = Instant::now();
        let second = Duration::from_secs(1);
        let mut monitor = ConnectionMonitor::new("tcp/host:1", Some(10 * second));
        monitor.on_failure(start, "refused".into());
        monitor.on_failure(start + 8 * second, "refused again".into());
        assert!(monitor.check(start + 9 * second).is_ok());
        monitor.on_answer();
        assert!(monitor.check(start + 100 * second).is_ok());
        monitor.on_failure(start + 100 * second, "refused".into());
        let error = monitor.check(start + 110 * second).unwrap_err();
        assert!(error.to_string().contains("tcp/host:1 for 10 s"), "{error}");
        assert!(error.to_string().contains("refused"), "{error}");
    }

    #[test]
    fn without_a_bound_it_never_gives_up() {
        let start = Instant::now();
        let mut monitor = ConnectionMonitor::new("tcp/host:1", None);
        monitor.on_failure(start, "refused".into());
        assert!(monitor.check(start + Duration::from_secs(1_000_000)).is_ok());
    }
}

#[cfg(test)]
mod licence_contact_tests {
    use super::*;
    use crate::service::practice_tests::job;

    #[test]
    fn only_evaluations_under_licences_end_without_contact() {
        let start = Instant::now();
        let later = start + LICENCE_CONTACT;
        let mut contact = LicenceContact { answered: Some(start), ..LicenceContact::default() };
        assert!(!contact.is_lost(later, 1) && contact.next_claim(1).is_none());
        contact.licensed = true;
        assert_eq!((contact.next_claim(0), contact.next_claim(2)), (None, Some(start + INTERVAL)));
        assert!(contact.is_lost(later, 1) && !contact.is_lost(later, 0));
        assert!(!contact.is_lost(later - Duration::from_millis(1), 1));
        // The time of the claim counts, not that of its reply.
        contact.answered = Some(start + INTERVAL);
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
        let mut contact = LicenceContact { answered: Some(start), ..LicenceContact::default() };
        assert_eq!(contact.new_limit(1), None);
        contact.licensed = true;
        let limit = start + LICENCE_CONTACT + MARGIN;
        assert_eq!((contact.new_limit(0), contact.new_limit(1)), (None, Some(Some(limit))));
        assert_eq!(contact.new_limit(2), None);
        contact.answered = Some(start + INTERVAL);
        assert_eq!(contact.new_limit(1), Some(Some(limit + INTERVAL)));
        assert_eq!(contact.new_limit(0), Some(None));
    }
}

#[cfg(test)]
mod own_campaign_tests {
    use super::*;
    use common::accuracy::Accuracy;
    use common::wire::{Subject, Task, TaskKey};

    #[test]
    fn issue_the_end_of_another_study_sent_a_worker_away() {
        let now = Instant::now();
        let mut own = OwnCampaign::default();
        assert!(own.is(3) && own.end(3, now), "nothing is known yet");
        let task = Task {
            key: TaskKey { campaign: 3, task: 0 },
            attempt: 1,
            sample: vec![],
            with_first_cycle: false,
            accuracy: None,
            level: 0,
        };
        let order = WorkOrder {
            subject: Subject::Scene(String::new()),
            accuracy: Accuracy::draft(),
            accuracy_name: "draft".into(),
            licensed: false,
            tasks: vec![task],
        };
        own.on_order(&order);
        assert!(!own.is(4) && !own.end(4, now) && !own.end(4, now + END_OF_ANOTHER / 2));
        assert!(own.end(4, now + END_OF_ANOTHER), "its own coordinator has been silent for long");
        own.on_order(&order);
        assert!(own.end(3, now));
    }
}
