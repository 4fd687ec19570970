//! Assigns tasks to workers: a pure state machine without clock, messages and threads. Events in, actions out.
//!
//! ```text
//! Submit -> queued -> leased -> delivered -> recorded (ended)
//!             ^          |
//!             +----------+  its last worker was lost, the reply was lost, or the task is overdue
//! ```
//!
//! Invariants, for messages lost, duplicated, delayed or out of order:
//! - Every task ends exactly once: one outcome is delivered to the study, or the task is given up with a reason.
//! - An outcome is acknowledged only when it is durable ([`Event::Recorded`]) or not needed, or when it waits for that of another worker
//!   ([`CrossCheck`]): if it is lost with the coordinator, it is evaluated again.
//! - An outcome of this campaign that has not been requested yet is not acknowledged: after a restart the study requests
//!   it again, and the worker still holds it.
//! - A claim lists all tasks its worker holds. A lease missing from the list was lost in transit; its task returns to the
//!   front of the queue. A listed task leased by an earlier coordinator is adopted: no other worker gets it.
//! - Only workers with a liveliness token get tasks, so the loss of a worker always causes an event.
//! - Only workers that offer the subject of the campaign get tasks. One that reports its simulator as unusable gets no more;
//!   its task returns to the queue. If no worker is left, a task is given up with the report.
//! - With licences, no more tasks than there are licences run at once; a second worker for stragglers would take another
//!   licence, so there is none.
//! - A task that would be given up at its next loss goes only to workers that have finished a task, if any exist: the
//!   earlier losses may have been faults of the workers.
//! - A worker's share of the tasks follows its measured speed. If slots are idle and the queue is empty, a task that has
//!   been running much longer than usual goes to a second worker too; the first outcome counts.

mod cross_check;
#[cfg(test)]
mod cross_check_tests;
mod event;
#[cfg(test)]
mod farm_tests;
mod held_outcomes;
#[cfg(test)]
mod licences_tests;
mod losses;
mod pending_replies;
#[cfg(test)]
mod recovery_tests;
mod settings;
mod tasks;
#[cfg(test)]
mod tests;
mod worker_warnings;
mod workers;
#[cfg(test)]
mod workers_tests;

pub use event::{Action, Event, Token};
pub use held_outcomes::CrossCheck;
pub use losses::LICENCE_HOLD;
pub use settings::SchedulerSettings;

use crate::farm::evaluate::{Finished, Request};
use common::failure::SimulationFailure;
use common::wire::{CandidatePoint, Claim, FarmStatus, Offers, Outcome, TaskKey, WorkerId, WorkerStatus};
use held_outcomes::{HeldOutcomes, may_evaluate};
use pending_replies::{PendingReplies, PendingReply};
use std::collections::BTreeSet;
use std::time::Duration;
use tasks::{TaskStatus, TaskTable};
use worker_warnings::WorkerWarnings;
use workers::Workforce;

/// Most tasks in one reply.
const MOST_TASKS: u32 = 1024;

/// The state machine.
#[derive(Debug)]
pub struct Scheduler {
    settings: SchedulerSettings,
    tasks: TaskTable,
    workers: Workforce,
    pending_replies: PendingReplies,
    warnings: WorkerWarnings,
    /// Licences that programs of lost workers may still use: the worker, and until when each is held.
    held_licences: Vec<(WorkerId, Duration)>,
    held: HeldOutcomes,
    /// Time and text of the last report of an unusable simulator since a worker claimed tasks that offers the subject.
    unusable: Option<(Duration, String)>,
    longest_wall: Option<f64>,
    /// End of the time in which tasks wait for workers that return with running tasks; `None` before the first event.
    settled_at: Option<Duration>,
    /// `settled_at` has not passed: no task is leased, and queued tasks are announced again when it passes.
    unsettled: bool,
    finishing: bool,
    /// Time of the event that is handled, since any fixed moment.
    now: Duration,
    /// Actions of that event so far.
    actions: Vec<Action>,
}

