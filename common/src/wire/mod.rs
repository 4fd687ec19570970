//! Messages between coordinator and workers: what they say, how they become bytes, under which keys they travel.
//!
//! ```text
//! coordinator --- Notice (a batch of candidate points, the end) ---> hingewise/notice         all workers
//! worker -------- Claim (credits, finished outcomes) --------------> hingewise/claim          as a query
//! coordinator --- Reply (acknowledgements, work or idle) ----------> the asker                as its reply
//! worker -------- liveliness token --------------------------------> hingewise/alive/<worker>/<epoch>
//! whoever looks - query (empty) -----------------------------------> hingewise/status
//! coordinator --- Status ------------------------------------------> the asker                as its reply
//! ```
//!
//! Keys carry no version on purpose: a worker of another protocol version reaches the coordinator, and both
//! sides refuse each other by name, instead of talking past each other without a word. The version stands in
//! the frame of every message ([`codec`]), whose first twelve bytes never change their layout.

pub mod codec;
pub mod keys;
pub mod message;
mod numbers;
mod reason;
pub mod status;
#[cfg(test)]
mod tests;

pub use codec::{MAX_MESSAGE, MAX_PAYLOAD, Message, WireError, decode, encode};
pub use message::{CandidatePoint, Claim, Next, Notice, Outcome, Reply, Task, TaskKey, WorkOrder, WorkerId};
pub use numbers::{NonFinite, failure_is_finite, find_non_finite};
pub use reason::reason;
pub use status::{FarmStatus, Phase, ReliabilitySoFar, Status, StudyStatus, WorkerStatus};

/// Version of the messages. It changes with every change of their layout or meaning; there is no negotiation.
pub const PROTOCOL_VERSION: u16 = 3;
