//! The thread between messages and scheduler: feeds events in, does what the commands say.

use super::board::Board;
use super::gate::Gate;
use super::scheduler::{Assignment, Command, Event, Scheduler, Settings, Token, Warning};
use super::tally::Tally;
use super::transport::{Asker, Transport};
use crate::farm::evaluate::{Finished, Request};
use common::wire::{
    self, CandidatePoint, Claim, Next, Notice, Reply, Status, WireError, WorkOrder, WorkerId,
};
use std::collections::{BTreeMap, BTreeSet};
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

/// When an idle worker asks again, unless a notice comes first [ms].
const ASK_AGAIN: u32 = 1000;
/// How often the scheduler looks at the clock.
const TICK: Duration = Duration::from_millis(500);
/// Points in one notice.
const POINTS_PER_NOTICE: usize = 1000;
/// Workers of other versions that are remembered, so that each is named once.
const MOST_REFUSED: usize = 1000;

/// What reaches the desk.
pub(super) enum Input {
    /// A claim.
    Claim(Asker),
    /// Somebody elsewhere asks for the status.
    Asked(Asker),
    /// Somebody in this process does.
    Look(Sender<Status>),
    /// A worker is there (true) or gone.
    Liveness(WorkerId, bool),
    /// The study asks for these; outcomes go to the sender.
    Submit(Vec<Request>, Sender<Delivery>),
    /// Outcomes are durable.
    Recorded(Vec<u64>),
    /// The study does not want the rest.
    Cancel,
    /// The campaign has ended.
    Finish,
    /// The end of the desk.
    Close,
}

/// What the desk has for the study.
#[derive(Debug)]
pub(super) enum Delivery {
    /// An outcome to record.
    Outcome(Box<Finished>),
    /// There will be none.
    GivenUp {
        /// Number of the evaluation.
        task: u64,
        /// Why.
        reason: String,
    },
}

/// A worker that is connected.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ConnectedWorker {
    /// Name.
    pub name: String,
    /// Threads that simulate; 0 until its first claim.
    pub slots: u32,
}

/// Who is connected, as last seen by the desk.
#[derive(Debug, Default)]
pub struct Attendance {
    workers: Mutex<Vec<ConnectedWorker>>,
    changed: Condvar,
}

impl Attendance {
    /// Workers that are connected now.
    pub fn workers(&self) -> Vec<ConnectedWorker> {
        self.seen().clone()
    }

    fn seen(&self) -> MutexGuard<'_, Vec<ConnectedWorker>> {
        self.workers.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Waits until `enough` is true; false if it did not become so in time.
    pub fn wait_for(&self, timeout: Duration, mut enough: impl FnMut(&[ConnectedWorker]) -> bool) -> bool {
        let waited = self.changed.wait_timeout_while(self.seen(), timeout, |workers| !enough(workers));
        !waited.unwrap_or_else(PoisonError::into_inner).1.timed_out()
    }

    fn set<'a>(&self, workers: impl Iterator<Item = (&'a WorkerId, u32)>) {
        *self.seen() = workers.map(|(id, slots)| ConnectedWorker { name: id.name.clone(), slots }).collect();
        self.changed.notify_all();
    }
}

/// See the module.
pub(super) struct Desk {
    scheduler: Scheduler,
    campaign: u64,
    /// Scene and settings that go with the tasks.
    order: WorkOrder,
    transport: Transport,
    attendance: Arc<Attendance>,
    board: Board,
    tally: Tally,
    gate: Arc<Gate>,
    started: Instant,
    waiting: BTreeMap<Token, Asker>,
    next_token: Token,
    deliveries: Option<Sender<Delivery>>,
    refused: BTreeSet<(String, u16)>,
    garbage: u64,
    /// State of the attendance that was passed on.
    attended: u64,
}

impl Desk {
    pub fn new(
        settings: Settings,
        order: WorkOrder,
        transport: Transport,
        attendance: Arc<Attendance>,
        board: Board,
        gate: Arc<Gate>,
    ) -> Self {
        Self {
            campaign: settings.campaign,
            scheduler: Scheduler::new(settings),
            order,
            transport,
            attendance,
            board,
            tally: Tally::default(),
            gate,
            started: Instant::now(),
            waiting: BTreeMap::new(),
            next_token: 0,
            deliveries: None,
            refused: BTreeSet::new(),
            garbage: 0,
            attended: 0,
        }
    }

    /// Works until told to close.
    pub fn run(mut self, inputs: &Receiver<Input>) {
        let mut next_tick = Instant::now() + TICK;
        loop {
            match inputs.recv_timeout(next_tick.saturating_duration_since(Instant::now())) {
                Ok(Input::Close) | Err(RecvTimeoutError::Disconnected) => break,
                Ok(input) => self.take(input),
                Err(RecvTimeoutError::Timeout) => {}
            }
            if Instant::now() >= next_tick {
                next_tick = Instant::now() + TICK;
                self.event(Event::Tick);
            }
        }
        self.waiting.clear();
        self.transport.close();
    }

