//! The workers whose liveliness token is there: what each has, how fast each is, and how much of the work each may have.

use common::wire::WorkerId;
use std::collections::{BTreeMap, BTreeSet};
use std::time::Duration;

/// Weight of the newest evaluation in the mean time of a worker's evaluations.
const NEWEST_WALL: f64 = 0.2;
/// Weight of the newest task in the mean time from lease to outcome.
const NEWEST_TURNAROUND: f64 = 0.1;
/// An evaluation counts as at least so long [s]: a clock that stands still must not make anybody infinitely fast.
const SHORTEST_WALL: f64 = 1e-6;

/// A worker that is there.
#[derive(Debug, Default)]
pub(super) struct Worker {
    /// Slots it has said to have; 0 until its first claim.
    pub slots: u32,
    /// Number of its last claim.
    pub last_sequence: Option<u64>,
    /// Tasks it has, and since when.
    leases: BTreeMap<u64, Duration>,
    /// Tasks taken from it because it had them for too long; it may still say that it has them.
    overdue: BTreeSet<u64>,
    /// Mean time of a slot that its evaluations took lately [s].
    wall: Option<f64>,
}

impl Worker {
    /// How many tasks it has.
    pub fn leased(&self) -> usize {
        self.leases.len()
    }

    fn threads(&self) -> f64 {
        f64::from(self.slots.max(1))
    }

    /// Its threads and the time an evaluation takes one of them.
    fn strength(&self) -> (f64, Option<f64>) {
        (self.threads(), self.wall)
    }
}

/// All workers and who has what. A task may be at several.
#[derive(Debug, Default)]
pub(super) struct Workforce {
    workers: BTreeMap<WorkerId, Worker>,
    /// Who has a task.
    holders: BTreeMap<u64, Vec<WorkerId>>,
    /// Tasks that one worker alone has, the longest first.
    alone: BTreeSet<(Duration, u64)>,
    /// Tasks that workers say to have and nobody has asked for so far.
    unrequested: BTreeMap<u64, WorkerId>,
    /// Slots and evaluations per second of the workers whose speed is known.
    measured: (f64, f64),
    /// Slots of the others.
    unmeasured: f64,
    /// Mean time from lease to outcome lately [s].
    turnaround: Option<f64>,
    /// Rises whenever somebody comes, goes, or says other slots.
    revision: u64,
}

impl Workforce {
    pub fn iter(&self) -> impl Iterator<Item = (&WorkerId, &Worker)> {
        self.workers.iter()
    }

    pub fn is_empty(&self) -> bool {
        self.workers.is_empty()
    }

    pub fn revision(&self) -> u64 {
        self.revision
    }

    pub fn get(&self, id: &WorkerId) -> Option<&Worker> {
        self.workers.get(id)
    }

    /// A worker has come.
    pub fn add(&mut self, id: WorkerId) {
        if !self.workers.contains_key(&id) {
            let worker = Worker::default();
            self.count(worker.strength(), 1.0);
            self.workers.insert(id, worker);
            self.revision += 1;
        }
    }

    /// A worker has gone; what it had.
    pub fn remove(&mut self, id: &WorkerId) -> Vec<u64> {
        let Some(worker) = self.workers.get(id) else { return Vec::new() };
        let tasks: Vec<u64> = worker.leases.keys().copied().collect();
        for task in &tasks {
            self.release(id, *task);
        }
        self.unrequested.retain(|_, holder| holder != id);
        if let Some(worker) = self.workers.remove(id) {
            self.count(worker.strength(), -1.0);
        }
        self.revision += 1;
        tasks
    }

    /// Takes note of a claim of a worker that is there; false if it is outdated.
    pub fn register_claim(&mut self, id: &WorkerId, sequence: u64, slots: u32) -> bool {
        if self.workers.get(id).is_some_and(|worker| worker.slots != slots) {
            self.revision += 1;
        }
        let mut newest = false;
        self.remeasure(id, |worker| {
            newest = worker.last_sequence.is_none_or(|last| sequence > last);
            worker.slots = slots;
            worker.last_sequence = worker.last_sequence.max(Some(sequence));
        });
        newest
    }

