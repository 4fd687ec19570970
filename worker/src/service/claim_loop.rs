//! The claims of a worker at one coordinator: what it asks for and hands in, and when. One claim is under way at a time,
//! so that the list of what it holds is exact and a lost reply is noticed by the coordinator.
//!
//! Three answers stay apart: work; "idle, ask again in T" (a notice ends the wait early); nothing, after which
//! the worker backs off, with a spread so that many workers do not come back at the same instant.

use super::claim_event::ClaimEvent;
use super::connection_monitor::ConnectionMonitor;
use super::leave_policy::LeavePolicy;
use super::link::Link;
use super::prefetch::PrefetchEstimator;
use super::slots::Slots;
use super::unacknowledged::UnacknowledgedResults;
use super::{Departure, Job, ServiceConfig, ServiceError};
use crate::log::refusal;
use common::wire::{self, Claim, Next, Notice, Reply, Task, TaskKey, WireError, WorkOrder, WorkerId};
use std::hash::{DefaultHasher, Hash, Hasher};
use std::sync::Arc;
use std::sync::mpsc::{Receiver, RecvTimeoutError};
use std::time::{Duration, Instant};

/// Outcomes that may wait for their acknowledgement before the worker takes no more tasks [bytes].
const MOST_HELD: usize = 64 << 20;
/// Pauses between claims that nobody answers: short enough that a restarted coordinator has its workers within a second.
const FIRST_BACKOFF: Duration = Duration::from_millis(50);
const LONGEST_BACKOFF: Duration = Duration::from_millis(400);
/// Pause after an answer with fewer tasks than asked for, unless a notice ends it.
const NO_MORE: Duration = Duration::from_secs(1);
/// How long leaving may take.
const FAREWELL: Duration = Duration::from_secs(5);
/// Beyond the timeout of the query, after which Zenoh itself has forgotten it.
const QUERY_MARGIN: Duration = Duration::from_secs(5);
/// Longest sleep.
const LOOK_UP: Duration = Duration::from_millis(500);

/// A claim under way.
struct PendingClaim {
    sequence: u64,
    credits: usize,
    leaving: bool,
    since: Instant,
}

/// See the module.
pub(super) struct ClaimLoop {
    config: ServiceConfig,
    worker: WorkerId,
    /// Which of the worker's coordinators this is.
    place: usize,
    link: Link,
    slots: Arc<Slots>,
    /// Tasks begun or waiting, and since when they are here.
    running: Vec<(Task, Instant)>,
    unacknowledged: UnacknowledgedResults,
    prefetch: PrefetchEstimator,
    sequence: u64,
    under_way: Option<PendingClaim>,
    /// When free slots ask again.
    ask_at: Instant,
    /// No claim before this, whatever there is to say.
    silent_until: Instant,
    backoff: Duration,
    monitor: ConnectionMonitor,
    leave_policy: LeavePolicy,
    /// Tasks were handed back, which the coordinator does not know yet.
    handed_back: bool,
    leaving_since: Option<Instant>,
    /// A claim that says the worker leaves was answered.
    said_farewell: bool,
}

impl ClaimLoop {
    pub fn new(
        config: ServiceConfig,
        worker: WorkerId,
        place: usize,
        link: Link,
        slots: Arc<Slots>,
        monitor: ConnectionMonitor,
        leave_policy: LeavePolicy,
    ) -> Self {
        let now = Instant::now();
        Self {
            config,
            worker,
            place,
            link,
            slots,
            running: Vec::new(),
            unacknowledged: UnacknowledgedResults::default(),
            prefetch: PrefetchEstimator::default(),
            sequence: 0,
            under_way: None,
            ask_at: now,
            silent_until: now,
            backoff: FIRST_BACKOFF,
            monitor,
            leave_policy,
            handed_back: false,
            leaving_since: None,
            said_farewell: false,
        }
    }

    /// Serves until the end.
    pub fn run(mut self, inbox: &Receiver<ClaimEvent>) -> Result<Departure, ServiceError> {
        let departure = self.serve(inbox);
        self.slots.shares().stop_competing(self.place);
        self.withdraw(|_| true);
        self.link.close();
        departure
    }

    fn serve(&mut self, inbox: &Receiver<ClaimEvent>) -> Result<Departure, ServiceError> {
        loop {
            let now = Instant::now();
            self.claim_if_due(now)?;
            let wait = self.next_wake(now).saturating_duration_since(now);
            let mut message = match inbox.recv_timeout(wait) {
                Ok(message) => Some(message),
                Err(RecvTimeoutError::Timeout) => None,
                Err(RecvTimeoutError::Disconnected) => return Ok(Departure::Aborted),
            };
            // Everything that is there already is heard before the next claim: outcomes travel together.
            while let Some(event) = message {
                if let Some(departure) = self.handle(event)? {
                    return Ok(departure);
                }
                message = inbox.try_recv().ok();
            }
            if let Some(departure) = self.check_time(Instant::now())? {
                return Ok(departure);
            }
        }
    }

