//! Evaluations by workers over Zenoh.
//!
//! ```text
//! study --evaluate--> ZenohEvaluator --Submit--> desk (thread: scheduler) --replies, notices--> transport
//!       <--record---                <--Deliver--                          <--claims, liveness---
//! ```
//!
//! [`scheduler`] decides, without clock or messages; `transport` is the only place of the coordinator that
//! knows Zenoh; `desk` is the thread between them. Nothing here needs a tokio runtime of the caller; inside one,
//! it must be a multi-threaded one (Zenoh's own condition).

mod board;
mod desk;
mod evaluator;
mod gate;
pub mod scheduler;
mod tally;
mod transport;

pub use board::{Board, clock_ms};
pub use desk::{Attendance, ConnectedWorker};
pub use evaluator::{Campaign, Look, ZenohEvaluator};
pub use transport::{Life, Listen, VisitError, Visitor};

use common::wire::WireError;
use std::path::PathBuf;
use thiserror::Error;

/// Why the coordinator cannot take workers.
#[derive(Debug, Error)]
pub enum DispatchError {
    /// An address other machines can reach, and nothing that keeps strangers out.
    #[error(
        "--listen {endpoint}: other machines could reach this address and nothing asks who they are; allowed are \
         a loopback address (tcp/127.0.0.1:PORT), tls/ with a Zenoh configuration that asks (enable_mtls, or a usrpwd \
         dictionary), or --insecure if the network is trusted"
    )]
    Insecure {
        /// The endpoint.
        endpoint: String,
    },
    /// Not an endpoint, or one that cannot be listened on.
    #[error("--listen {endpoint}: {reason}; expected e.g. tcp/127.0.0.1:7447")]
    Endpoint {
        /// The endpoint.
        endpoint: String,
        /// What is wrong.
        reason: String,
    },
    /// The Zenoh configuration cannot be used.
    #[error("Zenoh configuration {}: {reason}", file.display())]
    Configuration {
        /// Which file.
        file: PathBuf,
        /// What is wrong.
        reason: String,
    },
    /// The scene does not fit a message.
    #[error("the scene has {bytes} bytes, more than the {limit} a message may give it")]
    SceneTooLarge {
        /// Its size.
        bytes: usize,
        /// Limit.
        limit: usize,
    },
    /// The settings of the campaign cannot be sent.
    #[error("the campaign cannot be sent to workers: {0}")]
    Wire(#[from] WireError),
    /// The messaging library failed.
    #[error("messaging: {0}")]
    Messaging(String),
}

impl DispatchError {
    /// Whether the user can mend it (exit code 2).
    pub fn is_bad_input(&self) -> bool {
        !matches!(self, DispatchError::Messaging(_))
    }
}
