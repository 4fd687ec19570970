//! The worker's connection: the only place of the worker that knows Zenoh.

use super::claims::Inbox;
use super::{ServiceConfig, ServiceError};
use common::wire::{WorkerId, keys};
use std::sync::mpsc::{Sender, channel};
use std::time::Duration;
use zenoh::liveliness::LivelinessToken;
use zenoh::pubsub::Subscriber;
use zenoh::query::ConsolidationMode;
use zenoh::{Config, Session, Wait};

/// What the worker needs, as Zenoh settings. A hang of the worker is seen within its lease; reconnection is
/// tried for ever and by the second, so that a restarted coordinator has its workers back at once (measured:
/// 0.45 s against 4 s with Zenoh's own settings).
const SETTINGS: [(&str, &str); 9] = [
    ("mode", "\"client\""),
    ("listen/endpoints", "[]"),
    ("scouting/multicast/enabled", "false"),
    ("scouting/gossip/enabled", "false"),
    ("scouting/delay", "0"),
    ("transport/link/tx/lease", "2000"),
    ("connect/timeout_ms", "-1"),
    ("connect/exit_on_failure", "false"),
    ("connect/retry", "{period_init_ms: 200, period_max_ms: 1000, period_increase_factor: 1.5}"),
];

/// A dead line may never let go.
const CLOSE_TIMEOUT: Duration = Duration::from_secs(2);

/// See the module.
pub(super) struct Link {
    session: Session,
    _token: LivelinessToken,
    _notices: Subscriber<()>,
    selector: String,
    answer_timeout: Duration,
    inbox: Sender<Inbox>,
}

impl Link {
    /// Opens the session; the connection itself comes about when the coordinator can be reached.
    pub fn open(
        service: &ServiceConfig,
        worker: &WorkerId,
        inbox: &Sender<Inbox>,
    ) -> Result<Self, ServiceError> {
        let session = zenoh::open(settings(service)?).wait().map_err(messaging)?;
        // Callbacks only feed the inbox: a callback that waits would hold up Zenoh's receiving threads.
        let to_claims = inbox.clone();
        let notices = session
            .declare_subscriber(keys::NOTICE)
            .callback(move |sample| {
                let _ = to_claims.send(Inbox::Notice(sample.payload().to_bytes().into_owned()));
            })
            .wait()
            .map_err(messaging)?;
        let token = session.liveliness().declare_token(keys::alive(worker)).wait().map_err(messaging)?;
        Ok(Self {
            session,
            _token: token,
            _notices: notices,
            // In plain text, so that a coordinator of any version can say who it refuses.
            selector: format!("{}?worker={}", keys::CLAIM, worker.name),
            answer_timeout: service.answer_timeout,
            inbox: inbox.clone(),
        })
    }

    /// Sends a claim; its answer and its end go to the inbox under `sequence`.
    pub fn ask(&self, sequence: u64, frame: Vec<u8>) -> Result<(), String> {
        let ended = Ended { sequence, inbox: self.inbox.clone() };
        let query = self
            .session
            .get(&self.selector)
            .payload(frame)
            .timeout(self.answer_timeout)
            .consolidation(ConsolidationMode::None)
            .callback(move |reply| {
                let frame = match reply.result() {
                    Ok(sample) => Ok(sample.payload().to_bytes().into_owned()),
                    Err(error) => Err(String::from_utf8_lossy(&error.payload().to_bytes()).into_owned()),
                };
                let _ = ended.inbox.send(Inbox::Answer { sequence: ended.sequence, frame });
            });
        query.wait().map_err(|error| error.to_string())
    }

    /// Closes the session, or leaves it after a while if the line is dead.
    pub fn close(&self) {
        let (done, finished) = channel();
        let session = self.session.clone();
        let closing = std::thread::Builder::new().name("worker-close".into()).spawn(move || {
            let closed = session.close().wait();
            let _ = done.send(closed.is_ok());
        });
        if closing.is_ok() && finished.recv_timeout(CLOSE_TIMEOUT).is_err() {
            tracing::debug!("the session did not close in time");
        }
    }
}

/// Lives as long as the query: Zenoh drops the callback when no more answers can come.
struct Ended {
    sequence: u64,
    inbox: Sender<Inbox>,
}

impl Drop for Ended {
    fn drop(&mut self) {
        let _ = self.inbox.send(Inbox::QueryEnded { sequence: self.sequence });
    }
}

fn settings(service: &ServiceConfig) -> Result<Config, ServiceError> {
    let mut config = match &service.zenoh_config {
        None => Config::default(),
        Some(file) => Config::from_file(file).map_err(|error| ServiceError::Settings {
            setting: format!("Zenoh configuration {}", file.display()),
            reason: error.to_string(),
        })?,
    };
    for (key, value) in SETTINGS {
        config.insert_json5(key, value).map_err(messaging)?;
    }
    let wrong = |reason: String| ServiceError::Settings {
        setting: format!("endpoint {:?}", service.connect),
        reason: format!("{reason}; expected e.g. tcp/192.168.1.20:7447 or tls/host.example:7447"),
    };
    if !service.connect.contains('/') || service.connect.contains(['"', '\\']) {
        return Err(wrong("not an endpoint".into()));
    }
    config
        .insert_json5("connect/endpoints", &format!("[\"{}\"]", service.connect))
        .map_err(|error| wrong(error.to_string()))?;
    Ok(config)
}

fn messaging(error: zenoh::Error) -> ServiceError {
    ServiceError::Messaging(error.to_string())
}
