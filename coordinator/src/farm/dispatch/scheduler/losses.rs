//! Tasks lost with their workers, past their deadlines, or of simulators that cannot be used; licences of external simulators, a bound on the
//! evaluations that run at once, on all workers together.
//!
//! A lease takes a licence. A worker without contact ends its evaluations after [`LICENCE_CONTACT`], and those of a worker
//! that is killed end with it; until then the licence of a lease that ends without an outcome is held back.

use super::Scheduler;
use super::tasks::{Phase, TaskStatus};
use super::worker_warnings::UNATTENDED;
use common::wire::{LICENCE_CONTACT, TaskKey, WorkerId};
use std::collections::BTreeSet;
use std::time::Duration;

/// Time for which a licence is held back after the last contact: longer than [`LICENCE_CONTACT`] by the time in which a
/// worker notices that it is over and ends its programs.
pub const LICENCE_HOLD: Duration = LICENCE_CONTACT.saturating_add(Duration::from_secs(2));
/// Time in which the programs of a worker that leaves have ended.
const LEAVING: Duration = Duration::from_secs(1);

impl Scheduler {
    pub(super) fn on_worker_lost(&mut self, id: WorkerId) {
        self.hold_licences_of_lost(&id);
        let tasks = self.workers.remove(&id);
        if tasks.is_empty() {
            return;
        }
        tasks.iter().for_each(|task| self.tasks.set_lost_worker(*task, &id));
        self.warn(format!("worker {} was lost; its evaluations {tasks:?} are requeued", id.name));
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
        for (worker, task, after) in &overdue {
            let (worker, after) = (&worker.name, after.as_secs_f64());
            self.warn(format!(
                "evaluation {task} has been running on worker {worker} for {after:.0} s; another worker gets it too"
            ));
        }
        let tasks = overdue.into_iter().map(|(_, task, _)| task).collect();
        self.count_losses(tasks, "deadlines have passed");
    }

    /// Tasks that worker `id` may get in addition: without licences any number; with licences one per free slot, so that
    /// none waits at the worker, and at most the free licences.
    pub(super) fn licences_for(&self, id: &WorkerId) -> usize {
        let Some(licences) = self.settings.licences else { return usize::MAX };
        let taken = self.workers.under_way() + self.held_licences.len();
        let slots = self.workers.get(id).map_or(0, |worker| worker.usable_slots() as usize);
        let free_slots = slots.saturating_sub(self.workers.under_way_at(id));
        (licences as usize).saturating_sub(taken).min(free_slots)
    }

    /// Holds the licences of a lost worker back: its programs may still run.
    pub(super) fn hold_licences_of_lost(&mut self, id: &WorkerId) {
        if self.settings.licences.is_some() {
            self.hold_licences(id, self.workers.under_way_at(id), self.now + LICENCE_HOLD);
        }
    }

    /// Holds licences of a worker back until then: [`LICENCE_HOLD`] after the last contact of one that has no leases for what it runs,
    /// [`LEAVING`] of one that leaves.
    fn hold_licences(&mut self, id: &WorkerId, count: usize, until: Duration) {
        self.held_licences.extend(std::iter::repeat_n((id.clone(), until), count));
    }

    /// Extends the time for which licences are held back of a worker that has contact and no leases.
    pub(super) fn extend_licences(&mut self, id: &WorkerId) {
        let of_worker = self.held_licences.iter_mut().filter(|(worker, _)| worker == id);
        of_worker.for_each(|(_, until)| *until = self.now + LICENCE_HOLD);
    }

    /// Accounts for a worker's claim with the tasks `running`: their licences are those of its leases, and held back for
    /// tasks that have ended elsewhere meanwhile, or that the study has not requested again after a restart. After the claim
    /// of a worker that leaves, its programs end.
    pub(super) fn account_for_licences(&mut self, id: &WorkerId, leaving: bool, running: &BTreeSet<u64>) {
        if self.settings.licences.is_none() {
            return;
        }
        if leaving {
            self.hold_licences(id, self.workers.under_way_at(id), self.now + LEAVING);
        } else {
            let has_no_lease = |task: &&u64| {
                matches!(self.tasks.status(**task), TaskStatus::Ended | TaskStatus::NotRequested)
            };
            let without_lease = running.iter().filter(has_no_lease).count();
            // The claims of a connected worker list what it runs.
            self.held_licences.retain(|(worker, _)| worker != id);
            self.hold_licences(id, without_lease, self.now + LICENCE_HOLD);
        }
    }

    /// Holds the licences of all workers back, whose tasks are cancelled.
    pub(super) fn hold_all_licences(&mut self) {
        let ids: Vec<WorkerId> = self.workers.iter().map(|(id, _)| id.clone()).collect();
        ids.iter().for_each(|id| self.hold_licences_of_lost(id));
    }

    /// Releases the licences whose time is over; announces the queued tasks, so that idle workers claim again.
    pub(super) fn release_licences(&mut self) {
        let before = self.held_licences.len();
        self.held_licences.retain(|(_, until)| *until > self.now);
        if self.held_licences.len() < before {
            self.announce(self.tasks.queued());
        }
    }

    /// Excludes a worker that cannot use its simulator; its task returns to the queue, without a loss.
    pub(super) fn on_unusable(&mut self, id: &WorkerId, key: TaskKey, reason: String) {
        if key.campaign != self.settings.campaign {
            return;
        }
        if self.exclude(id, &reason) {
            self.unusable = Some((self.now, format!("worker {}: {reason}", id.name)));
        }
        let is_held = self.workers.get(id).is_some_and(|worker| worker.leases.contains_key(&key.task));
        if is_held && !self.workers.release(id, key.task) {
            self.requeue(vec![key.task]);
        }
    }

    /// Gives a worker no more tasks, and warns of it once; returns whether it was excluded just now.
    pub(super) fn exclude(&mut self, id: &WorkerId, reason: &str) -> bool {
        let is_new = self.workers.exclude_unusable(id);
        if is_new {
            self.warn(format!("worker {} gets no more evaluations: {reason}", id.name));
        }
        is_new
    }

    /// Gives a task up if all workers have reported that they cannot use their simulators, some time ago: others may
    /// have been about to connect.
    pub(super) fn give_up_unusable(&mut self) {
        if self.workers.any_eligible() {
            self.unusable = None;
        }
        let over = |(since, _): &mut (Duration, String)| self.now.saturating_sub(*since) >= UNATTENDED;
        let Some((_, reason)) = self.unusable.take_if(over) else { return };
        if let Some(task) = self.tasks.first_open() {
            self.give_up(task, reason);
        }
    }
}
