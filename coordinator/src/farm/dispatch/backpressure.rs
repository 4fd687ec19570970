//! Bounds on messages. Back-pressure bounds the unread queries: excess ones are dropped, and the sender retries; liveliness changes and
//! messages of the study are never dropped. Waiting points are announced at once, unless the last notice was sent a short time ago: a
//! notice is a message to every worker, and every worker claims tasks then, so the shortest interval grows with their number.

use common::wire::{CandidatePoint, Refused};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::Duration;

/// Most unread queries.
const MOST_WAITING: usize = 4096;
/// Most bytes of all unread queries together: sixteen of the largest messages.
const MOST_BYTES: usize = 256 << 20;

/// Number and size of the unread queries.
#[derive(Debug, Default, Clone, Copy)]
struct Backlog {
    messages: usize,
    bytes: usize,
    dropped: Refused,
}

/// Counts unread queries.
#[derive(Debug, Default)]
pub(super) struct Backpressure(Mutex<Backlog>);

impl Backpressure {
    /// Counts a query of `bytes` and returns true if it fits the bounds; otherwise the query must be dropped.
    pub fn try_admit(&self, bytes: usize) -> bool {
        let mut backlog = self.backlog();
        let room = backlog.messages < MOST_WAITING && bytes <= MOST_BYTES - backlog.bytes;
        if room {
            (backlog.messages, backlog.bytes) = (backlog.messages + 1, backlog.bytes + bytes);
        } else if let Some(count) = backlog.dropped.count() {
            tracing::warn!("a query is dropped ({count} so far): {} others are unread", backlog.messages);
        }
        room
    }

    /// Removes an admitted query of `bytes`, which was read.
    pub fn release(&self, bytes: usize) {
        let mut backlog = self.backlog();
        (backlog.messages, backlog.bytes) = (backlog.messages - 1, backlog.bytes - bytes);
    }

    fn backlog(&self) -> MutexGuard<'_, Backlog> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

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

    #[test]
    fn neither_many_small_messages_nor_few_large_ones_fill_the_memory() {
        let backpressure = Backpressure::default();
        assert!((0..MOST_WAITING).all(|_| backpressure.try_admit(100)));
        assert!(!backpressure.try_admit(0));
        backpressure.release(100);
        assert!(backpressure.try_admit(100) && !backpressure.try_admit(100));
        let backpressure = Backpressure::default();
        assert!((0..16).all(|_| backpressure.try_admit(16 << 20)));
        assert!(!backpressure.try_admit(1) && backpressure.try_admit(0));
        backpressure.release(16 << 20);
        assert!(
            backpressure.try_admit(1)
                && !backpressure.try_admit(16 << 20)
                && !backpressure.try_admit(usize::MAX)
        );
    }

    const SECOND: Duration = Duration::from_secs(1);

    fn points(tasks: std::ops::Range<u64>) -> Vec<CandidatePoint> {
        tasks.map(|task| CandidatePoint { task, sample: vec![] }).collect()
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
