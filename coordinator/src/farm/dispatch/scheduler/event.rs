//! What the scheduler hears and what it wants done.

use crate::farm::evaluate::{Finished, Request};
use common::wire::{CandidatePoint, Claim, Task, TaskKey, WorkerId};
use std::time::Duration;

/// Names one claim that waits for its reply.
pub type Token = u64;

/// What happened.
#[derive(Debug, Clone, PartialEq)]
pub enum Event {
    /// The study asks for these.
    Submit(Vec<Request>),
    /// A worker's liveliness token is there.
    WorkerJoined(WorkerId),
    /// A worker's liveliness token is gone: it died, hangs, was cut off or left.
    WorkerLost(WorkerId),
    /// A worker asks for tasks and hands in outcomes.
    Claimed {
        /// To answer it by.
        token: Token,
        /// What it says.
        claim: Claim,
    },
    /// The outcome of this task is durable.
    Recorded {
        /// Number of the evaluation.
        task: u64,
    },
    /// The study doesn't want what it asked for any more.
    Cancel,
    /// The campaign has come to its end: send the workers home.
    Finish,
    /// Time has passed.
    Tick,
}

/// What is to be done, in this order.
#[derive(Debug, Clone, PartialEq)]
pub enum Action {
    /// Hand the outcome to the study; [`Event::Recorded`] answers it.
    Deliver(Box<Finished>),
    /// Answer a claim.
    Reply {
        /// Which claim.
        token: Token,
        /// Outcomes the worker may forget.
        acknowledged: Vec<TaskKey>,
        /// What the worker does next.
        assignment: Assignment,
    },
    /// Tell all workers of points that wait.
    Announce(Vec<CandidatePoint>),
    /// Tell all workers that the campaign has ended.
    AnnounceEnd,
    /// A task will get no outcome.
    GiveUp {
        /// Number of the evaluation.
        task: u64,
        /// Why.
        reason: String,
    },
    /// Tell the user.
    Warn(Warning),
}

/// What a worker does next.
#[derive(Debug, Clone, PartialEq)]
pub enum Assignment {
    /// Evaluate these.
    Work(Vec<Task>),
    /// Nothing now.
    Idle,
    /// The campaign has ended.
    Leave,
}

/// Something a user should know.
#[derive(Debug, Clone, PartialEq)]
pub enum Warning {
    /// Tasks wait and there is nobody to do them.
    NoWorker {
        /// Tasks without an outcome.
        open: usize,
        /// How long there was no worker.
        since: Duration,
    },
    /// A worker asks for tasks but shows no liveliness token (access rules?), so its death would go unnoticed
    /// and it gets nothing.
    NoLiveliness {
        /// Worker.
        worker: WorkerId,
    },
    /// A worker was lost with tasks in hand, which go to others.
    WorkerLost {
        /// Worker.
        worker: WorkerId,
        /// What it had.
        tasks: Vec<u64>,
    },
    /// A task took so long that it is given to another worker too.
    Overdue {
        /// Worker.
        worker: WorkerId,
        /// Task.
        task: u64,
        /// How long it has been there.
        after: Duration,
    },
    /// An outcome belongs to another sample than the task of this number: the worker did something else.
    OtherSample {
        /// Worker.
        worker: WorkerId,
        /// Task.
        task: u64,
    },
}
