//! A worker as a whole: its slots, and the claims at each of its coordinators.

use super::claim_event::ClaimEvent;
use super::claim_loop::ClaimLoop;
use super::connection_monitor::ConnectionMonitor;
use super::leave_policy::LeavePolicy;
use super::link::{Link, LinkSettings, settings};
use super::slots::Slots;
use super::{Departure, ServiceConfig, ServiceError, Simulator, new_epoch};
use common::wire::{WorkerId, keys};
use std::sync::Arc;
use std::sync::mpsc::{Receiver, Sender, channel};
use std::thread::JoinHandle;
use std::time::Instant;

/// Asks a worker to stop; may be kept by a signal handler.
#[derive(Debug, Clone)]
pub struct Stopper(Vec<Sender<ClaimEvent>>);

impl Stopper {
    /// Take nothing new, end what can be ended within [`ServiceConfig::drain`], hand in what is finished, leave. What has
    /// not ended is dropped; the coordinator gives it to others.
    pub fn stop(&self) {
        self.tell(|| ClaimEvent::Stop);
    }

    /// Drop everything at once, as if the process had died.
    pub fn abort(&self) {
        self.tell(|| ClaimEvent::Abort);
    }

    fn tell(&self, message: impl Fn() -> ClaimEvent) {
        for claims in &self.0 {
            // A service that has ended needs no stop.
            let _ = claims.send(message());
        }
    }
}

/// A worker that serves in threads of its own.
#[derive(Debug)]
pub struct WorkerHandle {
    stopper: Stopper,
    claims: Vec<JoinHandle<Result<Departure, ServiceError>>>,
}

impl WorkerHandle {
    /// To stop it from elsewhere.
    pub fn stopper(&self) -> Stopper {
        self.stopper.clone()
    }

    /// Whether it has ended.
    pub fn has_ended(&self) -> bool {
        self.claims.iter().all(JoinHandle::is_finished)
    }

    /// Waits for its end: how it left its coordinators. Of several, one that it left before the end of its campaign
    /// counts most.
    ///
    /// # Errors
    /// [`ServiceError`], if it could serve none of its coordinators to the end.
    pub fn join(self) -> Result<Departure, ServiceError> {
        let ends = self.claims.into_iter().map(|claims| claims.join().unwrap_or(Err(ServiceError::Panicked)));
        let (left, failed): (Vec<_>, Vec<_>) = ends.partition(Result::is_ok);
        let mut left = left.into_iter().flatten();
        match (left.next(), failed.into_iter().find_map(Result::err)) {
            (Some(first), _) => Ok(left.fold(first, both)),
            (None, Some(error)) => Err(error),
            (None, None) => Ok(Departure::Aborted),
        }
    }
}

/// Two departures of one worker as one.
fn both(a: Departure, b: Departure) -> Departure {
    match (a, b) {
        (Departure::CampaignEnded, other) | (other, Departure::CampaignEnded) => other,
        (Departure::Stopped { lost }, Departure::Stopped { lost: more }) => {
            Departure::Stopped { lost: lost + more }
        }
        (Departure::TimeUp { lost }, Departure::TimeUp { lost: more }) => {
            Departure::TimeUp { lost: lost + more }
        }
        (a, _) => a,
    }
}

/// Starts a worker in its own threads.
///
/// # Errors
/// [`ServiceError::Settings`] and [`ServiceError::Messaging`], before anything is started; all else by
/// [`WorkerHandle::join`].
pub fn spawn(config: ServiceConfig, simulator: Arc<dyn Simulator>) -> Result<WorkerHandle, ServiceError> {
    for (missing, setting) in [(config.slots == 0, "slots"), (config.connect.is_empty(), "endpoints")] {
        if missing {
            return Err(ServiceError::Settings {
                setting: setting.into(),
                reason: "at least 1 is needed".into(),
            });
        }
    }
    let worker = WorkerId { name: keys::worker_name(&config.name), epoch: new_epoch() };
    let (inboxes, received): (Vec<_>, Vec<_>) = config.connect.iter().map(|_| channel()).unzip();
    let links: Vec<LinkSettings> =
        config.connect.iter().map(|endpoint| settings(&config, endpoint)).collect::<Result<_, _>>()?;
    let slots = Slots::start(config.slots, config.give_way, &worker.name, simulator, &inboxes)
        .map_err(|e| ServiceError::Messaging(format!("cannot start a thread: {e}")))?;
    let slots = Arc::new(slots);
    let started = Instant::now();
    let mut claims = Vec::new();
    for (place, (received, link)) in received.into_iter().zip(links).enumerate() {
        let (config, worker, slots) = (config.clone(), worker.clone(), Arc::clone(&slots));
        let seat =
            CoordinatorThread { config, worker, place, slots, link, inbox: inboxes[place].clone(), started };
        let thread = std::thread::Builder::new()
            .name(format!("worker-claims-{place}"))
            .spawn(move || seat.serve(&received))
            .map_err(|e| ServiceError::Messaging(format!("cannot start a thread: {e}")))?;
        claims.push(thread);
    }
    Ok(WorkerHandle { stopper: Stopper(inboxes), claims })
}

/// A worker at one of its coordinators.
struct CoordinatorThread {
    config: ServiceConfig,
    worker: WorkerId,
    place: usize,
    slots: Arc<Slots>,
    link: LinkSettings,
    inbox: Sender<ClaimEvent>,
    started: Instant,
}

impl CoordinatorThread {
    fn serve(self, received: &Receiver<ClaimEvent>) -> Result<Departure, ServiceError> {
        let others = self.config.connect.len() > 1;
        let ended = self.serve_alone(received);
        if let Err(error) = &ended
            && others
        {
            // The worker stays for them, so nobody else says it.
            tracing::warn!("{error}");
        }
        ended
    }

    fn serve_alone(self, received: &Receiver<ClaimEvent>) -> Result<Departure, ServiceError> {
        let CoordinatorThread { config, worker, place, slots, link, inbox, started } = self;
        let mut monitor = ConnectionMonitor::new(&config.connect[place], config.give_up_after);
        let leave_policy = LeavePolicy::new(&config, started);
        let over = |now: Instant| leave_policy.over_before_work(now, slots.shares().idle_for(now));
        match Link::connect(&link, &config, &worker, &inbox, received, &mut monitor, over)? {
            Ok(link) => {
                ClaimLoop::new(config, worker, place, link, slots, monitor, leave_policy).run(received)
            }
            Err(departure) => Ok(departure),
        }
    }
}

/// Serves until the end, in this thread's sight.
///
/// # Errors
/// [`ServiceError`].
pub fn run(config: ServiceConfig, simulator: Arc<dyn Simulator>) -> Result<Departure, ServiceError> {
    spawn(config, simulator)?.join()
}
