//! Batch systems by their commands: how a job with one worker is asked for, counted and withdrawn.
//!
//! A job is a process of ours that lives as long as the job does: `sbatch --wait`, `hq submit --wait`, `srun`, `ssh`. Whatever ends the
//! job, a time limit, `scancel`, a node that fails or a submission that is rejected, ends this process.

use std::fmt;
use std::str::FromStr;

/// The worker's job under Slurm, given to `sbatch` as standard input.
const SLURM_SCRIPT: &str = include_str!("../../../../deploy/slurm/workers.sbatch");

/// A batch system, or a command for one worker.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum BatchSystem {
    /// Slurm, by `sbatch --wait`, with `deploy/slurm/workers.sbatch`.
    Slurm,
    /// HyperQueue, by `hq submit --wait`, each job with all cores of a node.
    HyperQueue,
    /// A shell command that runs as long as its worker.
    Command(String),
}

impl FromStr for BatchSystem {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        match text.trim() {
            "" => Err("allowed: slurm, hyperqueue, or a shell command that runs one worker".to_owned()),
            "slurm" => Ok(BatchSystem::Slurm),
            "hyperqueue" => Ok(BatchSystem::HyperQueue),
            command => Ok(BatchSystem::Command(command.to_owned())),
        }
    }
}

impl fmt::Display for BatchSystem {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str(match self {
            BatchSystem::Slurm => "slurm",
            BatchSystem::HyperQueue => "hyperqueue",
            BatchSystem::Command(command) => command,
        })
    }
}

impl BatchSystem {
    /// Shell command that asks for a job and runs until it has ended.
    ///
    /// Its environment has CONNECT, the endpoint of the coordinator, WORKER_NAME, JOB_NAME (the same for all jobs of a campaign) and
    /// IDLE_TIMEOUT, the time after which a worker without tasks leaves [s].
    pub(super) fn submit(&self) -> &str {
        match self {
            BatchSystem::Slurm => "exec sbatch --wait --quiet --export=ALL --job-name=\"$JOB_NAME\"",
            BatchSystem::HyperQueue => {
                "exec hq submit --wait --name \"$JOB_NAME\" --cpus all --stdout none --stderr none -- worker --connect \"$CONNECT\" \
                 --name \"$WORKER_NAME\" --idle-timeout \"$IDLE_TIMEOUT\" --give-up-after 60 $WORKER_OPTIONS"
            }
            BatchSystem::Command(command) => command,
        }
    }

    /// Standard input of that command.
    pub(super) fn script(&self) -> &'static str {
        if *self == BatchSystem::Slurm { SLURM_SCRIPT } else { "" }
    }

    /// Shell command that prints a line for each job of the campaign that waits or runs, also those of an earlier coordinator.
    pub(super) fn list(&self) -> Option<&'static str> {
        match self {
            BatchSystem::Slurm => Some("squeue --noheader --format=%i --name=\"$JOB_NAME\""),
            BatchSystem::HyperQueue => Some(
                // Rows of its table: | number | name | ...
                "hq job list --filter waiting,running | awk -F'|' '{ gsub(/ /, \"\") } $3 == ENVIRON[\"JOB_NAME\"] { print $2 }'",
            ),
            BatchSystem::Command(_) => None,
        }
    }

    /// Shell command that withdraws the jobs of the campaign that still wait.
    pub(super) fn withdraw(&self) -> Option<&'static str> {
        match self {
            BatchSystem::Slurm => Some("scancel --name=\"$JOB_NAME\" --state=PENDING"),
            BatchSystem::HyperQueue => Some(
                "hq job list --filter waiting | awk -F'|' '{ gsub(/ /, \"\") } $3 == ENVIRON[\"JOB_NAME\"] { print $2 }' \
                 | xargs --no-run-if-empty -n 1 hq job cancel",
            ),
            BatchSystem::Command(_) => None,
        }
    }
}
