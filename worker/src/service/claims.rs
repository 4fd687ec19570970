//! The claims of a worker: what it asks for and hands in, and when. One claim is under way at a time, so that
//! the list of what it holds is exact and a lost reply is noticed by the coordinator.
//!
//! Three answers stay apart: work; "idle, ask again in T" (a notice ends the wait early); nothing, after which
//! the worker backs off, with a spread so that many workers do not come back at the same instant.

use super::held::Held;
use super::link::Link;
use super::patience::Patience;
use super::slots::Slots;
use super::{Departure, Job, ServiceConfig, ServiceError};
use crate::log::refusal;
use common::wire::{
    self, Claim, Next, Notice, Outcome, Reply, Task, TaskKey, WireError, WorkOrder, WorkerId,
};
use std::hash::{DefaultHasher, Hash, Hasher};
use std::sync::Arc;
use std::sync::mpsc::{Receiver, RecvTimeoutError};
use std::time::{Duration, Instant};

/// Outcomes that may wait for their acknowledgement before the worker takes no more tasks [bytes].
const MOST_HELD: usize = 64 << 20;
/// Pauses between claims that nobody answers.
const FIRST_BACKOFF: Duration = Duration::from_millis(50);
const LONGEST_BACKOFF: Duration = Duration::from_secs(1);
/// How long leaving may take.
const FAREWELL: Duration = Duration::from_secs(5);
/// Beyond the timeout of the query, after which Zenoh itself has forgotten it.
const QUERY_MARGIN: Duration = Duration::from_secs(5);

/// What reaches the claims.
#[derive(Debug)]
pub(super) enum Inbox {
    /// A slot has finished a task.
    Finished(Box<Outcome>),
    /// The coordinator's answer to a claim, or why it could not read it.
    Answer {
        /// Number of the claim.
        sequence: u64,
        /// Frame of the reply.
        frame: Result<Vec<u8>, String>,
    },
    /// No more answers to this claim will come.
    QueryEnded {
        /// Number of the claim.
        sequence: u64,
    },
    /// Frame of a notice.
    Notice(Vec<u8>),
    /// Hand in and leave.
    Stop,
    /// Leave at once.
    Abort,
}

/// A claim under way.
struct UnderWay {
    sequence: u64,
    credits: usize,
    leaving: bool,
    since: Instant,
}

/// See the module.
pub(super) struct Claims {
    config: ServiceConfig,
    worker: WorkerId,
    link: Link,
    slots: Slots,
    running: Vec<Task>,
    held: Held,
    sequence: u64,
    under_way: Option<UnderWay>,
    /// When free slots ask again.
    ask_at: Instant,
    /// No claim before this, whatever there is to say.
    silent_until: Instant,
    backoff: Duration,
    patience: Patience,
    leaving_since: Option<Instant>,
    /// A claim that says the worker leaves was answered.
    said_farewell: bool,
}

impl Claims {
    pub fn new(
        config: ServiceConfig,
        worker: WorkerId,
        link: Link,
        slots: Slots,
        patience: Patience,
    ) -> Self {
        let now = Instant::now();
        Self {
            config,
            worker,
            link,
            slots,
            running: Vec::new(),
            held: Held::default(),
            sequence: 0,
            under_way: None,
            ask_at: now,
            silent_until: now,
            backoff: FIRST_BACKOFF,
            patience,
            leaving_since: None,
            said_farewell: false,
        }
    }

    /// Serves until the end.
    pub fn run(mut self, inbox: &Receiver<Inbox>) -> Result<Departure, ServiceError> {
        let departure = self.serve(inbox);
        self.link.close();
        departure
    }

