//! What reaches the claims of a worker.

use common::wire::Outcome;

/// See the module.
#[derive(Debug)]
pub(super) enum ClaimEvent {
    /// A slot has finished a task.
    Finished(Box<Outcome>),
    /// A place for a task may be free that another coordinator's task had.
    SlotFree,
    /// The coordinator's answer to a claim, or why it could not read it.
    Answer {
        /// Number of the claim.
        sequence: u64,
        /// Frame of the reply.
        frame: Result<Vec<u8>, String>,
    },
    /// No more answers to this claim will come.
    QueryEnded {
        /// Number of the claim.
        sequence: u64,
    },
    /// Frame of a notice.
    Notice(Vec<u8>),
    /// Drain and leave.
    Stop,
    /// Leave at once.
    Abort,
}
