//! What coordinator and workers say to each other.

use super::codec::{Message, WireError};
use super::keys;
use super::numbers;
use crate::accuracy::Accuracy;
use crate::failure::SimulationFailure;
use crate::outputs::Evaluation;
use serde::{Deserialize, Serialize};

/// One start of one worker.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
pub struct WorkerId {
    /// Name, e.g. `host-4711`; see [`keys::is_worker_name`].
    pub name: String,
    /// Differs with every start, so that a dead worker's messages are told from its successor's.
    pub epoch: u64,
}

/// Which evaluation of which campaign.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
pub struct TaskKey {
    /// Campaign; the same after a coordinator's restart.
    pub campaign: u64,
    /// Number of the evaluation in the campaign.
    pub task: u64,
}

/// One evaluation to do.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Task {
    /// Which.
    pub key: TaskKey,
    /// How often it was handed out, this time included; from 1.
    pub attempt: u32,
    /// Values of the scene's random variables `(d,)`, SI.
    pub sample: Vec<f64>,
    /// Whether the settled first cycle is wanted too.
    pub with_first_cycle: bool,
    /// Numerical settings of this evaluation, where they are not those of its order.
    pub accuracy: Option<Accuracy>,
}

impl Task {
    /// Whether both ask for the same evaluation, bit for bit, in whatever attempt.
    pub fn same_work(&self, other: &Task) -> bool {
        self.key == other.key
            && self.with_first_cycle == other.with_first_cycle
            && self.accuracy == other.accuracy
            && self.sample.len() == other.sample.len()
            && self.sample.iter().zip(&other.sample).all(|(a, b)| a.to_bits() == b.to_bits())
    }
}

/// One evaluation that has ended at a worker. It carries its task, so that the coordinator needs no memory of
/// what it handed out to know what it is about.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Outcome {
    /// What was asked.
    pub task: Task,
    /// Who did it: worker and slot, e.g. `host-4711/0`.
    pub worker: String,
    /// Time of the slot that the simulation took; what is side by side shares it [s].
    pub wall: f64,
    /// What came of it.
    pub result: Result<Evaluation, SimulationFailure>,
}

/// A worker asks for tasks and hands in outcomes. Claims of one worker follow one another: the next is sent
/// only when the one before was answered or given up.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Claim {
    /// Who asks.
    pub worker: WorkerId,
    /// Number of the claim within the epoch, rising. A claim with a lower number than one seen is outdated.
    pub sequence: u64,
    /// Threads it simulates on.
    pub slots: u32,
    /// Tasks it would take now.
    pub credits: u32,
    /// Everything it has and was not acknowledged: running, waiting and finished. What the coordinator believes
    /// to be there and is not in this list was lost on the way.
    pub holding: Vec<TaskKey>,
    /// Finished outcomes, offered until acknowledged.
    pub finished: Vec<Outcome>,
    /// It is going away on its own accord and drops what it has not finished.
    pub leaving: bool,
}

/// Answer to a [`Claim`].
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Reply {
    /// Outcomes that are durable (or not wanted): the worker may forget them.
    pub acknowledged: Vec<TaskKey>,
    /// What to do next.
    pub next: Next,
}

/// What a worker does next. No answer at all is a third thing: back off and ask again.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub enum Next {
    /// Evaluate these.
    Work(WorkOrder),
    /// Nothing to do now.
    Idle {
        /// When to ask again, unless a notice comes first [ms].
        ask_again: u32,
    },
    /// The coordinator has finished.
    Leave,
}

/// Tasks with all it takes to do them: workers keep no state between orders.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct WorkOrder {
    /// Source text of the scene, TOML.
    pub scene: String,
    /// Numerical settings of every task that does not bring its own.
    pub accuracy: Accuracy,
    /// Name of the settings, for people.
    pub accuracy_name: String,
    /// What to evaluate.
    pub tasks: Vec<Task>,
}

/// What the coordinator publishes to all workers.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub enum Notice {
    /// Candidate points that wait to be claimed.
    Batch {
        /// Campaign.
        campaign: u64,
        /// The points.
        points: Vec<CandidatePoint>,
    },
    /// The campaign has come to its end; workers may go.
    Ended {
        /// Campaign.
        campaign: u64,
    },
}

/// A point of the sample space that is to be evaluated.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct CandidatePoint {
    /// Number of the evaluation in the campaign.
    pub task: u64,
    /// Values of the scene's random variables `(d,)`, SI.
    pub sample: Vec<f64>,
}

impl Message for Claim {
    const KIND: u8 = 1;
    const NAME: &'static str = "claim";

    fn check(&self) -> Result<(), WireError> {
        if !keys::is_worker_name(&self.worker.name) {
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
        points.iter().try_for_each(|point| numbers::all_finite("sample", &point.sample))
    }
}

fn check_accuracy(a: &Accuracy) -> Result<(), WireError> {
    let knobs = [a.step_tolerance, a.largest_step, a.jump_tolerance, a.wear_tolerance, a.warm_up];
    numbers::all_finite("accuracy", &knobs)
}

fn check_task(task: &Task) -> Result<(), WireError> {
    task.accuracy.iter().try_for_each(check_accuracy)?;
    numbers::all_finite("sample", &task.sample)
}

fn check_outcome(outcome: &Outcome) -> Result<(), WireError> {
    numbers::all_finite("wall time", &[outcome.wall])?;
    check_task(&outcome.task)?;
    let bad = |quantity: String| WireError::NotFinite { quantity };
    match &outcome.result {
        Ok(evaluation) => match numbers::find_non_finite(evaluation) {
            Some(found) => Err(bad(found.quantity)),
            None => Ok(()),
        },
        Err(failure) if !numbers::failure_is_finite(failure) => Err(bad("failure".into())),
        Err(_) => Ok(()),
    }
}
