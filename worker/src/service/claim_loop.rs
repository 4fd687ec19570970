//! Claims of a worker to one coordinator: when to claim, how many tasks to request, which outcomes to return. Only one
//! claim is open at a time, so that its list of held tasks is exact and the coordinator detects a lost reply.
//!
//! There are three kinds of reply: work; "idle, claim again in T" (a notice ends the wait early); none, after which the worker backs off.

use super::connection_monitor::{ConnectionMonitor, LicenceContact, OwnCampaign};
use super::leave_policy::LeavePolicy;
use super::link::Link;
use super::pace::{Backoff, PrefetchEstimator};
use super::slots::Slots;
use super::unacknowledged::UnacknowledgedResults;
use super::{ClaimEvent, Departure, ServiceConfig, ServiceError};
use crate::log::refusal;
use common::wire::{self, Claim, Notice, Refused, Task, TaskKey, WorkerId};
use std::sync::Arc;
use std::sync::mpsc::{Receiver, RecvTimeoutError};
use std::time::{Duration, Instant};

mod replies;

/// Size of unacknowledged outcomes above which the worker takes no more tasks [bytes].
const MOST_UNACKNOWLEDGED: usize = 64 << 20;
/// Pause after a reply with fewer tasks than requested, unless a notice ends it.
const QUEUE_EMPTY_PAUSE: Duration = Duration::from_secs(1);
/// Time limit for leaving.
const FAREWELL: Duration = Duration::from_secs(5);
/// Margin over the timeout of a query, after which Zenoh must have ended it.
const QUERY_MARGIN: Duration = Duration::from_secs(5);
/// Longest wait for an event.
const POLL_INTERVAL: Duration = Duration::from_millis(500);

/// State of the claims to one coordinator.
pub(super) struct ClaimLoop {
    config: ServiceConfig,
    worker: WorkerId,
    /// Index of the coordinator.
    coordinator: usize,
    link: Link,
    slots: Arc<Slots>,
    /// Tasks running or waiting for a slot, with the time of their arrival.
    running: Vec<(Task, Instant)>,
    unacknowledged: UnacknowledgedResults,
    prefetch: PrefetchEstimator,
    sequence: u64,
    pending: Option<PendingClaim>,
    /// Time of the next claim for free slots.
    claim_at: Instant,
    /// No claim is sent before this time.
    silent_until: Instant,
    backoff: Backoff,
    monitor: ConnectionMonitor,
    leave_policy: LeavePolicy,
    contact: LicenceContact,
    campaign: OwnCampaign,
    /// A claim is due whatever the free slots: tasks were returned, or the campaign has ended.
    must_claim: bool,
    refused_notices: Refused,
    leaving_since: Option<Instant>,
    /// A claim with the flag `leaving` was answered.
    farewell_answered: bool,
}

/// A claim without reply so far.
struct PendingClaim {
    /// Its sequence number.
    sequence: u64,
    /// Number of tasks it requests.
    credits: usize,
    /// Whether it announces that the worker leaves.
    leaving: bool,
    /// Time at which it was sent.
    since: Instant,
}

impl ClaimLoop {
    /// The claims to coordinator number `coordinator`.
    pub(crate) fn new(
        config: ServiceConfig,
        worker: WorkerId,
        coordinator: usize,
        link: Link,
        slots: Arc<Slots>,
        monitor: ConnectionMonitor,
        leave_policy: LeavePolicy,
    ) -> Self {
        let now = Instant::now();
        let backoff = Backoff::new(&worker);
        Self {
            config,
            worker,
            coordinator,
            link,
            slots,
            running: Vec::new(),
            unacknowledged: UnacknowledgedResults::default(),
            prefetch: PrefetchEstimator::default(),
            sequence: 0,
            pending: None,
            claim_at: now,
            silent_until: now,
            backoff,
            monitor,
            leave_policy,
            contact: LicenceContact::default(),
            campaign: OwnCampaign::default(),
            must_claim: false,
            refused_notices: Refused::default(),
            leaving_since: None,
            farewell_answered: false,
        }
    }

    /// Runs until the worker leaves this coordinator.
    ///
    /// # Errors
    /// [`ServiceError`].
    pub(crate) fn run(mut self, inbox: &Receiver<ClaimEvent>) -> Result<Departure, ServiceError> {
        let departure = self.serve(inbox);
        self.slots.shares().stop_competing(self.coordinator);
        self.withdraw(|_| true);
        self.link.close();
        self.slots.simulator.on_campaign_ended();
        departure
    }

