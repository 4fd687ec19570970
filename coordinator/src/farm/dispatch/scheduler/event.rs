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
    /// A worker claims tasks and returns outcomes.
    Claimed {
        /// Identifies the claim in its reply.
        token: Token,
        /// Contents of the claim.
        claim: Claim,
    },
    /// The outcome of this task is durable.
    Recorded {
        /// Number of the evaluation.
        task: u64,
    },
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
    /// Answer a claim.
    Reply {
        /// Identifies the claim.
        token: Token,
        /// Outcomes the worker may discard.
        acknowledged: Vec<TaskKey>,
        /// Next step of the worker.
        assignment: Assignment,
    },
    /// Announce waiting points to all workers.
    Announce(Vec<CandidatePoint>),
    /// Announce the end of the campaign to all workers.
    AnnounceEnd,
    /// Give a task up without outcome.
    GiveUp {
        /// Number of the evaluation.
        task: u64,
        /// Number and kind of its losses.
        reason: String,
    },
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
    /// Tasks wait and no worker is connected.
    NoWorker {
        /// Tasks without an outcome.
        open: usize,
        /// Time without any worker.
        since: Duration,
    },
    /// A worker claims tasks but has no liveliness token (access rules?). Its loss could not be detected, so it gets no
    /// tasks.
    NoLiveliness {
        /// The worker concerned.
        worker: WorkerId,
    },
    /// A worker was lost with leased tasks, which are requeued.
    WorkerLost {
        /// The worker concerned.
        worker: WorkerId,
        /// Numbers of its tasks.
        tasks: Vec<u64>,
    },
    /// A task exceeded its deadline; another worker gets it too.
    Overdue {
        /// The worker concerned.
        worker: WorkerId,
        /// Number of the task.
        task: u64,
        /// Time since its lease.
        after: Duration,
    },
    /// A worker does not offer the scene or simulator of the campaign, so it gets no tasks.
    NotOffered {
        /// The worker concerned.
        worker: WorkerId,
        /// What it offers.
        offers: Offers,
    },
    /// A worker cannot use its simulator, so it gets no more tasks.
    Unusable {
        /// The worker concerned.
        worker: WorkerId,
        /// What it reports.
        reason: String,
    },
    /// A claim is not newer than an earlier one of its worker, which gets no tasks by it.
    OutdatedClaim {
        /// The worker concerned.
        worker: WorkerId,
        /// Number of such claims so far.
        count: u64,
    },
    /// An outcome belongs to another campaign.
    OtherCampaign {
        /// The worker concerned.
        worker: WorkerId,
        /// Number of such outcomes so far.
        count: u64,
    },
    /// An outcome has the number of a task but another sample.
    OtherSample {
        /// The worker concerned.
        worker: WorkerId,
        /// Number of the task.
        task: u64,
    },
}
