//! Status of a study, as a reply to status queries: workers, queue, evaluations, interim reliability.

use super::codec::{Message, WireError, encoded};
use super::numbers;
use serde::{Deserialize, Serialize};

/// Status of a coordinator.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Status {
    /// Version of the program.
    pub program: String,
    /// The coordinator's clock: time since 1970-01-01 UTC [ms].
    pub clock_ms: u64,
    /// Time since it started to listen [s].
    pub up: f64,
    /// Current phase of the study.
    pub phase: Phase,
    /// Progress of the study.
    pub study: StudyStatus,
    /// Workers and queue.
    pub farm: FarmStatus,
    /// Jobs asked for of a batch system, if the coordinator asks for any.
    pub scale: Option<ScaleStatus>,
}

/// Phase of a coordinator.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum Phase {
    /// Evaluations wait, and no worker is connected.
    #[default]
    Waiting,
    /// Evaluations are running.
    Simulating,
    /// No evaluation is running: the study fits surrogates and selects points.
    Learning,
    /// All evaluations have ended: the results are computed and written.
    Ending,
}

impl Phase {
    /// Name of the phase in one word, for display and scripts.
    pub fn name(self) -> &'static str {
        ["waiting", "simulating", "learning", "ending"][self as usize]
    }
}

/// Progress of a study.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct StudyStatus {
    /// Name of the scene.
    pub scene: String,
    /// Purpose of the running evaluations, e.g. `round 3`.
    pub purpose: String,
    /// Evaluations that have ended.
    pub done: u64,
    /// Ended evaluations without a result.
    pub failed: u64,
    /// Ended evaluations found in the campaign file.
    pub recalled: u64,
    /// Evaluations requested so far, including those that have ended.
    pub planned: u64,
    /// Upper bound of the evaluations.
    pub budget: u64,
    /// Simulation time of the evaluations not found in the campaign file [s].
    pub simulation: f64,
    /// Completed learning rounds.
    pub rounds: u64,
    /// Reliability after the last completed round.
    pub reliability: Option<ReliabilitySoFar>,
    /// Number of warnings to the user so far.
    pub warnings: u64,
}

/// Interim estimate of the system's reliability.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct ReliabilitySoFar {
    /// Checkpoint with the reliability nearest to one half [cycles].
    pub cycles: u32,
    /// Reliability at this checkpoint [1].
    pub total: f64,
    /// Standard error of the reliability, from surrogates and sampling [1].
    pub standard_error: f64,
}

/// Workers and queue of a study.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct FarmStatus {
    /// Evaluations without a worker.
    pub queued: u64,
    /// Evaluations leased to workers.
    pub under_way: u64,
    /// Rate of ended evaluations over the last minute [1/s].
    pub rate: f64,
    /// Connected workers, in the order of their names.
    pub workers: Vec<WorkerStatus>,
}

impl FarmStatus {
    /// Simulations that can run concurrently.
    pub fn slots(&self) -> u64 {
        self.workers.iter().map(|worker| u64::from(worker.slots)).sum()
    }
}

/// Jobs of a batch system that a coordinator asked for, each with one worker.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct ScaleStatus {
    /// The batch system, or the command for a job.
    pub system: String,
    /// Most jobs at once.
    pub most: u64,
    /// Jobs asked for so far.
    pub asked: u64,
    /// Jobs whose workers have not connected yet.
    pub waiting: u64,
    /// Jobs whose workers are connected.
    pub running: u64,
    /// Jobs that ended before their workers connected.
    pub failed: u64,
    /// Why the last one of these failed; empty if none has.
    pub last_failure: String,
}

/// One connected worker.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct WorkerStatus {
    /// Name of the worker.
    pub name: String,
    /// Simulation threads; 0 until the first claim.
    pub slots: u32,
    /// Evaluations leased to it.
    pub under_way: u32,
    /// Evaluations it has finished for this coordinator.
    pub done: u64,
    /// Rate of its finished evaluations over the last minute [1/s].
    pub rate: f64,
}

encoded!(Status);

impl Message for Status {
    const KIND: u8 = 4;
    const NAME: &'static str = "status";

    fn check(&self) -> Result<(), WireError> {
        numbers::all_finite("times", &[self.up, self.study.simulation])?;
        if let Some(so_far) = &self.study.reliability {
            numbers::all_finite("reliability", &[so_far.total, so_far.standard_error])?;
        }
        numbers::all_finite("rate", &[self.farm.rate])?;
        self.farm.workers.iter().try_for_each(|worker| numbers::all_finite("rate", &[worker.rate]))
    }
}
