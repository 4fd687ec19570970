//! The messages between coordinator and workers.

use super::codec::{Message, WireError, encoded};
use super::numbers;
use crate::accuracy::Accuracy;
use crate::build::Build;
use crate::external::SimulatorId;
use crate::failure::SimulationFailure;
use crate::outputs::Evaluation;
use serde::{Deserialize, Serialize};

/// Identity of a worker process.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
pub struct WorkerId {
    /// Name, e.g. `host-4711`; see [`is_worker_name`].
    pub name: String,
    /// Number that differs with every start: it distinguishes the messages of a worker from those of its predecessor.
    pub epoch: u64,
}

/// Identity of an evaluation: campaign and number.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
pub struct TaskKey {
    /// Number of the campaign; the same after a restart of the coordinator.
    pub campaign: u64,
    /// Number of the evaluation in the campaign.
    pub task: u64,
}

/// One evaluation to perform.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Task {
    /// Campaign and number of the evaluation.
    pub key: TaskKey,
    /// Number of times the task was leased, this one included; from 1.
    pub attempt: u32,
    /// Values of the scene's random variables `(d,)`, SI.
    pub sample: Vec<f64>,
    /// Whether the settled first cycle is to be returned too.
    pub with_first_cycle: bool,
    /// Numerical settings of this evaluation, if they differ from those of its work order.
    pub accuracy: Option<Accuracy>,
    /// Level of accuracy of an external simulator, 0 for the first.
    pub level: u8,
}

impl Task {
    /// True if both tasks specify the same evaluation, bit for bit, regardless of the attempt.
    pub fn same_work(&self, other: &Task) -> bool {
        self.key == other.key
            && self.with_first_cycle == other.with_first_cycle
            && self.accuracy == other.accuracy
            && self.level == other.level
            && self.sample.len() == other.sample.len()
            && self.sample.iter().zip(&other.sample).all(|(a, b)| a.to_bits() == b.to_bits())
    }
}

/// An evaluation finished by a worker. It carries its task, so that a restarted coordinator can match it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Outcome {
    /// The evaluated task.
    pub task: Task,
    /// Worker and slot, e.g. `host-4711/0`.
    pub worker: String,
    /// Slot time of the simulation; simulations side by side share it [s].
    pub wall: f64,
    /// Evaluation, or the failure of the simulation.
    pub result: Result<Evaluation, SimulationFailure>,
}

impl Outcome {
    /// True if the outcome says nothing about its sample: the worker cannot use its simulator.
    pub fn is_unusable(&self) -> bool {
        matches!(self.result, Err(SimulationFailure::SimulatorUnusable { .. }))
    }
}

/// What a worker can evaluate.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub enum Offers {
    /// Scenes, by their text, simulated by a build of the program.
    Scenes(Build),
    /// External simulators that the worker has itself, and nothing else.
    Simulators(Vec<SimulatorId>),
}

impl Offers {
    /// True if tasks of `subject` may go to the worker.
    pub fn cover(&self, subject: &Subject) -> bool {
        match (self, subject) {
            (Self::Scenes(_), Subject::Scene(_)) => true,
            (Self::Simulators(offered), Subject::Simulator(wanted)) => offered.contains(wanted),
            _ => false,
        }
    }
}

/// Request of a worker for tasks, with finished outcomes. A worker sends the next claim only when the previous one was
/// answered or has timed out.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Claim {
    /// The worker that sends the claim.
    pub worker: WorkerId,
    /// Number of the claim within the epoch, increasing. A claim with a lower number than a previous one is outdated.
    pub sequence: u64,
    /// What the worker can evaluate.
    pub offers: Offers,
    /// Number of simulation threads.
    pub slots: u32,
    /// Most tasks in the reply.
    pub credits: u32,
    /// All tasks the worker holds, without acknowledged ones: running, waiting and finished. A lease missing from this list
    /// was lost in transit.
    pub holding: Vec<TaskKey>,
    /// Finished outcomes, sent until they are acknowledged.
    pub finished: Vec<Outcome>,
    /// The worker is leaving and drops its unfinished tasks.
    pub leaving: bool,
}

/// Reply to a [`Claim`].
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Reply {
    /// Outcomes that are durable (or not needed): the worker may discard them.
    pub acknowledged: Vec<TaskKey>,
    /// Next step of the worker.
    pub next: Next,
}

