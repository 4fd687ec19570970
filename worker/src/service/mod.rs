//! The worker service: claims tasks from coordinators, evaluates them on its slots, returns the outcomes.
//!
//! ```text
//! ClaimLoop (one thread per coordinator, one open claim at a time) --Job--> Slots (threads; simulations side by side)
//!        ^  |                                                      <--Outcome--
//!        |  v
//!       Link (the only module of the worker that uses Zenoh)
//! ```
//!
//! Several coordinators share the slots fairly (`FairShare`); the end or crash of one does not affect the others.
//!
//! The worker keeps no state between work orders: a reply carries the scene with its tasks. An outcome is kept until it
//! is acknowledged (`UnacknowledgedResults`), so a coordinator may stop and the connection may break at any time. The
//! caller needs no tokio runtime; if it has one, it must be multi-threaded (a condition of Zenoh).

mod claim_loop;
mod connection_monitor;
mod fair_share;
mod guard;
mod leave_policy;
mod link;
mod pace;
#[cfg(test)]
mod practice_tests;
mod slots;
mod unacknowledged;
mod worker_handle;

use common::accuracy::Accuracy;
use common::failure::SimulationFailure;
use common::outputs::Evaluation;
use common::wire::{Offers, Outcome, Task, WireError, WorkOrder};
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::{Duration, Instant, SystemTime};
use thiserror::Error;
pub use worker_handle::{Stopper, WorkerHandle, run, spawn};

/// One task with its work order.
#[derive(Debug, Clone, PartialEq)]
pub struct Job {
    /// What the tasks of the campaign have in common.
    pub order: Arc<WorkOrder>,
    /// The task to work on.
    pub task: Task,
    /// Index of the coordinator that gets the outcome.
    pub coordinator: usize,
}

impl Job {
    /// Values of the scene's random variables `(d,)`, SI.
    pub fn sample(&self) -> &[f64] {
        &self.task.sample
    }

    /// Numerical settings of this evaluation.
    pub fn accuracy(&self) -> &Accuracy {
        self.task.accuracy.as_ref().unwrap_or(&self.order.accuracy)
    }
}

/// Evaluates samples; implemented by the program behind a worker.
pub trait Simulator: Send + Sync {
    /// What the worker announces to coordinators: it gets no tasks of anything else.
    fn offers(&self) -> Offers {
        Offers::Scenes(crate::build::BUILD)
    }

    /// Evaluates the sample of one job.
    ///
    /// # Errors
    /// [`SimulationFailure`], which is returned to the coordinator as the outcome of the task.
    fn simulate(&self, job: &Job) -> Result<Evaluation, SimulationFailure>;

    /// A campaign has ended: releases what is kept for further jobs, e.g. idle processes. Other campaigns may go on.
    fn on_campaign_ended(&self) {}

    /// The worker is leaving: the results of running jobs are not needed any more.
    fn stop(&self) {}

    /// Ends the running jobs of one coordinator, which may not go on without contact with it. Later jobs run as usual.
    fn stop_jobs_of(&self, _coordinator: usize) {}

    /// The running jobs of a coordinator that take licences end at `until`, even if this process can end nothing then. Replaces
    /// the earlier time; `None`: no such job runs.
    fn limit_contact(&self, _coordinator: usize, _until: Option<Instant>) {}

    /// Number of evaluations a thread runs side by side.
    fn side_by_side(&self) -> usize {
        1
    }

    /// Evaluates the jobs returned by `next` until it returns `None`, at most [`Simulator::side_by_side`] of them at a
    /// time. Calls `done` with the index of the job, counted from zero in the order of `next`, its result, and the time
    /// charged to it: its own, plus its share of the time spent on several jobs at once. A result must not depend on the
    /// jobs that run side by side with it.
    fn simulate_together(
        &self,
        next: &mut dyn FnMut() -> Option<Job>,
        done: &mut dyn FnMut(usize, Result<Evaluation, SimulationFailure>, Duration),
    ) {
        for number in 0.. {
            let Some(job) = next() else { return };
            let begun = Instant::now();
            let evaluation = self.simulate(&job);
            done(number, evaluation, begun.elapsed());
        }
    }
}

/// Settings of a worker.
#[derive(Debug, Clone, PartialEq)]
pub struct ServiceConfig {
    /// Endpoints of the coordinators, e.g. `tcp/192.168.1.20:7447`; they share the slots.
    pub connect: Vec<String>,
    /// File with further Zenoh settings (JSON5), e.g. certificates; the settings required by the service override it.
    pub zenoh_config: Option<PathBuf>,
    /// Number of simulation threads.
    pub slots: usize,
    /// Lower bound of the tasks prefetched beyond the slots; more are prefetched if tasks are so short that slots would
    /// wait for replies.
    pub prefetch: usize,
    /// Name shown by the coordinator, unique among its workers; characters not allowed in a key are replaced by `-`.
    pub name: String,
    /// Time without an answer after which the worker gives up; `None`: never.
    pub give_up_after: Option<Duration>,
    /// Time limit for the reply to a claim.
    pub answer_timeout: Duration,
    /// Time for running tasks to finish after a stop request; unfinished tasks are then returned.
    pub drain: Duration,
    /// Time without tasks after which the worker leaves; `None`: never.
    pub idle_timeout: Option<Duration>,
    /// Maximum run time. A task that cannot finish within it, judged by the measured times, is not started.
    pub walltime: Option<Duration>,
    /// Whether the worker waits for the next campaign when one has ended.
    pub next_campaign: bool,
    /// Whether the slots run at lower priority than the other threads of the process (Linux only).
    pub give_way: bool,
}