    fn take(&mut self, input: Input) {
        match input {
            Input::Claim(asker) => {
                self.gate.leave(asker.size());
                self.take_claim(asker);
            }
            Input::Asked(asker) => {
                self.gate.leave(asker.size());
                match wire::encode(&self.status()) {
                    Ok(frame) => self.transport.tell_status(asker, frame),
                    Err(error) => self.transport.refuse(asker, error.to_string()),
                }
            }
            // Whoever has gone meanwhile needs no answer.
            Input::Look(whom) => _ = whom.send(self.status()),
            Input::Liveness(worker, true) => {
                tracing::info!("worker {} is there", worker.name);
                self.event(Event::Appeared(worker));
            }
            Input::Liveness(worker, false) => {
                tracing::info!("worker {} is gone", worker.name);
                self.event(Event::Gone(worker));
            }
            Input::Submit(requests, deliveries) => {
                self.deliveries = Some(deliveries);
                self.event(Event::Submit(requests));
            }
            Input::Recorded(tasks) => {
                tasks.into_iter().for_each(|task| self.event(Event::Recorded { task }));
            }
            Input::Cancel => {
                self.deliveries = None;
                self.event(Event::Cancel);
            }
            Input::Finish => self.event(Event::Finish),
            Input::Close => {}
        }
        // Asked after every message, so it must cost nothing while nothing changes.
        if self.attended != self.scheduler.changes() {
            self.attended = self.scheduler.changes();
            self.attendance.set(self.scheduler.workers());
        }
    }

    fn status(&mut self) -> Status {
        let now = self.started.elapsed();
        let farm = self.tally.status(now, self.scheduler.census());
        self.board.status(farm, now)
    }

    fn take_claim(&mut self, asker: Asker) {
        match wire::decode::<Claim>(&asker.frame()) {
            Ok(claim) => {
                let token = self.next_token;
                self.next_token += 1;
                self.waiting.insert(token, asker);
                self.event(Event::Claimed { token, claim });
            }
            Err(WireError::OtherVersion { theirs, ours }) => {
                let name = asker.name();
                if self.refused.len() < MOST_REFUSED && self.refused.insert((name.clone(), theirs)) {
                    tracing::warn!(
                        "worker {name} is refused: it speaks protocol version {theirs}, this coordinator {ours}"
                    );
                }
                // Whatever stands in it, its frame says our version.
                let reply = Reply { acknowledged: vec![], next: Next::Leave };
                self.answer(asker, &reply);
            }
            Err(error) => {
                self.garbage += 1;
                // Named at the first, second, fourth, ... time: a flood must not fill the log.
                if self.garbage.is_power_of_two() {
                    let (name, count) = (asker.name(), self.garbage);
                    tracing::warn!("a claim of worker {name} is refused ({count} such so far): {error}");
                }
                self.transport.refuse(asker, error.to_string());
            }
        }
    }

    fn event(&mut self, event: Event) {
        for command in self.scheduler.on_event(self.started.elapsed(), event) {
            self.obey(command);
        }
    }

    fn obey(&mut self, command: Command) {
        match command {
            Command::Deliver(finished) => {
                self.tally.count(self.started.elapsed(), &finished.worker);
                self.deliver(Delivery::Outcome(finished));
            }
            Command::GiveUp { task, reason } => self.deliver(Delivery::GivenUp { task, reason }),
            Command::Reply { token, acknowledged, assignment } => {
                let Some(asker) = self.waiting.remove(&token) else { return };
                let next = match assignment {
                    Assignment::Work(tasks) => Next::Work(WorkOrder { tasks, ..self.order.clone() }),
                    Assignment::Idle => Next::Idle { ask_again: ASK_AGAIN },
                    Assignment::Leave => Next::Leave,
                };
                self.answer(asker, &Reply { acknowledged, next });
            }
            Command::Announce(points) => {
                for some in points.chunks(POINTS_PER_NOTICE) {
                    self.announce(some);
                }
            }
            Command::AnnounceEnd => self.publish(&Notice::Ended { campaign: self.campaign }),
            Command::Warn(warning) => warn(&warning),
        }
    }

    fn deliver(&self, delivery: Delivery) {
        // A study that has gone away has cancelled, or will: its outcomes stay with the workers.
        if let Some(deliveries) = &self.deliveries {
            let _ = deliveries.send(delivery);
        }
    }

    fn answer(&self, asker: Asker, reply: &Reply) {
        match wire::encode(reply) {
            Ok(frame) => self.transport.answer(asker, frame),
            Err(error) => {
                tracing::error!("a reply cannot be sent: {error}");
                self.transport.refuse(asker, error.to_string());
            }
        }
    }

    fn announce(&self, points: &[CandidatePoint]) {
        self.publish(&Notice::Batch { campaign: self.campaign, points: points.to_vec() });
    }

    fn publish(&self, notice: &Notice) {
        match wire::encode(notice) {
            Ok(frame) => self.transport.publish(frame),
            Err(error) => tracing::error!("a notice cannot be sent: {error}"),
        }
    }
}

fn warn(warning: &Warning) {
    match warning {
        Warning::NoWorker { open, since } => tracing::warn!(
            "{open} evaluations wait and no worker is connected (for {:.0} s)",
            since.as_secs_f64()
        ),
        Warning::NoLiveliness { worker } => tracing::warn!(
            "worker {} asks for tasks but shows no liveliness token, so it gets none: do the access rules allow \
             hingewise/alive/**?",
            worker.name
        ),
        Warning::WorkerLost { worker, tasks } => {
            tracing::warn!("worker {} was lost; its evaluations {tasks:?} go to others", worker.name);
        }
        Warning::Overdue { worker, task, after } => tracing::warn!(
            "evaluation {task} has been at worker {} for {:.0} s and is given to another one too",
            worker.name,
            after.as_secs_f64()
        ),
        Warning::OtherSample { worker, task } => tracing::warn!(
            "worker {} brought an outcome for evaluation {task} that belongs to another sample; it is not used",
            worker.name
        ),
    }
}
