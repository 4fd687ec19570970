//! The tasks of a campaign and the queue of those nobody works on.

use crate::evaluate::Request;
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

/// What an outcome is to the campaign.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Accepted {
    /// Of another campaign, or of a task that has ended.
    NotWanted,
    /// Under the number of a task, but of another sample.
    OtherSample,
    /// Of this campaign, but not asked for by this coordinator so far.
    NotAskedYet,
    /// The first outcome is delivered and not durable yet.
    OnItsWay,
    /// The first outcome: it counts.
    First,
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
}

impl TaskTable {
    pub fn new(campaign: u64) -> Self {
        Self { campaign, entries: BTreeMap::new(), queue: VecDeque::new(), ended: BTreeSet::new() }
    }

    pub fn open(&self) -> usize {
        self.entries.len()
    }

    /// Tasks that nobody works on.
    pub fn queued(&self) -> usize {
        self.entries.values().filter(|entry| entry.phase == Phase::Queued).count()
    }

    /// Queues a request; a number that is open already is left as it is.
    pub fn submit(&mut self, request: Request) -> Option<CandidatePoint> {
        let id = request.id;
        if self.entries.contains_key(&id) {
            return None;
        }
        self.ended.remove(&id);
        let point = CandidatePoint { task: id, sample: request.sample.clone() };
        self.entries.insert(id, Entry { request, phase: Phase::Queued, attempts: 0, losses: 0 });
        self.queue.push_back(id);
        Some(point)
    }

    /// Up to `count` tasks from the front of the queue.
    pub fn lease(&mut self, count: usize) -> Vec<Task> {
        let mut tasks = Vec::new();
        while tasks.len() < count {
            let Some(id) = self.queue.pop_front() else { break };
            let Some(entry) = self.entries.get_mut(&id).filter(|e| e.phase == Phase::Queued) else {
                continue;
            };
            entry.phase = Phase::Leased;
            entry.attempts += 1;
            tasks.push(Task {
                key: TaskKey { campaign: self.campaign, task: id },
                attempt: entry.attempts,
                sample: entry.request.sample.clone(),
                with_first_cycle: entry.request.with_first_cycle,
                accuracy: entry.request.accuracy,
            });
        }
        tasks
    }

    /// Back to the front of the queue, if it is out and has no outcome.
    pub fn requeue(&mut self, id: u64) -> Option<CandidatePoint> {
        let entry = self.entries.get_mut(&id).filter(|entry| entry.phase == Phase::Leased)?;
        entry.phase = Phase::Queued;
        self.queue.push_front(id);
        Some(CandidatePoint { task: id, sample: entry.request.sample.clone() })
    }

    /// Counts the loss of a task that is out; how many there were.
    pub fn count_loss(&mut self, id: u64) -> Option<u32> {
        let entry = self.entries.get_mut(&id).filter(|entry| entry.phase == Phase::Leased)?;
        entry.losses += 1;
        Some(entry.losses)
    }

    pub fn accept(&mut self, done: &Task) -> Accepted {
        if done.key.campaign != self.campaign || self.ended.contains(&done.key.task) {
            return Accepted::NotWanted;
        }
        let Some(entry) = self.entries.get_mut(&done.key.task) else { return Accepted::NotAskedYet };
        let asked = Task {
            key: done.key,
            attempt: done.attempt,
            sample: entry.request.sample.clone(),
            with_first_cycle: entry.request.with_first_cycle,
            accuracy: entry.request.accuracy,
        };
        if !asked.same_work(done) {
            return Accepted::OtherSample;
        }
        match std::mem::replace(&mut entry.phase, Phase::Delivered) {
            Phase::Delivered => Accepted::OnItsWay,
            Phase::Queued | Phase::Leased => Accepted::First,
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

    /// Forgets what is open, without ending it.
    pub fn clear(&mut self) {
        self.entries.clear();
        self.queue.clear();
    }
}
