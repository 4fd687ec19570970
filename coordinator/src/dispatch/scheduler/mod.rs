//! Who evaluates what: a pure state machine. No clock, no messages, no threads; events in, commands out.
//!
//! ```text
//! Submit -> queued -> leased -> delivered -> recorded (ended)
//!             ^          |
//!             +----------+  worker lost, reply lost, overdue
//! ```
//!
//! Rules it keeps, whatever is lost, doubled, late or out of order:
//! - Every task ends exactly once: one outcome delivered to the study, or given up with a reason.
//! - An outcome is acknowledged only when it is durable ([`Event::Recorded`]) or not wanted.
//! - An outcome of this campaign that nobody asked for yet is not acknowledged: after a restart the study asks
//!   for it again, and the worker still has it.
//! - A claim lists all its worker holds; a lease that is not in the list was lost on the way and goes back to
//!   the front of the queue.
//! - Tasks go only to workers whose liveliness token is seen: a death always has an event.

mod census;
mod event;
#[cfg(test)]
mod farm_tests;
mod tasks;
#[cfg(test)]
mod tests;
mod workers;

pub use census::Census;
pub use event::{Assignment, Command, Event, Token, Warning};

use crate::evaluate::Finished;
use common::wire::{Claim, Outcome, TaskKey, WorkerId};
use std::collections::{BTreeMap, BTreeSet};
use std::time::Duration;
use tasks::{Accepted, TaskTable};
use workers::Worker;

/// Constants of the scheduler.
#[derive(Debug, Clone, PartialEq)]
pub struct Settings {
    /// Campaign its tasks belong to.
    pub campaign: u64,
    /// Workers (or deadlines) a task may outlive before it is given up.
    pub losses_allowed: u32,
    /// Deadline of a task while no simulation has ended yet.
    pub first_deadline: Duration,
    /// Deadline as a multiple of the longest simulation seen.
    pub deadline_factor: f64,
    /// Deadline at least.
    pub shortest_deadline: Duration,
    /// How long tasks may wait without any worker before the user is told, and told that their number changed.
    pub unattended: Duration,
    /// When the user is told again although nothing changed.
    pub still_unattended: Duration,
    /// Most tasks in one reply.
    pub most_tasks: u32,
}

impl Settings {
    /// The usual constants.
    pub fn new(campaign: u64) -> Self {
        Self {
            campaign,
            losses_allowed: 3,
            first_deadline: Duration::from_secs(3600),
            deadline_factor: 10.0,
            shortest_deadline: Duration::from_secs(120),
            unattended: Duration::from_secs(5),
            still_unattended: Duration::from_secs(60),
            most_tasks: 1024,
        }
    }
}

/// Claims without a liveliness token until the user is told: a token may be a moment late.
const STRANGE_CLAIMS: u32 = 10;
/// Workers without a liveliness token that are remembered.
const STRANGERS: usize = 1000;

/// A claim whose reply waits until its outcomes are durable.
#[derive(Debug)]
struct Pending {
    worker: WorkerId,
    credits: u32,
    acknowledged: Vec<TaskKey>,
    waiting: BTreeSet<u64>,
}

/// Tasks wait and nobody is there.
#[derive(Debug)]
struct Unattended {
    since: Duration,
    /// When the user was told last, and of how many tasks.
    told: Option<(Duration, usize)>,
}

/// The state machine.
#[derive(Debug)]
pub struct Scheduler {
    settings: Settings,
    tasks: TaskTable,
    workers: BTreeMap<WorkerId, Worker>,
    pending: BTreeMap<Token, Pending>,
    strangers: BTreeMap<WorkerId, u32>,
    longest_wall: Option<f64>,
    unattended: Option<Unattended>,
    finishing: bool,
}

impl Scheduler {
    /// Nothing to do, nobody there.
    pub fn new(settings: Settings) -> Self {
        Self {
            tasks: TaskTable::new(settings.campaign),
            settings,
            workers: BTreeMap::new(),
            pending: BTreeMap::new(),
            strangers: BTreeMap::new(),
            longest_wall: None,
            unattended: None,
            finishing: false,
        }
    }

    /// Takes one event at time `now` (since any fixed moment) and says what is to be done about it.
    pub fn on_event(&mut self, now: Duration, event: Event) -> Vec<Command> {
        let mut commands = Vec::new();
        match event {
            Event::Submit(requests) => {
                let points = requests.into_iter().filter_map(|request| self.tasks.submit(request)).collect();
                commands.push(Command::Announce(points));
            }
            Event::Appeared(worker) => {
                self.strangers.remove(&worker);
                self.workers.entry(worker).or_default();
            }
            Event::Gone(worker) => self.lose(worker, &mut commands),
            Event::Claimed { token, claim } => self.claimed(now, token, claim, &mut commands),
            Event::Recorded { task } => self.recorded(now, task, &mut commands),
            Event::Cancel => self.cancel(now, &mut commands),
            Event::Finish => {
                self.finishing = true;
                commands.push(Command::AnnounceEnd);
                self.cancel(now, &mut commands);
            }
            Event::Tick => {
                self.check_deadlines(now, &mut commands);
                self.check_attendance(now, &mut commands);
            }
        }
        commands
    }