    fn serve(&mut self, inbox: &Receiver<ClaimEvent>) -> Result<Departure, ServiceError> {
        loop {
            let now = Instant::now();
            // Before a claim: after a pause of this process the coordinator may have given the licences to others.
            self.check_contact(now);
            self.claim_if_due(now)?;
            let wait = self.next_wake(now).saturating_duration_since(now);
            let mut next = match inbox.recv_timeout(wait) {
                Ok(event) => Some(event),
                Err(RecvTimeoutError::Timeout) => None,
                Err(RecvTimeoutError::Disconnected) => return Ok(Departure::Aborted),
            };
            // All waiting events are handled before the next claim, so that it carries all finished outcomes.
            while let Some(event) = next {
                if let Some(departure) = self.handle(event)? {
                    return Ok(departure);
                }
                next = inbox.try_recv().ok();
            }
            if let Some(departure) = self.check_time(Instant::now())? {
                return Ok(departure);
            }
        }
    }

    fn handle(&mut self, event: ClaimEvent) -> Result<Option<Departure>, ServiceError> {
        let now = Instant::now();
        match event {
            // Stopped because the worker is leaving, or without contact: the task goes to another worker.
            ClaimEvent::Finished(outcome) if self.contact.take_ended(&outcome, self.leaving_since) => {
                self.running.retain(|(task, _)| !task.same_work(&outcome.task));
                self.must_claim = true;
            }
            ClaimEvent::Finished(outcome) => {
                if let Some(at) = self.running.iter().position(|(task, _)| task.same_work(&outcome.task)) {
                    let (_, since) = self.running.swap_remove(at);
                    self.prefetch.task_ended(outcome.wall, now.saturating_duration_since(since));
                }
                self.unacknowledged.push(*outcome, now);
                self.claim_at = now;
            }
            ClaimEvent::Answer { sequence, frame } if self.is_pending(sequence) => {
                return self.on_reply(now, frame);
            }
            ClaimEvent::QueryEnded(sequence) if self.is_pending(sequence) => {
                self.on_no_reply(now, refusal::no_answer(now));
            }
            ClaimEvent::SlotFree | ClaimEvent::Answer { .. } | ClaimEvent::QueryEnded(_) => {}
            ClaimEvent::Notice(frame) => match wire::decode::<Notice>(&frame) {
                Ok(Notice::Batch { points, .. }) => {
                    tracing::debug!("the coordinator announces {} points", points.len());
                    (self.claim_at, self.silent_until) = (now, now);
                    // The points may include tasks whose outcomes wait here for a request.
                    self.unacknowledged.resend_all(now);
                }
                // Only the reply to a claim says that this worker may leave: anybody may send a notice.
                Ok(Notice::Ended { campaign }) if self.campaign.is(campaign) => {
                    (self.must_claim, self.claim_at, self.silent_until) = (true, now, now);
                }
                other => {
                    if let Some(count) = self.refused_notices.count() {
                        let why = other.err().map_or("it ends another study".to_owned(), |e| e.to_string());
                        tracing::warn!("a notice is refused ({count} so far): {why}");
                    }
                }
            },
            ClaimEvent::Stop => {
                self.leave_policy.request_stop(now);
                // Waiting tasks are returned at once for other workers.
                self.must_claim |= self.withdraw(|_| true) > 0;
            }
            ClaimEvent::Abort => return Ok(Some(Departure::Aborted)),
        }
        Ok(None)
    }

    fn is_pending(&self, sequence: u64) -> bool {
        self.pending.as_ref().is_some_and(|claim| claim.sequence == sequence)
    }

    /// Removes tasks that wait for a slot; returns their number.
    fn withdraw(&mut self, unwanted: impl Fn(&Task) -> bool) -> usize {
        if !self.running.iter().any(|(task, _)| unwanted(task)) {
            return 0;
        }
        let dropped = self.slots.withdraw(self.coordinator, unwanted);
        self.running.retain(|(task, _)| !dropped.iter().any(|other| other.same_work(task)));
        dropped.len()
    }

    fn on_no_reply(&mut self, now: Instant, reason: String) {
        let since = self.pending.take().map_or(now, |claim| claim.since);
        self.slots.shares().answered(self.coordinator, 0, now);
        self.monitor.on_failure(since, reason);
        self.unacknowledged.resend_all(now);
        let pause = self.backoff.next(self.sequence);
        (self.claim_at, self.silent_until) = (now + pause, now + pause);
    }

    /// True if the worker takes new tasks.
    fn accepts_tasks(&self) -> bool {
        !self.leave_policy.is_draining() && self.unacknowledged.bytes() <= MOST_UNACKNOWLEDGED
    }

