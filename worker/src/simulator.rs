//! The simulator this program offers to a coordinator: a scene's text and a sample in, one evaluation out.

use crate::service::{Job, Simulator};
use crate::simulate::{Order, Width, simulate, simulate_together};
use common::accuracy::Accuracy;
use common::failure::SimulationFailure;
use common::outputs::Evaluation;
use common::scene::SceneSource;
use std::collections::VecDeque;
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

/// Evaluations a thread has under way at once. Two, of two islands each, fill four lanes; a third stands in where one of them
/// wears its bores; more gain nothing, and take 6 MB each.
const SIDE_BY_SIDE: usize = 3;

/// The simulator of the `worker` command and of local workers.
pub fn simulator() -> Arc<dyn Simulator> {
    Arc::new(Mechanism::default())
}

/// Scenes that are remembered: one for each of the coordinators that share a worker, as a rule.
const REMEMBERED: usize = 4;

/// Simulates scenes; remembers the last ones parsed, one of which is the next one asked for in all but name. What it
/// remembers is a function of the task, so a task does not depend on the tasks before it.
#[derive(Default)]
struct Mechanism {
    /// The latest used first.
    last: Mutex<VecDeque<Arc<SceneSource>>>,
}

impl Mechanism {
    fn source(&self, text: &str) -> Result<Arc<SceneSource>, SimulationFailure> {
        let mut last = self.last.lock().unwrap_or_else(PoisonError::into_inner);
        let known = last.iter().position(|source| source.text() == text).and_then(|at| last.remove(at));
        let source = match known {
            Some(source) => source,
            None => SceneSource::parse(text, "task").map(Arc::new).map_err(invalid)?,
        };
        last.truncate(REMEMBERED - 1);
        last.push_front(Arc::clone(&source));
        Ok(source)
    }

    fn order(
        &self,
        scene: &str,
        sample: &[f64],
        accuracy: &Accuracy,
        with_first_cycle: bool,
    ) -> Result<Order, SimulationFailure> {
        let scene = self.source(scene)?.resolve_sample(sample).map_err(invalid)?;
        Ok(Order { scene, accuracy: *accuracy, with_first_cycle })
    }
}

impl Simulator for Mechanism {
    fn simulate(
        &self,
        scene: &str,
        sample: &[f64],
        accuracy: &Accuracy,
        with_first_cycle: bool,
    ) -> Result<Evaluation, SimulationFailure> {
        let Order { scene, .. } = self.order(scene, sample, accuracy, with_first_cycle)?;
        simulate(&scene, accuracy, with_first_cycle)
    }

    fn side_by_side(&self) -> usize {
        SIDE_BY_SIDE
    }

    fn simulate_together(
        &self,
        next: &mut dyn FnMut() -> Option<Job>,
        done: &mut dyn FnMut(usize, Result<Evaluation, SimulationFailure>, Duration),
    ) {
        let mut order = || {
            let job = next()?;
            Some(self.order(job.scene(), job.sample(), job.accuracy(), job.with_first_cycle()))
        };
        simulate_together(Width::Widest, SIDE_BY_SIDE, &mut order, done);
    }
}

fn invalid(faults: common::scene::Faults) -> SimulationFailure {
    SimulationFailure::InvalidSample { faults: faults.to_string() }
}
