//! How much may wait to be read. Claims and questions beyond that are dropped, and whoever sent them backs off; liveness and the
//! study's own messages are never dropped.

use std::sync::{Mutex, MutexGuard, PoisonError};

/// Claims and questions that may wait,
const MOST_WAITING: usize = 4096;
/// and their size together [bytes]: sixteen of the largest messages there are.
const MOST_BYTES: usize = 256 << 20;

/// What waits.
#[derive(Debug, Default, Clone, Copy)]
struct Waiting {
    messages: usize,
    bytes: usize,
}

/// See the module.
#[derive(Debug, Default)]
pub(super) struct Gate(Mutex<Waiting>);

impl Gate {
    /// Whether one more message of so many bytes may wait.
    pub fn enter(&self, bytes: usize) -> bool {
        let mut waiting = self.waiting();
        let room = waiting.messages < MOST_WAITING && bytes <= MOST_BYTES - waiting.bytes;
        if room {
            *waiting = Waiting { messages: waiting.messages + 1, bytes: waiting.bytes + bytes };
        }
        room
    }

    /// One that had entered is read.
    pub fn leave(&self, bytes: usize) {
        let mut waiting = self.waiting();
        *waiting = Waiting { messages: waiting.messages - 1, bytes: waiting.bytes - bytes };
    }

    fn waiting(&self) -> MutexGuard<'_, Waiting> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn neither_many_small_messages_nor_few_large_ones_fill_the_memory() {
        let gate = Gate::default();
        assert!((0..MOST_WAITING).all(|_| gate.enter(100)));
        assert!(!gate.enter(0));
        gate.leave(100);
        assert!(gate.enter(100) && !gate.enter(100));
        let gate = Gate::default();
        assert!((0..16).all(|_| gate.enter(16 << 20)));
        assert!(!gate.enter(1) && gate.enter(0));
        gate.leave(16 << 20);
        assert!(gate.enter(1) && !gate.enter(16 << 20) && !gate.enter(usize::MAX));
    }
}
