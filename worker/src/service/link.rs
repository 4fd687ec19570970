//! Zenoh session of a worker with one coordinator: the only module of the worker that uses Zenoh.

use super::connection_monitor::ConnectionMonitor;
use super::{ClaimEvent, Departure, ServiceConfig, ServiceError};
use crate::log::refusal;
use common::panics::ends_within;
use common::wire::{self, WorkerId, keys, reason};
use std::path::Path;
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, channel};
use std::time::{Duration, Instant};
use zenoh::liveliness::LivelinessToken;
use zenoh::pubsub::Subscriber;
use zenoh::query::ConsolidationMode;
use zenoh::{Config, Session, Wait};

/// Zenoh settings the worker requires. The lease bounds the time in which a hang of the worker is detected. Reconnection
/// is tried about twice a second without limit, so that a restarted coordinator has its workers back at once (4 s with
/// Zenoh's default).
const ZENOH_SETTINGS: [(&str, &str); 9] = [
    ("mode", "\"client\""),
    ("listen/endpoints", "[]"),
    ("scouting/multicast/enabled", "false"),
    ("scouting/gossip/enabled", "false"),
    ("scouting/delay", "0"),
    ("transport/link/tx/lease", "2000"),
    ("transport/link/rx/max_message_size", wire::MAX_MESSAGE),
    ("connect/exit_on_failure", "false"),
    ("connect/retry", "{period_init_ms: 200, period_max_ms: 400, period_increase_factor: 1.5}"),
];

/// Zenoh setting that limits an attempt to open the session [ms]; without it the reason why none succeeds would stay unknown.
const ATTEMPT_LIMIT: &str = "connect/timeout_ms";
/// Limit of the first attempt. It doubles with each further one, so that thousands of workers that connect at the same time do not
/// give up handshakes that a busy coordinator has begun.
const FIRST_ATTEMPT: Duration = Duration::from_secs(1);
/// Longest limit of an attempt: where the coordinator's queue of connections overflows, TCP tries again after 1, 3, 7 and 15 s, a new attempt
/// at once.
const LONGEST_ATTEMPT: Duration = Duration::from_secs(4);

/// Pause between attempts to open the session.
const RETRY: Duration = Duration::from_millis(200);
/// Interval at which a worker looks for a reason to leave during an attempt.
const POLL: Duration = Duration::from_millis(50);

/// Time limit for closing the session: closing may block on a broken connection.
const CLOSE_TIMEOUT: Duration = Duration::from_secs(2);

/// An open session with its declarations; they end when it is dropped.
pub(super) struct Link {
    session: Session,
    _token: LivelinessToken,
    _notices: Subscriber<()>,
    selector: String,
    answer_timeout: Duration,
    inbox: Sender<ClaimEvent>,
}

impl Link {
    /// Opens the session as soon as the coordinator can be reached. `Ok(Err(_))` if the worker is stopped before that, or
    /// `departure` returns a reason to leave.
    ///
    /// # Errors
    /// [`ServiceError::Unreachable`] once `monitor` gives up.
    pub(crate) fn connect(
        settings: &Config,
        service: &ServiceConfig,
        worker: &WorkerId,
        inbox: &Sender<ClaimEvent>,
        received: &Receiver<ClaimEvent>,
        monitor: &mut ConnectionMonitor,
        departure: impl Fn(Instant) -> Option<Departure>,
    ) -> Result<Result<Self, Departure>, ServiceError> {
        let mut limit = FIRST_ATTEMPT;
        loop {
            let started = Instant::now();
            let opening = open(settings.clone(), limit)?;
            loop {
                match opening.recv_timeout(POLL) {
                    Ok(Ok(session)) => return Self::declare(session, service, worker, inbox).map(Ok),
                    Ok(Err(error)) => {
                        monitor.on_failure(started, refusal::explain(&error, started));
                        break;
                    }
                    Err(RecvTimeoutError::Timeout) => {
                        monitor.on_silence(started, refusal::last_failure(started))
                    }
                    Err(RecvTimeoutError::Disconnected) => {
                        return Err(ServiceError::Messaging(
                            "the thread that opens the session has ended".into(),
                        ));
                    }
                }
                if let Some(departure) = must_leave(received, Duration::ZERO, monitor, &departure)? {
                    return Ok(Err(departure));
                }
            }
            if let Some(departure) = must_leave(received, RETRY, monitor, &departure)? {
                return Ok(Err(departure));
            }
            limit = LONGEST_ATTEMPT.min(2 * limit);
        }
    }

