//! A client session with a coordinator, for the commands `status` and `doctor`: queries the status and tries what a
//! worker does.

use common::wire::{self, Claim, Message, Reply, Status, WireError, WorkerId, keys, reason};
use std::path::{Path, PathBuf};
use std::time::Duration;
use thiserror::Error;
use zenoh::liveliness::LivelinessToken;
use zenoh::query::ConsolidationMode;
use zenoh::{Config, Session, Wait};

/// Zenoh settings as for a worker, except that a failed connection is reported at once.
const SETTINGS: [(&str, &str); 8] = [
    ("mode", "\"client\""),
    ("listen/endpoints", "[]"),
    ("scouting/multicast/enabled", "false"),
    ("scouting/gossip/enabled", "false"),
    ("scouting/delay", "0"),
    ("transport/link/rx/max_message_size", wire::MAX_MESSAGE),
    // One attempt, which ends with `transport/unicast/open_timeout` at the latest.
    ("connect/timeout_ms", "0"),
    ("connect/exit_on_failure", "true"),
];

/// Time to open a session in, for a person who waits.
const OPENING: Duration = Duration::from_secs(3);

/// Reasons for a query to a coordinator to fail.
#[derive(Debug, Error)]
pub enum ClientError {
    /// The text is not an endpoint, with what is wrong with it.
    #[error("{0}: {1}; expected e.g. tcp/192.168.1.20:7447 or tls/host.example:7447")]
    Endpoint(String, String),
    /// The Zenoh configuration of this file cannot be used, with the error of Zenoh.
    #[error("--config {file}: {1}", file = .0.display())]
    Configuration(PathBuf, String),
    /// No session could be opened with this endpoint, with the error of Zenoh.
    #[error("no coordinator can be reached at {0} ({1})")]
    Unreachable(String, String),
    /// A session with this endpoint is open, but the query of this key gets no reply.
    #[error(
        "connected to {0}, but queries on {1} get no reply: no coordinator runs behind that address, or its \
         access_control does not permit the query"
    )]
    Silent(String, &'static str),
    /// The coordinator at this endpoint replied with an error of this text.
    #[error("the coordinator at {0} refuses the query: {1}")]
    Refused(String, String),
    /// The reply of this endpoint cannot be decoded, e.g. because it comes from another version of the program.
    #[error("the reply of {0} cannot be decoded: {1}")]
    Answer(String, WireError),
    /// The claim cannot be encoded.
    #[error(transparent)]
    Wire(#[from] WireError),
    /// Zenoh failed; the text is its error.
    #[error("messaging: {0}")]
    Messaging(String),
}

impl ClientError {
    /// True if the user's input causes the error (exit code 2).
    pub fn is_bad_input(&self) -> bool {
        matches!(self, ClientError::Endpoint(..) | ClientError::Configuration(..))
    }
}

/// An open session with a coordinator.
pub struct ClientSession {
    session: Session,
    endpoint: String,
}

/// Liveliness token of a worker, withdrawn when dropped.
pub struct LivelinessGuard(#[allow(dead_code)] LivelinessToken); // kept for its Drop

impl ClientSession {
    /// Opens a session with the coordinator at `endpoint`; `config` is a file with further Zenoh settings.
    ///
    /// # Errors
    /// [`ClientError::Endpoint`], [`ClientError::Configuration`], [`ClientError::Unreachable`],
    /// [`ClientError::Messaging`].
    pub fn open(endpoint: &str, config: Option<&Path>) -> Result<Self, ClientError> {
        Self::open_within(endpoint, config, OPENING)
    }

    /// As [`open`](Self::open): a coordinator that accepts no more sessions refuses at once, one that is silent after the whole `time`.
    ///
    /// # Errors
    /// Those of [`open`](Self::open).
    pub fn open_within(endpoint: &str, config: Option<&Path>, time: Duration) -> Result<Self, ClientError> {
        let session = sessions::open(settings(endpoint, config, time)?)
            .map_err(|error| ClientError::Unreachable(endpoint.to_owned(), reason(error)))?;
        Ok(Self { session, endpoint: endpoint.to_owned() })
    }

    /// Queries the status of the study.
    ///
    /// # Errors
    /// [`ClientError`].
    pub fn status(&self, timeout: Duration) -> Result<Status, ClientError> {
        self.query(keys::STATUS, keys::STATUS, Vec::new(), timeout)
    }

    /// Sends a claim and returns the coordinator's reply.
    ///
    /// # Errors
    /// [`ClientError`].
    pub fn claim(&self, claim: &Claim, timeout: Duration) -> Result<Reply, ClientError> {
        let frame = wire::encode(claim)?;
        self.query(keys::CLAIM, &format!("{}?worker={}", keys::CLAIM, claim.worker.name), frame, timeout)
    }

    /// Declares the liveliness token of a worker.
    ///
    /// # Errors
    /// [`ClientError::Messaging`].
    pub fn declare_liveliness(&self, worker: &WorkerId) -> Result<LivelinessGuard, ClientError> {
        let token = self.session.liveliness().declare_token(keys::alive(worker)).wait();
        token.map(LivelinessGuard).map_err(|error| ClientError::Messaging(reason(error)))
    }

    fn query<M: Message>(
        &self,
        key: &'static str,
        selector: &str,
        payload: Vec<u8>,
        timeout: Duration,
    ) -> Result<M, ClientError> {
        let query = self.session.get(selector).payload(payload).timeout(timeout);
        let replies = query
            .consolidation(ConsolidationMode::None)
            .wait()
            .map_err(|error| ClientError::Messaging(reason(error)))?;
        let endpoint = self.endpoint.clone();
        // The channel closes with the query, at the latest after its timeout.
        let Ok(reply) = replies.recv() else { return Err(ClientError::Silent(endpoint, key)) };
        match reply.into_result() {
            Ok(sample) => wire::decode(&sample.payload().to_bytes())
                .map_err(|fault| ClientError::Answer(endpoint, fault)),
            Err(error) => {
                let text = String::from_utf8_lossy(&error.payload().to_bytes()).into_owned();
                // Zenoh's text for a query without a reply.
                if text == "Timeout" {
                    return Err(ClientError::Silent(endpoint, key));
                }
                Err(ClientError::Refused(endpoint, text))
            }
        }
    }
}

fn settings(endpoint: &str, config: Option<&Path>, opening: Duration) -> Result<Config, ClientError> {
    let wrong = |reason: String| ClientError::Endpoint(endpoint.to_owned(), reason);
    let mut settings = sessions::configuration(config).map_err(|error| {
        ClientError::Configuration(config.map(Path::to_owned).unwrap_or_default(), reason(error))
    })?;
    let opening = opening.as_millis().to_string();
    for (key, value) in SETTINGS.into_iter().chain([("transport/unicast/open_timeout", opening.as_str())]) {
        settings
            .insert_json5(key, value)
            .map_err(|error| ClientError::Messaging(format!("{key}: {}", reason(error))))?;
    }
    if !endpoint.contains('/') || endpoint.contains(['"', '\\']) {
        return Err(wrong("not an endpoint".into()));
    }
    let connect = format!("[\"{endpoint}\"]");
    settings.insert_json5("connect/endpoints", &connect).map_err(|error| wrong(reason(error)))?;
    Ok(settings)
}
