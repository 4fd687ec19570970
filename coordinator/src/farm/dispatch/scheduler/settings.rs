//! Constants of the scheduler.

use std::time::Duration;

/// See the module.
#[derive(Debug, Clone, PartialEq)]
pub struct SchedulerSettings {
    /// Campaign its tasks belong to.
    pub campaign: u64,
    /// Workers (or deadlines) a task may outlive before it is given up; the last of them one that has finished others, where there
    /// is any.
    pub losses_allowed: u32,
    /// Deadline of a task while no simulation has ended yet.
    pub first_deadline: Duration,
    /// Deadline as a multiple of the longest simulation seen.
    pub deadline_factor: f64,
    /// Deadline at least.
    pub shortest_deadline: Duration,
    /// How long tasks may wait without any worker before the user is told, and told that their number changed.
    pub unattended: Duration,
    /// When the user is told again although nothing changed.
    pub still_unattended: Duration,
    /// Most tasks in one reply.
    pub most_tasks: u32,
    /// A task goes to a second, idle worker too once it is out for this multiple of the mean time from lease to outcome,
    pub straggler_factor: f64,
    /// and at least for so long.
    pub straggler_least: Duration,
    /// How long after the start tasks wait, so that workers of an earlier coordinator can say what they are running.
    pub settle: Duration,
}

impl SchedulerSettings {
    /// The usual constants.
    pub fn new(campaign: u64) -> Self {
        Self {
            campaign,
            losses_allowed: 3,
            first_deadline: Duration::from_secs(3600),
            deadline_factor: 10.0,
            shortest_deadline: Duration::from_secs(120),
            unattended: Duration::from_secs(5),
            still_unattended: Duration::from_secs(60),
            most_tasks: 1024,
            straggler_factor: 2.0,
            straggler_least: Duration::from_secs(1),
            settle: Duration::ZERO,
        }
    }

    /// How long a task may take at a worker of one slot per lease, where the longest simulation so far took so long [s].
    pub(super) fn deadline(&self, longest_wall: Option<f64>) -> Duration {
        match longest_wall {
            None => self.first_deadline,
            Some(wall) => Duration::try_from_secs_f64(wall * self.deadline_factor)
                .unwrap_or(Duration::MAX)
                .max(self.shortest_deadline),
        }
    }
}
