//! Evaluator that dispatches requests to workers over Zenoh.

use super::backpressure::Backpressure;
use super::dispatch_loop::{ConnectedWorker, ConnectedWorkers, DispatchLoop, Input};
use super::scheduler::{CrossCheck, LICENCE_HOLD, SchedulerSettings};
use super::status_board::StatusBoard;
use super::transport::{Incoming, Listen, Transport};
use super::{DispatchError, MAX_SCENE};
use crate::farm::evaluate::{EvaluateError, Evaluator, POLL_INTERVAL, RequestSource, next_requests};
use common::accuracy::Accuracy;
use common::build::Build;
use common::evaluation_shape::EvaluationShape;
use common::external::{SimulatorId, SlotError};
use common::locks::locked;
use common::wire::{self, Message, Next, Reply, Status, Subject, WorkOrder};
use std::collections::BTreeSet;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{RecvTimeoutError, Sender, channel};
use std::sync::{Arc, Mutex};
use std::thread::JoinHandle;
use std::time::Duration;

/// Time for workers to leave at the end of a campaign; it begins again while some leave, since thousands take longer.
const FAREWELL: Duration = Duration::from_secs(2);
/// Most outcomes recorded together.
const MOST_TOGETHER: usize = 256;
/// Time that the tasks of a resumed campaign wait for workers of the previous coordinator, which reconnect about twice
/// a second.
const SETTLE: Duration = Duration::from_secs(1);
/// Times that a worker may run a program for one evaluation.
const TRIES: u32 = 3;

/// What workers need to know of a campaign.
#[derive(Debug, Clone, PartialEq)]
pub struct CampaignSpec {
    /// Number of the campaign: the same after a restart that resumes it, different otherwise (e.g. a digest of scene,
    /// accuracy and seed). A worker that finishes an evaluation while the coordinator is down returns it under this
    /// number.
    pub id: u64,
    /// Source text of the scene, TOML.
    pub scene: String,
    /// Numerical settings of the evaluations.
    pub accuracy: Accuracy,
    /// Name of the numerical settings, for display.
    pub accuracy_name: String,
    /// The build of the program whose simulations the study uses; workers of another build get no tasks. `None`: all builds are
    /// admitted, and that of each result is recorded with its worker.
    pub build: Option<Build>,
    /// Which results another worker has to repeat; `None`: none.
    pub cross_check: Option<CrossCheck>,
    /// The shape of its outcomes: workers whose outcomes have another one get no more tasks. `None`: any.
    pub shape: Option<EvaluationShape>,
    /// The external simulator of the scene, if it names one. Workers then get its identity instead of the scene.
    pub simulator: Option<CampaignSimulator>,
    /// Whether an earlier coordinator began the campaign. Its workers may reconnect with running tasks, so new leases wait
    /// one second for them if the endpoint is a fixed one, and twelve with licences.
    pub resumed: bool,
}

/// An external simulator that workers have themselves.
#[derive(Debug, Clone, PartialEq)]
pub struct CampaignSimulator {
    /// What coordinator and workers agree by.
    pub id: SimulatorId,
    /// Longest time of one evaluation [s].
    pub timeout: f64,
    /// Most evaluations at once on all workers together.
    pub licences: Option<u32>,
}

/// Evaluator that listens for workers from [`ZenohEvaluator::open`] until it is finished or dropped.
#[derive(Debug)]
pub struct ZenohEvaluator {
    inputs: Sender<Input>,
    dispatch_thread: Option<JoinHandle<()>>,
    /// The connected workers, shared with the dispatch loop.
    pub connected: Arc<ConnectedWorkers>,
    /// The board to which the study posts its progress.
    pub board: StatusBoard,
    /// Endpoints to which workers can connect, e.g. `tcp/127.0.0.1:37021`.
    pub endpoints: Vec<String>,
    licences: Option<u32>,
    interrupted: Arc<AtomicBool>,
}

