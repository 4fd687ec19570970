//! Events and actions of the scheduler.

use crate::farm::evaluate::{Finished, Request};
use common::wire::{CandidatePoint, Claim, Offers, Task, TaskKey, WorkerId};
use std::time::Duration;

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
    /// Answer the claim of this token: outcomes that the worker may discard, and its next step.
    Reply(Token, Vec<TaskKey>, Assignment),
    /// Announce waiting points to all workers.
    Announce(Vec<CandidatePoint>),
    /// Announce the end of the campaign to all workers.
    AnnounceEnd,
    /// Give the task of this number up without outcome, with number and kind of its losses.
    GiveUp(u64, String),
    /// Warn the user.
    Warn(Warning),
}

/// Next step of a worker.
#[derive(Debug, Clone, PartialEq)]
pub enum Assignment {
    /// Evaluate these tasks.
    Work(Vec<Task>),
    /// Wait: no task is available.
    Idle,
    /// The campaign has ended.
    Leave,
}

/// A condition the user should check.
#[derive(Debug, Clone, PartialEq)]
pub enum Warning {
    /// Tasks wait and no worker is connected: their number, and the time without any worker.
    NoWorker(usize, Duration),
    /// A worker claims tasks but has no liveliness token (access rules?). Its loss could not be detected, so it gets no
    /// tasks.
    NoLiveliness(WorkerId),
    /// A worker was lost with leased tasks of these numbers, which are requeued.
    WorkerLost(WorkerId, Vec<u64>),
    /// The task of this number exceeded its deadline this time after its lease; another worker gets it too.
    Overdue(WorkerId, u64, Duration),
    /// A worker does not offer the scene or simulator of the campaign, but this, so it gets no tasks.
    NotOffered(WorkerId, Offers),
    /// A worker cannot use its simulator, so it gets no more tasks, with what it reports.
    Unusable(WorkerId, String),
    /// A claim is not newer than an earlier one of its worker, which gets no tasks by it; number of such claims so far.
    OutdatedClaim(WorkerId, u64),
    /// An outcome belongs to another campaign; number of such outcomes so far.
    OtherCampaign(WorkerId, u64),
    /// An outcome has the number of this task but another sample.
    OtherSample(WorkerId, u64),
}
