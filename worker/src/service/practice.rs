//! What the tests of the service share.

use super::{Job, Simulator};
use common::accuracy::Accuracy;
use common::failure::SimulationFailure;
use common::outputs::{Diagnostics, Evaluation};
use common::wire::{Task, TaskKey, WorkOrder};
use std::sync::Arc;
use std::time::Duration;

/// A simulator made of a closure; of what it has side by side, it begins all before it ends any.
pub struct Practice<F>(pub F);

impl<F: Fn(f64) -> Result<Evaluation, SimulationFailure> + Send + Sync> Simulator for Practice<F> {
    fn simulate(
        &self,
        _scene: &str,
        sample: &[f64],
        _accuracy: &Accuracy,
        _with_first_cycle: bool,
    ) -> Result<Evaluation, SimulationFailure> {
        self.0(sample[0])
    }

    fn simulate_together(
        &self,
        next: &mut dyn FnMut() -> Option<Job>,
        done: &mut dyn FnMut(usize, Result<Evaluation, SimulationFailure>, Duration),
    ) {
        let jobs: Vec<Job> = std::iter::from_fn(next).collect();
        jobs.iter().enumerate().for_each(|(number, job)| {
            done(number, self.0(job.sample()[0]), Duration::from_millis(250));
        });
    }
}

/// A job with this sample.
pub fn job(x: f64) -> Job {
    let accuracy = Accuracy::draft();
    let order = WorkOrder { scene: String::new(), accuracy, accuracy_name: String::new(), tasks: vec![] };
    let key = TaskKey { campaign: 1, task: 2 };
    let task = Task { key, attempt: 1, sample: vec![x], with_first_cycle: false, accuracy: None };
    Job { order: Arc::new(order), task, place: 0 }
}

/// An evaluation of one output.
pub fn evaluation(history: Vec<f64>) -> Evaluation {
    let cycles = (1..=history.len()).map(|k| 1000 * u32::try_from(k).unwrap()).collect();
    let diagnostics = Diagnostics::default();
    Evaluation {
        cycles,
        errors: vec![vec![0.0; history.len()]],
        histories: vec![history],
        joints: vec![],
        first_cycle: None,
        worn: None,
        diagnostics,
    }
}
