//! The coordinator's connection: the only place of the coordinator that knows Zenoh.
//!
//! Callbacks only pass on what they get: one that waits would hold up Zenoh's receiving threads. Whatever may
//! wait for a slow line (replies, notices) is sent by a thread of its own.

mod settings;
mod visitor;

pub use settings::Listen;
pub use visitor::{Life, VisitError, Visitor};

use super::DispatchError;
use common::wire::{WorkerId, keys, reason};
use std::sync::mpsc::{Receiver, Sender, channel};
use std::time::Duration;
use zenoh::liveliness::LivelinessToken;
use zenoh::pubsub::Subscriber;
use zenoh::query::{Query, Queryable};
use zenoh::sample::SampleKind;
use zenoh::{Session, Wait};

/// A dead line may never let go.
const CLOSE_TIMEOUT: Duration = Duration::from_secs(2);

/// A claim that waits for its answer. Dropped without one, the worker hears at once that there is none.
pub(super) struct Asker(Query);

impl Asker {
    /// What the claim says.
    pub fn frame(&self) -> Vec<u8> {
        self.0.payload().map(|payload| payload.to_bytes().into_owned()).unwrap_or_default()
    }

    /// Length of the claim [bytes].
    pub fn size(&self) -> usize {
        self.0.payload().map_or(0, |payload| payload.len())
    }

    /// The worker's name, in plain text, whatever its version.
    pub fn name(&self) -> String {
        let name = self.0.parameters().get("worker").unwrap_or_default();
        if keys::is_worker_name(name) { name.to_owned() } else { "without a name".to_owned() }
    }
}

/// What is to be sent.
enum Parcel {
    Answer(Asker, Vec<u8>),
    Refusal(Asker, String),
    Status(Asker, Vec<u8>),
    Notice(Vec<u8>),
}

/// See the module.
pub(super) struct Transport {
    session: Session,
    endpoints: Vec<String>,
    parcels: Sender<Parcel>,
    _claims: Queryable<()>,
    _looks: Queryable<()>,
    _liveness: Subscriber<()>,
    _token: LivelinessToken,
}

impl Transport {
    /// Listens; `on_claim`, `on_look` (somebody asks for the status) and `on_liveness` (true: there) must not wait.
    pub fn open(
        listen: &Listen,
        on_claim: impl Fn(Asker) + Send + Sync + 'static,
        on_look: impl Fn(Asker) + Send + Sync + 'static,
        on_liveness: impl Fn(WorkerId, bool) + Send + Sync + 'static,
    ) -> Result<Self, DispatchError> {
        let settings = settings::settings(listen)?;
        let session = zenoh::open(settings.config).wait().map_err(|error| DispatchError::Endpoint {
            endpoint: settings.endpoints.join(", "),
            reason: reason(error),
        })?;
        let liveness = session
            .liveliness()
            .declare_subscriber(keys::ALIVE_ALL)
            .history(true)
            .callback(move |sample| {
                if let Some(worker) = keys::worker_of(sample.key_expr().as_str()) {
                    on_liveness(worker, sample.kind() == SampleKind::Put);
                }
            })
            .wait()
            .map_err(messaging)?;
        let claims = session
            .declare_queryable(keys::CLAIM)
            .complete(true)
            .callback(move |query| on_claim(Asker(query)))
            .wait()
            .map_err(messaging)?;
        let looks = session
            .declare_queryable(keys::STATUS)
            .complete(true)
            .callback(move |query| on_look(Asker(query)))
            .wait()
            .map_err(messaging)?;
        // Seen by tools that list what is there.
        let token = session.liveliness().declare_token(keys::COORDINATOR).wait().map_err(messaging)?;
        let endpoints: Vec<String> =
            session.info().locators().wait().iter().map(ToString::to_string).collect();
        let (parcels, to_send) = channel();
        let sender = session.clone();
        std::thread::Builder::new()
            .name("coordinator-send".into())
            .spawn(move || send(&sender, &to_send))
            .map_err(|error| DispatchError::Messaging(format!("cannot start a thread: {error}")))?;
        Ok(Self {
            session,
            endpoints,
            parcels,
            _claims: claims,
            _looks: looks,
            _liveness: liveness,
            _token: token,
        })
    }

    /// Where workers can connect; with port 0 asked for, the port given.
    pub fn endpoints(&self) -> &[String] {
        &self.endpoints
    }

    /// Answers a claim.
    pub fn answer(&self, asker: Asker, frame: Vec<u8>) {
        self.post(Parcel::Answer(asker, frame));
    }

    /// Answers a claim that cannot be understood.
    pub fn refuse(&self, asker: Asker, reason: String) {
        self.post(Parcel::Refusal(asker, reason));
    }

    /// Answers whoever asked for the status.
    pub fn tell_status(&self, asker: Asker, frame: Vec<u8>) {
        self.post(Parcel::Status(asker, frame));
    }

    /// Tells all workers.
    pub fn publish(&self, frame: Vec<u8>) {
        self.post(Parcel::Notice(frame));
    }

    fn post(&self, parcel: Parcel) {
        // The sending thread ends only when this value is gone.
        let _ = self.parcels.send(parcel);
    }

    /// Closes the session, or leaves it after a while if a line is dead.
    pub fn close(self) {
        let Self { session, parcels, .. } = self;
        drop(parcels);
        let (done, finished) = channel();
        let closing = std::thread::Builder::new().name("coordinator-close".into()).spawn(move || {
            let closed = session.close().wait();
            let _ = done.send(closed.is_ok());
        });
        if closing.is_ok() && finished.recv_timeout(CLOSE_TIMEOUT).is_err() {
            tracing::debug!("the session did not close in time");
        }
    }
}

fn send(session: &Session, parcels: &Receiver<Parcel>) {
    while let Ok(parcel) = parcels.recv() {
        let sent = match parcel {
            Parcel::Answer(Asker(query), frame) => query.reply(keys::CLAIM, frame).wait(),
            Parcel::Refusal(Asker(query), reason) => query.reply_err(reason).wait(),
            Parcel::Status(Asker(query), frame) => query.reply(keys::STATUS, frame).wait(),
            // A hint only: workers ask again by themselves, so a congested line may lose it.
            Parcel::Notice(frame) => session.put(keys::NOTICE, frame).wait(),
        };
        if let Err(error) = sent {
            tracing::debug!("a message could not be sent: {error}");
        }
    }
}

fn messaging(error: zenoh::Error) -> DispatchError {
    DispatchError::Messaging(reason(error))
}
