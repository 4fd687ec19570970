//! The tasks of a campaign and the queue of tasks without a worker.

use crate::farm::evaluate::Request;
use common::wire::{CandidatePoint, Task, TaskKey, WorkerId};
use std::collections::{BTreeMap, BTreeSet, VecDeque};

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Phase {
    /// Without a worker.
    Queued,
    /// With a worker.
    Leased,
    /// With an outcome.
    Delivered,
}

#[derive(Debug)]
struct Entry {
    request: Request,
    phase: Phase,
    attempts: u32,
    losses: u32,
    /// Workers whose loss is among `losses`.
    lost_workers: Vec<WorkerId>,
}

impl Entry {
    fn point(&self) -> CandidatePoint {
        (self.request.id, self.request.sample.clone())
    }

    fn task(&self, campaign: u64) -> Task {
        Task {
            key: TaskKey { campaign, task: self.request.id },
            attempt: self.attempts,
            sample: self.request.sample.clone(),
            with_first_cycle: self.request.with_first_cycle,
            accuracy: self.request.accuracy,
            level: self.request.level,
        }
    }
}

/// State of a task that a worker holds.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum TaskStatus {
    /// It has no outcome.
    Open,
    /// Its outcome was delivered and is not durable yet.
    Delivered,
    /// It has ended, or its outcome was in the campaign file.
    Ended,
    /// This coordinator has not requested it yet.
    NotRequested,
}

/// All tasks of a campaign.
#[derive(Debug)]
pub(super) struct TaskTable {
    campaign: u64,
    entries: BTreeMap<u64, Entry>,
    /// Numbers of the queued tasks. It is complete, but may list tasks whose outcome has arrived since: the phase decides.
    queue: VecDeque<u64>,
    ended: BTreeSet<u64>,
    /// Numbers below this were requested or found in the campaign file: a study requests in the order of its numbers.
    passed: u64,
}

impl TaskTable {
    pub fn new(campaign: u64) -> Self {
        let (entries, queue, ended) = Default::default();
        Self { campaign, entries, queue, ended, passed: 0 }
    }

    pub fn open(&self) -> usize {
        self.entries.len()
    }

    /// The open task with the lowest number.
    pub fn first_open(&self) -> Option<u64> {
        self.entries.keys().next().copied()
    }

    /// Number of queued tasks.
    pub fn waiting(&self) -> usize {
        self.entries.values().filter(|entry| entry.phase == Phase::Queued).count()
    }

    /// Queues a request; `None` if a task of this number is open already.
    pub fn submit(&mut self, request: Request) -> Option<CandidatePoint> {
        let id = request.id;
        if self.entries.contains_key(&id) {
            return None;
        }
        self.ended.remove(&id);
        self.passed = self.passed.max(id.saturating_add(1));
        let entry = Entry { request, phase: Phase::Queued, attempts: 0, losses: 0, lost_workers: vec![] };
        let point = entry.point();
        self.entries.insert(id, entry);
        self.queue.push_back(id);
        Some(point)
    }

    /// Leases up to `count` tasks from the front of the queue; tasks with `losses` or more losses are skipped, and those whose request is not
    /// `open` to the worker.
    pub fn lease(&mut self, count: usize, losses: u32, open: impl Fn(&Request) -> bool) -> Vec<Task> {
        let mut tasks = Vec::new();
        let mut withheld = Vec::new();
        while tasks.len() < count {
            let Some(id) = self.queue.pop_front() else { break };
            let campaign = self.campaign;
            let Some(entry) = self.in_phase(id, Phase::Queued) else { continue };
            if entry.losses >= losses || !open(&entry.request) {
                withheld.push(id);
                continue;
            }
            entry.phase = Phase::Leased;
            entry.attempts += 1;
            tasks.push(entry.task(campaign));
        }
        for id in withheld.into_iter().rev() {
            self.queue.push_front(id);
        }
        tasks
    }

    /// A copy of a leased task for a second worker; `None` if it is not leased or has `losses` or more losses.
    pub fn copy(&mut self, id: u64, losses: u32) -> Option<Task> {
        let campaign = self.campaign;
        let entry = self.in_phase(id, Phase::Leased).filter(|entry| entry.losses < losses)?;
        entry.attempts += 1;
        Some(entry.task(campaign))
    }

    /// Marks a queued task as leased: a worker holds it already.
    pub fn adopt(&mut self, id: u64) {
        if let Some(entry) = self.in_phase(id, Phase::Queued) {
            entry.phase = Phase::Leased;
            entry.attempts += 1;
        }
    }

    /// Returns a task to the front of the queue; `None` if it is not in this phase.
    pub fn requeue(&mut self, id: u64, from: Phase) -> Option<CandidatePoint> {
        let entry = self.in_phase(id, from)?;
        entry.phase = Phase::Queued;
        let point = entry.point();
        self.queue.push_front(id);
        Some(point)
    }

    fn in_phase(&mut self, id: u64, phase: Phase) -> Option<&mut Entry> {
        self.entries.get_mut(&id).filter(|entry| entry.phase == phase)
    }

    /// Marks a task as delivered.
    pub fn set_delivered(&mut self, id: u64) {
        if let Some(entry) = self.entries.get_mut(&id) {
            entry.phase = Phase::Delivered;
        }
    }

    /// Points of the queued tasks.
    pub fn queued(&self) -> Vec<CandidatePoint> {
        let queued = |entry: &&Entry| entry.phase == Phase::Queued;
        self.entries.values().filter(queued).map(Entry::point).collect()
    }

    /// Counts a loss of a leased task; returns its losses, `None` if it is not leased.
    pub fn count_loss(&mut self, id: u64) -> Option<u32> {
        let entry = self.in_phase(id, Phase::Leased)?;
        entry.losses += 1;
        Some(entry.losses)
    }

    /// Notes which worker was lost with a task.
    pub fn set_lost_worker(&mut self, id: u64, worker: &WorkerId) {
        if let Some(entry) = self.entries.get_mut(&id) {
            entry.lost_workers.push(worker.clone());
        }
    }

    /// Withdraws the loss of a task with this worker: the worker has returned with it, so only its connection was lost.
    pub fn withdraw_loss(&mut self, id: u64, worker: &WorkerId) {
        if let Some(entry) = self.entries.get_mut(&id)
            && let Some(at) = entry.lost_workers.iter().position(|lost| lost == worker)
        {
            entry.lost_workers.swap_remove(at);
            entry.losses = entry.losses.saturating_sub(1);
        }
    }

    pub fn status(&self, id: u64) -> TaskStatus {
        match self.entries.get(&id) {
            Some(Entry { phase: Phase::Delivered, .. }) => TaskStatus::Delivered,
            Some(_) => TaskStatus::Open,
            None if self.ended.contains(&id) || id < self.passed => TaskStatus::Ended,
            None => TaskStatus::NotRequested,
        }
    }

    /// True if a task of this coordinator is the one that was `done`, not another one with its number.
    pub fn has_work(&self, done: &Task) -> bool {
        self.entries.get(&done.key.task).is_some_and(|entry| entry.task(self.campaign).same_work(done))
    }

    /// Ends a task; false if it was not open.
    pub fn end(&mut self, id: u64) -> bool {
        let was_open = self.entries.remove(&id).is_some();
        if was_open {
            self.ended.insert(id);
        }
        was_open
    }

    /// Removes all open tasks without ending them: they may be requested again.
    pub fn clear(&mut self) {
        self.entries.clear();
        self.queue.clear();
        self.passed = 0;
    }
}
