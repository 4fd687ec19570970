//! Outcomes that another worker has to repeat, when two of them agree, and samples that are evaluated once more: a worker that has
//! evaluated one before gets it only where no other worker is connected.

use super::event::Action;
use super::workers::{Worker, Workforce};
use crate::farm::evaluate::{EvaluationResult, Finished, agree};
use common::wire::WorkerId;
use std::collections::{BTreeMap, BTreeSet};

/// Which results another worker has to repeat.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CrossCheck {
    /// Share of the evaluations besides the first one of each worker [1].
    pub share: f64,
    /// Whether results have to agree to the last bit; otherwise within their stated errors.
    pub is_exact: bool,
}

impl CrossCheck {
    /// True if `task` belongs to the share, whose numbers are equally spaced.
    pub(super) fn is_chosen(&self, task: u64) -> bool {
        let chosen_before = |task: f64| (task * self.share).floor();
        chosen_before(task as f64 + 1.0) > chosen_before(task as f64)
    }

    pub(super) fn agree(&self, one: &EvaluationResult, other: &EvaluationResult) -> bool {
        match (one, other) {
            (Ok(one), Ok(other)) => {
                let [one_values, other_values] =
                    [one, other].map(|of| (of.histories.as_slice(), of.errors.as_slice()));
                one.cycles == other.cycles && agree(one_values, other_values, self.is_exact)
            }
            (one, other) => one.is_err() == other.is_err(),
        }
    }
}

/// Outcomes that wait for those of other workers.
#[derive(Debug, Default)]
pub(super) struct HeldOutcomes {
    pub by_task: BTreeMap<u64, Vec<(WorkerId, Finished)>>,
    /// Workers with an outcome that another one has repeated.
    pub confirmed: BTreeSet<WorkerId>,
    /// Number of outcomes of each worker that were passed on.
    pub passed_on: BTreeMap<WorkerId, usize>,
}

impl HeldOutcomes {
    /// True if the worker has an outcome of the task that waits.
    pub fn has(&self, task: u64, id: &WorkerId) -> bool {
        self.by_task.get(&task).is_some_and(|held| held.iter().any(|(worker, _)| worker.name == id.name))
    }

    pub fn pass_on(&mut self, worker: &WorkerId, finished: Finished, actions: &mut Vec<Action>) {
        *self.passed_on.entry(worker.clone()).or_default() += 1;
        actions.push(Action::Deliver(Box::new(finished)));
    }
}

/// True if a worker is not among the slots `not_by` that evaluated a sample before, or no other worker is connected that is not.
pub(super) fn may_evaluate(not_by: &[String], id: &WorkerId, workers: &Workforce) -> bool {
    // Slots of a worker are named `host-4711/0`.
    let has_evaluated = |id: &WorkerId| {
        let rest =
            |slot: &String| slot.strip_prefix(&id.name).map(|rest| rest.is_empty() || rest.starts_with('/'));
        not_by.iter().any(|slot| rest(slot) == Some(true))
    };
    let is_other = |(other, worker): (&WorkerId, &Worker)| worker.usable_slots() > 0 && !has_evaluated(other);
    !has_evaluated(id) || !workers.iter().any(is_other)
}
