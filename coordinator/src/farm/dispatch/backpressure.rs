//! Back-pressure: bounds on unread queries. Excess queries are dropped, and the sender retries; liveliness changes and
//! messages of the study are never dropped.

use common::wire::Refused;

/// Most unread queries.
const MOST_WAITING: usize = 4096;
/// Most bytes of all unread queries together: sixteen of the largest messages.
const MOST_BYTES: usize = 256 << 20;

/// Number and size of the unread queries.
#[derive(Debug, Default)]
pub(super) struct Backpressure {
    messages: usize,
    bytes: usize,
    dropped: Refused,
}

impl Backpressure {
    /// Counts a query of `bytes` and returns true if it fits the bounds; otherwise the query must be dropped.
    pub fn try_admit(&mut self, bytes: usize) -> bool {
        let room = self.messages < MOST_WAITING && bytes <= MOST_BYTES - self.bytes;
        if room {
            (self.messages, self.bytes) = (self.messages + 1, self.bytes + bytes);
        } else if let Some(count) = self.dropped.count() {
            tracing::warn!("a query is dropped ({count} so far): {} others are unread", self.messages);
        }
        room
    }

    /// Removes an admitted query of `bytes`, which was read.
    pub fn release(&mut self, bytes: usize) {
        (self.messages, self.bytes) = (self.messages - 1, self.bytes - bytes);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn neither_many_small_messages_nor_few_large_ones_fill_the_memory() {
        let mut backpressure = Backpressure::default();
        assert!((0..MOST_WAITING).all(|_| backpressure.try_admit(100)));
        assert!(!backpressure.try_admit(0));
        backpressure.release(100);
        assert!(backpressure.try_admit(100) && !backpressure.try_admit(100));
        let mut backpressure = Backpressure::default();
        assert!((0..16).all(|_| backpressure.try_admit(16 << 20)));
        assert!(!backpressure.try_admit(1) && backpressure.try_admit(0));
        backpressure.release(16 << 20);
        assert!(
            backpressure.try_admit(1)
                && !backpressure.try_admit(16 << 20)
                && !backpressure.try_admit(usize::MAX)
        );
    }
}