/// Next step of a worker. Without any reply, the worker backs off and claims again.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub enum Next {
    /// Evaluate these tasks.
    Work(WorkOrder),
    /// Wait: no task is available.
    Idle {
        /// Time after which to claim again, unless a notice arrives first [ms].
        ask_again: u32,
    },
    /// Leave: the campaign has ended.
    Leave {
        /// Number of the campaign.
        campaign: u64,
    },
}

/// What is to be evaluated.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub enum Subject {
    /// A scene, by its source text, TOML.
    Scene(String),
    /// An external simulator that the worker has itself. Neither command nor path nor address is sent.
    Simulator(SimulatorId),
}

/// Tasks with everything needed to evaluate them: workers keep no state between work orders.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct WorkOrder {
    /// Scene or simulator of the tasks.
    pub subject: Subject,
    /// Numerical settings of the tasks that state none.
    pub accuracy: Accuracy,
    /// Name of the numerical settings, for display.
    pub accuracy_name: String,
    /// Whether the tasks need licences: a worker without contact ends them after [`super::LICENCE_CONTACT`].
    pub licensed: bool,
    /// Tasks to evaluate.
    pub tasks: Vec<Task>,
}

/// Announcement of the coordinator to all workers.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub enum Notice {
    /// Candidate points are waiting to be claimed.
    Batch {
        /// Number of the campaign.
        campaign: u64,
        /// Numbers and samples of the points.
        points: Vec<CandidatePoint>,
    },
    /// The campaign has ended: the answer to a claim is now to leave.
    Ended {
        /// Number of the campaign.
        campaign: u64,
    },
}

/// A point of the sample space to be evaluated: number of the evaluation in the campaign, and values of the scene's random variables `(d,)`, SI.
pub type CandidatePoint = (u64, Vec<f64>);

/// Longest name of a worker [bytes].
pub const LONGEST_NAME: usize = 100;

/// True if `name` is allowed in a key: 1 to [`LONGEST_NAME`] letters, digits, `-`, `_` and `.`.
pub fn is_worker_name(name: &str) -> bool {
    (1..=LONGEST_NAME).contains(&name.len()) && name.bytes().all(is_name_byte)
}

/// A worker name from any text, e.g. a host name: characters not allowed in a key become `-`.
pub fn worker_name(text: &str) -> String {
    let text = if text.is_empty() { "-" } else { text };
    let allowed = |c: char| if c.is_ascii() && is_name_byte(c as u8) { c } else { '-' };
    text.chars().map(allowed).take(LONGEST_NAME).collect()
}

fn is_name_byte(byte: u8) -> bool {
    byte.is_ascii_alphanumeric() || matches!(byte, b'-' | b'_' | b'.')
}

encoded!(Claim, Reply, Notice, Outcome);

impl Message for Claim {
    const KIND: u8 = 1;
    const NAME: &'static str = "claim";

    fn check(&self) -> Result<(), WireError> {
        if !is_worker_name(&self.worker.name) {
            return Err(WireError::BadWorkerName);
        }
        self.finished.iter().try_for_each(check_outcome)
    }
}

impl Message for Reply {
    const KIND: u8 = 2;
    const NAME: &'static str = "reply";

    fn check(&self) -> Result<(), WireError> {
        let Next::Work(order) = &self.next else { return Ok(()) };
        check_accuracy(&order.accuracy)?;
        order.tasks.iter().try_for_each(check_task)
    }
}

impl Message for Notice {
    const KIND: u8 = 3;
    const NAME: &'static str = "notice";

    fn check(&self) -> Result<(), WireError> {
        let Notice::Batch { points, .. } = self else { return Ok(()) };
        points.iter().try_for_each(|(_, sample)| numbers::all_finite("sample", sample))
    }
}

fn check_accuracy(a: &Accuracy) -> Result<(), WireError> {
    a.out_of_range().map_or(Ok(()), |setting| Err(WireError::OutOfRange(setting)))
}

fn check_task(task: &Task) -> Result<(), WireError> {
    task.accuracy.iter().try_for_each(check_accuracy)?;
    numbers::all_finite("sample", &task.sample)
}

fn check_outcome(outcome: &Outcome) -> Result<(), WireError> {
    numbers::all_finite("wall time", &[outcome.wall])?;
    check_task(&outcome.task)?;
    let wrong = match &outcome.result {
        Ok(evaluation) => numbers::find_non_finite(evaluation).map(|(quantity, _)| quantity),
        Err(failure) => (!numbers::failure_is_finite(failure)).then(|| "failure".to_owned()),
    };
    wrong.map_or(Ok(()), |quantity| Err(WireError::NotFinite(quantity)))
}
