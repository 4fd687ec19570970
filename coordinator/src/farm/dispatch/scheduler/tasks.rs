//! The tasks of a campaign and the queue of those nobody works on.

use crate::farm::evaluate::Request;
use common::wire::{CandidatePoint, Task, TaskKey};
use std::collections::{BTreeMap, BTreeSet, VecDeque};

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Phase {
    Queued,
    Leased,
    Delivered,
}

#[derive(Debug)]
struct Entry {
    request: Request,
    phase: Phase,
    attempts: u32,
    losses: u32,
}

impl Entry {
    fn point(&self) -> CandidatePoint {
        CandidatePoint { task: self.request.id, sample: self.request.sample.clone() }
    }

    fn task(&self, campaign: u64) -> Task {
        Task {
            key: TaskKey { campaign, task: self.request.id },
            attempt: self.attempts,
            sample: self.request.sample.clone(),
            with_first_cycle: self.request.with_first_cycle,
            accuracy: self.request.accuracy,
        }
    }
}

/// What an outcome is to the campaign.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum OutcomeStatus {
    /// Of another campaign, or of a task that has ended.
    NotWanted,
    /// Under the number of a task, but of another sample.
    OtherSample,
    /// Of this campaign, but not asked for by this coordinator so far.
    NotRequested,
    /// The first outcome is delivered and not durable yet.
    Duplicate,
    /// The first outcome: it counts.
    First,
}

/// How a task stands that a worker says to have.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum TaskStatus {
    /// Without an outcome.
    Open,
    /// Its outcome is on its way to the study.
    Delivered,
    /// It has ended, or was found in the campaign file.
    Ended,
    /// Not asked for by this coordinator so far.
    NotRequested,
}

/// All tasks of a campaign.
#[derive(Debug)]
pub(super) struct TaskTable {
    campaign: u64,
    entries: BTreeMap<u64, Entry>,
    /// Numbers of the tasks to hand out. None is missing; some may be outdated (the outcome came meanwhile), so
    /// the phase decides.
    queue: VecDeque<u64>,
    ended: BTreeSet<u64>,
    /// Numbers below were asked for, or found in the campaign file: a study asks in the order of its numbers.
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

    /// Tasks that nobody works on.
    pub fn waiting(&self) -> usize {
        self.entries.values().filter(|entry| entry.phase == Phase::Queued).count()
    }

    /// Queues a request; a number that is open already is left as it is.
    pub fn submit(&mut self, request: Request) -> Option<CandidatePoint> {
        let id = request.id;
        if self.entries.contains_key(&id) {
            return None;
        }
        self.ended.remove(&id);
        self.passed = self.passed.max(id.saturating_add(1));
        let entry = Entry { request, phase: Phase::Queued, attempts: 0, losses: 0 };
        let point = entry.point();
        self.entries.insert(id, entry);
        self.queue.push_back(id);
        Some(point)
    }

    /// Up to `count` tasks from the front of the queue, of those that were lost fewer than `losses` times.
    pub fn lease(&mut self, count: usize, losses: u32) -> Vec<Task> {
        let mut tasks = Vec::new();
        let mut withheld = Vec::new();
        while tasks.len() < count {
            let Some(id) = self.queue.pop_front() else { break };
            let Some(entry) = self.entries.get_mut(&id).filter(|e| e.phase == Phase::Queued) else {
                continue;
            };
            if entry.losses >= losses {
                withheld.push(id);
                continue;
            }
            entry.phase = Phase::Leased;
            entry.attempts += 1;
            tasks.push(entry.task(self.campaign));
        }
        for id in withheld.into_iter().rev() {
            self.queue.push_front(id);
        }
        tasks
    }

    /// The same task once more, for a second worker, if it is out and was lost fewer than `losses` times.
    pub fn copy(&mut self, id: u64, losses: u32) -> Option<Task> {
        let campaign = self.campaign;
        let out = |entry: &&mut Entry| entry.phase == Phase::Leased && entry.losses < losses;
        let entry = self.entries.get_mut(&id).filter(out)?;
        entry.attempts += 1;
        Some(entry.task(campaign))
    }

    /// A worker has it already, whoever gave it: it leaves the queue.
    pub fn adopt(&mut self, id: u64) {
        if let Some(entry) = self.entries.get_mut(&id).filter(|entry| entry.phase == Phase::Queued) {
            entry.phase = Phase::Leased;
            entry.attempts += 1;
        }
    }

    /// Back to the front of the queue, if it is out and has no outcome.
    pub fn requeue(&mut self, id: u64) -> Option<CandidatePoint> {
        let entry = self.entries.get_mut(&id).filter(|entry| entry.phase == Phase::Leased)?;
        entry.phase = Phase::Queued;
        self.queue.push_front(id);
        Some(entry.point())
    }

    /// What waits for a worker.
    pub fn queued(&self) -> Vec<CandidatePoint> {
        let queued = |entry: &&Entry| entry.phase == Phase::Queued;
        self.entries.values().filter(queued).map(Entry::point).collect()
    }

    /// Counts the loss of a task that is out; how many there were.
    pub fn count_loss(&mut self, id: u64) -> Option<u32> {
        let entry = self.entries.get_mut(&id).filter(|entry| entry.phase == Phase::Leased)?;
        entry.losses += 1;
        Some(entry.losses)
    }

    pub fn status(&self, id: u64) -> TaskStatus {
        match self.entries.get(&id) {
            Some(Entry { phase: Phase::Delivered, .. }) => TaskStatus::Delivered,
            Some(_) => TaskStatus::Open,
            None if self.ended.contains(&id) || id < self.passed => TaskStatus::Ended,
            None => TaskStatus::NotRequested,
        }
    }

    pub fn accept(&mut self, done: &Task) -> OutcomeStatus {
        if done.key.campaign != self.campaign {
            return OutcomeStatus::NotWanted;
        }
        match self.status(done.key.task) {
            TaskStatus::Ended => return OutcomeStatus::NotWanted,
            TaskStatus::NotRequested => return OutcomeStatus::NotRequested,
            TaskStatus::Open | TaskStatus::Delivered => {}
        }
        let campaign = self.campaign;
        let Some(entry) = self.entries.get_mut(&done.key.task) else { return OutcomeStatus::NotRequested };
        if !entry.task(campaign).same_work(done) {
            return OutcomeStatus::OtherSample;
        }
        match std::mem::replace(&mut entry.phase, Phase::Delivered) {
            Phase::Delivered => OutcomeStatus::Duplicate,
            Phase::Queued | Phase::Leased => OutcomeStatus::First,
        }
    }

    /// Ends a task for good; false if it was not open.
    pub fn end(&mut self, id: u64) -> bool {
        let was_open = self.entries.remove(&id).is_some();
        if was_open {
            self.ended.insert(id);
        }
        was_open
    }

    /// Forgets what is open, without ending it: it may be asked for again.
    pub fn clear(&mut self) {
        self.entries.clear();
        self.queue.clear();
        self.passed = 0;
    }
}
