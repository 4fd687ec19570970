//! When waiting points are announced: at once, unless the last notice was sent a short time ago. A notice is a message to
//! every worker, and every worker claims tasks then, so the shortest interval grows with their number.

use common::wire::CandidatePoint;
use std::time::Duration;

/// Most points in a notice: a worker claims tasks whichever points it names.
const POINTS_PER_NOTICE: usize = 100;
/// Shortest interval between two notices, per connected worker: a claim and its reply take about this time of a processor.
const INTERVAL_PER_WORKER: Duration = Duration::from_micros(100);

/// Points that are not announced yet.
#[derive(Debug, Default)]
pub(super) struct Announcements {
    waiting: Vec<CandidatePoint>,
    /// Earliest time of the next notice.
    earliest: Duration,
}

impl Announcements {
    /// Adds points to be announced.
    pub fn add(&mut self, points: Vec<CandidatePoint>) {
        let room = POINTS_PER_NOTICE.saturating_sub(self.waiting.len());
        self.waiting.extend(points.into_iter().take(room));
    }

    /// Time of the next notice; `None` without points.
    pub fn due(&self) -> Option<Duration> {
        (!self.waiting.is_empty()).then_some(self.earliest)
    }

    /// The points of a notice that is due; `workers` get it.
    pub fn take_due(&mut self, now: Duration, workers: usize) -> Option<Vec<CandidatePoint>> {
        self.due().filter(|due| *due <= now)?;
        self.earliest = now + INTERVAL_PER_WORKER * u32::try_from(workers).unwrap_or(u32::MAX);
        Some(std::mem::take(&mut self.waiting))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SECOND: Duration = Duration::from_secs(1);

    fn points(tasks: std::ops::Range<u64>) -> Vec<CandidatePoint> {
        tasks.map(|task| (task, vec![])).collect()
    }

    #[test]
    fn the_first_notice_is_sent_at_once_and_the_next_ones_together() {
        let mut announcements = Announcements::default();
        assert_eq!(announcements.take_due(SECOND, 2000), None);
        announcements.add(points(0..1));
        assert_eq!(announcements.take_due(SECOND, 2000), Some(points(0..1)));
        announcements.add(points(1..2));
        announcements.add(points(2..1000));
        let due = announcements.due().unwrap();
        assert_eq!(due, SECOND + Duration::from_millis(200));
        assert_eq!(announcements.take_due(due - Duration::from_nanos(1), 2000), None);
        assert_eq!(announcements.take_due(due, 2000), Some(points(1..101)));
        assert_eq!(announcements.due(), None);
    }
}
