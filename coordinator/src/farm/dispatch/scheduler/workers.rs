//! The connected workers: leases, measured speed, and share of the tasks.

use common::wire::WorkerId;
use std::collections::btree_map::Entry;
use std::collections::{BTreeMap, BTreeSet};
use std::time::Duration;

/// Most tasks of a worker that are remembered without a request: more than a worker can hold.
const MOST_UNREQUESTED: usize = 10_000;
/// Weight of the newest evaluation in the running mean of a worker's evaluation times [1].
const NEWEST_WALL: f64 = 0.2;
/// Weight of the newest task in the running mean of the time from lease to outcome [1].
const NEWEST_TURNAROUND: f64 = 0.1;
/// Lower bound of a measured evaluation time [s]. Below it, messages and not evaluations bound the rate of a worker, and the
/// measured times differ by chance: with 1e-6 the shares of 2000 workers with empty tasks differed by orders of magnitude.
const SHORTEST_WALL: f64 = 1e-3;
/// Least age of a lease at which its task goes to a second worker.
const STRAGGLER_LEAST: Duration = Duration::from_secs(1);

/// A connected worker.
#[derive(Debug, Default)]
pub(super) struct Worker {
    /// Slots stated in its claims; 0 until the first claim.
    pub slots: u32,
    /// Whether it gets no tasks: it does not offer the subject of the campaign.
    excluded: bool,
    /// Whether it has reported that it cannot use its simulator.
    unusable: bool,
    /// Highest sequence number of its claims.
    pub last_sequence: Option<u64>,
    /// Leased tasks with the time of their lease.
    pub leases: BTreeMap<u64, Duration>,
    /// Tasks whose lease was revoked after their deadline; the worker may still list them.
    overdue: BTreeSet<u64>,
    /// Running mean of the slot time of its evaluations [s].
    wall: Option<f64>,
}

impl Worker {
    /// Number of tasks that may be running: leased ones, and those whose lease was revoked after their deadline.
    pub fn under_way(&self) -> usize {
        self.leases.len() + self.overdue.len()
    }

    /// True if the worker gets tasks.
    pub fn is_eligible(&self) -> bool {
        !(self.excluded || self.unusable)
    }

    /// Slots for tasks of the campaign; 0 until the first claim, and for a worker that gets no tasks.
    pub fn usable_slots(&self) -> u32 {
        if self.is_eligible() { self.slots } else { 0 }
    }

    fn threads(&self) -> f64 {
        if self.is_eligible() { f64::from(self.slots.max(1)) } else { 0.0 }
    }

    /// Threads, and mean time of an evaluation on one of them [s].
    fn strength(&self) -> (f64, Option<f64>) {
        (self.threads(), self.wall)
    }
}

/// All connected workers and their leases. Several workers may hold a lease of the same task.
#[derive(Debug, Default)]
pub(super) struct Workforce {
    workers: BTreeMap<WorkerId, Worker>,
    /// Workers with a lease, by task.
    holders: BTreeMap<u64, Vec<WorkerId>>,
    /// Tasks leased to exactly one worker, the oldest lease first.
    alone: BTreeSet<(Duration, u64)>,
    /// Tasks that a worker holds and the study has not requested yet.
    unrequested: BTreeMap<u64, WorkerId>,
    /// Slots [1] and rate [1/s] of the workers with measured speed.
    measured: (f64, f64),
    /// Slots of the workers without measured speed.
    unmeasured: f64,
    /// Running mean of the time from lease to outcome [s].
    turnaround: Option<f64>,
    /// Number that increases whenever a worker joins, leaves or changes its slots.
    pub revision: u64,
}

impl Workforce {
    pub fn iter(&self) -> impl Iterator<Item = (&WorkerId, &Worker)> {
        self.workers.iter()
    }

    /// True if any connected worker gets tasks.
    pub fn any_eligible(&self) -> bool {
        self.workers.values().any(Worker::is_eligible)
    }

    /// Number of tasks that may be running.
    pub fn under_way(&self) -> usize {
        self.workers.values().map(Worker::under_way).sum()
    }

    pub fn get(&self, id: &WorkerId) -> Option<&Worker> {
        self.workers.get(id)
    }

    /// Adds a worker without leases.
    pub fn add(&mut self, id: WorkerId) {
        if !self.workers.contains_key(&id) {
            let worker = Worker::default();
            self.count(worker.strength(), 1.0);
            self.workers.insert(id, worker);
            self.revision += 1;
        }
    }