    /// Workers that are there and the slots they have said to have (0 until their first claim).
    pub fn workers(&self) -> impl Iterator<Item = (&WorkerId, u32)> + Clone {
        self.workers.iter().map(|(id, worker)| (id, worker.slots))
    }

    /// Tasks submitted that have not ended.
    pub fn open(&self) -> usize {
        self.tasks.open()
    }

    /// How long a task may take at a worker of one slot per lease.
    fn deadline(&self) -> Duration {
        match self.longest_wall {
            None => self.settings.first_deadline,
            Some(wall) => Duration::try_from_secs_f64(wall * self.settings.deadline_factor)
                .unwrap_or(Duration::MAX)
                .max(self.settings.shortest_deadline),
        }
    }

    fn claimed(&mut self, now: Duration, token: Token, claim: Claim, commands: &mut Vec<Command>) {
        let Claim { worker: id, sequence, slots, credits, holding, finished, leaving } = claim;
        let campaign = self.settings.campaign;
        let held = holding.into_iter().chain(finished.iter().map(|outcome| outcome.task.key));
        let kept: BTreeSet<u64> = held.filter(|key| key.campaign == campaign).map(|key| key.task).collect();

        // Outcomes first: whoever brings them, they count.
        let mut pending =
            Pending { worker: id.clone(), credits, acknowledged: Vec::new(), waiting: BTreeSet::new() };
        for outcome in finished {
            self.take(outcome, &mut pending, commands);
        }

        // Then what the worker is believed to hold and does not.
        let strange = !self.workers.contains_key(&id);
        if strange {
            pending.credits = 0;
            self.note_stranger(&id, commands);
        }
        if let Some(worker) = self.workers.get_mut(&id) {
            worker.slots = slots;
            if worker.last_sequence.is_some_and(|last| sequence <= last) {
                pending.credits = 0;
            } else {
                worker.last_sequence = Some(sequence);
                let lost: Vec<u64> =
                    worker.leases.keys().filter(|t| leaving || !kept.contains(t)).copied().collect();
                for task in &lost {
                    worker.leases.remove(task);
                }
                // An answer that still waits would reach a worker that no longer listens to it.
                for older in self.pending.values_mut().filter(|p| p.worker == id) {
                    older.credits = 0;
                }
                self.requeue(lost, commands);
            }
        }
        if leaving {
            pending.credits = 0;
        }
        self.pending.insert(token, pending);
        self.answer_if_ready(now, token, commands);
    }

    /// Sorts one outcome: acknowledge now, deliver and acknowledge when durable, or leave it with the worker.
    fn take(&mut self, outcome: Outcome, pending: &mut Pending, commands: &mut Vec<Command>) {
        let Outcome { task, worker, wall, result } = outcome;
        let key = task.key;
        match self.tasks.accept(&task) {
            Accepted::NotWanted => pending.acknowledged.push(key),
            Accepted::OtherSample => {
                pending.acknowledged.push(key);
                commands.push(Command::Warn(Warning::OtherSample {
                    worker: pending.worker.clone(),
                    task: key.task,
                }));
            }
            Accepted::NotAskedYet => {}
            Accepted::OnItsWay => {
                pending.waiting.insert(key.task);
            }
            Accepted::First => {
                pending.waiting.insert(key.task);
                self.longest_wall = Some(self.longest_wall.map_or(wall, |longest| longest.max(wall)));
                for other in self.workers.values_mut() {
                    other.leases.remove(&key.task);
                }
                commands.push(Command::Deliver(Box::new(Finished {
                    id: key.task,
                    outcome: result,
                    worker,
                    wall,
                })));
            }
        }
    }

    fn recorded(&mut self, now: Duration, task: u64, commands: &mut Vec<Command>) {
        if !self.tasks.end(task) {
            return;
        }
        let key = TaskKey { campaign: self.settings.campaign, task };
        let mut touched = Vec::new();
        for (&token, pending) in &mut self.pending {
            if pending.waiting.remove(&task) {
                pending.acknowledged.push(key);
                touched.push(token);
            }
        }
        for token in touched {
            self.answer_if_ready(now, token, commands);
        }
    }

