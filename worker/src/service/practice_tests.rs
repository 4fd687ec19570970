//! Simulator, job and evaluation for the tests of the service.

use super::{Job, Simulator};
use common::accuracy::Accuracy;
use common::failure::SimulationFailure;
use common::outputs::{Diagnostics, Evaluation};
use common::wire::{Subject, Task, TaskKey, WorkOrder};
use std::sync::Arc;
use std::time::Duration;

/// A simulator from a closure on the first value of the sample. It takes all available jobs before it ends the first.
pub struct EagerSimulator<F>(pub F);

impl<F: Fn(f64) -> Result<Evaluation, SimulationFailure> + Send + Sync> Simulator for EagerSimulator<F> {
    fn simulate(&self, job: &Job) -> Result<Evaluation, SimulationFailure> {
        self.0(job.sample()[0])
    }

    fn simulate_together(
        &self,
        next: &mut dyn FnMut() -> Option<Job>,
        done: &mut dyn FnMut(usize, Result<Evaluation, SimulationFailure>, Duration),
    ) {
        let jobs: Vec<Job> = std::iter::from_fn(next).collect();
        jobs.iter().enumerate().for_each(|(number, job)| {
            done(number, self.simulate(job), Duration::from_millis(250));
        });
    }
}

/// A job with the sample `[x]`.
pub(crate) fn job(x: f64) -> Job {
    let (scene, sample, accuracy) = ("", [x], Accuracy::draft());
    let subject = Subject::Scene(scene.to_owned());
    let order = WorkOrder { subject, accuracy, accuracy_name: String::new(), licensed: false, tasks: vec![] };
    let task = Task {
        key: TaskKey { campaign: 0, task: 0 },
        attempt: 1,
        sample: sample.to_vec(),
        with_first_cycle: false,
        accuracy: None,
        level: 0,
    };
    Job { order: Arc::new(order), task, coordinator: 0 }
}

/// An evaluation with one output `history`.
pub(crate) fn evaluation(history: Vec<f64>) -> Evaluation {
    let cycles = (1..=history.len()).map(|k| 1000 * u32::try_from(k).unwrap()).collect();
    let diagnostics = Diagnostics::default();
    Evaluation {
        cycles,
        errors: vec![vec![0.0; history.len()]],
        histories: vec![history],
        joints: vec![],
        first_cycle: None,
        worn: None,
        start: vec![],
        diagnostics,
    }
}
