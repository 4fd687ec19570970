//! Tasks lost with their workers, or past their deadlines.

use super::tasks::Phase;
use super::{Action, Scheduler, Warning};
use common::wire::WorkerId;

impl Scheduler {
    pub(super) fn on_worker_lost(&mut self, id: WorkerId) {
        self.hold_licences_of_lost(&id);
        let tasks = self.workers.remove(&id);
        if tasks.is_empty() {
            return;
        }
        tasks.iter().for_each(|task| self.tasks.set_lost_worker(*task, &id));
        self.actions.push(Action::Warn(Warning::WorkerLost(id, tasks.clone())));
        self.count_losses(tasks, "workers were lost while running it");
    }

    /// Requeues each task that no other worker holds; gives up a task after `losses_allowed` losses.
    pub(super) fn count_losses(&mut self, tasks: Vec<u64>, what: &str) {
        let mut again = Vec::new();
        for task in tasks {
            let losses = self.tasks.count_loss(task);
            match losses.filter(|_| !self.workers.is_held(task)) {
                Some(losses) if losses >= self.settings.losses_allowed => {
                    self.give_up(task, format!("{losses} {what}"));
                }
                Some(_) => again.push(task),
                None => {}
            }
        }
        self.requeue(again);
    }

    /// Returns tasks to the front of the queue, in the order of their numbers, and announces them.
    pub(super) fn requeue(&mut self, tasks: Vec<u64>) {
        let points =
            tasks.into_iter().rev().filter_map(|task| self.tasks.requeue(task, Phase::Leased)).collect();
        self.announce(points);
    }

    pub(super) fn check_deadlines(&mut self) {
        let overdue = self.workers.take_overdue(self.now, self.settings.deadline(self.longest_wall));
        let tasks = overdue.iter().map(|(_, task, _)| *task).collect();
        let warning = |(worker, task, after)| Action::Warn(Warning::Overdue(worker, task, after));
        self.actions.extend(overdue.into_iter().map(warning));
        self.count_losses(tasks, "deadlines have passed");
    }
}
