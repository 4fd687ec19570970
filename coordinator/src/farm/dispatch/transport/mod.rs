//! The coordinator's Zenoh session: the only module of the coordinator that uses Zenoh.
//!
//! Callbacks only pass messages on: a callback that waits would block Zenoh's receiving threads. Replies and notices,
//! which may wait for a slow connection, are sent by a separate thread.

mod client_session;
mod settings;
mod watchdog;

pub use client_session::{ClientError, ClientSession, LivelinessGuard};
pub use settings::Listen;
pub use watchdog::{Watch, watch};

use super::DispatchError;
use common::panics::ends_within;
use common::wire::{WorkerId, is_worker_name, keys, reason};
use settings::{messaging, transport_settings};
use std::sync::Arc;
use std::sync::mpsc::{Receiver, Sender, channel};
use std::time::Duration;
use zenoh::liveliness::LivelinessToken;
use zenoh::pubsub::Subscriber;
use zenoh::query::{Query, Queryable};
use zenoh::sample::SampleKind;
use zenoh::{Session, Wait};

/// Time limit for closing the session: closing may block on a broken connection.
const CLOSE_TIMEOUT: Duration = Duration::from_secs(2);

/// A message received by the coordinator.
pub(super) enum Incoming {
    /// A worker's claim, or a query for the status.
    Query(IncomingQuery),
    /// The liveliness token of a worker appeared.
    WorkerJoined(WorkerId),
    /// The liveliness token of a worker disappeared.
    WorkerLost(WorkerId),
}

/// A query on a key that waits for its reply. If it is dropped without one, Zenoh notifies the sender at once.
pub(super) struct IncomingQuery(Query, &'static str);

impl IncomingQuery {
    /// Frame of the query.
    pub fn frame(&self) -> Vec<u8> {
        self.0.payload().map(|payload| payload.to_bytes().into_owned()).unwrap_or_default()
    }

    /// True for a worker's claim.
    pub fn is_claim(&self) -> bool {
        self.1 == keys::CLAIM
    }

    /// Length of the frame [bytes].
    pub fn size(&self) -> usize {
        self.0.payload().map_or(0, |payload| payload.len())
    }

    /// Name of the worker from the selector: plain text, readable for every protocol version.
    pub fn name(&self) -> String {
        let name = self.0.parameters().get("worker").unwrap_or_default();
        if is_worker_name(name) { name.to_owned() } else { "(no name)".to_owned() }
    }
}

/// A message to be sent.
pub(super) enum Outgoing {
    /// The answer to a query.
    Answer(IncomingQuery, Vec<u8>),
    /// An error as the reply to a query that cannot be answered.
    Refusal(IncomingQuery, String),
    /// A notice to all workers.
    Notice(Vec<u8>),
}

/// The session with its declarations; they end when it is dropped.
pub(super) struct Transport {
    session: Session,
    /// Endpoints to which workers can connect, with the port assigned where port 0 was requested.
    pub endpoints: Vec<String>,
    outgoing: Sender<Outgoing>,
    _queries: [Queryable<()>; 2],
    _liveliness: Subscriber<()>,
    _token: LivelinessToken,
}

impl Transport {
    /// Opens the session and passes every message to `on_incoming`, which must not block.
    ///
    /// # Errors
    /// [`DispatchError`].
    pub fn open(
        listen: &Listen,
        on_incoming: impl Fn(Incoming) + Send + Sync + 'static,
    ) -> Result<Self, DispatchError> {
        let on_incoming = Arc::new(on_incoming);
        let (config, endpoints) = transport_settings(listen)?;
        let session = sessions::open(config)
            .map_err(|error| DispatchError::Endpoint(endpoints.join(", "), reason(error)))?;
        let changed = Arc::clone(&on_incoming);
        let liveliness = session
            .liveliness()
            .declare_subscriber(keys::ALIVE_ALL)
            .history(true)
            .callback(move |sample| {
                if let Some(worker) = keys::worker_of(sample.key_expr().as_str()) {
                    changed(match sample.kind() {
                        SampleKind::Put => Incoming::WorkerJoined(worker),
                        SampleKind::Delete => Incoming::WorkerLost(worker),
                    });
                }
            })
            .wait()
            .map_err(messaging)?;
        let queries = |key: &'static str| {
            let on_incoming = Arc::clone(&on_incoming);
            let pass_on = move |query| on_incoming(Incoming::Query(IncomingQuery(query, key)));
            session.declare_queryable(key).complete(true).callback(pass_on).wait().map_err(messaging)
        };
        let queries = [queries(keys::CLAIM)?, queries(keys::STATUS)?];
        // For tools that list liveliness tokens.
        let token = session.liveliness().declare_token(keys::COORDINATOR).wait().map_err(messaging)?;
        let endpoints: Vec<String> =
            session.info().locators().wait().iter().map(ToString::to_string).collect();
        let (outgoing, to_send) = channel();
        let sender = session.clone();
        std::thread::Builder::new()
            .name("coordinator-send".into())
            .spawn(move || send(&sender, &to_send))
            .map_err(DispatchError::Thread)?;
        Ok(Self { session, endpoints, outgoing, _queries: queries, _liveliness: liveliness, _token: token })
    }

    /// Sends a message.
    pub fn post(&self, message: Outgoing) {
        // The sending thread runs until this value is dropped.
        let _ = self.outgoing.send(message);
    }

    /// Closes the session; gives up after [`CLOSE_TIMEOUT`].
    pub fn close(self) {
        let Self { session, outgoing, .. } = self;
        drop(outgoing);
        if !ends_within(CLOSE_TIMEOUT, "coordinator-close", move || sessions::close(&session)) {
            tracing::debug!("the session did not close in time");
        }
    }
}

fn send(session: &Session, outgoing: &Receiver<Outgoing>) {
    while let Ok(message) = outgoing.recv() {
        let sent = match message {
            Outgoing::Answer(IncomingQuery(query, key), frame) => query.reply(key, frame).wait(),
            Outgoing::Refusal(IncomingQuery(query, _), reason) => query.reply_err(reason).wait(),
            // Only a hint: workers claim again after a pause, so a congested connection may drop it.
            Outgoing::Notice(frame) => session.put(keys::NOTICE, frame).wait(),
        };
        if let Err(error) = sent {
            tracing::debug!("a message could not be sent: {error}");
        }
    }
}
