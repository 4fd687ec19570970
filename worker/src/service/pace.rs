//! The pace of a claim loop: pauses after claims without reply, with a spread so that many workers do not return at the same time; estimates from
//! measured times how many tasks to prefetch, and how long the next task may take.

use common::wire::WorkerId;
use std::collections::VecDeque;
use std::hash::{DefaultHasher, Hash, Hasher};
use std::time::Duration;

/// First pause after a claim without reply; it doubles each time. Short enough that a restarted coordinator has its workers
/// within a second.
const FIRST: Duration = Duration::from_millis(50);
/// Longest pause after a claim without reply.
const LONGEST: Duration = Duration::from_millis(400);

/// The next pause of a worker.
pub(super) struct Backoff {
    worker: WorkerId,
    pause: Duration,
}

impl Backoff {
    /// The first pause of a worker.
    pub(crate) fn new(worker: &WorkerId) -> Self {
        Self { worker: worker.clone(), pause: FIRST }
    }

    /// Starts with the first pause again: a reply has arrived.
    pub(crate) fn reset(&mut self) {
        self.pause = FIRST;
    }

    /// The pause after claim number `sequence`.
    pub(crate) fn next(&mut self, sequence: u64) -> Duration {
        let pause = self.spread(self.pause, sequence);
        self.pause = (2 * self.pause).min(LONGEST);
        pause
    }

    /// `pause` reduced by up to a quarter, by a hash of worker and claim.
    pub(crate) fn spread(&self, pause: Duration, sequence: u64) -> Duration {
        let mut hasher = DefaultHasher::new();
        (&self.worker, sequence).hash(&mut hasher);
        let share = (hasher.finish() % 1024) as f64 / 1024.0;
        pause.mul_f64(1.0 - 0.25 * share)
    }
}

/// Weight of the newest value in the running means [1].
const NEWEST: f64 = 0.2;
/// Number of recent evaluations considered for the longest one.
const RECENT: usize = 32;
/// Margin of the next evaluation over the longest recent one [1].
const MARGIN: f64 = 1.25;
/// Share of its time that a slot may wait for a reply before tasks are prefetched [1].
const WAIT_SHARE: f64 = 0.005;
/// Most tasks prefetched: a prefetched task is not available to other workers.
const MOST_PREFETCHED: f64 = 256.0;

/// Running means of task and reply times.
#[derive(Debug, Default)]
pub(super) struct PrefetchEstimator {
    /// Running mean of the slot time of a task [s].
    wall: Option<f64>,
    /// Running mean of the time from a claim to its reply [s].
    reply: Option<f64>,
    /// Time from arrival to end of the most recent tasks.
    latest: VecDeque<Duration>,
    /// Number of tasks ended.
    ended: usize,
}

impl PrefetchEstimator {
    /// Registers a task that took a slot `wall` seconds and ended `took` after its arrival.
    pub(crate) fn task_ended(&mut self, wall: f64, took: Duration) {
        self.wall = mean(self.wall, wall);
        self.ended += 1;
        self.latest.truncate(RECENT - 1);
        self.latest.push_front(took);
    }

    /// Registers a reply that arrived `after` its claim.
    pub(crate) fn reply_received(&mut self, after: Duration) {
        self.reply = mean(self.reply, after.as_secs_f64());
    }

    /// Longest expected time of a task from arrival to end; `None` before the first task has ended.
    pub(crate) fn longest(&self) -> Option<Duration> {
        self.latest.iter().max().map(|longest| longest.mul_f64(MARGIN))
    }

    /// Tasks to prefetch: as many as `slots` threads finish during one reply time. Zero if a slot would wait for less than
    /// 0.5 % of its time; at most the number of tasks ended so far, since the next ones may be longer.
    pub(crate) fn tasks(&self, slots: usize) -> usize {
        let tasks = match (self.wall, self.reply) {
            (Some(wall), Some(reply)) if reply > WAIT_SHARE * wall => {
                (slots as f64 * reply / wall.max(f64::MIN_POSITIVE)).ceil().min(MOST_PREFETCHED) as usize
            }
            _ => 0,
        };
        tasks.min(self.ended)
    }
}

fn mean(before: Option<f64>, newest: f64) -> Option<f64> {
    Some(before.map_or(newest, |before| before + NEWEST * (newest - before)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn prefetched_tasks_cover_the_reply_time() {
        let mut prefetch = PrefetchEstimator::default();
        assert_eq!(prefetch.tasks(2), 0, "nothing is measured yet");
        prefetch.reply_received(Duration::from_millis(1));
        for (wall, tasks) in [(1.0, 0), (0.01, 1), (1e-3, 2), (2.5e-4, 8), (0.0, 256)] {
            let prefetch = PrefetchEstimator {
                wall: Some(wall),
                reply: prefetch.reply,
                ended: 1000,
                ..PrefetchEstimator::default()
            };
            assert_eq!(prefetch.tasks(2), tasks, "{wall} s a task");
        }
        let new = PrefetchEstimator {
            wall: Some(0.0),
            reply: prefetch.reply,
            ended: 3,
            ..PrefetchEstimator::default()
        };
        assert_eq!(new.tasks(2), 3, "three ended at once; the next ones may not");
    }

    #[test]
    fn the_longest_is_that_of_recent_tasks() {
        let mut prefetch = PrefetchEstimator::default();
        assert_eq!(prefetch.longest(), None);
        prefetch.task_ended(1.0, Duration::from_secs(8));
        prefetch.task_ended(1.0, Duration::from_secs(4));
        assert_eq!(prefetch.longest(), Some(Duration::from_secs(10)));
        (0..RECENT).for_each(|_| prefetch.task_ended(1.0, Duration::from_secs(4)));
        assert_eq!(prefetch.longest(), Some(Duration::from_secs(5)));
    }
}