    /// Gives a task to a worker.
    pub fn lease(&mut self, id: &WorkerId, task: u64, now: Duration) {
        let Some(worker) = self.workers.get_mut(id) else { return };
        if worker.leases.contains_key(&task) {
            return;
        }
        worker.leases.insert(task, now);
        self.holders.entry(task).or_default().push(id.clone());
        self.sort_by_age(task);
    }

    /// Takes a task from a worker; whether anybody still has it.
    pub fn release(&mut self, id: &WorkerId, task: u64) -> bool {
        self.forget_age(task);
        if let Some(worker) = self.workers.get_mut(id) {
            worker.leases.remove(&task);
        }
        let Some(holders) = self.holders.get_mut(&task) else { return false };
        holders.retain(|holder| holder != id);
        if holders.is_empty() {
            self.holders.remove(&task);
            return false;
        }
        self.sort_by_age(task);
        true
    }

    /// Takes a task from everybody: it has ended, or nobody wants it.
    pub fn release_from_all(&mut self, task: u64) {
        self.forget_age(task);
        for holder in self.holders.remove(&task).unwrap_or_default() {
            if let Some(worker) = self.workers.get_mut(&holder) {
                worker.leases.remove(&task);
            }
        }
    }

    /// Takes everything from everybody.
    pub fn release_everything(&mut self) {
        self.holders.clear();
        self.alone.clear();
        for worker in self.workers.values_mut() {
            worker.leases.clear();
        }
    }

    /// Whether anybody has a task.
    pub fn is_held(&self, task: u64) -> bool {
        self.holders.contains_key(&task)
    }

    /// Tasks this worker has that are not among `kept`, or all.
    pub fn missing_leases(&self, id: &WorkerId, kept: &BTreeSet<u64>, all: bool) -> Vec<u64> {
        let leases = self.workers.get(id).map(|worker| worker.leases.keys());
        leases.into_iter().flatten().filter(|task| all || !kept.contains(task)).copied().collect()
    }

    /// Whether what a worker says to have is news: not leased to it, nor taken from it as overdue.
    pub fn is_unknown_task(&self, id: &WorkerId, task: u64) -> bool {
        let known = |worker: &Worker| worker.leases.contains_key(&task) || worker.overdue.contains(&task);
        self.workers.get(id).is_some_and(|worker| !known(worker))
    }

    /// Notes what a worker has that nobody has asked for so far.
    pub fn set_unrequested(&mut self, id: &WorkerId, tasks: &[u64]) {
        if !self.unrequested.is_empty() {
            self.unrequested.retain(|_, holder| holder != id);
        }
        self.unrequested.extend(tasks.iter().map(|&task| (task, id.clone())));
    }

    /// The worker that has this task already, which is asked for now.
    pub fn take_unrequested(&mut self, task: u64) -> Option<WorkerId> {
        self.unrequested.remove(&task)
    }

    /// Takes note of an evaluation that took a slot `wall` seconds.
    pub fn measure(&mut self, id: &WorkerId, task: u64, wall: f64, now: Duration) {
        let since = self.workers.get(id).and_then(|worker| worker.leases.get(&task));
        if let Some(taken) = since.map(|since| now.saturating_sub(*since).as_secs_f64()) {
            let mean = self.turnaround.unwrap_or(taken);
            self.turnaround = Some(mean + NEWEST_TURNAROUND * (taken - mean));
        }
        let wall = wall.max(SHORTEST_WALL);
        self.remeasure(id, |worker| {
            let mean = worker.wall.unwrap_or(wall);
            worker.wall = Some(mean + NEWEST_WALL * (wall - mean));
        });
    }

    /// Whether a worker has finished a task.
    pub fn has_finished(&self, id: &WorkerId) -> bool {
        self.workers.get(id).is_some_and(|worker| worker.wall.is_some())
    }

    /// Whether any of the workers that are there has.
    pub fn any_has_finished(&self) -> bool {
        self.measured.0 > 0.5
    }

    /// Tasks that worker `id` may have at once: of all that are `open` the share that its speed (slots over time of an
    /// evaluation, as measured; the mean of the others before that) is of the speed of all, but one for each of its slots
    /// in any case. A slot gains by several side by side, as long as none idles elsewhere.
    pub fn share(&self, id: &WorkerId, open: usize) -> usize {
        let Some(worker) = self.workers.get(id) else { return 0 };
        let (slots, rate) = self.measured;
        let mean = if slots > 0.5 && rate > 0.0 { rate / slots } else { 1.0 };
        let own = worker.wall.map_or(worker.threads() * mean, |wall| worker.threads() / wall);
        let known = if slots > 0.5 { rate } else { 0.0 };
        let all = known + self.unmeasured * mean;
        // Sums that grow and shrink end a little beside what they should be.
        let share = (open as f64 * own / all.max(own) - 1e-6).ceil();
        (worker.slots.max(1) as usize).max(share as usize)
    }

