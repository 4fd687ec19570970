//! Deadlines and limits of the scheduler.

use super::held_outcomes::CrossCheck;
use common::build::Build;
use common::wire::{Offers, Subject};
use std::time::Duration;

/// Deadline as a multiple of the longest simulation so far [1].
const DEADLINE_FACTOR: f64 = 10.0;

/// Simulators of a worker that are listed.
const SHOWN: usize = 5;

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
    /// Lower bound of the deadline.
    pub shortest_deadline: Duration,
    /// A task goes to a second, idle worker once its lease is older than this multiple of the mean time from lease to
    /// outcome [1].
    pub straggler_factor: f64,
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

    /// The warning about a worker that gets no tasks because of what it offers.
    pub(super) fn not_offered(&self, worker: &str, offers: &Offers) -> String {
        let (wanted, offered) = match (&self.subject, self.build, offers) {
            (Subject::Scene(_), Some(ours), Offers::Scenes(theirs)) if ours != *theirs => {
                return format!(
                    "worker {worker} gets no evaluations: its program is build {theirs}, that of the coordinator build {ours}, and their \
                     results may differ; start the worker with the program of the coordinator, or the study with --mixed-builds"
                );
            }
            (subject, _, Offers::Scenes(_)) => (subject, "simulations of mechanisms".to_owned()),
            (subject, _, Offers::Simulators(all)) => {
                let shown: Vec<String> = all.iter().take(SHOWN).map(ToString::to_string).collect();
                let more = if all.len() > SHOWN { ", ..." } else { "" };
                (subject, format!("{}{more}", shown.join(", ")))
            }
        };
        let wanted = match wanted {
            Subject::Scene(_) => "a mechanism".to_owned(),
            Subject::Simulator(id) => format!("simulator {id}"),
        };
        format!("worker {worker} gets no evaluations: the study is of {wanted}, the worker offers {offered}")
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
            shortest_deadline: Duration::from_secs(120),
            straggler_factor: 2.0,
            settle: Duration::ZERO,
        }
    }

    /// Deadline of a task on a worker with one slot per lease; `longest_wall` is the longest simulation so far [s].
    pub(super) fn deadline(&self, longest_wall: Option<f64>) -> Duration {
        match longest_wall {
            None => self.first_deadline,
            Some(wall) => Duration::try_from_secs_f64(wall * DEADLINE_FACTOR)
                .unwrap_or(Duration::MAX)
                .max(self.shortest_deadline),
        }
    }
}
