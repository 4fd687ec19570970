//! The campaign that a worker works for, as far as its coordinator has told: behind a router a claim may reach the coordinator of another
//! study, whose end is none for this worker.

use common::wire::WorkOrder;
use std::time::{Duration, Instant};

/// Time for which the end of another campaign is no reason to leave.
const END_OF_ANOTHER: Duration = Duration::from_secs(10);

/// Campaign of the tasks last received.
#[derive(Debug, Default)]
pub(super) struct OwnCampaign {
    number: Option<u64>,
    /// When a claim was first answered with the end of another campaign.
    another_ended: Option<Instant>,
}

impl OwnCampaign {
    /// Notes the campaign of tasks that have arrived.
    pub fn on_order(&mut self, order: &WorkOrder) {
        self.number = order.tasks.first().map(|task| task.key.campaign).or(self.number);
        self.another_ended = None;
    }

    /// True if a campaign is, as far as is known, that of this worker.
    pub fn is(&self, campaign: u64) -> bool {
        self.number.is_none_or(|own| own == campaign)
    }

    /// True if the end of `campaign` is a reason to leave, as the reply to a claim says.
    pub fn end(&mut self, campaign: u64, now: Instant) -> bool {
        let is_own = self.is(campaign);
        let since = *self.another_ended.get_or_insert(now);
        if !is_own && now.saturating_duration_since(since) < END_OF_ANOTHER {
            tracing::warn!(
                "the end of another study (campaign {campaign:x}) is ignored: one router serves one coordinator"
            );
            return false;
        }
        *self = Self::default();
        true
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use common::accuracy::Accuracy;
    use common::wire::{Subject, Task, TaskKey};

    #[test]
    fn issue_the_end_of_another_study_sent_a_worker_away() {
        let now = Instant::now();
        let mut own = OwnCampaign::default();
        assert!(own.is(3) && own.end(3, now), "nothing is known yet");
        let task = Task {
            key: TaskKey { campaign: 3, task: 0 },
            attempt: 1,
            sample: vec![],
            with_first_cycle: false,
            accuracy: None,
            level: 0,
        };
        let order = WorkOrder {
            subject: Subject::Scene(String::new()),
            accuracy: Accuracy::draft(),
            accuracy_name: "draft".into(),
            licensed: false,
            tasks: vec![task],
        };
        own.on_order(&order);
        assert!(!own.is(4) && !own.end(4, now) && !own.end(4, now + END_OF_ANOTHER / 2));
        assert!(own.end(4, now + END_OF_ANOTHER), "its own coordinator has been silent for long");
        own.on_order(&order);
        assert!(own.end(3, now));
    }
}
