//! Evaluates tasks so that panics and non-finite results become failed outcomes.

use super::{Job, Simulator};
use common::external::SampleResult;
use common::failure::SimulationFailure;
use common::panics::caught;
use common::wire::codec::Encoded;
use common::wire::{self, Outcome};
use std::cell::RefCell;
use std::collections::BTreeMap;
use std::time::{Duration, Instant};

/// Largest encoded outcome [bytes]; a message carries several.
const MAX_OUTCOME: usize = 4 << 20;

/// Evaluates `first` and the jobs returned by `more`, which is called with the number of running jobs. Every job ends
/// with one outcome, passed to `done` with the index of its coordinator; `worker` is the name in the outcome.
pub(super) fn evaluate(
    simulator: &dyn Simulator,
    worker: &str,
    first: Job,
    more: &mut dyn FnMut(usize) -> Option<Job>,
    done: &mut dyn FnMut(usize, Outcome),
) {
    let under_way: RefCell<BTreeMap<usize, Job>> = RefCell::default();
    let (mut first, mut begun) = (Some(first), 0);
    let together = caught(|| {
        let mut next = || {
            let job = first.take().or_else(|| more(under_way.borrow().len()))?;
            under_way.borrow_mut().insert(begun, job.clone());
            begun += 1;
            Some(job)
        };
        simulator.simulate_together(&mut next, &mut |number, result, took| {
            let ended = under_way.borrow_mut().remove(&number);
            if let Some(job) = ended {
                done(job.coordinator, outcome_of(job, worker, took, result));
            }
        });
    });
    let mut left: Vec<Job> = first.into_iter().chain(under_way.into_inner().into_values()).collect();
    match (together, left.len()) {
        (Err(message), 1) => {
            let failure = SimulationFailure::Panicked { message };
            left.drain(..).for_each(|job| {
                done(job.coordinator, outcome_of(job, worker, Duration::ZERO, Err(failure.clone())))
            });
        }
        // Each of the other jobs is evaluated again, alone: only the one that caused the panic fails.
        _ => left.drain(..).for_each(|job| done(job.coordinator, evaluate_alone(simulator, worker, job))),
    }
}

fn evaluate_alone(simulator: &dyn Simulator, worker: &str, job: Job) -> Outcome {
    let begun = Instant::now();
    let result = caught(|| simulator.simulate(&job));
    let failed = |message| Err(SimulationFailure::Panicked { message });
    outcome_of(job, worker, begun.elapsed(), result.unwrap_or_else(failed))
}

fn outcome_of(job: Job, worker: &str, took: Duration, result: SampleResult) -> Outcome {
    let (worker, wall) = (worker.to_owned(), took.as_secs_f64());
    within_size(Outcome { task: job.task, worker, wall, result: only_finite(result) })
}

fn only_finite(result: SampleResult) -> SampleResult {
    let found = match &result {
        Ok(evaluation) => {
            wire::find_non_finite(evaluation).map(|(quantity, cycle)| (cycle.unwrap_or(0), quantity))
        }
        Err(failure) => (!wire::failure_is_finite(failure)).then(|| (0, format!("failure: {failure}"))),
    };
    let Some((cycle, quantity)) = found else { return result };
    Err(SimulationFailure::NotFinite { cycle, time: 0.0, quantity })
}

fn within_size(outcome: Outcome) -> Outcome {
    match outcome.encoded_size() {
        Ok(bytes) if bytes <= MAX_OUTCOME => outcome,
        size => {
            let size = size.map_or_else(|error| error.to_string(), |bytes| format!("{bytes} bytes"));
            let what = format!("a result of more than {MAX_OUTCOME} bytes ({size})");
            Outcome { result: Err(SimulationFailure::NotModelled { what }), ..outcome }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::service::practice_tests::{EagerSimulator, evaluation, job};

    fn outcomes_of<F>(simulate: F, jobs: usize) -> Vec<Outcome>
    where
        F: Fn(f64) -> SampleResult + Send + Sync,
    {
        let mut outcomes = vec![];
        let mut waiting = (1..jobs).map(|k| job(3.0 + k as f64));
        let mut more = |_| waiting.next();
        evaluate(&EagerSimulator(simulate), "w/0", job(3.0), &mut more, &mut |_, outcome| {
            outcomes.push(outcome);
        });
        outcomes.sort_by(|a, b| a.task.sample[0].total_cmp(&b.task.sample[0]));
        outcomes
    }

    fn outcome_of(simulate: impl Fn(f64) -> SampleResult + Send + Sync) -> SampleResult {
        let outcome = outcomes_of(simulate, 1).remove(0);
        assert_eq!((&outcome.task, outcome.worker.as_str()), (&job(3.0).task, "w/0"));
        assert!(
            [0.0, 0.25].contains(&outcome.wall),
            "the time stated by the simulator, or none after a panic"
        );
        outcome.result
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
    fn a_panic_fails_only_the_job_that_caused_it() {
        let outcomes = outcomes_of(
            |x| if x == 5.0 { panic!("sample {x} is too much") } else { Ok(evaluation(vec![x])) },
            6,
        );
        let panicked = SimulationFailure::Panicked { message: "sample 5 is too much".into() };
        for (k, outcome) in outcomes.iter().enumerate() {
            let x = 3.0 + k as f64;
            let expected = if x == 5.0 { Err(panicked.clone()) } else { Ok(evaluation(vec![x])) };
            assert_eq!((outcome.task.sample[0], &outcome.result), (x, &expected));
        }
        assert_eq!(outcomes.len(), 6);
    }

    #[test]
    fn a_non_finite_number_is_a_failed_outcome() {
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
    fn issue_the_largest_result_of_a_valid_scene_did_not_fit_into_a_message() {
        let mut all = evaluation(vec![0.5; common::scene::VALUE_LIMIT / 2]);
        all.histories.push(all.histories[0].clone());
        all.errors.push(all.errors[0].clone());
        assert!(outcome_of(|_| Ok(all.clone())).is_ok());
    }

    #[test]
    fn a_result_too_large_for_a_message_is_a_failure() {
        let result = outcome_of(|_| Ok(evaluation(vec![0.5; MAX_OUTCOME / 8 + 1])));
        assert!(matches!(result, Err(SimulationFailure::NotModelled { .. })));
    }
}
