//! The thread between transport and scheduler: passes messages to the scheduler as events and executes its actions.

use super::announcements::Announcements;
use super::backpressure::Backpressure;
use super::scheduler::{Action, Event, Scheduler, SchedulerSettings, Token};
use super::status_board::{StatusBoard, Throughput};
use super::transport::{Incoming, IncomingQuery, Outgoing, Transport};
use crate::farm::evaluate::{Finished, Request};
use common::evaluation_shape::EvaluationShape;
use common::failure::SimulationFailure;
use common::locks::locked;
use common::wire::{
    self, Claim, Message, Next, Notice, Outcome, Refused, Reply, Status, WireError, WorkOrder, WorkerId,
};
use std::collections::{BTreeMap, BTreeSet};
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender};
use std::sync::{Arc, Condvar, Mutex, PoisonError};
use std::time::{Duration, Instant};

/// Time after which an idle worker claims again, unless a notice arrives first [ms].
const ASK_AGAIN: u32 = 1000;
/// Interval of the scheduler's tick events.
const TICK: Duration = Duration::from_millis(500);
/// Most messages that are handled before the workers are listed and deadlines checked.
const MOST_TOGETHER: usize = 1000;
/// Workers of other versions that are remembered, so that each is logged once.
const MOST_REFUSED: usize = 1000;

/// Input of the dispatch loop.
pub(super) enum Input {
    /// A message of the transport.
    Transport(Incoming),
    /// A query for the status from this process.
    Status(Sender<Status>),
    /// Requests of the study; outcomes go to the sender.
    Submit(Vec<Request>, Sender<Delivery>),
    /// The outcomes of these evaluations are durable.
    Recorded(Vec<u64>),
    /// The study cancels all open requests.
    Cancel,
    /// The campaign has ended.
    Finish,
    /// End of the loop.
    Close,
}

/// Output of the dispatch loop for the study: an outcome to record, or the number of an evaluation that was given up with the reason.
pub(super) type Delivery = Result<Box<Finished>, (u64, String)>;

/// A connected worker.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ConnectedWorker {
    /// Name of the worker, e.g. `host-4711`.
    pub name: String,
    /// Simulation threads; 0 until its first claim.
    pub slots: u32,
}

/// The connected workers, updated by the dispatch loop.
#[derive(Debug, Default)]
pub struct ConnectedWorkers {
    workers: Mutex<Vec<ConnectedWorker>>,
    changed: Condvar,
}

impl ConnectedWorkers {
    /// Workers connected now.
    pub fn workers(&self) -> Vec<ConnectedWorker> {
        locked(&self.workers).clone()
    }

    /// Waits until `enough` returns true; false after `timeout`.
    pub fn wait_for(&self, timeout: Duration, mut enough: impl FnMut(&[ConnectedWorker]) -> bool) -> bool {
        let waited =
            self.changed.wait_timeout_while(locked(&self.workers), timeout, |workers| !enough(workers));
        !waited.unwrap_or_else(PoisonError::into_inner).1.timed_out()
    }

    fn set<'a>(&self, workers: impl Iterator<Item = (&'a WorkerId, u32)>) {
        *locked(&self.workers) =
            workers.map(|(id, slots)| ConnectedWorker { name: id.name.clone(), slots }).collect();
        self.changed.notify_all();
    }
}

/// State of the dispatch thread.
pub(super) struct DispatchLoop {
    scheduler: Scheduler,
    campaign: u64,
    /// Scene and settings sent with the tasks.
    order: WorkOrder,
    /// Shape of the outcomes; `None`: any.
    shape: Option<EvaluationShape>,
    transport: Transport,
    connected: Arc<ConnectedWorkers>,
    board: StatusBoard,
    throughput: Throughput,
    announcements: Announcements,
    backpressure: Arc<Mutex<Backpressure>>,
    started: Instant,
    unanswered: BTreeMap<Token, IncomingQuery>,
    next_token: Token,
    deliveries: Option<Sender<Delivery>>,
    /// Workers refused for their protocol version: name and version.
    refused: BTreeSet<(String, u16)>,
    /// Claims that could not be decoded.
    malformed: Refused,
    /// Revision of the scheduler's workers last published in `connected`.
    published_revision: u64,
}