impl Scheduler {
    /// A scheduler without tasks and workers.
    pub fn new(settings: SchedulerSettings) -> Self {
        Self {
            tasks: TaskTable::new(settings.campaign),
            unsettled: !settings.settle.is_zero(),
            settings,
            workers: Workforce::default(),
            pending_replies: PendingReplies::default(),
            warnings: WorkerWarnings::default(),
            held_licences: Vec::new(),
            held: HeldOutcomes::default(),
            unusable: None,
            longest_wall: None,
            settled_at: None,
            finishing: false,
            now: Duration::ZERO,
            actions: Vec::new(),
        }
    }

    /// Handles one event at time `now` (since any fixed moment); returns the actions to execute, in order.
    pub fn on_event(&mut self, now: Duration, event: Event) -> Vec<Action> {
        self.now = now;
        self.settled_at.get_or_insert(now + self.settings.settle);
        match event {
            Event::Submit(requests) => self.on_submit(requests),
            Event::WorkerJoined(worker) => {
                self.warnings.on_worker_joined(&worker);
                self.workers.add(worker);
            }
            Event::WorkerLost(worker) => self.on_worker_lost(worker),
            Event::Claimed(token, claim) => self.on_claim(token, claim),
            Event::Recorded(task) => self.on_recorded(task),
            Event::Cancel => self.on_cancel(),
            Event::Finish => {
                self.finishing = true;
                self.actions.push(Action::AnnounceEnd);
                self.on_cancel();
            }
            Event::Tick => {
                self.settle();
                self.check_deadlines();
                self.release_licences();
                self.check_held();
                self.give_up_unusable();
                let open = if self.workers.any_eligible() { 0 } else { self.tasks.open() };
                let warning = self.warnings.check_unattended(now, open);
                self.actions.extend(warning.map(Action::Warn));
            }
        }
        std::mem::take(&mut self.actions)
    }

    /// Gives a task up without an outcome.
    fn give_up(&mut self, task: u64, reason: String) {
        self.tasks.end(task);
        self.actions.push(Action::GiveUp(task, reason));
    }

    /// Announces these points, if there are any.
    fn warn(&mut self, warning: String) {
        self.actions.push(Action::Warn(warning));
    }

    fn announce(&mut self, points: Vec<CandidatePoint>) {
        self.actions.extend((!points.is_empty()).then_some(Action::Announce(points)));
    }

    /// Connected workers with their slots (0 until their first claim, and for workers that get no tasks).
    pub fn workers(&self) -> impl Iterator<Item = (&WorkerId, u32)> {
        self.workers.iter().map(|(id, worker)| (id, worker.usable_slots()))
    }

    /// Number that increases whenever [`Scheduler::workers`] changes.
    pub fn revision(&self) -> u64 {
        self.workers.revision
    }

    /// The workers and the queue now, without evaluations done and rates.
    pub fn status(&self) -> FarmStatus {
        let worker = |(id, worker): (&WorkerId, &workers::Worker)| WorkerStatus {
            name: id.name.clone(),
            slots: worker.usable_slots(),
            under_way: u32::try_from(worker.leases.len()).unwrap_or(u32::MAX),
            ..WorkerStatus::default()
        };
        let (queued, workers) = (self.tasks.waiting() as u64, self.workers.iter().map(worker).collect());
        let under_way = (self.tasks.open() as u64).saturating_sub(queued);
        FarmStatus { queued, under_way, rate: 0.0, workers }
    }

    fn on_submit(&mut self, requests: Vec<Request>) {
        let mut points = Vec::new();
        for request in requests {
            let task = request.id;
            let Some(point) = self.tasks.submit(request) else { continue };
            points.push(point);
            if let Some(holder) = self.workers.take_unrequested(task) {
                self.tasks.adopt(task);
                self.workers.lease(&holder, task, self.now);
            }
        }
        self.actions.push(Action::Announce(points));
    }

    /// Ends the settling time, once it is over: announces the queued tasks, so that idle workers claim again.
    fn settle(&mut self) {
        if self.unsettled && self.is_settled() {
            self.unsettled = false;
            self.announce(self.tasks.queued());
        }
    }

