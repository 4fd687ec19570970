//! One task, evaluated so that whatever happens is an outcome: no panic and no number that is not finite
//! leaves the worker.

use super::Simulator;
use common::failure::SimulationFailure;
use common::outputs::Evaluation;
use common::wire::{self, Outcome, Task, WorkOrder};
use std::any::Any;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::time::Instant;

/// Largest outcome [bytes]; a message carries several.
const MAX_OUTCOME: usize = 4 << 20;

/// Evaluates `task` of `order` under the name `worker`.
pub(super) fn evaluate(simulator: &dyn Simulator, order: &WorkOrder, task: Task, worker: &str) -> Outcome {
    let started = Instant::now();
    let result = catch_unwind(AssertUnwindSafe(|| {
        let accuracy = task.accuracy.as_ref().unwrap_or(&order.accuracy);
        simulator.simulate(&order.scene, &task.sample, accuracy, task.with_first_cycle)
    }));
    let wall = started.elapsed().as_secs_f64();
    let result = match result {
        Ok(result) => only_finite(result),
        Err(panic) => Err(SimulationFailure::Panicked { message: said(&*panic) }),
    };
    within_size(Outcome { task, worker: worker.to_owned(), wall, result })
}

fn only_finite(result: Result<Evaluation, SimulationFailure>) -> Result<Evaluation, SimulationFailure> {
    match result {
        Ok(evaluation) => match wire::find_non_finite(&evaluation) {
            None => Ok(evaluation),
            Some(found) => Err(SimulationFailure::NotFinite {
                cycle: found.cycle.unwrap_or(0),
                time: 0.0,
                quantity: found.quantity,
            }),
        },
        Err(failure) if !wire::failure_is_finite(&failure) => {
            Err(SimulationFailure::NotFinite { cycle: 0, time: 0.0, quantity: format!("failure: {failure}") })
        }
        Err(failure) => Err(failure),
    }
}

fn within_size(outcome: Outcome) -> Outcome {
    match wire::codec::encoded_size(&outcome) {
        Ok(bytes) if bytes <= MAX_OUTCOME => outcome,
        size => {
            let size = size.map_or_else(|error| error.to_string(), |bytes| format!("{bytes} bytes"));
            let what = format!("a result of more than {MAX_OUTCOME} bytes ({size})");
            Outcome { result: Err(SimulationFailure::NotModelled { what }), ..outcome }
        }
    }
}

fn said(panic: &(dyn Any + Send)) -> String {
    let text = panic.downcast_ref::<&str>().map(|text| (*text).to_owned());
    text.or_else(|| panic.downcast_ref::<String>().cloned()).unwrap_or_else(|| "no message".into())
}

#[cfg(test)]
mod tests {
    use super::*;
    use common::accuracy::Accuracy;
    use common::outputs::Diagnostics;
    use common::wire::TaskKey;

    struct Practice<F>(F);

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
    }

    fn outcome_of(
        simulate: impl Fn(f64) -> Result<Evaluation, SimulationFailure> + Send + Sync,
    ) -> Result<Evaluation, SimulationFailure> {
        let accuracy = Accuracy {
            step_tolerance: 1e-4,
            largest_step: 0.01,
            steps_bound: 1,
            wear_samples: 1,
            cycle_jump: 1,
            jump_tolerance: 0.0,
            wear_tolerance: 0.1,
            warm_up: 0.5,
            tier: common::accuracy::Tier::Dynamic,
        };
        let order = WorkOrder { scene: String::new(), accuracy, accuracy_name: String::new(), tasks: vec![] };
        let key = TaskKey { campaign: 1, task: 2 };
        let task = Task { key, attempt: 1, sample: vec![3.0], with_first_cycle: false, accuracy: None };
        let outcome = evaluate(&Practice(simulate), &order, task.clone(), "w/0");
        assert_eq!((outcome.task, outcome.worker.as_str()), (task, "w/0"));
        assert!(outcome.wall >= 0.0);
        outcome.result
    }

    fn evaluation(history: Vec<f64>) -> Evaluation {
        let cycles = (1..=history.len()).map(|k| 1000 * u32::try_from(k).unwrap()).collect();
        let diagnostics = Diagnostics::default();
        Evaluation {
            cycles,
            errors: vec![vec![0.0; history.len()]],
            histories: vec![history],
            joints: vec![],
            first_cycle: None,
            diagnostics,
        }
    }

    #[test]
    fn a_result_passes_unchanged() {
        assert_eq!(outcome_of(|x| Ok(evaluation(vec![x, 2.0 * x]))), Ok(evaluation(vec![3.0, 6.0])));
    }

    #[test]
    fn a_panic_is_an_outcome() {
        let result = outcome_of(|x| panic!("sample {x} is too much"));
        assert_eq!(result, Err(SimulationFailure::Panicked { message: "sample 3 is too much".into() }));
    }

    #[test]
    fn nothing_that_is_not_finite_leaves() {
        let result = outcome_of(|_| Ok(evaluation(vec![1.0, f64::NAN])));
        let quantity = "histories[0][1]".to_owned();
        assert_eq!(result, Err(SimulationFailure::NotFinite { cycle: 2000, time: 0.0, quantity }));
        let result = outcome_of(|_| {
            Err(SimulationFailure::WearStep { cycle: 5, joint: "2".into(), error: f64::INFINITY })
        });
        assert!(
            matches!(&result, Err(SimulationFailure::NotFinite { quantity, .. }) if quantity.contains("joint 2")),
            "{result:?}"
        );
    }

    #[test]
    fn a_result_no_message_can_carry_is_a_failure() {
        let result = outcome_of(|_| Ok(evaluation(vec![0.5; MAX_OUTCOME / 8 + 1])));
        assert!(matches!(result, Err(SimulationFailure::NotModelled { .. })));
    }
}