impl ZenohEvaluator {
    /// Starts to listen. When `interrupted` becomes true, a run ends with [`EvaluateError::Interrupted`] within a tenth of
    /// a second.
    ///
    /// # Errors
    /// [`DispatchError`].
    pub fn open(
        campaign: CampaignSpec,
        listen: &Listen,
        interrupted: Arc<AtomicBool>,
    ) -> Result<Self, DispatchError> {
        let fixed_endpoint = listen.endpoint.is_some() || listen.config.is_some();
        let licences = campaign.simulator.as_ref().and_then(|simulator| simulator.licences);
        let settle = match (campaign.resumed, licences) {
            // Evaluations of the earlier coordinator may still run, also where its workers do not find this one.
            (true, Some(_)) => LICENCE_HOLD,
            (true, None) if fixed_endpoint => SETTLE,
            _ => Duration::ZERO,
        };
        let CampaignSpec { id, scene, accuracy, accuracy_name, build, cross_check, shape, simulator, .. } =
            campaign;
        let settings = SchedulerSettings { settle, build, cross_check, ..settings(id, simulator.as_ref()) };
        if scene.len() > MAX_SCENE {
            return Err(DispatchError::SceneTooLarge(scene.len()));
        }
        let subject =
            simulator.map_or_else(|| Subject::Scene(scene), |simulator| Subject::Simulator(simulator.id));
        let order =
            WorkOrder { subject, accuracy, accuracy_name, licensed: licences.is_some(), tasks: vec![] };
        Reply { acknowledged: vec![], next: Next::Work(order.clone()) }.check()?;

        let (inputs, received) = channel();
        let backpressure = Arc::new(Mutex::new(Backpressure::default()));
        let (to_loop, bounds) = (inputs.clone(), Arc::clone(&backpressure));
        let transport = Transport::open(listen, move |incoming| {
            let is_admitted =
                !matches!(&incoming, Incoming::Query(query) if !locked(&bounds).try_admit(query.size()));
            if is_admitted {
                // The dispatch loop runs as long as the session, so a send fails only after its end.
                let _ = to_loop.send(Input::Transport(incoming));
            }
        })?;
        let endpoints = transport.endpoints.clone();
        let connected = Arc::new(ConnectedWorkers::default());
        let board = StatusBoard::default();
        let dispatch_loop = DispatchLoop::new(
            settings,
            order,
            shape,
            transport,
            Arc::clone(&connected),
            board.clone(),
            backpressure,
        );
        let dispatch_thread = std::thread::Builder::new()
            .name("coordinator-dispatch".into())
            .spawn(move || dispatch_loop.run(&received))
            .map_err(DispatchError::Thread)?;
        tracing::info!("workers can connect to {}", endpoints.join(", "));
        let dispatch_thread = Some(dispatch_thread);
        Ok(Self { inputs, dispatch_thread, connected, board, endpoints, licences, interrupted })
    }

    /// A handle for status queries from this process.
    pub fn status_handle(&self) -> StatusHandle {
        StatusHandle(self.inputs.clone())
    }

    /// Workers connected now.
    pub fn workers(&self) -> Vec<ConnectedWorker> {
        self.connected.workers()
    }

    /// Ends the campaign: notifies the workers, waits until they have left or none has left for 2 s, and stops listening. An
    /// evaluator that is only dropped stops listening without notice, and its workers keep trying to reconnect.
    pub fn finish(self) {
        if self.inputs.send(Input::Finish).is_err() {
            return;
        }
        let mut connected = self.workers().len();
        while !self.connected.wait_for(FAREWELL, <[_]>::is_empty) {
            let left = self.workers().len();
            if left >= connected {
                tracing::debug!("{left} workers are still connected");
                break;
            }
            connected = left;
        }
    }

    fn send(&self, input: Input) -> Result<(), EvaluateError> {
        self.inputs.send(input).map_err(|_| loop_ended())
    }