    /// Tasks that one worker alone, other than `requester`, has had for longer than `factor` of the mean and than `least`,
    /// the longest first. A requester of less than half the mean speed gets those that are out for four times as long: a
    /// faster one is likely to come first.
    pub fn stragglers(
        &self,
        requester: &WorkerId,
        now: Duration,
        factor: f64,
        least: Duration,
    ) -> impl Iterator<Item = u64> {
        let usual = self.turnaround.and_then(|mean| Duration::try_from_secs_f64(factor * mean).ok());
        let patience = if self.is_slow(requester) { 4 } else { 1 };
        let until = usual.and_then(|usual| now.checked_sub(patience * usual.max(least)));
        let late = until.into_iter().flat_map(|until| self.alone.range(..=(until, u64::MAX)));
        let elsewhere = move |task: &u64| self.holders[task].iter().all(|holder| holder != requester);
        late.map(|(_, task)| *task).filter(elsewhere)
    }

    /// Whether a worker is known to be less than half as fast as the mean of those that are known.
    fn is_slow(&self, id: &WorkerId) -> bool {
        let (slots, rate) = self.measured;
        let wall = self.workers.get(id).and_then(|worker| worker.wall);
        wall.is_some_and(|wall| slots > 0.5 && 1.0 / wall < 0.5 * rate / slots)
    }

    /// Takes from each worker what it has had for longer than `deadline`, once for each turn its slots have to take:
    /// whom, what, and how long.
    pub fn take_overdue(&mut self, now: Duration, deadline: Duration) -> Vec<(WorkerId, u64, Duration)> {
        let mut overdue = Vec::new();
        for (id, worker) in &mut self.workers {
            // A worker that took more than its slots can do at once works them off one after the other.
            let turns = worker.leases.len().div_ceil(worker.slots.max(1) as usize);
            let allowed = deadline.saturating_mul(u32::try_from(turns).unwrap_or(u32::MAX));
            let late = |since: &Duration| now.saturating_sub(*since) > allowed;
            for (task, since) in worker.leases.iter().filter(|(_, since)| late(since)) {
                overdue.push((id.clone(), *task, now.saturating_sub(*since)));
            }
        }
        for (id, task, _) in &overdue {
            self.release(id, *task);
            if let Some(worker) = self.workers.get_mut(id) {
                worker.overdue.insert(*task);
            }
        }
        overdue
    }

    /// Changes a worker, and with it what is known of all.
    fn remeasure(&mut self, id: &WorkerId, change: impl FnOnce(&mut Worker)) {
        let Some(worker) = self.workers.get_mut(id) else { return };
        let before = worker.strength();
        change(worker);
        let after = worker.strength();
        self.count(before, -1.0);
        self.count(after, 1.0);
    }

    fn count(&mut self, (threads, wall): (f64, Option<f64>), sign: f64) {
        match wall {
            Some(wall) => {
                self.measured.0 += sign * threads;
                self.measured.1 += sign * threads / wall;
            }
            None => self.unmeasured += sign * threads,
        }
    }

    fn forget_age(&mut self, task: u64) {
        if let Some((since, task)) = self.age(task) {
            self.alone.remove(&(since, task));
        }
    }

    fn sort_by_age(&mut self, task: u64) {
        match self.age(task) {
            Some(age) => {
                self.alone.insert(age);
            }
            None => {
                for since in self.since(task) {
                    self.alone.remove(&(since, task));
                }
            }
        }
    }

    /// Since when its only holder has a task.
    fn age(&self, task: u64) -> Option<(Duration, u64)> {
        match &self.since(task)[..] {
            [since] => Some((*since, task)),
            _ => None,
        }
    }

    fn since(&self, task: u64) -> Vec<Duration> {
        let holders = self.holders.get(&task).into_iter().flatten();
        holders.filter_map(|id| self.workers.get(id)?.leases.get(&task).copied()).collect()
    }
}
