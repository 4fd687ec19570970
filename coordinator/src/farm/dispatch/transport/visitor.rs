//! A short visit to a coordinator by somebody who is no worker: asks how a study is getting on, tries what a worker
//! would do.

use common::wire::{self, Claim, Message, Reply, Status, WireError, WorkerId, keys, reason};
use std::path::{Path, PathBuf};
use std::time::Duration;
use thiserror::Error;
use zenoh::liveliness::LivelinessToken;
use zenoh::query::ConsolidationMode;
use zenoh::{Config, Session, Wait};

/// As a worker, but it gives up at once: whoever visits wants an answer now.
const SETTINGS: [(&str, &str); 8] = [
    ("mode", "\"client\""),
    ("listen/endpoints", "[]"),
    ("scouting/multicast/enabled", "false"),
    ("scouting/gossip/enabled", "false"),
    ("scouting/delay", "0"),
    ("transport/link/rx/max_message_size", wire::MAX_MESSAGE),
    ("connect/timeout_ms", "3000"),
    ("connect/exit_on_failure", "true"),
];

/// Why a visit failed.
#[derive(Debug, Error)]
pub enum VisitError {
    /// Not an endpoint.
    #[error("{endpoint}: {reason}; expected e.g. tcp/192.168.1.20:7447 or tls/host.example:7447")]
    Endpoint {
        /// What was given.
        endpoint: String,
        /// What is wrong.
        reason: String,
    },
    /// The Zenoh configuration cannot be used.
    #[error("--config {}: {reason}", file.display())]
    Configuration {
        /// Which file.
        file: PathBuf,
        /// What is wrong.
        reason: String,
    },
    /// There is no session.
    #[error("no coordinator can be reached at {endpoint} ({reason})")]
    Unreachable {
        /// Where it should be.
        endpoint: String,
        /// What the messaging library says.
        reason: String,
    },
    /// A session, and nobody who answers.
    #[error(
        "connected to {endpoint}, but nobody answers queries on {key}: no coordinator is behind that address, or its \
         access_control does not let us ask"
    )]
    Silent {
        /// Where.
        endpoint: String,
        /// What was asked.
        key: &'static str,
    },
    /// The answer is a refusal.
    #[error("the coordinator at {endpoint} refuses: {reason}")]
    Refused {
        /// Where.
        endpoint: String,
        /// Its words.
        reason: String,
    },
    /// The answer cannot be read, e.g. as it comes from another version of the program.
    #[error("the answer of {endpoint} cannot be read: {fault}")]
    Answer {
        /// Where.
        endpoint: String,
        /// Why not.
        fault: WireError,
    },
    /// The messaging library failed.
    #[error("messaging: {0}")]
    Messaging(String),
}

impl VisitError {
    /// Whether the user can mend it (exit code 2).
    pub fn is_bad_input(&self) -> bool {
        matches!(self, VisitError::Endpoint { .. } | VisitError::Configuration { .. })
    }
}

/// A session with a coordinator.
pub struct Visitor {
    session: Session,
    endpoint: String,
}

/// Shows that a worker lives, until it is dropped.
pub struct Life(#[allow(dead_code)] LivelinessToken); // kept for its Drop

impl Visitor {
    /// Opens a session with the coordinator at `endpoint`, with more Zenoh settings from a file.
    ///
    /// # Errors
    /// [`VisitError`], all but silence and refusals.
    pub fn open(endpoint: &str, config: Option<&Path>) -> Result<Self, VisitError> {
        let session = zenoh::open(settings(endpoint, config)?).wait().map_err(|error| {
            VisitError::Unreachable { endpoint: endpoint.to_owned(), reason: reason(error) }
        })?;
        Ok(Self { session, endpoint: endpoint.to_owned() })
    }

    /// How the study is getting on.
    ///
    /// # Errors
    /// [`VisitError`].
    pub fn status(&self, timeout: Duration) -> Result<Status, VisitError> {
        self.ask(keys::STATUS, keys::STATUS, Vec::new(), timeout)
    }

    /// What the coordinator answers to a claim.
    ///
    /// # Errors
    /// [`VisitError`].
    pub fn claim(&self, claim: &Claim, timeout: Duration) -> Result<Reply, VisitError> {
        let frame = wire::encode(claim).map_err(|e| VisitError::Messaging(e.to_string()))?;
        self.ask(keys::CLAIM, &format!("{}?worker={}", keys::CLAIM, claim.worker.name), frame, timeout)
    }

    /// Shows that this worker lives.
    ///
    /// # Errors
    /// [`VisitError::Messaging`].
    pub fn live(&self, worker: &WorkerId) -> Result<Life, VisitError> {
        let token = self.session.liveliness().declare_token(keys::alive(worker)).wait();
        token.map(Life).map_err(|error| VisitError::Messaging(reason(error)))
    }

    fn ask<M: Message>(
        &self,
        key: &'static str,
        selector: &str,
        payload: Vec<u8>,
        timeout: Duration,
    ) -> Result<M, VisitError> {
        let query = self.session.get(selector).payload(payload).timeout(timeout);
        let replies = query
            .consolidation(ConsolidationMode::None)
            .wait()
            .map_err(|error| VisitError::Messaging(reason(error)))?;
        let endpoint = self.endpoint.clone();
        // The channel closes with the query, at the latest after its timeout.
        let Ok(reply) = replies.recv() else { return Err(VisitError::Silent { endpoint, key }) };
        match reply.into_result() {
            Ok(sample) => wire::decode(&sample.payload().to_bytes())
                .map_err(|fault| VisitError::Answer { endpoint, fault }),
            Err(error) => {
                let text = String::from_utf8_lossy(&error.payload().to_bytes()).into_owned();
                // Zenoh's own word for a query that came to nothing.
                if text == "Timeout" {
                    return Err(VisitError::Silent { endpoint, key });
                }
                Err(VisitError::Refused { endpoint, reason: text })
            }
        }
    }
}

fn settings(endpoint: &str, config: Option<&Path>) -> Result<Config, VisitError> {
    let wrong = |reason: String| VisitError::Endpoint { endpoint: endpoint.to_owned(), reason };
    let mut settings = match config {
        None => Config::default(),
        Some(file) => Config::from_file(file)
            .map_err(|error| VisitError::Configuration { file: file.to_owned(), reason: reason(error) })?,
    };
    for (key, value) in SETTINGS {
        settings
            .insert_json5(key, value)
            .map_err(|error| VisitError::Messaging(format!("{key}: {}", reason(error))))?;
    }
    if !endpoint.contains('/') || endpoint.contains(['"', '\\']) {
        return Err(wrong("not an endpoint".into()));
    }
    let connect = format!("[\"{endpoint}\"]");
    settings.insert_json5("connect/endpoints", &connect).map_err(|error| wrong(reason(error)))?;
    Ok(settings)
}
