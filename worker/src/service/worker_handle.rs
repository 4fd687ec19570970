//! Starts and stops a worker: its slots, and one claim loop for each of its coordinators.

use super::claim_loop::ClaimLoop;
use super::connection_monitor::ConnectionMonitor;
use super::leave_policy::LeavePolicy;
use super::link::{Link, link_settings};
use super::slots::Slots;
use super::{ClaimEvent, Departure, ServiceConfig, ServiceError, Simulator, new_epoch};
use common::wire::{WorkerId, worker_name};
use std::sync::Arc;
use std::sync::mpsc::{Sender, channel};
use std::thread::JoinHandle;
use std::time::Instant;

/// Stops a worker, e.g. from a signal handler.
#[derive(Debug, Clone)]
pub struct Stopper(Vec<Sender<ClaimEvent>>);

impl Stopper {
    /// Stops the worker: it takes no new tasks, lets running tasks continue for [`ServiceConfig::drain`], returns its
    /// finished outcomes and leaves. The coordinator gives unfinished tasks to other workers.
    pub fn stop(&self) {
        // The claim loops may have ended already.
        self.0.iter().for_each(|inbox| _ = inbox.send(ClaimEvent::Stop));
    }

    /// Aborts the worker: it drops tasks and outcomes at once, as after a crash.
    pub fn abort(&self) {
        self.0.iter().for_each(|inbox| _ = inbox.send(ClaimEvent::Abort));
    }
}

/// A running worker, on separate threads.
#[derive(Debug)]
pub struct WorkerHandle {
    /// Stops the worker.
    pub stopper: Stopper,
    claims: Vec<JoinHandle<Result<Departure, ServiceError>>>,
}

impl WorkerHandle {
    /// True if the worker has ended.
    pub fn has_ended(&self) -> bool {
        self.claims.iter().all(JoinHandle::is_finished)
    }

    /// Waits for the end of the worker and returns how it left. With several coordinators, a departure before the end of a
    /// campaign takes precedence.
    ///
    /// # Errors
    /// [`ServiceError`] if the worker failed at all of its coordinators.
    pub fn join(self) -> Result<Departure, ServiceError> {
        let ends = self.claims.into_iter().map(|claims| claims.join().unwrap_or(Err(ServiceError::Panicked)));
        let (left, failed): (Vec<_>, Vec<_>) = ends.partition(Result::is_ok);
        let mut left = left.into_iter().flatten();
        match (left.next(), failed.into_iter().find_map(Result::err)) {
            (Some(first), _) => Ok(left.fold(first, combine)),
            (None, Some(error)) => Err(error),
            (None, None) => Ok(Departure::Aborted),
        }
    }
}

/// Combines the departures from two coordinators.
fn combine(a: Departure, b: Departure) -> Departure {
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

/// Starts a worker on separate threads.
///
/// # Errors
/// [`ServiceError::Settings`], [`ServiceError::Messaging`] and [`ServiceError::Thread`]; errors of the running worker are
/// returned by [`WorkerHandle::join`].
pub fn spawn(config: ServiceConfig, simulator: Arc<dyn Simulator>) -> Result<WorkerHandle, ServiceError> {
    for (missing, setting) in [(config.slots == 0, "slots"), (config.connect.is_empty(), "endpoints")] {
        if missing {
            return Err(ServiceError::Settings {
                setting: setting.into(),
                reason: "at least 1 is needed".into(),
            });
        }
    }
    let worker = WorkerId { name: worker_name(&config.name), epoch: new_epoch() };
    let (inboxes, received): (Vec<_>, Vec<_>) = config.connect.iter().map(|_| channel()).unzip();
    let links = config.connect.iter().map(|endpoint| link_settings(&config, endpoint));
    let links = links.collect::<Result<Vec<_>, _>>()?;
    let slots = Slots::start(&config, &worker.name, simulator, &inboxes).map_err(ServiceError::Thread)?;
    let slots = Arc::new(slots);
    let started = Instant::now();
    let mut claims = Vec::new();
    for (coordinator, (received, link)) in received.into_iter().zip(links).enumerate() {
        let (config, worker, slots) = (config.clone(), worker.clone(), Arc::clone(&slots));
        let inbox = inboxes[coordinator].clone();
        let serve = move || {
            let mut monitor = ConnectionMonitor::new(&config.connect[coordinator], config.give_up_after);
            let leave_policy = LeavePolicy::new(&config, started);
            let departure = |now: Instant| leave_policy.over_before_work(now, slots.shares().idle_for(now));
            match Link::connect(&link, &config, &worker, &inbox, &received, &mut monitor, departure)? {
                Ok(link) => ClaimLoop::new(config, worker, coordinator, link, slots, monitor, leave_policy)
                    .run(&received),
                Err(departure) => Ok(departure),
            }
        };
        let has_others = inboxes.len() > 1;
        let report = move |error: &ServiceError| {
            // The worker continues with the other coordinators, so its caller does not report the error.
            if has_others {
                tracing::warn!("{error}");
            }
        };
        let handle = std::thread::Builder::new()
            .name(format!("worker-claims-{coordinator}"))
            .spawn(move || serve().inspect_err(report))
            .map_err(ServiceError::Thread)?;
        claims.push(handle);
    }
    Ok(WorkerHandle { stopper: Stopper(inboxes), claims })
}

/// Starts a worker and waits for its end.
///
/// # Errors
/// [`ServiceError`].
pub fn run(config: ServiceConfig, simulator: Arc<dyn Simulator>) -> Result<Departure, ServiceError> {
    spawn(config, simulator)?.join()
}