    fn is_settled(&self) -> bool {
        !self.unsettled || self.settled_at.is_some_and(|at| self.now >= at)
    }

    fn on_claim(&mut self, token: Token, claim: Claim) {
        let Claim { worker: id, sequence, offers, slots, credits, holding, finished, leaving } = claim;
        let offered = self.settings.admits(&offers);
        let campaign = self.settings.campaign;
        let of_campaign = |key: TaskKey| (key.campaign == campaign).then_some(key.task);
        let returned: BTreeSet<u64> =
            finished.iter().filter_map(|outcome| of_campaign(outcome.task.key)).collect();
        let mut running: BTreeSet<u64> = holding.into_iter().filter_map(of_campaign).collect();
        let kept = &running | &returned;
        running.retain(|task| !returned.contains(task));

        // Outcomes first: they count whichever worker returns them.
        let (acknowledged, waiting) = Default::default();
        let mut pending = PendingReply { worker: id.clone(), credits, acknowledged, waiting };
        for mut outcome in finished {
            if let (None, Offers::Scenes(build)) = (self.settings.build, &offers) {
                outcome.worker = format!("{} (build {build})", outcome.worker);
            }
            self.on_outcome(outcome, &mut pending);
        }

        // Then the leases missing from the claim, and the tasks in the claim without a lease.
        if leaving || !offered {
            pending.credits = 0;
        }
        if self.workers.get(&id).is_none() {
            pending.credits = 0;
            self.extend_licences(&id);
            self.actions.extend(self.warnings.on_claim_without_token(&id).map(Action::Warn));
        } else if self.workers.register_claim(&id, sequence, slots, offered) {
            if !offered {
                self.actions.extend(
                    self.warnings.on_claim_without_subject(&id, &offers, &self.settings).map(Action::Warn),
                );
            }
            let lost = self.workers.missing_leases(&id, &kept, leaving);
            self.account_for_licences(&id, leaving, &running);
            self.workers.forget_dropped(&id, &kept);
            let free = lost.into_iter().filter(|task| !self.workers.release(&id, *task)).collect();
            self.pending_replies.withdraw_credits(&id);
            self.requeue(free);
            if !leaving {
                self.adopt(&id, &kept, &mut pending);
            }
        } else {
            pending.credits = 0;
            self.actions.extend(self.warnings.on_outdated_claim(&id).map(Action::Warn));
        }
        self.pending_replies.add(token, pending);
        self.answer_if_ready(token);
    }

    /// Adopts the tasks that a worker holds without a lease; acknowledges those that have ended.
    fn adopt(&mut self, id: &WorkerId, kept: &BTreeSet<u64>, pending: &mut PendingReply) {
        let mut unrequested = Vec::new();
        for &task in kept {
            match self.tasks.status(task) {
                // Its own outcome waits here for that of another worker.
                TaskStatus::Open if self.held.has(task, id) => {}
                TaskStatus::Open if self.workers.is_unknown_task(id, task) => {
                    self.tasks.adopt(task);
                    self.tasks.withdraw_loss(task, id);
                    self.workers.lease(id, task, self.now);
                }
                TaskStatus::Open | TaskStatus::Delivered => {}
                TaskStatus::Ended => {
                    let key = TaskKey { campaign: self.settings.campaign, task };
                    if !pending.acknowledged.contains(&key) {
                        pending.acknowledged.push(key);
                    }
                }
                TaskStatus::NotRequested => unrequested.push(task),
            }
        }
        self.workers.set_unrequested(id, &unrequested);
    }

