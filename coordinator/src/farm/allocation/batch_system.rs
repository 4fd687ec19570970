//! Batch systems by their commands: how a job with one worker is asked for, counted and withdrawn.
//!
//! A job is a process of ours that lives as long as the job does: `sbatch --wait`, `hq submit --wait`, `srun`, `ssh`. Whatever ends the
//! job, a time limit, `scancel`, a node that fails or a submission that is rejected, ends this process.

use std::fmt;
use std::str::FromStr;

/// Slurm: `sbatch` receives the worker's job as standard input.
const SLURM: [&str; 4] = [
    "exec sbatch --wait --quiet --export=ALL --job-name=\"$JOB_NAME\"",
    include_str!("../../../../deploy/slurm/workers.sbatch"),
    "squeue --noheader --format=%i --name=\"$JOB_NAME\"",
    "scancel --name=\"$JOB_NAME\" --state=PENDING",
];

/// HyperQueue. The rows of its table: | number | name | ...
const HYPERQUEUE: [&str; 4] = [
    "exec hq submit --wait --name \"$JOB_NAME\" --cpus all --stdout none --stderr none -- worker --connect \"$CONNECT\" \
     --name \"$WORKER_NAME\" --idle-timeout \"$IDLE_TIMEOUT\" --give-up-after 60 $WORKER_OPTIONS",
    "",
    "hq job list --filter waiting,running | awk -F'|' '{ gsub(/ /, \"\") } $3 == ENVIRON[\"JOB_NAME\"] { print $2 }'",
    "hq job list --filter waiting | awk -F'|' '{ gsub(/ /, \"\") } $3 == ENVIRON[\"JOB_NAME\"] { print $2 }' \
     | xargs --no-run-if-empty -n 1 hq job cancel",
];

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
    /// The shell command that asks for a job and runs until it has ended; its standard input; the command that prints a line for each job of
    /// the campaign that waits or runs, also those of an earlier coordinator; and the one that withdraws those that still wait. The last two
    /// are empty for a command for one worker.
    ///
    /// Their environment has CONNECT, the endpoint of the coordinator, WORKER_NAME, JOB_NAME (the same for all jobs of a campaign) and
    /// IDLE_TIMEOUT, the time after which a worker without tasks leaves [s].
    pub(super) fn commands(&self) -> [&str; 4] {
        match self {
            BatchSystem::Slurm => SLURM,
            BatchSystem::HyperQueue => HYPERQUEUE,
            BatchSystem::Command(command) => [command, "", "", ""],
        }
    }
}