impl ServiceConfig {
    /// Default settings with `slots` threads for the coordinator at `connect`, and the name `<host>-<process number>`.
    pub fn new(connect: impl Into<String>, slots: usize) -> Self {
        Self {
            connect: vec![connect.into()],
            zenoh_config: None,
            slots,
            prefetch: 0,
            name: format!("{}-{}", host_name(), std::process::id()),
            give_up_after: Some(Duration::from_secs(30)),
            answer_timeout: Duration::from_secs(10),
            drain: Duration::ZERO,
            idle_timeout: None,
            walltime: None,
            next_campaign: false,
            give_way: false,
        }
    }
}

/// Normal reasons for a worker to exit.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Departure {
    /// The campaign of its coordinator has ended.
    CampaignEnded,
    /// It was stopped and has returned its finished outcomes.
    Stopped {
        /// Outcomes that could not be returned.
        lost: usize,
    },
    /// It had no tasks for [`ServiceConfig::idle_timeout`].
    Idle,
    /// Its [`ServiceConfig::walltime`] is over.
    TimeUp {
        /// Outcomes that could not be returned.
        lost: usize,
    },
    /// It was aborted and has dropped its tasks and outcomes.
    Aborted,
}

/// Reasons for a worker to fail.
#[derive(Debug, Error)]
pub enum ServiceError {
    /// A setting of the worker is wrong.
    #[error("{setting}: {reason}")]
    Settings {
        /// Name of the setting.
        setting: String,
        /// What is wrong with it.
        reason: String,
    },
    /// No coordinator answers.
    #[error(
        "no coordinator answered at {endpoint} for {seconds:.0} s ({last_reason}): is it running, is the address \
         right, does it accept this worker?"
    )]
    Unreachable {
        /// Endpoint of the coordinator.
        endpoint: String,
        /// Time since the first failed attempt [s].
        seconds: f64,
        /// Error of the last attempt.
        last_reason: String,
    },
    /// Coordinator and worker have different protocol versions.
    #[error(
        "the coordinator at {endpoint} uses protocol version {theirs}, this worker version {ours}: use the same \
         version of the program on both sides"
    )]
    OtherVersion {
        /// Endpoint of the coordinator.
        endpoint: String,
        /// Protocol version of the coordinator.
        theirs: u16,
        /// Protocol version of this worker.
        ours: u16,
    },
    /// A claim cannot be encoded.
    #[error("a claim cannot be sent: {0}")]
    Wire(#[from] WireError),
    /// The operating system cannot start a thread.
    #[error("cannot start a thread: {0}")]
    Thread(std::io::Error),
    /// Zenoh failed; the text is its error.
    #[error("messaging: {0}")]
    Messaging(String),
    /// A thread of the service panicked: a defect of the program.
    #[error("the service of the worker panicked")]
    Panicked,
}

/// Input of a claim loop, from slots, link and [`Stopper`].
#[derive(Debug)]
enum ClaimEvent {
    /// A slot has finished a task.
    Finished(Box<Outcome>),
    /// A slot may be free: a task of another coordinator has ended, or that coordinator needs fewer slots.
    SlotFree,
    /// The coordinator's reply to a claim, or its error text.
    Answer {
        /// Sequence number of the claim.
        sequence: u64,
        /// Frame of the reply, or the text of the error.
        frame: Result<Vec<u8>, String>,
    },
    /// No further reply to this claim will arrive. Holds the sequence number of the claim.
    QueryEnded(u64),
    /// A notice of the coordinator, as a frame.
    Notice(Vec<u8>),
    /// Stop: finish within the drain time, return outcomes and leave.
    Stop,
    /// Leave at once, without returning outcomes.
    Abort,
}

/// Number that increases with every start on this machine.
fn new_epoch() -> u64 {
    static STARTS: AtomicU64 = AtomicU64::new(0);
    let since = SystemTime::now().duration_since(SystemTime::UNIX_EPOCH).unwrap_or_default();
    let nanoseconds = u64::try_from(since.as_nanos()).unwrap_or(u64::MAX / 2);
    nanoseconds + STARTS.fetch_add(1, Ordering::Relaxed)
}

fn host_name() -> String {
    let from_kernel = std::fs::read_to_string("/proc/sys/kernel/hostname").ok();
    let name = from_kernel.or_else(|| std::env::var("HOSTNAME").ok()).unwrap_or_default();
    if name.trim().is_empty() { "worker".into() } else { name.trim().to_owned() }
}
