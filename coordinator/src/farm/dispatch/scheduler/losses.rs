//! Tasks lost with their workers, or past their deadlines.

use super::{Action, Scheduler, Warning};
use common::wire::WorkerId;
use std::time::Duration;

impl Scheduler {
    pub(super) fn on_worker_lost(&mut self, now: Duration, id: WorkerId, actions: &mut Vec<Action>) {
        self.hold_licences_of_lost(now, &id);
        let tasks = self.workers.remove(&id);
        if tasks.is_empty() {
            return;
        }
        tasks.iter().for_each(|task| self.tasks.set_lost_worker(*task, &id));
        actions.push(Action::Warn(Warning::WorkerLost { worker: id, tasks: tasks.clone() }));
        self.count_losses(tasks, "workers were lost while running it", actions);
    }

    /// Requeues each task that no other worker holds; gives up a task after `losses_allowed` losses.
    pub(super) fn count_losses(&mut self, tasks: Vec<u64>, what: &str, actions: &mut Vec<Action>) {
        let mut again = Vec::new();
        for task in tasks {
            let losses = self.tasks.count_loss(task);
            match losses.filter(|_| !self.workers.is_held(task)) {
                Some(losses) if losses >= self.settings.losses_allowed => {
                    self.tasks.end(task);
                    actions.push(Action::GiveUp { task, reason: format!("{losses} {what}") });
                }
                Some(_) => again.push(task),
                None => {}
            }
        }
        self.requeue(again, actions);
    }

    /// Returns tasks to the front of the queue, in the order of their numbers, and announces them.
    pub(super) fn requeue(&mut self, tasks: Vec<u64>, actions: &mut Vec<Action>) {
        let points: Vec<_> = tasks.into_iter().rev().filter_map(|task| self.tasks.requeue(task)).collect();
        if !points.is_empty() {
            actions.push(Action::Announce(points));
        }
    }

    pub(super) fn check_deadlines(&mut self, now: Duration, actions: &mut Vec<Action>) {
        let overdue = self.workers.take_overdue(now, self.settings.deadline(self.longest_wall));
        let tasks = overdue.iter().map(|(_, task, _)| *task).collect();
        let warning = |(worker, task, after)| Action::Warn(Warning::Overdue { worker, task, after });
        actions.extend(overdue.into_iter().map(warning));
        self.count_losses(tasks, "deadlines have passed", actions);
    }
}
