//! Events of a claim loop.

use common::wire::Outcome;
use std::time::Instant;

/// Input of a claim loop, from slots, link and [`Stopper`](super::Stopper).
#[derive(Debug)]
pub(super) enum ClaimEvent {
    /// A slot has finished a task.
    Finished(Box<Outcome>),
    /// A slot may be free: a task of another coordinator has ended, or that coordinator needs fewer slots.
    SlotFree,
    /// The coordinator's reply to a claim, or its error text.
    Answer {
        /// Sequence number of the claim.
        sequence: u64,
        /// Frame of the reply, or the text of the error.
        frame: Result<Vec<u8>, String>,
    },
    /// No further reply to this claim will arrive. Holds the sequence number of the claim.
    QueryEnded(u64),
    /// A notice of the coordinator, as a frame.
    Notice(Vec<u8>),
    /// Stop: finish within the drain time, return outcomes and leave.
    Stop,
    /// Leave at once, without returning outcomes.
    Abort,
}

/// A claim without reply so far.
pub(super) struct PendingClaim {
    /// Its sequence number.
    pub sequence: u64,
    /// Number of tasks it requests.
    pub credits: usize,
    /// Whether it announces that the worker leaves.
    pub leaving: bool,
    /// Time at which it was sent.
    pub since: Instant,
}