    /// Submits requests and records outcomes until the source is exhausted and no request is open.
    fn collect(&self, source: &mut dyn RequestSource) -> Result<(), EvaluateError> {
        let (sender, deliveries) = channel();
        let (mut exhausted, mut open) = (false, BTreeSet::new());
        let mut given_up = None;
        loop {
            let requests = next_requests(source, &mut exhausted)?;
            if !requests.is_empty() {
                open.extend(requests.iter().map(|request| request.id));
                self.send(Input::Submit(requests, sender.clone()))?;
            }
            if open.is_empty() && exhausted {
                return given_up.map_or(Ok(()), Err);
            }
            let stopping = self.interrupted.load(Ordering::Relaxed);
            // Outcomes that have arrived before the stop are still recorded.
            let is_running = || self.dispatch_thread.as_ref().is_some_and(|thread| !thread.is_finished());
            let next = if stopping {
                deliveries.try_recv().map_err(|_| EvaluateError::Interrupted)
            } else {
                match deliveries.recv_timeout(POLL_INTERVAL) {
                    Err(RecvTimeoutError::Timeout) if is_running() => continue,
                    received => received.map_err(|_| loop_ended()),
                }
            };
            // All outcomes received so far are recorded together: one disk flush serves them all.
            let mut arrived = Vec::new();
            for delivery in std::iter::once(next?).chain(deliveries.try_iter()).take(MOST_TOGETHER) {
                match delivery {
                    Ok(finished) => arrived.push(*finished),
                    Err((task, reason)) => {
                        open.remove(&task);
                        given_up.get_or_insert(EvaluateError::GivenUp(task, reason));
                        // The run ends with this error, so no further request is started.
                        exhausted = true;
                    }
                }
            }
            if !arrived.is_empty() {
                let ids: Vec<u64> = arrived.iter().map(|finished| finished.id).collect();
                source.record_all(arrived)?;
                ids.iter().for_each(|id| _ = open.remove(id));
                self.send(Input::Recorded(ids))?;
            }
        }
    }
}

/// Handle for status queries from this process. It costs the study nothing between queries.
#[derive(Debug, Clone)]
pub struct StatusHandle(Sender<Input>);

impl StatusHandle {
    /// The current status; `None` if the dispatch loop has ended or does not reply within `timeout`.
    pub fn status(&self, timeout: Duration) -> Option<Status> {
        let (reply_to, reply) = channel();
        self.0.send(Input::Status(reply_to)).ok()?;
        reply.recv_timeout(timeout).ok()
    }
}

impl Evaluator for ZenohEvaluator {
    /// The slots of all connected workers, at most the number of licences.
    fn concurrency(&self) -> u32 {
        let slots = self.workers().iter().map(|worker| worker.slots).sum();
        self.licences.map_or(slots, |licences| licences.min(slots))
    }

    /// If a task is given up, the tasks already running are finished, and the run ends with the error.
    fn run(&mut self, source: &mut dyn RequestSource) -> Result<(), EvaluateError> {
        let done = self.collect(source);
        if done.is_err() {
            // Outcomes not recorded stay with their workers, unacknowledged.
            self.send(Input::Cancel)?;
        }
        done
    }
}

impl Drop for ZenohEvaluator {
    fn drop(&mut self) {
        let _ = self.inputs.send(Input::Close);
        if let Some(dispatch_thread) = self.dispatch_thread.take()
            && dispatch_thread.join().is_err()
        {
            tracing::error!("the dispatch thread panicked");
        }
    }
}

/// Settings of the scheduler for a campaign. The time limit of an external simulator is kept by its workers, which try a
/// program up to three times, so the deadlines of the scheduler come after that.
fn settings(campaign: u64, simulator: Option<&CampaignSimulator>) -> SchedulerSettings {
    let usual = SchedulerSettings::new(campaign);
    let Some(simulator) = simulator else { return usual };
    let timeout = Duration::try_from_secs_f64(simulator.timeout).unwrap_or(Duration::MAX);
    let longest = timeout.saturating_mul(TRIES).saturating_add(usual.shortest_deadline);
    SchedulerSettings {
        subject: Subject::Simulator(simulator.id.clone()),
        licences: simulator.licences,
        first_deadline: usual.first_deadline.max(longest),
        shortest_deadline: longest,
        ..usual
    }
}

fn loop_ended() -> EvaluateError {
    EvaluateError::Slot(SlotError::ThreadEnded("the dispatch thread"))
}

/// A scene within its limit always fits a message.
const _: () = assert!(MAX_SCENE < wire::MAX_PAYLOAD / 2);
