//! Which workers may run how many tasks of an external simulator: licences, and reports of simulators that cannot be used.

use super::licences::{LEAVING, LICENCE_HOLD};
use super::tasks::TaskStatus;
use super::{Action, Scheduler, Warning};
use common::wire::{TaskKey, WorkerId};
use std::collections::BTreeSet;
use std::time::Duration;

impl Scheduler {
    /// Tasks that worker `id` may get in addition: without licences any number; with licences one per free slot, so that
    /// none waits at the worker, and at most the free licences.
    pub(super) fn licences_for(&self, id: &WorkerId) -> usize {
        let Some(licences) = self.settings.licences else { return usize::MAX };
        let taken = self.workers.under_way() + self.held_licences.count();
        let slots = self.workers.get(id).map_or(0, |worker| worker.usable_slots() as usize);
        let free_slots = slots.saturating_sub(self.workers.under_way_at(id));
        (licences as usize).saturating_sub(taken).min(free_slots)
    }

    /// Holds the licences of a lost worker back: its programs may still run.
    pub(super) fn hold_licences_of_lost(&mut self, id: &WorkerId) {
        if self.settings.licences.is_some() {
            self.held_licences.hold(id, self.workers.under_way_at(id), self.now + LICENCE_HOLD);
        }
    }

    /// Accounts for a worker's claim with the tasks `running`: their licences are those of its leases, and held back for
    /// tasks that have ended elsewhere meanwhile, or that the study has not requested again after a restart. After the claim
    /// of a worker that leaves, its programs end.
    pub(super) fn account_for_licences(&mut self, id: &WorkerId, leaving: bool, running: &BTreeSet<u64>) {
        if self.settings.licences.is_none() {
            return;
        }
        if leaving {
            self.held_licences.hold(id, self.workers.under_way_at(id), self.now + LEAVING);
        } else {
            let has_no_lease = |task: &&u64| {
                matches!(self.tasks.status(**task), TaskStatus::Ended | TaskStatus::NotRequested)
            };
            let without_lease = running.iter().filter(has_no_lease).count();
            self.held_licences.forget(id);
            self.held_licences.hold(id, without_lease, self.now + LICENCE_HOLD);
        }
    }

    /// Holds the licences of all workers back, whose tasks are cancelled.
    pub(super) fn hold_all_licences(&mut self) {
        let ids: Vec<WorkerId> = self.workers.iter().map(|(id, _)| id.clone()).collect();
        ids.iter().for_each(|id| self.hold_licences_of_lost(id));
    }

    /// Releases the licences whose time is over; announces the queued tasks, so that idle workers claim again.
    pub(super) fn release_licences(&mut self) {
        if self.held_licences.release(self.now) {
            self.announce(self.tasks.queued());
        }
    }

    /// Excludes a worker that cannot use its simulator; its task returns to the queue, without a loss.
    pub(super) fn on_unusable(&mut self, id: &WorkerId, key: TaskKey, reason: String) {
        if key.campaign != self.settings.campaign {
            return;
        }
        if self.workers.exclude_unusable(id) {
            self.unusable = Some((self.now, format!("worker {}: {reason}", id.name)));
            self.actions.push(Action::Warn(Warning::Unusable(id.clone(), reason)));
        }
        let is_held = self.workers.get(id).is_some_and(|worker| worker.leases.contains_key(&key.task));
        if is_held && !self.workers.release(id, key.task) {
            self.requeue(vec![key.task]);
        }
    }

    /// Gives a task up if all workers have reported that they cannot use their simulators, some time ago: others may
    /// have been about to connect.
    pub(super) fn give_up_unusable(&mut self) {
        if self.workers.any_eligible() {
            self.unusable = None;
        }
        let over =
            |(since, _): &mut (Duration, String)| self.now.saturating_sub(*since) >= self.settings.unattended;
        let Some((_, reason)) = self.unusable.take_if(over) else { return };
        if let Some(task) = self.tasks.first_open() {
            self.give_up(task, reason);
        }
    }
}
