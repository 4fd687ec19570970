//! A client session with a coordinator, for the commands `status` and `doctor`: queries the status and tries what a
//! worker does; and a watch that asks the own coordinator as any new client would: a session that was open before may go on where the
//! messaging library no longer serves new ones: no worker could join any more, and the loss of one would not be noticed.

use super::super::DispatchError;
use common::wire::{self, Claim, Message, Reply, Status, WireError, WorkerId, keys, reason};
use std::path::{Path, PathBuf};
use std::sync::mpsc::{RecvTimeoutError, Sender, channel};
use std::thread;
use std::time::{Duration, Instant};
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
        let session = zenoh::open(settings(endpoint, config, time)?)
            .wait()
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
    let mut settings = match config {
        None => Config::default(),
        Some(file) => Config::from_file(file)
            .map_err(|error| ClientError::Configuration(file.to_owned(), reason(error)))?,
    };
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

/// How often and how long to ask.
#[derive(Debug, Clone, Copy)]
pub struct Watch {
    /// Time between two questions.
    pub every: Duration,
    /// Longest wait for the answer.
    pub patience: Duration,
    /// Number of questions in a row without an answer after which the messaging has failed: a flood of messages passes, a standstill does not.
    pub silences: u32,
}

impl Default for Watch {
    fn default() -> Self {
        Self { every: Duration::from_secs(20), patience: Duration::from_secs(20), silences: 3 }
    }
}

/// The coordinator is watched until this is dropped.
#[derive(Debug)]
pub struct Watched {
    _until_dropped: Sender<()>,
}

/// Asks the coordinator at `endpoint` in a thread, with the Zenoh settings of its own workers, and calls `failed` at most once: when it is
/// silent, also from its start on: the first clients may be the ones that stop the messaging.
///
/// # Errors
/// [`DispatchError::Thread`].
pub fn watch(
    endpoint: String,
    config: Option<PathBuf>,
    watch: Watch,
    failed: impl FnOnce() + Send + 'static,
) -> Result<Watched, DispatchError> {
    let (_until_dropped, dropped) = channel();
    let run = move || {
        let mut silences = 0;
        loop {
            match answers(&endpoint, config.as_deref(), watch.patience) {
                Some(true) => silences = 0,
                Some(false) => silences += 1,
                None => {}
            }
            if silences >= watch.silences {
                return failed();
            }
            if dropped.recv_timeout(watch.every) != Err(RecvTimeoutError::Timeout) {
                return;
            }
        }
    };
    let started = thread::Builder::new().name("coordinator-watch".into()).spawn(run);
    started.map(|_| Watched { _until_dropped }).map_err(DispatchError::Thread)
}

/// Whether the coordinator answers a new client within this time. `None` where it refuses the session: it may have all that it accepts,
/// but a listener that waits for ever for a lock refuses nothing.
fn answers(endpoint: &str, config: Option<&Path>, patience: Duration) -> Option<bool> {
    let begun = Instant::now();
    let session = ClientSession::open_within(endpoint, config, patience);
    let error = match session.and_then(|session| session.status(patience)) {
        Ok(_) => return Some(true),
        Err(error) => error,
    };
    tracing::debug!("the coordinator's own question: {error}");
    let is_silent = match error {
        ClientError::Silent(..) => true,
        ClientError::Unreachable(..) => begun.elapsed() >= patience.mul_f64(0.9),
        _ => false,
    };
    is_silent.then_some(false)
}

#[cfg(test)]
mod tests {
    use super::answers;
    use std::net::TcpListener;
    use std::time::Duration;

    #[test]
    fn issue_a_listener_that_no_longer_reads_was_not_noticed() {
        let listener = TcpListener::bind("127.0.0.1:0").unwrap();
        let endpoint = format!("tcp/{}", listener.local_addr().unwrap());
        // The system completes the connection, and nothing reads from it.
        assert_eq!(answers(&endpoint, None, Duration::from_millis(200)), Some(false));
        let closing = std::thread::spawn(move || drop((listener.accept(), listener.accept())));
        assert_eq!(answers(&endpoint, None, Duration::from_secs(20)), None);
        closing.join().unwrap();
        assert_eq!(answers(&endpoint, None, Duration::from_secs(20)), None, "nothing listens");
    }
}