    fn handle(&mut self, message: ClaimEvent) -> Result<Option<Departure>, ServiceError> {
        let now = Instant::now();
        match message {
            ClaimEvent::Finished(outcome) => {
                if let Some(at) = self.running.iter().position(|(task, _)| task.same_work(&outcome.task)) {
                    let (_, since) = self.running.swap_remove(at);
                    self.prefetch.task_ended(outcome.wall, now.saturating_duration_since(since));
                }
                self.unacknowledged.push(*outcome, now);
                self.ask_at = now;
            }
            ClaimEvent::SlotFree => {}
            ClaimEvent::Answer { sequence, frame } if self.is_under_way(sequence) => {
                return self.answered(now, frame);
            }
            ClaimEvent::QueryEnded { sequence } if self.is_under_way(sequence) => {
                self.unanswered(now, refusal::no_answer(now));
            }
            ClaimEvent::Answer { .. } | ClaimEvent::QueryEnded { .. } => {}
            ClaimEvent::Notice(frame) => match wire::decode::<Notice>(&frame) {
                Ok(Notice::Batch { points, .. }) => {
                    tracing::debug!("the coordinator announces {} points", points.len());
                    self.ask_at = now;
                    self.silent_until = now;
                    // What the coordinator did not know so far may be among them.
                    self.unacknowledged.resend_all(now);
                }
                Ok(Notice::Ended { .. }) => return Ok(self.campaign_ended(now)),
                Err(error) => tracing::warn!("a notice of the coordinator could not be read: {error}"),
            },
            ClaimEvent::Stop => {
                self.leave_policy.request_stop(now);
                // What waits for a slot others can do at once.
                self.handed_back |= self.withdraw(|_| true) > 0;
            }
            ClaimEvent::Abort => return Ok(Some(Departure::Aborted)),
        }
        Ok(None)
    }

    fn is_under_way(&self, sequence: u64) -> bool {
        self.under_way.as_ref().is_some_and(|claim| claim.sequence == sequence)
    }

    fn answered(
        &mut self,
        now: Instant,
        frame: Result<Vec<u8>, String>,
    ) -> Result<Option<Departure>, ServiceError> {
        let reply = match frame.map(|frame| wire::decode::<Reply>(&frame)) {
            Ok(Ok(reply)) => reply,
            Ok(Err(WireError::OtherVersion { theirs, ours })) => {
                let endpoint = self.config.connect[self.place].clone();
                return Err(ServiceError::OtherVersion { endpoint, theirs, ours });
            }
            Ok(Err(error)) => {
                tracing::warn!("an answer of the coordinator could not be read: {error}");
                self.unanswered(now, error.to_string());
                return Ok(None);
            }
            Err(reason) => {
                self.unanswered(now, reason);
                return Ok(None);
            }
        };
        let Some(PendingClaim { credits, leaving, since, .. }) = self.under_way.take() else {
            return Ok(None);
        };
        self.said_farewell |= leaving;
        self.monitor.on_answer();
        self.backoff = FIRST_BACKOFF;
        self.unacknowledged.forget(&reply.acknowledged);
        // What others have done meanwhile need not be begun.
        self.withdraw(|task| reply.acknowledged.contains(&task.key));
        match reply.next {
            Next::Work(order) => {
                let got = order.tasks.len();
                self.prefetch.answered(now.saturating_duration_since(since));
                self.begin(order, now);
                // Fewer than asked for: there are no more for now; a notice tells when.
                self.ask_at = if got < credits { now + NO_MORE } else { now };
            }
            Next::Idle { ask_again } => {
                self.slots.shares().answered(self.place, 0, now);
                // One that was asked for nothing has not said that it has nothing.
                if credits > 0 {
                    self.ask_at = now + self.spread(Duration::from_millis(u64::from(ask_again)));
                }
            }
            Next::Leave => return Ok(self.campaign_ended(now)),
        }
        Ok(None)
    }

    /// Leaves, or waits for the next campaign there.
    fn campaign_ended(&mut self, now: Instant) -> Option<Departure> {
        if !self.config.next_campaign || self.leave_policy.is_draining() {
            return Some(Departure::CampaignEnded);
        }
        tracing::info!("the campaign at {} has ended", self.config.connect[self.place]);
        self.under_way = None;
        self.slots.shares().answered(self.place, 0, now);
        self.withdraw(|_| true);
        self.unacknowledged = UnacknowledgedResults::default();
        (self.ask_at, self.silent_until) = (now + NO_MORE, now + NO_MORE);
        None
    }

    fn begin(&mut self, mut order: WorkOrder, now: Instant) {
        let mut tasks = std::mem::take(&mut order.tasks);
        tasks.retain(|task| {
            let runs = self.running.iter().any(|(other, _)| other.same_work(task));
            !(runs || self.unacknowledged.resend_if_held(task, now))
        });
        // What arrives after the decision to leave is handed back.
        if self.leaving_since.is_some() {
            tasks.clear();
        }
        self.slots.shares().answered(self.place, tasks.len(), now);
        let order = Arc::new(order);
        for task in tasks {
            self.running.push((task.clone(), now));
            self.slots.start_job(Job { order: Arc::clone(&order), task, place: self.place });
        }
    }

