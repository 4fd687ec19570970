//! Messages between coordinator and workers: contents, encoding, and Zenoh keys.
//!
//! ```text
//! coordinator --- Notice (a batch of candidate points, the end) ---> hingewise/notice         all workers
//! worker -------- Claim (credits, finished outcomes) --------------> hingewise/claim          as a query
//! coordinator --- Reply (acknowledgements, work or idle) ----------> the worker               as its reply
//! worker -------- liveliness token --------------------------------> hingewise/alive/<worker>/<epoch>
//! any client ---- query (empty) -----------------------------------> hingewise/status
//! coordinator --- Status ------------------------------------------> the client               as its reply
//! ```
//!
//! Keys carry no version on purpose: a worker of another protocol version reaches the coordinator, and both sides report
//! the mismatch by name instead of ignoring each other. The version is in the frame of every message ([`codec`]), whose
//! first twelve bytes never change their layout.

pub mod codec;
pub mod keys;
#[cfg(test)]
mod layout_tests;
pub mod message;
mod numbers;
mod refused;
pub mod status;
#[cfg(test)]
mod tests;

use std::time::Duration;

pub use codec::{MAX_MESSAGE, MAX_PAYLOAD, Message, WireError, decode, encode};
pub use message::{
    CandidatePoint, Claim, Next, Notice, Offers, Outcome, Reply, Subject, Task, TaskKey, WorkOrder, WorkerId,
    is_worker_name, worker_name,
};
pub use numbers::{failure_is_finite, find_non_finite};
pub use refused::{Refused, reason};
pub use status::{FarmStatus, Phase, ReliabilitySoFar, ScaleStatus, Status, StudyStatus, WorkerStatus};

/// Version of the messages. It changes with every change of their layout or meaning; there is no negotiation.
pub const PROTOCOL_VERSION: u16 = 16;

/// Sessions that a coordinator accepts unless its configuration sets another number: one for each directly connected
/// worker, router, or command that queries the status. See `cargo run --release -p tests --example many_sessions`.
pub const MAX_SESSIONS: u32 = 4000;

/// Time without an answered claim after which a worker ends the evaluations that need licences. A coordinator holds the
/// licences of a lost worker back for longer than this.
pub const LICENCE_CONTACT: Duration = Duration::from_secs(10);
