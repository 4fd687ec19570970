//! How fast tasks end and answers come, as measured: how many tasks to hold in reserve, and whether one can still be ended
//! in time.

use std::collections::VecDeque;
use std::time::Duration;

/// Weight of the newest in the means.
const NEWEST: f64 = 0.2;
/// Evaluations that are looked back on for the longest.
const LOOK_BACK: usize = 32;
/// By how much the next evaluation may be longer than the longest of those.
const LONGER: f64 = 1.25;
/// Share of its time that a slot may wait for an answer before tasks are held in reserve.
const WAITED: f64 = 0.005;
/// Most tasks in reserve: what is here cannot be done elsewhere.
const MOST_IN_RESERVE: f64 = 256.0;

/// See the module.
#[derive(Debug, Default)]
pub(super) struct PrefetchEstimator {
    /// Mean time that a task took a slot [s].
    wall: Option<f64>,
    /// Mean time from a claim to its answer [s].
    answer: Option<f64>,
    /// From the beginning of a task to its end.
    latest: VecDeque<Duration>,
    /// Tasks so far.
    ended: usize,
}

impl PrefetchEstimator {
    /// A task took a slot `wall` seconds, and was here for `took`.
    pub fn task_ended(&mut self, wall: f64, took: Duration) {
        self.wall = mean(self.wall, wall);
        self.ended += 1;
        self.latest.truncate(LOOK_BACK - 1);
        self.latest.push_front(took);
    }

    /// A claim was answered after so long.
    pub fn answered(&mut self, after: Duration) {
        self.answer = mean(self.answer, after.as_secs_f64());
    }

    /// How long a task may take from its beginning to its end; `None` before the first has ended.
    pub fn longest(&self) -> Option<Duration> {
        self.latest.iter().max().map(|longest| longest.mul_f64(LONGER))
    }

    /// Tasks that `slots` threads work off while a claim is answered; none where they would hardly wait for it, and no
    /// more than have ended so far, as the next ones may be longer.
    pub fn reserve(&self, slots: usize) -> usize {
        let reserve = match (self.wall, self.answer) {
            (Some(wall), Some(answer)) if answer > WAITED * wall => {
                (slots as f64 * answer / wall.max(f64::MIN_POSITIVE)).ceil().min(MOST_IN_RESERVE) as usize
            }
            _ => 0,
        };
        reserve.min(self.ended)
    }
}

fn mean(before: Option<f64>, newest: f64) -> Option<f64> {
    Some(before.map_or(newest, |before| before + NEWEST * (newest - before)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_reserve_covers_the_time_of_an_answer() {
        let mut prefetch = PrefetchEstimator::default();
        assert_eq!(prefetch.reserve(2), 0, "nothing is known");
        prefetch.answered(Duration::from_millis(1));
        for (wall, reserve) in [(1.0, 0), (0.01, 1), (1e-3, 2), (2.5e-4, 8), (0.0, 256)] {
            let prefetch = PrefetchEstimator {
                wall: Some(wall),
                answer: prefetch.answer,
                ended: 1000,
                ..PrefetchEstimator::default()
            };
            assert_eq!(prefetch.reserve(2), reserve, "{wall} s a task");
        }
        let new = PrefetchEstimator {
            wall: Some(0.0),
            answer: prefetch.answer,
            ended: 3,
            ..PrefetchEstimator::default()
        };
        assert_eq!(new.reserve(2), 3, "three ended at once; the next ones may not");
    }

    #[test]
    fn the_longest_is_that_of_late() {
        let mut prefetch = PrefetchEstimator::default();
        assert_eq!(prefetch.longest(), None);
        prefetch.task_ended(1.0, Duration::from_secs(8));
        prefetch.task_ended(1.0, Duration::from_secs(4));
        assert_eq!(prefetch.longest(), Some(Duration::from_secs(10)));
        (0..LOOK_BACK).for_each(|_| prefetch.task_ended(1.0, Duration::from_secs(4)));
        assert_eq!(prefetch.longest(), Some(Duration::from_secs(5)));
    }
}
