//! How a study is getting on, as a coordinator tells it to whoever asks: workers, queue, evaluations, reliability so far.

use super::codec::{Message, WireError};
use super::numbers;
use serde::{Deserialize, Serialize};

/// What a coordinator says of itself.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Status {
    /// Version of the program, for people.
    pub program: String,
    /// The coordinator's clock: time since 1970 in UTC [ms].
    pub clock_ms: u64,
    /// How long it has been listening [s].
    pub up: f64,
    /// What it is at.
    pub phase: Phase,
    /// The study.
    pub study: StudyStatus,
    /// Who works for it.
    pub farm: FarmStatus,
}

/// What a coordinator is at.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum Phase {
    /// Evaluations wait, and nobody is there to do them.
    #[default]
    Waiting,
    /// Evaluations are under way.
    Simulating,
    /// Nothing is under way: the study thinks about what comes next.
    Learning,
    /// Everything is evaluated: the results are worked out and written.
    Ending,
}

impl Phase {
    /// In one word, for people and scripts.
    pub fn name(self) -> &'static str {
        match self {
            Phase::Waiting => "waiting",
            Phase::Simulating => "simulating",
            Phase::Learning => "learning",
            Phase::Ending => "ending",
        }
    }
}

/// How far a study is.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct StudyStatus {
    /// Name of its scene.
    pub scene: String,
    /// What the evaluations under way are for, e.g. `round 3`.
    pub purpose: String,
    /// Evaluations that have ended.
    pub done: u64,
    /// Of these, without a result.
    pub failed: u64,
    /// Of these, found in the campaign file.
    pub recalled: u64,
    /// Evaluations known of so far, those done included.
    pub planned: u64,
    /// Bound on evaluations.
    pub budget: u64,
    /// Simulation time of the evaluations that were not recalled [s].
    pub simulation: f64,
    /// Rounds of learning that have ended.
    pub rounds: u64,
    /// After the last of them.
    pub reliability: Option<ReliabilitySoFar>,
    /// Warnings to the user so far.
    pub warnings: u64,
}

/// Reliability of the system as estimated so far.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct ReliabilitySoFar {
    /// Where in life: where it is nearest one half [cycles].
    pub cycles: u32,
    /// Reliability there [1].
    pub total: f64,
    /// Its standard error, of surrogates and of counting [1].
    pub standard_error: f64,
}

/// Who works for a study.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct FarmStatus {
    /// Evaluations that nobody has begun.
    pub queued: u64,
    /// Evaluations at workers.
    pub under_way: u64,
    /// Evaluations that ended within the last minute [1/s].
    pub rate: f64,
    /// Workers that are connected, by name.
    pub workers: Vec<WorkerStatus>,
}

impl FarmStatus {
    /// Simulations that can run at once.
    pub fn slots(&self) -> u64 {
        self.workers.iter().map(|worker| u64::from(worker.slots)).sum()
    }
}

/// One connected worker.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct WorkerStatus {
    /// Name.
    pub name: String,
    /// Threads that simulate; 0 until its first claim.
    pub slots: u32,
    /// Evaluations it has.
    pub under_way: u32,
    /// Evaluations it has ended for this coordinator.
    pub done: u64,
    /// Those that ended within the last minute [1/s].
    pub rate: f64,
}

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