impl DispatchLoop {
    pub fn new(
        settings: SchedulerSettings,
        order: WorkOrder,
        shape: Option<EvaluationShape>,
        transport: Transport,
        connected: Arc<ConnectedWorkers>,
        board: StatusBoard,
        backpressure: Arc<Mutex<Backpressure>>,
    ) -> Self {
        Self {
            campaign: settings.campaign,
            scheduler: Scheduler::new(settings),
            order,
            shape,
            transport,
            connected,
            board,
            throughput: Throughput::default(),
            announcements: Announcements::default(),
            backpressure,
            started: Instant::now(),
            unanswered: BTreeMap::new(),
            next_token: 0,
            deliveries: None,
            refused: BTreeSet::new(),
            malformed: Refused::default(),
            published_revision: 0,
        }
    }

    /// Runs until [`Input::Close`].
    pub fn run(mut self, inputs: &Receiver<Input>) {
        let mut next_tick = Instant::now() + TICK;
        'inputs: loop {
            let notice = self.announcements.due().map(|due| self.started + due);
            let wake = notice.map_or(next_tick, |due| next_tick.min(due));
            let mut next = match inputs.recv_timeout(wake.saturating_duration_since(Instant::now())) {
                Err(RecvTimeoutError::Disconnected) => break,
                input => input.ok(),
            };
            // The list of workers is published once for all messages that wait: it is as long as they are many.
            let mut handled = 0;
            while let Some(input) = next {
                if matches!(input, Input::Close) {
                    break 'inputs;
                }
                self.handle(input);
                handled += 1;
                next = if handled < MOST_TOGETHER { inputs.try_recv().ok() } else { None };
            }
            self.publish_workers();
            if Instant::now() >= next_tick {
                next_tick = Instant::now() + TICK;
                self.event(Event::Tick);
            }
            self.announce();
        }
        self.unanswered.clear();
        self.transport.close();
    }

    fn handle(&mut self, input: Input) {
        match input {
            Input::Transport(incoming) => self.handle_incoming(incoming),
            // The receiver may have given up.
            Input::Status(reply_to) => _ = reply_to.send(self.status()),
            Input::Submit(requests, deliveries) => {
                self.deliveries = Some(deliveries);
                self.event(Event::Submit(requests));
            }
            Input::Recorded(tasks) => tasks.into_iter().for_each(|task| self.event(Event::Recorded(task))),
            Input::Cancel => {
                self.deliveries = None;
                self.event(Event::Cancel);
            }
            Input::Finish => self.event(Event::Finish),
            Input::Close => {}
        }
    }

    fn publish_workers(&mut self) {
        if self.published_revision != self.scheduler.revision() {
            self.published_revision = self.scheduler.revision();
            self.connected.set(self.scheduler.workers());
        }
    }

    fn handle_incoming(&mut self, incoming: Incoming) {
        match incoming {
            Incoming::Query(query) => {
                locked(&self.backpressure).release(query.size());
                if query.is_claim() {
                    return self.handle_claim(query);
                }
                let status = self.status();
                self.answer(query, &status);
            }
            Incoming::WorkerJoined(worker) => {
                tracing::info!("worker {} joined", worker.name);
                self.event(Event::WorkerJoined(worker));
            }
            Incoming::WorkerLost(worker) => {
                tracing::info!("worker {} left", worker.name);
                self.event(Event::WorkerLost(worker));
            }
        }
    }

    fn status(&mut self) -> Status {
        let now = self.started.elapsed();
        let farm = self.throughput.count_in(now, self.scheduler.status());
        self.board.status(farm, now)
    }

    fn handle_claim(&mut self, query: IncomingQuery) {
        match wire::decode::<Claim>(&query.frame()) {
            Ok(mut claim) => {
                claim.finished.iter_mut().for_each(|outcome| self.refuse_misfit(outcome));
                let token = self.next_token;
                self.next_token += 1;
                self.unanswered.insert(token, query);
                self.event(Event::Claimed(token, claim));
            }
            Err(WireError::OtherVersion { theirs, ours }) => {
                let name = query.name();
                if self.refused.len() < MOST_REFUSED && self.refused.insert((name.clone(), theirs)) {
                    tracing::warn!(
                        "worker {name} is refused: it uses protocol version {theirs}, this coordinator version {ours}"
                    );
                }
                // The frame of any reply carries our version, which is all the worker can read.
                let reply = Reply { acknowledged: vec![], next: Next::Leave { campaign: self.campaign } };
                self.answer(query, &reply);
            }
            Err(error) => {
                if let Some(count) = self.malformed.count() {
                    tracing::warn!("a claim of worker {} is refused ({count} so far): {error}", query.name());
                }
                self.transport.post(Outgoing::Refusal(query, error.to_string()));
            }
        }
    }

    /// Replaces an outcome of the campaign that does not fit its scene by the statement that its worker cannot be used.
    fn refuse_misfit(&self, outcome: &mut Outcome) {
        let Outcome { task, result, .. } = outcome;
        if let (Some(shape), Ok(evaluation)) = (&self.shape, &*result)
            && task.key.campaign == self.campaign
            && let Some(misfit) = shape.misfit(evaluation)
        {
            let reason =
                format!("its outcome of evaluation {} does not fit the scene: {misfit}", task.key.task);
            *result = Err(SimulationFailure::SimulatorUnusable { reason });
        }
    }

    fn event(&mut self, event: Event) {
        for action in self.scheduler.on_event(self.started.elapsed(), event) {
            self.execute(action);
        }
    }

    fn execute(&mut self, action: Action) {
        match action {
            Action::Deliver(finished) => {
                self.throughput.count(self.started.elapsed(), &finished.worker);
                self.deliver(Ok(finished));
            }
            Action::GiveUp(task, reason) => self.deliver(Err((task, reason))),
            Action::Reply(token, acknowledged, tasks) => {
                let Some(query) = self.unanswered.remove(&token) else { return };
                let next = match tasks {
                    None => Next::Leave { campaign: self.campaign },
                    Some(tasks) if tasks.is_empty() => Next::Idle { ask_again: ASK_AGAIN },
                    Some(tasks) => Next::Work(WorkOrder { tasks, ..self.order.clone() }),
                };
                self.answer(query, &Reply { acknowledged, next });
            }
            Action::Announce(points) => self.announcements.add(points),
            Action::AnnounceEnd => self.publish(&Notice::Ended { campaign: self.campaign }),
            Action::Warn(warning) => tracing::warn!("{warning}"),
        }
    }

    fn deliver(&self, delivery: Delivery) {
        // A study that has ended has cancelled, or will: its outcomes stay with the workers.
        if let Some(deliveries) = &self.deliveries {
            let _ = deliveries.send(delivery);
        }
    }

    fn answer(&self, query: IncomingQuery, reply: &impl Message) {
        match wire::encode(reply) {
            Ok(frame) => self.transport.post(Outgoing::Answer(query, frame)),
            Err(error) => {
                tracing::error!("a reply cannot be encoded: {error}");
                self.transport.post(Outgoing::Refusal(query, error.to_string()));
            }
        }
    }

    /// Announces waiting points if that is due.
    fn announce(&mut self) {
        if self.announcements.due().is_none() {
            return;
        }
        let workers = self.scheduler.workers().count();
        if let Some(points) = self.announcements.take_due(self.started.elapsed(), workers) {
            self.publish(&Notice::Batch { campaign: self.campaign, points });
        }
    }

    fn publish(&self, notice: &Notice) {
        match wire::encode(notice) {
            Ok(frame) => self.transport.post(Outgoing::Notice(frame)),
            Err(error) => tracing::error!("a notice cannot be encoded: {error}"),
        }
    }
}
