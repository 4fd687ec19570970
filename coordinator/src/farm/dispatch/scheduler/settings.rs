//! Deadlines and limits of the scheduler.

use super::held_outcomes::CrossCheck;
use common::build::Build;
use common::wire::{Offers, Subject};
use std::time::Duration;

/// Deadlines and limits of the scheduler.
#[derive(Debug, Clone, PartialEq)]
pub struct SchedulerSettings {
    /// Campaign of the tasks.
    pub campaign: u64,
    /// Scene or simulator of the tasks: workers that do not offer it get none.
    pub subject: Subject,
    /// The build of the program that simulates scenes: workers of another one get none. `None`: any.
    pub build: Option<Build>,
    /// Which results another worker has to repeat; `None`: none.
    pub cross_check: Option<CrossCheck>,
    /// Bound on the evaluations at once, if there is one.
    pub licences: Option<u32>,
    /// Losses (of a worker, or by a deadline) after which a task is given up; the last loss counts at a worker that has
    /// finished other tasks, if any exists.
    pub losses_allowed: u32,
    /// Deadline of a task before the first simulation has ended.
    pub first_deadline: Duration,
    /// Deadline as a multiple of the longest simulation so far [1].
    pub deadline_factor: f64,
    /// Lower bound of the deadline.
    pub shortest_deadline: Duration,
    /// Time without any worker that offers the subject before a warning, and before the campaign is given up if all of
    /// them have reported an unusable simulator; and before a repeated one if the number of tasks has changed.
    pub unattended: Duration,
    /// Time before the warning is repeated with an unchanged number of tasks.
    pub still_unattended: Duration,
    /// Most tasks in one reply.
    pub most_tasks: u32,
    /// A task goes to a second, idle worker once its lease is older than this multiple of the mean time from lease to
    /// outcome [1].
    pub straggler_factor: f64,
    /// Lower bound of that age.
    pub straggler_least: Duration,
    /// Time after the start in which no task is leased, so that workers of an earlier coordinator can claim what they are
    /// running.
    pub settle: Duration,
}

impl SchedulerSettings {
    /// True if a worker that offers this gets tasks.
    pub(super) fn admits(&self, offers: &Offers) -> bool {
        match (self.build, offers) {
            (Some(ours), Offers::Scenes(theirs)) if ours != *theirs => false,
            _ => offers.cover(&self.subject),
        }
    }

    /// The default settings for a campaign.
    pub fn new(campaign: u64) -> Self {
        Self {
            campaign,
            subject: Subject::Scene(String::new()),
            build: Some(Build::default()),
            cross_check: None,
            licences: None,
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

    /// Deadline of a task on a worker with one slot per lease; `longest_wall` is the longest simulation so far [s].
    pub(super) fn deadline(&self, longest_wall: Option<f64>) -> Duration {
        match longest_wall {
            None => self.first_deadline,
            Some(wall) => Duration::try_from_secs_f64(wall * self.deadline_factor)
                .unwrap_or(Duration::MAX)
                .max(self.shortest_deadline),
        }
    }
}