    /// Handles one outcome: acknowledges it now, delivers it and acknowledges it when durable, or leaves it with the
    /// worker.
    fn on_outcome(&mut self, outcome: Outcome, pending: &mut PendingReply) {
        let Outcome { task, worker, wall, result } = outcome;
        let key = task.key;
        if let Err(SimulationFailure::SimulatorUnusable { reason }) = result {
            pending.acknowledged.push(key);
            self.on_unusable(&pending.worker, key, reason);
            return;
        }
        match self.tasks.status(key.task) {
            _ if key.campaign != self.settings.campaign => {
                pending.acknowledged.push(key);
                self.actions.extend(self.warnings.on_other_campaign(&pending.worker).map(Action::Warn));
            }
            TaskStatus::Ended => pending.acknowledged.push(key),
            TaskStatus::NotRequested => {}
            _ if !self.tasks.has_work(&task) => {
                pending.acknowledged.push(key);
                let (name, task) = (&pending.worker.name, key.task);
                self.warn(format!(
                    "worker {name} returned an outcome of another sample as evaluation {task}; it is not used"
                ));
            }
            TaskStatus::Delivered => {
                pending.waiting.insert(key.task);
            }
            // The first outcome, which counts.
            TaskStatus::Open => {
                self.tasks.set_delivered(key.task);
                self.longest_wall = Some(self.longest_wall.map_or(wall, |longest| longest.max(wall)));
                self.workers.record_evaluation(&pending.worker, key.task, wall, self.now);
                self.workers.release_from_all(key.task);
                let finished = Finished { id: key.task, outcome: result, worker, wall };
                let id = pending.worker.clone();
                match self.deliver_checked(&id, finished) {
                    true if self.tasks.status(key.task) == TaskStatus::Delivered => {
                        pending.waiting.insert(key.task);
                    }
                    _ => pending.acknowledged.push(key),
                }
            }
        }
    }

    fn on_recorded(&mut self, task: u64) {
        if !self.tasks.end(task) {
            return;
        }
        let key = TaskKey { campaign: self.settings.campaign, task };
        for token in self.pending_replies.recorded(key) {
            self.answer_if_ready(token);
        }
    }

    fn answer_if_ready(&mut self, token: Token) {
        let Some(PendingReply { worker: id, credits, acknowledged, .. }) =
            self.pending_replies.take_ready(token)
        else {
            return;
        };
        let tasks = match self.workers.get(&id).map(|worker| worker.leases.len()) {
            _ if self.finishing => None,
            // The worker was lost after its claim; tasks sent to it would be lost too.
            None => Some(vec![]),
            Some(_) if !self.is_settled() => Some(vec![]),
            Some(leased) => {
                let room = self.workers.share(&id, self.tasks.open()).saturating_sub(leased);
                let room = room.min(self.licences_for(&id));
                let wanted = room.min(credits.min(MOST_TASKS) as usize);
                let losses = self.losses_bound(&id);
                let (held, workers) = (&self.held, &self.workers);
                let is_open = |request: &Request| {
                    !held.has(request.id, &id) && may_evaluate(&request.not_by, &id, workers)
                };
                let mut tasks = self.tasks.lease(wanted, losses, is_open);
                if tasks.len() < wanted && self.settings.licences.is_none() {
                    let late = self.workers.stragglers(&id, self.now, self.settings.straggler_factor);
                    let late = late.filter(|task| !held.has(*task, &id));
                    let copies = late.filter_map(|task| self.tasks.copy(task, losses));
                    tasks.extend(copies.take(wanted - tasks.len()));
                }
                for task in &tasks {
                    self.workers.lease(&id, task.key.task, self.now);
                }
                Some(tasks)
            }
        };
        self.actions.push(Action::Reply(token, acknowledged, tasks));
    }

    /// Bound on the losses of a task that may go to this worker (exclusive).
    fn losses_bound(&self, id: &WorkerId) -> u32 {
        let last_chance = self.settings.losses_allowed.saturating_sub(1).max(1);
        if self.workers.has_finished(id) || !self.workers.any_has_finished() { u32::MAX } else { last_chance }
    }

    fn on_cancel(&mut self) {
        self.tasks.clear();
        self.held.by_task.clear();
        self.hold_all_licences();
        self.workers.release_everything();
        // Outcomes that are not durable stay with their workers.
        for token in self.pending_replies.give_up_waiting() {
            self.answer_if_ready(token);
        }
    }
}