    /// Removes a worker; returns its leased tasks.
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

    /// Registers a claim: updates slots and sequence number of the worker, and whether it `offers` the subject of the
    /// campaign. False if the claim is older than a previous one.
    pub fn register_claim(&mut self, id: &WorkerId, sequence: u64, slots: u32, offers: bool) -> bool {
        let mut newest = false;
        self.change(id, |worker| {
            newest = worker.last_sequence.is_none_or(|last| sequence > last);
            worker.slots = slots;
            worker.excluded = !offers;
            worker.last_sequence = worker.last_sequence.max(Some(sequence));
        });
        newest
    }

    /// Excludes a worker that cannot use its simulator; false if it is unknown or excluded already.
    pub fn exclude_unusable(&mut self, id: &WorkerId) -> bool {
        let is_new = self.workers.get(id).is_some_and(|worker| !worker.unusable);
        self.change(id, |worker| worker.unusable = true);
        is_new
    }

    /// Forgets the revoked tasks that a worker no longer holds.
    pub fn forget_dropped(&mut self, id: &WorkerId, kept: &BTreeSet<u64>) {
        if let Some(worker) = self.workers.get_mut(id) {
            worker.overdue.retain(|task| kept.contains(task));
        }
    }

    /// Number of tasks of a worker that may be running.
    pub fn under_way_at(&self, id: &WorkerId) -> usize {
        self.workers.get(id).map_or(0, Worker::under_way)
    }

    /// Leases a task to a worker.
    pub fn lease(&mut self, id: &WorkerId, task: u64, now: Duration) {
        self.relet(task, |all| {
            let lease = all.workers.get_mut(id).map(|worker| worker.leases.entry(task));
            if let Some(Entry::Vacant(lease)) = lease {
                lease.insert(now);
                all.holders.entry(task).or_default().push(id.clone());
            }
        });
    }

    /// Removes a worker's lease of a task; true if another worker still holds one.
    pub fn release(&mut self, id: &WorkerId, task: u64) -> bool {
        self.relet(task, |all| {
            if let Some(worker) = all.workers.get_mut(id) {
                worker.leases.remove(&task);
            }
            if let Some(holders) = all.holders.get_mut(&task) {
                holders.retain(|holder| holder != id);
                if holders.is_empty() {
                    all.holders.remove(&task);
                }
            }
        });
        self.is_held(task)
    }

    /// Removes all leases of a task that has ended.
    pub fn release_from_all(&mut self, task: u64) {
        self.relet(task, |all| {
            for holder in all.holders.remove(&task).unwrap_or_default() {
                if let Some(worker) = all.workers.get_mut(&holder) {
                    worker.leases.remove(&task);
                }
            }
        });
    }

    /// Changes the leases of a task, and its place among the tasks that are leased to exactly one worker.
    fn relet(&mut self, task: u64, change: impl FnOnce(&mut Self)) {
        if let Some(age) = self.age(task) {
            self.alone.remove(&age);
        }
        change(self);
        self.alone.extend(self.age(task));
    }

    /// Removes all leases.
    pub fn release_everything(&mut self) {
        self.holders.clear();
        self.alone.clear();
        for worker in self.workers.values_mut() {
            worker.leases.clear();
        }
    }

    /// True if any worker holds a lease of the task.
    pub fn is_held(&self, task: u64) -> bool {
        self.holders.contains_key(&task)
    }

    /// Tasks leased to this worker that its claim no longer lists (all of them if it is leaving).
    pub fn missing_leases(&self, id: &WorkerId, claimed: &BTreeSet<u64>, leaving: bool) -> Vec<u64> {
        let leases = self.workers.get(id).map(|worker| worker.leases.keys());
        leases.into_iter().flatten().filter(|task| leaving || !claimed.contains(task)).copied().collect()
    }

    /// True if the worker holds a task that this coordinator neither leased to it nor revoked.
    pub fn is_unknown_task(&self, id: &WorkerId, task: u64) -> bool {
        let known = |worker: &Worker| worker.leases.contains_key(&task) || worker.overdue.contains(&task);
        self.workers.get(id).is_some_and(|worker| !known(worker))
    }

    /// Sets the tasks that a worker holds and the study has not requested yet.
    pub fn set_unrequested(&mut self, id: &WorkerId, tasks: &[u64]) {
        if !self.unrequested.is_empty() {
            self.unrequested.retain(|_, holder| holder != id);
        }
        self.unrequested.extend(tasks.iter().take(MOST_UNREQUESTED).map(|&task| (task, id.clone())));
    }

