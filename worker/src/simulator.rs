//! The simulator of the `worker` command: text of a scene and sample in, one evaluation out.

use crate::service::{Job, Simulator};
use crate::simulate::{
    LaneWidth, SimulateOptions, SimulationInput, simulate, simulate_side_by_side, widest_lanes,
};
use common::failure::SimulationFailure;
use common::locks::locked;
use common::outputs::Evaluation;
use common::scene::SceneSource;
use common::wire::Subject;
use std::collections::VecDeque;
use std::sync::{Arc, Mutex};
use std::time::Duration;

/// Evaluations that a thread runs side by side, for a number of lanes. Two evaluations of two islands each fill four lanes, four fill
/// eight; with four lanes a third one fills those of an evaluation that updates its wear. More gain nothing and take memory (`cargo bench`:
/// `at_a_time`).
fn evaluations_for(lanes: usize) -> usize {
    2 + lanes / 4
}

/// The simulator of the `worker` command and of the coordinator's local workers.
pub fn simulator() -> Arc<dyn Simulator> {
    Arc::new(Mechanism::default())
}

/// Parsed scenes kept: usually one for each coordinator that shares the worker.
const CACHED_SCENES: usize = 4;

/// Simulates scenes and caches the parsed ones, since consecutive tasks usually have the same scene. A cached scene is a
/// function of its text, so a result does not depend on previous tasks.
#[derive(Default)]
struct Mechanism {
    /// Parsed scenes, the most recently used first.
    last: Mutex<VecDeque<Arc<SceneSource>>>,
}

impl Mechanism {
    /// The parsed scene of `text`, from the cache if possible.
    fn source(&self, text: &str) -> Result<Arc<SceneSource>, SimulationFailure> {
        let mut last = locked(&self.last);
        let cached = last.iter().position(|source| source.text() == text).and_then(|at| last.remove(at));
        let source = match cached {
            Some(source) => source,
            None => SceneSource::parse(text, "task").map(Arc::new).map_err(invalid)?,
        };
        last.truncate(CACHED_SCENES - 1);
        last.push_front(Arc::clone(&source));
        Ok(source)
    }

    fn input(&self, job: &Job) -> Result<SimulationInput, SimulationFailure> {
        let Subject::Scene(text) = &job.order.subject else {
            let reason = "this worker simulates mechanisms only".to_owned();
            return Err(SimulationFailure::SimulatorUnusable { reason });
        };
        let scene = self.source(text)?.resolve_sample(job.sample()).map_err(invalid)?;
        if scene.simulator.is_some() {
            let what = "a scene that names its own simulator; a worker with it is started with --simulator"
                .to_owned();
            return Err(SimulationFailure::NotModelled { what });
        }
        let options = SimulateOptions { first_cycle: job.task.with_first_cycle };
        Ok(SimulationInput { scene, accuracy: *job.accuracy(), options })
    }
}

impl Simulator for Mechanism {
    fn simulate(&self, job: &Job) -> Result<Evaluation, SimulationFailure> {
        let SimulationInput { scene, accuracy, options } = self.input(job)?;
        simulate(&scene, &accuracy, options)
    }

    fn side_by_side(&self) -> usize {
        evaluations_for(widest_lanes())
    }

    fn simulate_together(
        &self,
        next: &mut dyn FnMut() -> Option<Job>,
        done: &mut dyn FnMut(usize, Result<Evaluation, SimulationFailure>, Duration),
    ) {
        let mut input = || next().map(|job| self.input(&job));
        simulate_side_by_side(LaneWidth::Widest, self.side_by_side(), &mut input, done);
    }
}

fn invalid(faults: common::scene::Faults) -> SimulationFailure {
    SimulationFailure::InvalidSample { faults: faults.to_string() }
}
