//! How long a worker stays: until it is told to leave, has been idle for too long, or its time is up; and what becomes of
//! what it is running then.

use super::{Departure, ServiceConfig};
use std::time::{Duration, Instant};

/// Before the end of its time a worker begins to leave: handing in and closing the line may take so long where nobody
/// answers,
const HANDING_IN: Duration = Duration::from_secs(8);
/// but never more than this share of its time.
const HANDING_IN_SHARE: f64 = 0.1;

/// Why it leaves.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Why {
    Asked,
    Idle,
    Walltime,
}

/// See the module.
#[derive(Debug)]
pub(super) struct LeavePolicy {
    /// When what runs is dropped because the time is up.
    time_up: Option<Instant>,
    idle_timeout: Option<Duration>,
    drain: Duration,
    /// Why it takes nothing new, and until when what runs may run.
    draining: Option<(Why, Instant)>,
}

impl LeavePolicy {
    /// Counted from `start`.
    pub fn new(config: &ServiceConfig, start: Instant) -> Self {
        let walltime = config.walltime;
        let working = walltime.map(|t| t - HANDING_IN.min(t.mul_f64(HANDING_IN_SHARE)));
        Self {
            time_up: working.map(|working| start + working),
            idle_timeout: config.idle_timeout,
            drain: config.drain,
            draining: None,
        }
    }

    /// Told to leave.
    pub fn request_stop(&mut self, now: Instant) {
        if self.draining.is_none_or(|(why, _)| why != Why::Asked) {
            let until = self.time_up.map_or(now + self.drain, |up| up.min(now + self.drain));
            self.draining = Some((Why::Asked, until));
        }
    }

    /// Whether it takes nothing new.
    pub fn is_draining(&self) -> bool {
        self.draining.is_some()
    }

    /// Looks at the clock. A task that takes up to `longest` is not begun where it could not end in time; `idle` is how
    /// long there has been nothing to do.
    pub fn check(&mut self, now: Instant, longest: Option<Duration>, idle: Duration) {
        if self.draining.is_some() {
            return;
        }
        if let Some(up) = self.time_up
            && now + longest.unwrap_or_default() >= up
        {
            self.draining = Some((Why::Walltime, up));
        } else if self.idle_timeout.is_some_and(|timeout| idle >= timeout) {
            self.draining = Some((Why::Idle, now));
        }
    }

    /// How it leaves, if it is to before it has found its coordinator.
    pub fn over_before_work(&self, now: Instant, idle: Duration) -> Option<Departure> {
        let up = self.time_up.is_some_and(|up| now >= up).then_some(Departure::TimeUp { lost: 0 });
        up.or(self.idle_timeout.is_some_and(|timeout| idle >= timeout).then_some(Departure::Idle))
    }

    /// Whether it is time to go, with so many tasks running.
    pub fn is_over(&self, now: Instant, running: usize) -> bool {
        self.draining.is_some_and(|(_, until)| running == 0 || now >= until)
    }

    /// When to look again at the latest.
    pub fn next_look(&self, now: Instant, longest: Option<Duration>, idle: Duration) -> Option<Instant> {
        if let Some((_, until)) = self.draining {
            return Some(until);
        }
        let timeout = self.idle_timeout.map(|timeout| now + timeout.saturating_sub(idle));
        let up = self.time_up.map(|up| up.checked_sub(longest.unwrap_or_default()).unwrap_or(now));
        [timeout, up].into_iter().flatten().min()
    }

    /// How it has left, with outcomes it could not hand in.
    pub fn departure(&self, lost: usize) -> Departure {
        match self.draining {
            Some((Why::Idle, _)) if lost == 0 => Departure::Idle,
            Some((Why::Walltime, _)) => Departure::TimeUp { lost },
            _ => Departure::Stopped { lost },
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SECOND: Duration = Duration::from_secs(1);

    fn leave_policy(walltime: Option<u32>, idle: Option<u32>, drain: u32) -> (LeavePolicy, Instant) {
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
    fn nothing_is_begun_that_cannot_end_in_time() {
        let (mut leave_policy, start) = leave_policy(Some(100), None, 0);
        // 92 s are left for work; what takes 30 s is begun in the first 62.
        let longest = Some(30 * SECOND);
        leave_policy.check(start + 61 * SECOND, longest, Duration::ZERO);
        assert!(!leave_policy.is_draining());
        assert_eq!(leave_policy.next_look(start, longest, Duration::ZERO), Some(start + 62 * SECOND));
        leave_policy.check(start + 62 * SECOND, longest, Duration::ZERO);
        assert!(leave_policy.is_draining() && !leave_policy.is_over(start + 91 * SECOND, 1));
        assert!(leave_policy.is_over(start + 63 * SECOND, 0), "with nothing to end it goes at once");
        assert!(leave_policy.is_over(start + 92 * SECOND, 1), "with time to hand back what has not ended");
        assert_eq!(leave_policy.departure(0), Departure::TimeUp { lost: 0 });
    }

    #[test]
    fn what_runs_may_end_within_the_drain() {
        let (mut leave_policy, start) = leave_policy(None, None, 20);
        leave_policy.request_stop(start);
        leave_policy.request_stop(start + 19 * SECOND);
        assert!(leave_policy.is_draining() && !leave_policy.is_over(start + 19 * SECOND, 1));
        assert!(leave_policy.is_over(start + SECOND, 0) && leave_policy.is_over(start + 20 * SECOND, 1));
        assert_eq!(leave_policy.departure(2), Departure::Stopped { lost: 2 });
    }

    #[test]
    fn it_goes_when_it_was_idle_for_too_long() {
        let (mut leave_policy, start) = leave_policy(None, Some(60), 0);
        leave_policy.check(start, None, 59 * SECOND);
        assert!(!leave_policy.is_draining());
        assert_eq!(leave_policy.next_look(start, None, 59 * SECOND), Some(start + SECOND));
        leave_policy.check(start, None, 60 * SECOND);
        assert!(leave_policy.is_over(start, 0));
        assert_eq!(leave_policy.departure(0), Departure::Idle);
    }
}