    /// The worker that already holds this task, which the study requests now.
    pub fn take_unrequested(&mut self, task: u64) -> Option<WorkerId> {
        self.unrequested.remove(&task)
    }

    /// Updates the running means with an evaluation that took a slot `wall` seconds.
    pub fn record_evaluation(&mut self, id: &WorkerId, task: u64, wall: f64, now: Duration) {
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

    /// True if a worker has finished a task.
    pub fn has_finished(&self, id: &WorkerId) -> bool {
        self.workers.get(id).is_some_and(|worker| worker.wall.is_some())
    }

    /// True if any connected worker has finished a task.
    pub fn any_has_finished(&self) -> bool {
        self.measured.0 > 0.5
    }

    /// Most tasks that worker `id` may hold: its share `open * r / sum(r)` of the open tasks, at least one per slot. `r` is
    /// its rate, slots over mean evaluation time; an unmeasured worker counts with the mean rate per slot of the measured
    /// ones. A slot may run several tasks side by side, which is faster as long as no other slot is idle.
    pub fn share(&self, id: &WorkerId, open: usize) -> usize {
        let Some(worker) = self.workers.get(id) else { return 0 };
        let (slots, rate) = self.measured;
        let mean = if slots > 0.5 && rate > 0.0 { rate / slots } else { 1.0 };
        let own = worker.wall.map_or(worker.threads() * mean, |wall| worker.threads() / wall);
        let known = if slots > 0.5 { rate } else { 0.0 };
        let all = known + self.unmeasured * mean;
        // Sums updated by addition and subtraction carry rounding errors.
        let share = if own > 0.0 { (open as f64 * own / all.max(own) - 1e-6).ceil() } else { return 0 };
        (worker.slots.max(1) as usize).max(share as usize)
    }

    /// Tasks leased to exactly one worker other than `requester`, for longer than `factor` times the mean and than
    /// [`STRAGGLER_LEAST`], the oldest lease first. A requester slower than half the mean speed only gets tasks four times as old: a
    /// faster worker is likely to finish earlier.
    pub fn stragglers(&self, requester: &WorkerId, now: Duration, factor: f64) -> impl Iterator<Item = u64> {
        let usual = self.turnaround.and_then(|mean| Duration::try_from_secs_f64(factor * mean).ok());
        let multiple = if self.is_slow(requester) { 4 } else { 1 };
        let until = usual.and_then(|usual| now.checked_sub(multiple * usual.max(STRAGGLER_LEAST)));
        let late = until.into_iter().flat_map(|until| self.alone.range(..=(until, u64::MAX)));
        let elsewhere = move |task: &u64| self.holders[task].iter().all(|holder| holder != requester);
        late.map(|(_, task)| *task).filter(elsewhere)
    }

    /// True if the measured speed of a worker is below half the mean of the measured workers.
    fn is_slow(&self, id: &WorkerId) -> bool {
        let (slots, rate) = self.measured;
        let wall = self.workers.get(id).and_then(|worker| worker.wall);
        wall.is_some_and(|wall| slots > 0.5 && 1.0 / wall < 0.5 * rate / slots)
    }

    /// Revokes all leases older than `deadline` times the turns that the worker's slots need for its leases. Returns
    /// worker, task and age of the lease.
    pub fn take_overdue(&mut self, now: Duration, deadline: Duration) -> Vec<(WorkerId, u64, Duration)> {
        let mut overdue = Vec::new();
        for (id, worker) in &mut self.workers {
            // A worker with more leases than slots evaluates them in turns.
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

    /// Changes a worker; counts a change of its slots for tasks.
    fn change(&mut self, id: &WorkerId, change: impl FnOnce(&mut Worker)) {
        let slots = |all: &Self| all.workers.get(id).map(Worker::usable_slots);
        let before = slots(self);
        self.remeasure(id, change);
        if slots(self) != before {
            self.revision += 1;
        }
    }

    /// Changes a worker and updates the sums over all workers.
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

    /// Time of the lease of a task with exactly one lease, and the task.
    fn age(&self, task: u64) -> Option<(Duration, u64)> {
        let [holder] = self.holders.get(&task)?.as_slice() else { return None };
        Some((*self.workers.get(holder)?.leases.get(&task)?, task))
    }
}