    /// Number of tasks to request now.
    fn credits(&self, now: Instant) -> usize {
        let mut shares = self.slots.shares();
        if !self.accepts_tasks() || self.claim_at.max(self.silent_until) > now {
            shares.stop_competing(self.coordinator);
            return 0;
        }
        let prefetched = self.config.prefetch.max(self.prefetch.tasks(self.config.slots));
        shares.allowance(self.coordinator, self.slots.at_once + prefetched, now)
    }

    fn claim_if_due(&mut self, now: Instant) -> Result<(), ServiceError> {
        if self.pending.is_some() {
            return Ok(());
        }
        let credits = self.credits(now);
        if self.silent_until > now {
            return Ok(());
        }
        let leaving = self.leaving_since.is_some();
        let contact = self.contact.next_claim(self.running.len()).is_some_and(|due| due <= now);
        let must_report = (leaving && !self.farewell_answered) || self.must_claim || contact;
        if credits == 0 && !must_report && self.unacknowledged.next_due().is_none_or(|due| due > now) {
            return Ok(());
        }
        self.sequence += 1;
        self.must_claim = false;
        let running = self.running.iter().map(|(task, _)| task.key);
        let holding: Vec<TaskKey> = running.chain(self.unacknowledged.keys()).collect();
        let claim = Claim {
            worker: self.worker.clone(),
            sequence: self.sequence,
            offers: self.slots.simulator.offers(),
            slots: u32::try_from(self.config.slots).unwrap_or(u32::MAX),
            credits: u32::try_from(credits).unwrap_or(u32::MAX),
            holding,
            finished: self.unacknowledged.take_due(now),
            leaving,
        };
        let frame = wire::encode(&claim)?;
        self.slots.shares().request(self.coordinator, credits, now);
        self.pending = Some(PendingClaim { sequence: self.sequence, credits, leaving, since: now });
        if let Err(reason) = self.link.send_claim(self.sequence, frame) {
            self.on_no_reply(now, reason);
        }
        Ok(())
    }

    fn next_wake(&self, now: Instant) -> Instant {
        let idle = self.slots.shares().idle_for(now);
        let mut wake = now + POLL_INTERVAL;
        if self.pending.is_none() {
            let claim = Some(self.claim_at).filter(|at| self.accepts_tasks() && *at > now);
            let contact = self.contact.next_claim(self.running.len());
            let due = [claim, self.unacknowledged.next_due(), contact].into_iter().flatten().min();
            wake = due.map_or(wake, |due| wake.min(due.max(self.silent_until)));
        }
        self.leave_policy
            .next_check(now, self.prefetch.longest(), idle)
            .map_or(wake, |check| wake.min(check.max(now)))
    }

    /// Ends the running tasks that need licences if there is no contact.
    fn check_contact(&mut self, now: Instant) {
        if self.contact.is_lost(now, self.running.len()) {
            // The coordinator may give their licences to other workers.
            self.must_claim |= self.withdraw(|_| true) > 0;
            self.contact.end(self.running.drain(..).map(|(task, _)| task));
            self.slots.simulator.stop_jobs_of(self.coordinator);
        }
        self.limit_contact();
    }

    /// Gives the simulator the time at which it ends them if this process cannot.
    fn limit_contact(&mut self) {
        if let Some(until) = self.contact.new_limit(self.running.len()) {
            self.slots.simulator.limit_contact(self.coordinator, until);
        }
    }

    /// Checks timeouts, the leave policy and the connection.
    fn check_time(&mut self, now: Instant) -> Result<Option<Departure>, ServiceError> {
        let limit = self.config.answer_timeout + QUERY_MARGIN;
        if self.pending.as_ref().is_some_and(|claim| now.duration_since(claim.since) > limit) {
            self.on_no_reply(now, "the claim got no reply".into());
        }
        self.leave_policy.check(now, self.prefetch.longest(), self.slots.shares().idle_for(now));
        if self.leaving_since.is_none() && self.leave_policy.must_leave(now, self.running.len()) {
            self.leaving_since = Some(now);
            // Their time is over at all coordinators.
            if !self.running.is_empty() {
                self.slots.simulator.stop();
            }
        }
        if let Some(since) = self.leaving_since {
            // Outcomes not acknowledged by then belong to tasks the coordinator has not requested.
            let returned =
                self.farewell_answered && self.unacknowledged.next_due().is_none_or(|due| due > now);
            if returned || now.duration_since(since) > FAREWELL {
                return Ok(Some(self.leave_policy.departure(self.unacknowledged.len())));
            }
        }
        self.monitor.check(now)?;
        Ok(None)
    }
}
