//! Times of a study over all its runs: the first one and every `resume`.

use serde::{Deserialize, Serialize};

/// Wall-clock times of a study [s], summed over its runs.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Timing {
    /// Duration of the study, without the time between its runs.
    pub total: f64,
    /// Sum of the simulation times of all evaluations.
    pub simulation: f64,
    /// Fitting, prediction and selection of points.
    pub surrogate: f64,
    /// Time in which no evaluation was under way, summed over the slots.
    pub idle: f64,
    /// Number of runs; 0 in studies by earlier versions, whose times are those of the last run.
    pub runs: u32,
    /// Largest number of workers that simulated in one run; 0 in studies by earlier versions.
    pub workers: u32,
}

impl Timing {
    /// These times and those of a run that follows; simulation times are those of all evaluations already.
    #[must_use]
    pub fn with_run(&self, run: &Timing) -> Timing {
        Timing {
            total: self.total + run.total,
            simulation: run.simulation,
            surrogate: self.surrogate + run.surrogate,
            idle: self.idle + run.idle,
            runs: self.runs + 1,
            workers: self.workers.max(run.workers),
        }
    }
}

/// Jobs that a coordinator asked for of a batch system in the last run of a study.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct ScaleRow {
    /// The batch system, or the command for a job.
    pub system: String,
    /// Most jobs at once.
    pub most: u64,
    /// Jobs asked for.
    pub asked: u64,
    /// Jobs that were refused or ended before their workers connected.
    pub failed: u64,
}

/// Contribution of one worker.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct WorkerShare {
    /// Name of the worker.
    pub name: String,
    /// Number of evaluations.
    pub evaluations: usize,
    /// Sum of the simulation times [s].
    pub simulation_s: f64,
}
