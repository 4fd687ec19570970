//! Decides when a worker leaves: after a stop request, without tasks for the idle timeout, or at the end of its run time;
//! and how long its running tasks may continue.

use super::{Departure, ServiceConfig};
use std::time::{Duration, Instant};

/// Part of the run time reserved for returning outcomes and closing the connection, which takes this long if no
/// coordinator answers.
const RESERVED: Duration = Duration::from_secs(8);
/// Upper bound of that part as a share of the run time [1].
const RESERVED_SHARE: f64 = 0.1;

/// Limits of a worker's stay, and whether it is leaving.
#[derive(Debug)]
pub(super) struct LeavePolicy {
    /// Time at which running tasks are dropped because the run time ends.
    time_up: Option<Instant>,
    idle_timeout: Option<Duration>,
    drain: Duration,
    /// Why the worker takes no new tasks, and the time limit of its running tasks.
    draining: Option<(Departure, Instant)>,
}

impl LeavePolicy {
    /// The policy of a worker that started at `start`.
    pub(crate) fn new(config: &ServiceConfig, start: Instant) -> Self {
        let walltime = config.walltime;
        let working = walltime.map(|t| t - RESERVED.min(t.mul_f64(RESERVED_SHARE)));
        Self {
            time_up: working.map(|working| start + working),
            idle_timeout: config.idle_timeout,
            drain: config.drain,
            draining: None,
        }
    }

    /// Registers a stop request.
    pub(crate) fn request_stop(&mut self, now: Instant) {
        if self.draining.is_none_or(|(reason, _)| !matches!(reason, Departure::Stopped { .. })) {
            let until = self.time_up.map_or(now + self.drain, |up| up.min(now + self.drain));
            self.draining = Some((Departure::Stopped { lost: 0 }, until));
        }
    }

    /// True if the worker takes no new tasks.
    pub(crate) fn is_draining(&self) -> bool {
        self.draining.is_some()
    }

    /// Starts draining at the end of the run time or of the idle timeout. `longest` is the longest expected task, which must
    /// not start unless it can finish in time; `idle` is the time without tasks.
    pub(crate) fn check(&mut self, now: Instant, longest: Option<Duration>, idle: Duration) {
        self.draining = self.draining.or_else(|| self.due(now, longest, idle));
    }

    /// The departure due before the first connection, if any.
    pub(crate) fn over_before_work(&self, now: Instant, idle: Duration) -> Option<Departure> {
        self.due(now, None, idle).map(|(departure, _)| departure)
    }

    fn due(&self, now: Instant, longest: Option<Duration>, idle: Duration) -> Option<(Departure, Instant)> {
        let up = self.time_up.filter(|up| now + longest.unwrap_or_default() >= *up);
        let is_idle = self.idle_timeout.is_some_and(|timeout| idle >= timeout);
        up.map(|up| (Departure::TimeUp { lost: 0 }, up)).or(is_idle.then_some((Departure::Idle, now)))
    }

    /// True if the worker is to leave now, with `running` tasks.
    pub(crate) fn must_leave(&self, now: Instant, running: usize) -> bool {
        self.draining.is_some_and(|(_, until)| running == 0 || now >= until)
    }

    /// Latest time of the next [`LeavePolicy::check`].
    pub(crate) fn next_check(
        &self,
        now: Instant,
        longest: Option<Duration>,
        idle: Duration,
    ) -> Option<Instant> {
        if let Some((_, until)) = self.draining {
            return Some(until);
        }
        let timeout = self.idle_timeout.map(|timeout| now + timeout.saturating_sub(idle));
        let up = self.time_up.map(|up| up.checked_sub(longest.unwrap_or_default()).unwrap_or(now));
        [timeout, up].into_iter().flatten().min()
    }

    /// The departure with `lost` outcomes that could not be returned.
    pub(crate) fn departure(&self, lost: usize) -> Departure {
        match self.draining {
            Some((Departure::Idle, _)) if lost == 0 => Departure::Idle,
            Some((Departure::TimeUp { .. }, _)) => Departure::TimeUp { lost },
            _ => Departure::Stopped { lost },
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SECOND: Duration = Duration::from_secs(1);

    fn policy(walltime: Option<u32>, idle: Option<u32>, drain: u32) -> (LeavePolicy, Instant) {
        let seconds = |n: Option<u32>| n.map(|n| n * SECOND);
        let config = ServiceConfig {
            walltime: seconds(walltime),
            idle_timeout: seconds(idle),
            drain: drain * SECOND,
            ..ServiceConfig::new("tcp/host:1", 1)
        };
        let start = Instant::now();
        (LeavePolicy::new(&config, start), start)
    }

    #[test]
    fn no_task_starts_that_cannot_finish_in_time() {
        let (mut policy, start) = policy(Some(100), None, 0);
        // 92 s are left for work; a task of 30 s starts within the first 62 s.
        let longest = Some(30 * SECOND);
        policy.check(start + 61 * SECOND, longest, Duration::ZERO);
        assert!(!policy.is_draining());
        assert_eq!(policy.next_check(start, longest, Duration::ZERO), Some(start + 62 * SECOND));
        policy.check(start + 62 * SECOND, longest, Duration::ZERO);
        assert!(policy.is_draining() && !policy.must_leave(start + 91 * SECOND, 1));
        assert!(policy.must_leave(start + 63 * SECOND, 0), "without running tasks it leaves at once");
        assert!(policy.must_leave(start + 92 * SECOND, 1), "with time to return unfinished tasks");
        assert_eq!(policy.departure(0), Departure::TimeUp { lost: 0 });
    }

    #[test]
    fn running_tasks_may_finish_within_the_drain_time() {
        let (mut policy, start) = policy(None, None, 20);
        policy.request_stop(start);
        policy.request_stop(start + 19 * SECOND);
        assert!(policy.is_draining() && !policy.must_leave(start + 19 * SECOND, 1));
        assert!(policy.must_leave(start + SECOND, 0) && policy.must_leave(start + 20 * SECOND, 1));
        assert_eq!(policy.departure(2), Departure::Stopped { lost: 2 });
    }

    #[test]
    fn a_worker_leaves_after_the_idle_timeout() {
        let (mut policy, start) = policy(None, Some(60), 0);
        policy.check(start, None, 59 * SECOND);
        assert!(!policy.is_draining());
        assert_eq!(policy.next_check(start, None, 59 * SECOND), Some(start + SECOND));
        policy.check(start, None, 60 * SECOND);
        assert!(policy.must_leave(start, 0));
        assert_eq!(policy.departure(0), Departure::Idle);
    }
}
