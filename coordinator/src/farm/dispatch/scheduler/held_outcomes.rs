//! Outcomes that another worker has to repeat, and when two of them agree.

use super::event::Action;
use crate::farm::evaluate::Finished;
use common::failure::SimulationFailure;
use common::outputs::Evaluation;
use common::wire::WorkerId;
use std::collections::{BTreeMap, BTreeSet};

/// Difference of results of external simulators beyond their stated errors that counts as none, relative to the values [1].
const SAME: f64 = 1e-9;

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

    pub(super) fn agree(
        &self,
        one: &Result<Evaluation, SimulationFailure>,
        other: &Result<Evaluation, SimulationFailure>,
    ) -> bool {
        match (one, other) {
            (Ok(one), Ok(other)) if self.is_exact => {
                one.cycles == other.cycles && one.histories == other.histories && one.errors == other.errors
            }
            (Ok(one), Ok(other)) => one.cycles == other.cycles && agree_within_errors(one, other),
            (one, other) => one.is_err() == other.is_err(),
        }
    }
}

fn agree_within_errors(one: &Evaluation, other: &Evaluation) -> bool {
    let error =
        |of: &Evaluation, k: usize, j: usize| of.errors.get(k).and_then(|e| e.get(j)).copied().unwrap_or(0.0);
    one.histories.iter().zip(&other.histories).enumerate().all(|(k, (a, b))| {
        a.iter().zip(b).enumerate().all(|(j, (a, b))| {
            (a - b).abs() <= error(one, k, j) + error(other, k, j) + SAME * a.abs().max(b.abs())
        })
    })
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

    /// Forgets what waits.
    pub fn clear(&mut self) {
        self.by_task.clear();
    }

    pub fn pass_on(&mut self, worker: &WorkerId, finished: Finished, actions: &mut Vec<Action>) {
        *self.passed_on.entry(worker.clone()).or_default() += 1;
        actions.push(Action::Deliver(Box::new(finished)));
    }
}