    fn serve(&mut self, inbox: &Receiver<Inbox>) -> Result<Departure, ServiceError> {
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
            while let Some(heard) = message {
                if let Some(departure) = self.hear(heard)? {
                    return Ok(departure);
                }
                message = inbox.try_recv().ok();
            }
            if let Some(departure) = self.check_time(Instant::now())? {
                return Ok(departure);
            }
        }
    }

    fn hear(&mut self, message: Inbox) -> Result<Option<Departure>, ServiceError> {
        let now = Instant::now();
        match message {
            Inbox::Finished(outcome) => {
                self.running.retain(|task| !task.same_work(&outcome.task));
                self.held.push(*outcome, now);
                self.ask_at = now;
            }
            Inbox::Answer { sequence, frame } if self.is_under_way(sequence) => {
                return self.answered(now, frame);
            }
            Inbox::QueryEnded { sequence } if self.is_under_way(sequence) => {
                self.unanswered(now, refusal::no_answer(now));
            }
            Inbox::Answer { .. } | Inbox::QueryEnded { .. } => {}
            Inbox::Notice(frame) => match wire::decode::<Notice>(&frame) {
                Ok(Notice::Batch { points, .. }) => {
                    tracing::debug!("the coordinator announces {} points", points.len());
                    self.ask_at = now;
                    self.silent_until = now;
                    // What the coordinator did not know so far may be among them.
                    self.held.offer_again(now);
                }
                Ok(Notice::Ended { .. }) => return Ok(Some(Departure::CampaignEnded)),
                Err(error) => tracing::warn!("a notice of the coordinator could not be read: {error}"),
            },
            Inbox::Stop => self.leaving_since = self.leaving_since.or(Some(now)),
            Inbox::Abort => return Ok(Some(Departure::Aborted)),
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
                return Err(ServiceError::OtherVersion {
                    endpoint: self.config.connect.clone(),
                    theirs,
                    ours,
                });
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
        let Some(UnderWay { credits, leaving, .. }) = self.under_way.take() else { return Ok(None) };
        self.said_farewell |= leaving;
        self.patience.heard();
        self.backoff = FIRST_BACKOFF;
        self.held.forget(&reply.acknowledged);
        match reply.next {
            Next::Work(order) => {
                let got = order.tasks.len();
                self.begin(order, now);
                // Fewer than asked for: there are no more for now; a notice tells when.
                self.ask_at = if got < credits { now + LONGEST_BACKOFF } else { now };
            }
            Next::Idle { ask_again } => {
                self.ask_at = now + self.spread(Duration::from_millis(u64::from(ask_again)));
            }
            Next::Leave => return Ok(Some(Departure::CampaignEnded)),
        }
        Ok(None)
    }

    fn begin(&mut self, mut order: WorkOrder, now: Instant) {
        let tasks = std::mem::take(&mut order.tasks);
        let order = Arc::new(order);
        for task in tasks {
            let here = self.running.iter().any(|other| other.same_work(&task)) || self.held.has(&task, now);
            if !here {
                self.running.push(task.clone());
                if self.leaving_since.is_none() {
                    self.slots.start_job(Job { order: Arc::clone(&order), task });
                }
            }
        }
    }

    fn unanswered(&mut self, now: Instant, reason: String) {
        let since = self.under_way.take().map_or(now, |claim| claim.since);
        self.patience.failed(since, reason);
        self.held.offer_again(now);
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

    fn credits(&self) -> usize {
        if self.leaving_since.is_some() || self.held.bytes() > MOST_HELD {
            return 0;
        }
        (self.slots.at_once() + self.config.prefetch).saturating_sub(self.running.len())
    }

    /// When the next claim is due, if there is one to make.
    fn claim_due(&self) -> Option<Instant> {
        if self.under_way.is_some() {
            return None;
        }
        let ask = (self.credits() > 0).then_some(self.ask_at);
        let farewell = self.leaving_since.filter(|_| !self.said_farewell);
        let due = [ask, farewell, self.held.next_due()].into_iter().flatten().min()?;
        Some(due.max(self.silent_until))
    }

    fn claim_if_due(&mut self, now: Instant) -> Result<(), ServiceError> {
        if self.claim_due().is_none_or(|due| due > now) {
            return Ok(());
        }
        let credits = self.credits();
        self.sequence += 1;
        let holding: Vec<TaskKey> =
            self.running.iter().map(|task| task.key).chain(self.held.keys()).collect();
        let claim = Claim {
            worker: self.worker.clone(),
            sequence: self.sequence,
            slots: as_u32(self.config.slots),
            credits: as_u32(credits),
            holding,
            finished: self.held.offer(now),
            leaving: self.leaving_since.is_some(),
        };
        let frame = wire::encode(&claim).map_err(|e| ServiceError::Messaging(format!("a claim: {e}")))?;
        self.under_way = Some(UnderWay {
            sequence: self.sequence,
            credits,
            leaving: self.leaving_since.is_some(),
            since: now,
        });
        if let Err(reason) = self.link.ask(self.sequence, frame) {
            self.unanswered(now, reason);
        }
        Ok(())
    }

    fn next_wake(&self, now: Instant) -> Instant {
        let mut wake = now + Duration::from_secs(1);
        if let Some(due) = self.claim_due() {
            wake = wake.min(due);
        }
        wake
    }

    /// What the clock alone brings about.
    fn check_time(&mut self, now: Instant) -> Result<Option<Departure>, ServiceError> {
        let patience = self.config.answer_timeout + QUERY_MARGIN;
        if self.under_way.as_ref().is_some_and(|claim| now.duration_since(claim.since) > patience) {
            self.unanswered(now, "the claim was forgotten".into());
        }
        if let Some(since) = self.leaving_since {
            // What the coordinator has not taken by then (outcomes it does not know of) it will not take.
            let handed_in = self.said_farewell && self.held.next_due().is_none_or(|due| due > now);
            if handed_in || now.duration_since(since) > FAREWELL {
                return Ok(Some(Departure::Stopped { lost: self.held.len() }));
            }
        }
        self.patience.check(now)?;
        Ok(None)
    }
}

fn as_u32(count: usize) -> u32 {
    u32::try_from(count).unwrap_or(u32::MAX)
}
