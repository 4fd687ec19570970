//! What follows from the reply to a claim: work, a pause, or the end of the campaign.

use super::{ClaimLoop, PendingClaim, QUEUE_EMPTY_PAUSE};
use crate::service::unacknowledged::UnacknowledgedResults;
use crate::service::{Departure, Job, ServiceError};
use common::wire::{self, Next, Reply, WireError, WorkOrder};
use std::sync::Arc;
use std::time::{Duration, Instant};

impl ClaimLoop {
    pub(super) fn on_reply(
        &mut self,
        now: Instant,
        frame: Result<Vec<u8>, String>,
    ) -> Result<Option<Departure>, ServiceError> {
        let reply = match frame.map(|frame| wire::decode::<Reply>(&frame)) {
            Ok(Ok(reply)) => reply,
            Ok(Err(WireError::OtherVersion { theirs, ours })) => {
                let endpoint = self.config.connect[self.coordinator].clone();
                return Err(ServiceError::OtherVersion { endpoint, theirs, ours });
            }
            Ok(Err(error)) => {
                tracing::warn!("a reply of the coordinator cannot be decoded: {error}");
                self.on_no_reply(now, error.to_string());
                return Ok(None);
            }
            Err(reason) => {
                self.on_no_reply(now, reason);
                return Ok(None);
            }
        };
        let Some(PendingClaim { credits, leaving, since, .. }) = self.pending.take() else {
            return Ok(None);
        };
        self.farewell_answered |= leaving;
        self.contact.answered = Some(since);
        self.monitor.on_answer();
        self.backoff.reset();
        self.unacknowledged.forget(&reply.acknowledged);
        // Tasks that other workers have finished are not started.
        self.withdraw(|task| reply.acknowledged.contains(&task.key));
        match reply.next {
            Next::Work(order) => {
                let received = order.tasks.len();
                self.campaign.on_order(&order);
                self.prefetch.reply_received(now.saturating_duration_since(since));
                self.start_tasks(order, now);
                // Fewer than requested: the queue is empty; a notice announces new tasks.
                self.claim_at = if received < credits { now + QUEUE_EMPTY_PAUSE } else { now };
            }
            Next::Idle { ask_again } => {
                self.slots.shares().answered(self.coordinator, 0, now);
                // Without credits, the reply says nothing about the queue.
                if credits > 0 {
                    self.claim_at =
                        now + self.backoff.spread(Duration::from_millis(u64::from(ask_again)), self.sequence);
                }
            }
            Next::Leave { campaign } if self.campaign.end(campaign, now) => {
                return Ok(self.campaign_ended(now));
            }
            Next::Leave { .. } => self.claim_at = now + QUEUE_EMPTY_PAUSE,
        }
        Ok(None)
    }

    /// Handles the end of the campaign: leaves, or waits for the next one at this endpoint.
    fn campaign_ended(&mut self, now: Instant) -> Option<Departure> {
        if !self.config.next_campaign || self.leave_policy.is_draining() {
            return Some(Departure::CampaignEnded);
        }
        tracing::info!("the campaign at {} has ended", self.config.connect[self.coordinator]);
        self.pending = None;
        self.slots.shares().answered(self.coordinator, 0, now);
        self.slots.simulator.on_campaign_ended();
        self.withdraw(|_| true);
        self.unacknowledged = UnacknowledgedResults::default();
        (self.claim_at, self.silent_until) = (now + QUEUE_EMPTY_PAUSE, now + QUEUE_EMPTY_PAUSE);
        None
    }

    fn start_tasks(&mut self, mut order: WorkOrder, now: Instant) {
        let mut tasks = std::mem::take(&mut order.tasks);
        tasks.retain(|task| {
            let is_running = self.running.iter().any(|(other, _)| other.same_work(task));
            !(is_running || self.unacknowledged.resend_if_held(task, now))
        });
        // Tasks that arrive after the decision to leave are returned.
        if self.leaving_since.is_some() {
            tasks.clear();
        }
        self.slots.shares().answered(self.coordinator, tasks.len(), now);
        self.contact.licensed = order.licensed;
        let order = Arc::new(order);
        self.running.extend(tasks.iter().map(|task| (task.clone(), now)));
        self.limit_contact();
        for task in tasks {
            self.slots.queue.push(Job { order: Arc::clone(&order), task, coordinator: self.coordinator });
        }
    }
}