    fn answer_if_ready(&mut self, now: Duration, token: Token, commands: &mut Vec<Command>) {
        if self.pending.get(&token).is_none_or(|pending| !pending.waiting.is_empty()) {
            return;
        }
        let Some(Pending { worker: id, credits, acknowledged, .. }) = self.pending.remove(&token) else {
            return;
        };
        let share = workers::share(&self.workers, &id, self.tasks.open());
        let assignment = match self.workers.get_mut(&id) {
            _ if self.finishing => Assignment::Leave,
            // Lost since it asked: what it would get would be lost too.
            None => Assignment::Idle,
            Some(worker) => {
                let room = share.saturating_sub(worker.leases.len());
                let tasks = self.tasks.lease(room.min(credits.min(self.settings.most_tasks) as usize));
                worker.leases.extend(tasks.iter().map(|task| (task.key.task, now)));
                if tasks.is_empty() { Assignment::Idle } else { Assignment::Work(tasks) }
            }
        };
        commands.push(Command::Reply { token, acknowledged, assignment });
    }

    fn lose(&mut self, id: WorkerId, commands: &mut Vec<Command>) {
        let Some(worker) = self.workers.remove(&id) else { return };
        let tasks: Vec<u64> = worker.leases.into_keys().collect();
        if tasks.is_empty() {
            return;
        }
        commands.push(Command::Warn(Warning::WorkerLost { worker: id, tasks: tasks.clone() }));
        self.count_losses(tasks, "workers were lost while they had it", commands);
    }

    /// Back to the queue, or given up where it was lost too often.
    fn count_losses(&mut self, tasks: Vec<u64>, what: &str, commands: &mut Vec<Command>) {
        let mut again = Vec::new();
        for task in tasks {
            match self.tasks.count_loss(task) {
                Some(losses) if losses >= self.settings.losses_allowed => {
                    self.tasks.end(task);
                    // Another worker may still have it from an earlier deadline.
                    for worker in self.workers.values_mut() {
                        worker.leases.remove(&task);
                    }
                    commands.push(Command::GiveUp { task, reason: format!("{losses} {what}") });
                }
                Some(_) => again.push(task),
                None => {}
            }
        }
        self.requeue(again, commands);
    }

    /// Back to the front of the queue, in the order of their numbers; idle workers are told.
    fn requeue(&mut self, tasks: Vec<u64>, commands: &mut Vec<Command>) {
        let points: Vec<_> = tasks.into_iter().rev().filter_map(|task| self.tasks.requeue(task)).collect();
        if !points.is_empty() {
            commands.push(Command::Announce(points));
        }
    }

    fn cancel(&mut self, now: Duration, commands: &mut Vec<Command>) {
        self.tasks.clear();
        for worker in self.workers.values_mut() {
            worker.leases.clear();
        }
        // Outcomes that were not recorded stay with their workers.
        for pending in self.pending.values_mut() {
            pending.waiting.clear();
        }
        let tokens: Vec<Token> = self.pending.keys().copied().collect();
        for token in tokens {
            self.answer_if_ready(now, token, commands);
        }
    }

    fn check_deadlines(&mut self, now: Duration, commands: &mut Vec<Command>) {
        let deadline = self.deadline();
        let mut overdue = Vec::new();
        for (id, worker) in &mut self.workers {
            // A worker that took more than its slots can do at once works them off one after the other.
            let turns = worker.leases.len().div_ceil(worker.slots.max(1) as usize);
            let allowed = deadline.saturating_mul(u32::try_from(turns).unwrap_or(u32::MAX));
            worker.leases.retain(|&task, &mut since| {
                let after = now.saturating_sub(since);
                if after > allowed {
                    overdue.push(task);
                    commands.push(Command::Warn(Warning::Overdue { worker: id.clone(), task, after }));
                }
                after <= allowed
            });
        }
        self.count_losses(overdue, "deadlines have passed", commands);
    }

    fn check_attendance(&mut self, now: Duration, commands: &mut Vec<Command>) {
        let open = self.tasks.open();
        if !self.workers.is_empty() || open == 0 {
            self.unattended = None;
            return;
        }
        let Unattended { since, told } = self.unattended.get_or_insert(Unattended { since: now, told: None });
        let (last, patience) = match *told {
            Some((last, of)) if of == open => (last, self.settings.still_unattended),
            Some((last, _)) => (last, self.settings.unattended),
            None => (*since, self.settings.unattended),
        };
        if now.saturating_sub(last) >= patience {
            *told = Some((now, open));
            commands.push(Command::Warn(Warning::NoWorker { open, since: now.saturating_sub(*since) }));
        }
    }

    fn note_stranger(&mut self, id: &WorkerId, commands: &mut Vec<Command>) {
        if self.strangers.len() >= STRANGERS && !self.strangers.contains_key(id) {
            return;
        }
        let claims = self.strangers.entry(id.clone()).or_default();
        *claims = claims.saturating_add(1);
        if *claims == STRANGE_CLAIMS {
            commands.push(Command::Warn(Warning::NoLiveliness { worker: id.clone() }));
        }
    }
}