    fn declare(
        session: Session,
        service: &ServiceConfig,
        worker: &WorkerId,
        inbox: &Sender<ClaimEvent>,
    ) -> Result<Self, ServiceError> {
        // Callbacks only feed the inbox: a callback that waits would block Zenoh's receiving threads.
        let to_claims = inbox.clone();
        let notices = session
            .declare_subscriber(keys::NOTICE)
            .callback(move |sample| {
                let _ = to_claims.send(ClaimEvent::Notice(sample.payload().to_bytes().into_owned()));
            })
            .wait()
            .map_err(messaging)?;
        let token = session.liveliness().declare_token(keys::alive(worker)).wait().map_err(messaging)?;
        Ok(Self {
            session,
            _token: token,
            _notices: notices,
            // In plain text, so that a coordinator of any version can name the worker it refuses.
            selector: format!("{}?worker={}", keys::CLAIM, worker.name),
            answer_timeout: service.answer_timeout,
            inbox: inbox.clone(),
        })
    }

    /// Sends a claim; its reply and the end of the query arrive in the inbox as events with `sequence`.
    ///
    /// # Errors
    /// Error text of Zenoh.
    pub(crate) fn send_claim(&self, sequence: u64, frame: Vec<u8>) -> Result<(), String> {
        let end = QueryEnd { sequence, inbox: self.inbox.clone() };
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
                let _ = end.inbox.send(ClaimEvent::Answer { sequence: end.sequence, frame });
            });
        query.wait().map_err(reason)
    }

    /// Closes the session; gives up after [`CLOSE_TIMEOUT`].
    pub(crate) fn close(&self) {
        let session = self.session.clone();
        if !ends_within(CLOSE_TIMEOUT, "worker-close", move || sessions::close(&session)) {
            tracing::debug!("the session did not close in time");
        }
    }
}

/// Reports the end of a query when dropped: Zenoh drops the callback when no further reply can arrive.
struct QueryEnd {
    sequence: u64,
    inbox: Sender<ClaimEvent>,
}

impl Drop for QueryEnd {
    fn drop(&mut self) {
        let _ = self.inbox.send(ClaimEvent::QueryEnded(self.sequence));
    }
}

/// Begins to open a session; the receiver gets it, or Zenoh's error text after `limit` at the latest. Opening blocks its thread, and
/// nothing ends it before: a session that is no longer received is closed.
///
/// # Errors
/// [`ServiceError::Messaging`], [`ServiceError::Thread`].
fn open(mut config: Config, limit: Duration) -> Result<Receiver<Result<Session, String>>, ServiceError> {
    config.insert_json5(ATTEMPT_LIMIT, &limit.as_millis().to_string()).map_err(messaging)?;
    let (opened, opening) = channel();
    let open = move || {
        let _ = opened.send(sessions::open(config).map_err(reason));
    };
    std::thread::Builder::new().name("worker-open".into()).spawn(open).map_err(ServiceError::Thread)?;
    Ok(opening)
}

/// Why the worker leaves before it has a session, if it does; waits up to `pause` for a request to stop.
///
/// # Errors
/// [`ServiceError::Unreachable`].
fn must_leave(
    received: &Receiver<ClaimEvent>,
    pause: Duration,
    monitor: &mut ConnectionMonitor,
    departure: impl Fn(Instant) -> Option<Departure>,
) -> Result<Option<Departure>, ServiceError> {
    let now = Instant::now();
    monitor.check(now)?;
    if let Some(left) = departure(now) {
        return Ok(Some(left));
    }
    Ok(match received.recv_timeout(pause) {
        Ok(ClaimEvent::Stop) => Some(Departure::Stopped { lost: 0 }),
        Ok(ClaimEvent::Abort) | Err(RecvTimeoutError::Disconnected) => Some(Departure::Aborted),
        Ok(_) | Err(RecvTimeoutError::Timeout) => None,
    })
}

/// Builds the Zenoh configuration for the coordinator at `endpoint`.
///
/// # Errors
/// [`ServiceError::Settings`], [`ServiceError::Messaging`].
pub(super) fn link_settings(service: &ServiceConfig, endpoint: &str) -> Result<Config, ServiceError> {
    let file = service.zenoh_config.as_deref();
    let mut config = sessions::configuration(file).map_err(|error| ServiceError::Settings {
        setting: format!("Zenoh configuration {}", file.unwrap_or(Path::new("")).display()),
        reason: reason(error),
    })?;
    for (key, value) in ZENOH_SETTINGS {
        config.insert_json5(key, value).map_err(messaging)?;
    }
    let wrong = |reason: String| ServiceError::Settings {
        setting: format!("endpoint {endpoint:?}"),
        reason: format!("{reason}; expected e.g. tcp/192.168.1.20:7447 or tls/host.example:7447"),
    };
    if !endpoint.contains('/') || endpoint.contains(['"', '\\']) {
        return Err(wrong("not an endpoint".into()));
    }
    config
        .insert_json5("connect/endpoints", &format!("[\"{endpoint}\"]"))
        .map_err(|error| wrong(reason(error)))?;
    Ok(config)
}

fn messaging(error: zenoh::Error) -> ServiceError {
    ServiceError::Messaging(reason(error))
}
