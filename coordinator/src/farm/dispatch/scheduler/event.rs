//! Events and actions of the scheduler.

use crate::farm::evaluate::{Finished, Request};
use common::wire::{CandidatePoint, Claim, Task, TaskKey, WorkerId};

/// Identifies a claim that waits for its reply.
pub type Token = u64;

/// Input of the scheduler.
#[derive(Debug, Clone, PartialEq)]
pub enum Event {
    /// The study requests these evaluations.
    Submit(Vec<Request>),
    /// The liveliness token of a worker appeared.
    WorkerJoined(WorkerId),
    /// The liveliness token of a worker disappeared: it crashed, hangs, lost its connection or left.
    WorkerLost(WorkerId),
    /// A worker claims tasks and returns outcomes; the token identifies the claim in its reply.
    Claimed(Token, Claim),
    /// The outcome of the task of this number is durable.
    Recorded(u64),
    /// The study cancels all open requests.
    Cancel,
    /// The campaign has ended: all workers are to leave.
    Finish,
    /// Periodic check of deadlines and warnings.
    Tick,
}

/// Output of the scheduler, executed in order.
#[derive(Debug, Clone, PartialEq)]
pub enum Action {
    /// Pass the outcome to the study, which responds with [`Event::Recorded`].
    Deliver(Box<Finished>),
    /// Answer the claim of this token: outcomes that the worker may discard, and the tasks that it is to evaluate, of which none may be
    /// available; `None`: the campaign has ended, the worker leaves.
    Reply(Token, Vec<TaskKey>, Option<Vec<Task>>),
    /// Announce waiting points to all workers.
    Announce(Vec<CandidatePoint>),
    /// Announce the end of the campaign to all workers.
    AnnounceEnd,
    /// Give the task of this number up without outcome, with number and kind of its losses.
    GiveUp(u64, String),
    /// Warn the user of a condition to check.
    Warn(String),
}
