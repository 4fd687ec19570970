//! Evaluations that two workers make. A result that differs from that of another worker for the same sample is not used, and a third
//! worker decides which of the two gets no more tasks: a faulty processor, another library or a worker that lies would otherwise be
//! believed, since every result that fits the scene is possible.

use super::tasks::Phase;
use super::workers::Worker;
use super::{Action, Scheduler};
use crate::farm::evaluate::Finished;
use common::wire::WorkerId;

/// Workers that evaluate a sample until two of them agree, at most.
const MOST_WORKERS: usize = 3;

impl Scheduler {
    /// Passes the first outcome of a task on, or holds it until another worker has repeated it; true if it was passed on.
    pub(super) fn deliver_checked(&mut self, id: &WorkerId, finished: Finished) -> bool {
        let task = finished.id;
        let mut held = self.held.by_task.remove(&task).unwrap_or_default();
        let wanted = self
            .settings
            .cross_check
            .filter(|check| !held.is_empty() || check.is_chosen(task) || !self.held.confirmed.contains(id));
        let Some(check) = wanted else {
            self.held.pass_on(id, finished, &mut self.actions);
            return true;
        };
        let same = held.iter().position(|(_, other)| check.agree(&other.outcome, &finished.outcome));
        if let Some(same) = same {
            let (first, outcome) = held.swap_remove(same);
            self.held.confirmed.extend([id.clone(), first.clone()]);
            let agreed = format!("workers {} and {}", first.name, id.name);
            let doubt = held.into_iter().filter_map(|(wrong, _)| self.distrust(&wrong, task, &agreed)).last();
            match doubt {
                Some(reason) => self.give_up(task, reason),
                None => self.held.pass_on(&first, outcome, &mut self.actions),
            }
            return true;
        }
        held.push((id.clone(), finished));
        self.held.by_task.insert(task, held);
        self.resolve_unchecked(task)
    }

    /// Holds a task for another worker if there is one, otherwise ends it with what there is; true if it has ended.
    fn resolve_unchecked(&mut self, task: u64) -> bool {
        let is_other =
            |(id, worker): (&WorkerId, &Worker)| worker.usable_slots() > 0 && !self.held.has(task, id);
        let number = self.held.by_task.get(&task).map_or(0, Vec::len);
        if number < MOST_WORKERS && self.workers.iter().any(is_other) {
            self.actions.extend(
                self.tasks.requeue(task, Phase::Delivered).map(|point| Action::Announce(vec![point])),
            );
            return false;
        }
        let held = self.held.by_task.remove(&task).unwrap_or_default();
        self.workers.release_from_all(task);
        let names: Vec<String> = held.iter().map(|(worker, _)| worker.name.clone()).collect();
        if let Ok([(worker, finished)]) = <[_; 1]>::try_from(held) {
            self.tasks.set_delivered(task);
            self.held.pass_on(&worker, finished, &mut self.actions);
        } else {
            let reason = format!(
                "workers {} return different results for it: at least one of the machines or its libraries is faulty; compare each \
                 with a further worker",
                names.join(", ")
            );
            self.give_up(task, reason);
        }
        true
    }

    /// Ends the tasks that wait for a worker which is no longer there.
    pub(super) fn check_held(&mut self) {
        let tasks: Vec<u64> = self.held.by_task.keys().copied().collect();
        for task in tasks.into_iter().filter(|task| !self.workers.is_held(*task)).collect::<Vec<_>>() {
            self.resolve_unchecked(task);
        }
    }

    /// Excludes a worker whose result others contradict; the doubt about its earlier ones, if there are any.
    fn distrust(&mut self, id: &WorkerId, task: u64, agreed: &str) -> Option<String> {
        let reason = format!("its result of evaluation {task} is not that of {agreed}");
        self.exclude(id, &reason);
        let before = self.held.passed_on.get(id).copied().filter(|number| *number > 0)?;
        let WorkerId { name, .. } = id;
        Some(format!(
            "worker {name} is faulty: {reason}; {before} of its results were used before: remove it, and continue with \
             `coordinator resume DIR --distrust {name}`, which repeats them"
        ))
    }
}