    /// Drops tasks that wait for a slot; how many.
    fn withdraw(&mut self, unwanted: impl Fn(&Task) -> bool) -> usize {
        if !self.running.iter().any(|(task, _)| unwanted(task)) {
            return 0;
        }
        let dropped = self.slots.withdraw(self.place, unwanted);
        self.running.retain(|(task, _)| !dropped.iter().any(|other| other.same_work(task)));
        dropped.len()
    }

    fn unanswered(&mut self, now: Instant, reason: String) {
        let since = self.under_way.take().map_or(now, |claim| claim.since);
        self.slots.shares().answered(self.place, 0, now);
        self.monitor.on_failure(since, reason);
        self.unacknowledged.resend_all(now);
        let pause = self.spread(self.backoff);
        self.backoff = (2 * self.backoff).min(LONGEST_BACKOFF);
        self.ask_at = now + pause;
        self.silent_until = now + pause;
    }

    /// `pause` less up to a quarter, differently for each worker and claim.
    fn spread(&self, pause: Duration) -> Duration {
        let mut hasher = DefaultHasher::new();
        (&self.worker, self.sequence).hash(&mut hasher);
        let share = (hasher.finish() % 1024) as f64 / 1024.0;
        pause.mul_f64(1.0 - 0.25 * share)
    }

    /// Whether it takes tasks at all.
    fn takes_tasks(&self) -> bool {
        !self.leave_policy.is_draining() && self.unacknowledged.bytes() <= MOST_HELD
    }

    /// How many tasks to ask for now.
    fn credits(&self, now: Instant) -> usize {
        let shares = self.slots.shares();
        if !self.takes_tasks() || self.ask_at.max(self.silent_until) > now {
            shares.stop_competing(self.place);
            return 0;
        }
        let reserve = self.config.prefetch.max(self.prefetch.reserve(self.config.slots));
        shares.allowance(self.place, self.slots.at_once() + reserve, now)
    }

    fn claim_if_due(&mut self, now: Instant) -> Result<(), ServiceError> {
        if self.under_way.is_some() {
            return Ok(());
        }
        let credits = self.credits(now);
        if self.silent_until > now {
            return Ok(());
        }
        let leaving = self.leaving_since.is_some();
        let tells = (leaving && !self.said_farewell) || self.handed_back;
        if credits == 0 && !tells && self.unacknowledged.next_due().is_none_or(|due| due > now) {
            return Ok(());
        }
        self.sequence += 1;
        self.handed_back = false;
        let running = self.running.iter().map(|(task, _)| task.key);
        let holding: Vec<TaskKey> = running.chain(self.unacknowledged.keys()).collect();
        let claim = Claim {
            worker: self.worker.clone(),
            sequence: self.sequence,
            slots: as_u32(self.config.slots),
            credits: as_u32(credits),
            holding,
            finished: self.unacknowledged.offer(now),
            leaving,
        };
        let frame = wire::encode(&claim).map_err(|e| ServiceError::Messaging(format!("a claim: {e}")))?;
        self.slots.shares().ask(self.place, credits, now);
        self.under_way = Some(PendingClaim { sequence: self.sequence, credits, leaving, since: now });
        if let Err(reason) = self.link.ask(self.sequence, frame) {
            self.unanswered(now, reason);
        }
        Ok(())
    }

    fn next_wake(&self, now: Instant) -> Instant {
        let idle = self.slots.shares().idle_for(now);
        let mut wake = now + LOOK_UP;
        if self.under_way.is_none() {
            let ask = Some(self.ask_at).filter(|at| self.takes_tasks() && *at > now);
            let due = [ask, self.unacknowledged.next_due()].into_iter().flatten().min();
            wake = due.map_or(wake, |due| wake.min(due.max(self.silent_until)));
        }
        self.leave_policy
            .next_look(now, self.prefetch.longest(), idle)
            .map_or(wake, |look| wake.min(look.max(now)))
    }

    /// What the clock alone brings about.
    fn check_time(&mut self, now: Instant) -> Result<Option<Departure>, ServiceError> {
        let patience = self.config.answer_timeout + QUERY_MARGIN;
        if self.under_way.as_ref().is_some_and(|claim| now.duration_since(claim.since) > patience) {
            self.unanswered(now, "the claim was forgotten".into());
        }
        self.leave_policy.check(now, self.prefetch.longest(), self.slots.shares().idle_for(now));
        if self.leaving_since.is_none() && self.leave_policy.is_over(now, self.running.len()) {
            self.leaving_since = Some(now);
        }
        if let Some(since) = self.leaving_since {
            // What the coordinator has not taken by then (outcomes it does not know of) it will not take.
            let handed_in = self.said_farewell && self.unacknowledged.next_due().is_none_or(|due| due > now);
            if handed_in || now.duration_since(since) > FAREWELL {
                return Ok(Some(self.leave_policy.departure(self.unacknowledged.len())));
            }
        }
        self.monitor.check(now)?;
        Ok(None)
    }
}

fn as_u32(count: usize) -> u32 {
    u32::try_from(count).unwrap_or(u32::MAX)
}
