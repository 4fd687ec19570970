//! Replies that wait until the outcomes in their claims are durable.

use super::Token;
use common::wire::{TaskKey, WorkerId};
use std::collections::{BTreeMap, BTreeSet};

/// The reply to one claim.
#[derive(Debug)]
pub(super) struct PendingReply {
    /// Worker that sent the claim.
    pub worker: WorkerId,
    /// Most tasks in the reply.
    pub credits: u32,
    /// Outcomes the worker may discard.
    pub acknowledged: Vec<TaskKey>,
    /// Tasks whose outcomes are not durable yet.
    pub waiting: BTreeSet<u64>,
}

/// All pending replies, by token and task.
#[derive(Debug, Default)]
pub(super) struct PendingReplies {
    pending: BTreeMap<Token, PendingReply>,
    by_task: BTreeMap<u64, Vec<Token>>,
}

impl PendingReplies {
    /// Adds the reply to a claim.
    pub fn add(&mut self, token: Token, pending: PendingReply) {
        for &task in &pending.waiting {
            self.by_task.entry(task).or_default().push(token);
        }
        self.pending.insert(token, pending);
    }

    /// Removes the credits of all replies to a worker, which has sent a newer claim: it ignores replies to older claims,
    /// so tasks in them would be lost.
    pub fn withdraw_credits(&mut self, worker: &WorkerId) {
        let of_worker = self.pending.values_mut().filter(|pending| pending.worker == *worker);
        of_worker.for_each(|pending| pending.credits = 0);
    }

    /// Acknowledges a durable outcome in all replies that waited for it; returns their tokens.
    pub fn recorded(&mut self, key: TaskKey) -> Vec<Token> {
        let tokens = self.by_task.remove(&key.task).unwrap_or_default();
        for token in &tokens {
            if let Some(pending) = self.pending.get_mut(token)
                && pending.waiting.remove(&key.task)
            {
                pending.acknowledged.push(key);
            }
        }
        tokens
    }

    /// Ends all waiting, without acknowledgement; returns all tokens.
    pub fn give_up_waiting(&mut self) -> Vec<Token> {
        self.by_task.clear();
        self.pending.values_mut().for_each(|pending| pending.waiting.clear());
        self.pending.keys().copied().collect()
    }

    /// Removes a reply that waits for no further outcome; `None` if it still waits.
    pub fn take_ready(&mut self, token: Token) -> Option<PendingReply> {
        let is_ready = self.pending.get(&token)?.waiting.is_empty();
        if is_ready { self.pending.remove(&token) } else { None }
    }
}
