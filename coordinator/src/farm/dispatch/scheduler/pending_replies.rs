//! Claims whose replies wait until the outcomes they brought are durable.

use super::Token;
use common::wire::{TaskKey, WorkerId};
use std::collections::{BTreeMap, BTreeSet};

/// A claim to be answered.
#[derive(Debug)]
pub(super) struct PendingReply {
    /// Who asked.
    pub worker: WorkerId,
    /// Tasks it may get.
    pub credits: u32,
    /// What it may forget.
    pub acknowledged: Vec<TaskKey>,
    /// Tasks whose outcomes are not durable yet.
    pub waiting: BTreeSet<u64>,
}

/// See the module.
#[derive(Debug, Default)]
pub(super) struct PendingReplies {
    pending: BTreeMap<Token, PendingReply>,
    of_task: BTreeMap<u64, Vec<Token>>,
    of_worker: BTreeMap<WorkerId, Vec<Token>>,
}

impl PendingReplies {
    /// Adds a claim.
    pub fn add(&mut self, token: Token, pending: PendingReply) {
        for &task in &pending.waiting {
            self.of_task.entry(task).or_default().push(token);
        }
        self.of_worker.entry(pending.worker.clone()).or_default().push(token);
        self.pending.insert(token, pending);
    }

    /// The worker has asked again: an answer that still waits would reach a worker that no longer listens to it, so no
    /// tasks go with it.
    pub fn withdraw_credits(&mut self, worker: &WorkerId) {
        for token in self.of_worker.get(worker).into_iter().flatten() {
            if let Some(pending) = self.pending.get_mut(token) {
                pending.credits = 0;
            }
        }
    }

    /// The outcome of a task is durable; claims that waited for it.
    pub fn recorded(&mut self, key: TaskKey) -> Vec<Token> {
        let tokens = self.of_task.remove(&key.task).unwrap_or_default();
        for token in &tokens {
            if let Some(pending) = self.pending.get_mut(token)
                && pending.waiting.remove(&key.task)
            {
                pending.acknowledged.push(key);
            }
        }
        tokens
    }

    /// Nothing becomes durable any more; all claims.
    pub fn give_up_waiting(&mut self) -> Vec<Token> {
        self.of_task.clear();
        self.pending.values_mut().for_each(|pending| pending.waiting.clear());
        self.pending.keys().copied().collect()
    }

    /// Takes a claim out that waits for nothing more.
    pub fn take_ready(&mut self, token: Token) -> Option<PendingReply> {
        if !self.pending.get(&token)?.waiting.is_empty() {
            return None;
        }
        let pending = self.pending.remove(&token)?;
        if let Some(tokens) = self.of_worker.get_mut(&pending.worker) {
            tokens.retain(|other| *other != token);
            if tokens.is_empty() {
                self.of_worker.remove(&pending.worker);
            }
        }
        Some(pending)
    }
}
