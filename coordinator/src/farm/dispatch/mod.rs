//! Evaluations by workers over Zenoh.
//!
//! ```text
//! study --requests--> ZenohEvaluator --Submit--> DispatchLoop (thread: scheduler) --replies, notices--> transport
//!       <--record----               <--Deliver--                                  <--claims, liveliness-
//! ```
//!
//! [`scheduler`] is a pure state machine without clock and messages. `transport` is the only module of the coordinator
//! that uses Zenoh. `dispatch_loop` is the thread that connects them. The caller needs no tokio runtime; if it has one,
//! it must be multi-threaded (a condition of Zenoh).

mod announcements;
mod backpressure;
mod dispatch_loop;
mod evaluator;
pub mod scheduler;
mod status_board;
mod transport;

pub use dispatch_loop::{ConnectedWorker, ConnectedWorkers};
pub use evaluator::{CampaignSimulator, CampaignSpec, StatusHandle, ZenohEvaluator};
pub use scheduler::CrossCheck;
pub use status_board::{StatusBoard, clock_ms};
pub use transport::{ClientError, ClientSession, Listen, LivelinessGuard, Watch, watch};

use common::wire::WireError;
use std::path::PathBuf;
use thiserror::Error;

/// Largest scene text [bytes]: every reply with tasks carries it.
const MAX_SCENE: usize = 4 << 20;

/// Reasons why the coordinator cannot accept workers.
#[derive(Debug, Error)]
pub enum DispatchError {
    /// Other machines can reach the address, and clients are not authenticated.
    #[error(
        "--listen {0}: other machines can reach this address, and clients are not authenticated; allowed are a \
         loopback address (tcp/127.0.0.1:PORT), tls/ with a Zenoh configuration that authenticates clients \
         (enable_mtls, or a usrpwd dictionary), or --insecure if the network is trusted"
    )]
    Insecure(String),
    /// The text is not an endpoint, or the system cannot listen on it; with what is wrong with it.
    #[error("--listen {0}: {1}; expected a free address of this machine, e.g. tcp/127.0.0.1:7447")]
    Endpoint(String, String),
    /// The Zenoh configuration of this file cannot be used; with the error of Zenoh.
    #[error("Zenoh configuration {file}: {1}", file = .0.display())]
    Configuration(PathBuf, String),
    /// The scene's text of this size [bytes] is too large for a message.
    #[error("the scene has {0} bytes; a message allows {limit}", limit = MAX_SCENE)]
    SceneTooLarge(usize),
    /// The settings of the campaign cannot be encoded.
    #[error("the campaign cannot be sent to workers: {0}")]
    Wire(#[from] WireError),
    /// The operating system cannot start a thread.
    #[error("cannot start a thread: {0}")]
    Thread(std::io::Error),
    /// Zenoh failed; the text is its error.
    #[error("messaging: {0}")]
    Messaging(String),
}

impl DispatchError {
    /// True if the user's input causes the error (exit code 2).
    pub fn is_bad_input(&self) -> bool {
        !matches!(self, DispatchError::Messaging(_) | DispatchError::Thread(_))
    }
}
