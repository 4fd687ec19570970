//! Offers a simulator to coordinators: claims tasks, evaluates them on its slots, hands the outcomes in.
//!
//! ```text
//! claims (a thread a coordinator: one claim under way at a time) --job--> slots (threads: simulations side by side)
//!        ^  |                                                    <--outcome--
//!        |  v
//!       link (the only place of the worker that knows Zenoh)
//! ```
//!
//! Several coordinators share the slots fairly (`shares`); the end or death of one does not touch the others.
//!
//! The worker keeps no state between orders: a reply carries the scene with its tasks. It forgets an outcome
//! only when it was acknowledged, so a coordinator may stop, or the line may break, at any moment. Nothing here
//! needs a tokio runtime of the caller; inside one, it must be a multi-threaded one (Zenoh's own condition).

mod claim_event;
mod claim_loop;
mod connection_monitor;
mod fair_share;
mod guard;
mod leave_policy;
mod link;
#[cfg(test)]
mod practice;
mod prefetch;
mod queue;
mod slots;
mod unacknowledged;
mod worker_handle;

use common::accuracy::Accuracy;
use common::failure::SimulationFailure;
use common::outputs::Evaluation;
use common::wire::{Task, WorkOrder};
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::{Duration, Instant, SystemTime};
use thiserror::Error;
pub use worker_handle::{Stopper, WorkerHandle, run, spawn};

/// One task with the order it came in.
#[derive(Debug, Clone, PartialEq)]
pub struct Job {
    order: Arc<WorkOrder>,
    task: Task,
    /// Which of the worker's coordinators wants it.
    place: usize,
}

impl Job {
    /// Text of the scene.
    pub fn scene(&self) -> &str {
        &self.order.scene
    }

    /// Values of its random variables, SI.
    pub fn sample(&self) -> &[f64] {
        &self.task.sample
    }

    /// How accurately it is wanted.
    pub fn accuracy(&self) -> &Accuracy {
        self.task.accuracy.as_ref().unwrap_or(&self.order.accuracy)
    }

    /// Whether the settled first cycle is wanted too.
    pub fn with_first_cycle(&self) -> bool {
        self.task.with_first_cycle
    }
}

/// What a worker offers.
pub trait Simulator: Send + Sync {
    /// Evaluates one sample of a scene.
    ///
    /// # Errors
    /// [`SimulationFailure`]: an outcome like any other, handed in as such.
    fn simulate(
        &self,
        scene: &str,
        sample: &[f64],
        accuracy: &Accuracy,
        with_first_cycle: bool,
    ) -> Result<Evaluation, SimulationFailure>;

    /// Evaluations that a thread should have under way at once.
    fn side_by_side(&self) -> usize {
        1
    }

    /// Evaluates what `next` gives until it gives nothing, [`Simulator::side_by_side`] or fewer at a time; `done` takes
    /// each result with the number of its job, counted from zero as they were given, and the time it took, its share of
    /// what was done for several at once. A result does not depend on what was beside.
    fn simulate_together(
        &self,
        next: &mut dyn FnMut() -> Option<Job>,
        done: &mut dyn FnMut(usize, Result<Evaluation, SimulationFailure>, Duration),
    ) {
        for number in 0.. {
            let Some(job) = next() else { return };
            let begun = Instant::now();
            let evaluation = self.simulate(job.scene(), job.sample(), job.accuracy(), job.with_first_cycle());
            done(number, evaluation, begun.elapsed());
        }
    }
}

/// How a worker serves.
#[derive(Debug, Clone, PartialEq)]
pub struct ServiceConfig {
    /// Where the coordinators are, e.g. `tcp/192.168.1.20:7447`; they share the slots.
    pub connect: Vec<String>,
    /// More Zenoh settings (JSON5 file), e.g. certificates; what the service needs stands above them.
    pub zenoh_config: Option<PathBuf>,
    /// Threads that simulate.
    pub slots: usize,
    /// Tasks to hold in reserve beyond the slots at least; more where tasks are so short that slots would wait for
    /// answers.
    pub prefetch: usize,
    /// Name, unique where people look at it; what cannot stand in a key becomes `-`.
    pub name: String,
    /// How long the coordinator may be out of reach before the worker gives up; `None`: for ever.
    pub give_up_after: Option<Duration>,
    /// How long an answer to a claim may take.
    pub answer_timeout: Duration,
    /// How long what runs may go on once the worker is asked to stop; what has not ended by then is handed back.
    pub drain: Duration,
    /// How long there may be nothing to do before the worker leaves; `None`: for ever.
    pub idle_timeout: Option<Duration>,
    /// Time after which the worker has left. It begins nothing that, by what it has measured, would not end before.
    pub walltime: Option<Duration>,
    /// Whether it waits for the next campaign where one has ended.
    pub next_campaign: bool,
    /// Whether its slots give way to other threads of the process that want a core (on Linux).
    pub give_way: bool,
}

impl ServiceConfig {
    /// `slots` threads for the coordinator at `connect`, under the name `<host>-<process>`.
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

/// Why a worker has ended as it should.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Departure {
    /// The coordinator has finished.
    CampaignEnded,
    /// It was asked to stop, and what it had finished was handed in.
    Stopped {
        /// Outcomes that could not be handed in.
        lost: usize,
    },
    /// It had nothing to do for too long.
    Idle,
    /// Its time was up.
    TimeUp {
        /// Outcomes that could not be handed in.
        lost: usize,
    },
    /// It was told to drop everything at once.
    Aborted,
}

/// Why a worker cannot serve.
#[derive(Debug, Error)]
pub enum ServiceError {
    /// A setting of its own is wrong.
    #[error("{setting}: {reason}")]
    Settings {
        /// Which.
        setting: String,
        /// What is wrong.
        reason: String,
    },
    /// Nobody answers.
    #[error(
        "no coordinator answered at {endpoint} for {seconds:.0} s ({last_reason}): is it running, is the address \
         right, does it accept this worker?"
    )]
    Unreachable {
        /// Where it should be.
        endpoint: String,
        /// How long it was tried [s].
        seconds: f64,
        /// What the last attempt said.
        last_reason: String,
    },
    /// Coordinator and worker come from different versions of the program.
    #[error(
        "the coordinator at {endpoint} speaks protocol version {theirs}, this worker version {ours}: use the same \
         version of the program on both sides"
    )]
    OtherVersion {
        /// Where it is.
        endpoint: String,
        /// Its version.
        theirs: u16,
        /// Ours.
        ours: u16,
    },
    /// The messaging library failed.
    #[error("messaging: {0}")]
    Messaging(String),
    /// The thread of the service broke: a defect of the program.
    #[error("the service of the worker panicked")]
    Panicked,
}

/// Rises with every start on this machine.
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
