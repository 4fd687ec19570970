//! [`Evaluator`] whose evaluations are done by workers over Zenoh.

use super::DispatchError;
use super::board::Board;
use super::desk::{Attendance, ConnectedWorker, Delivery, Desk, Input};
use super::gate::Gate;
use super::scheduler::Settings;
use super::transport::{Listen, Transport};
use crate::farm::evaluate::{Beginnings, EvaluateError, Evaluator, LOOK_UP, Pursuit};
use common::accuracy::Accuracy;
use common::wire::{self, Message, Next, Reply, Status, WorkOrder};
use std::collections::BTreeSet;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{RecvTimeoutError, Sender, channel};
use std::thread::JoinHandle;
use std::time::Duration;

/// How long workers may take to leave at the end of a campaign.
const FAREWELL: Duration = Duration::from_secs(2);
/// Outcomes that are recorded together at most.
const MOST_TOGETHER: usize = 256;
/// How long the tasks of a resumed campaign wait for workers of the coordinator before, which try to reach it again about
/// twice a second.
const SETTLE: Duration = Duration::from_secs(1);
/// Largest scene text [bytes]: it travels with every reply that carries tasks.
const MAX_SCENE: usize = 4 << 20;

/// What the workers of a campaign are told.
#[derive(Debug, Clone, PartialEq)]
pub struct Campaign {
    /// Number of the campaign: the same after a restart that resumes it, different for anything else (a digest
    /// of scene, accuracy and seed does). A worker that finished an evaluation while the coordinator was away
    /// hands it in under this number.
    pub id: u64,
    /// Source text of the scene, TOML.
    pub scene: String,
    /// Numerical settings.
    pub accuracy: Accuracy,
    /// Their name, for people.
    pub accuracy_name: String,
    /// Whether it goes on from an earlier coordinator, whose workers may come back with what they are running: tasks wait
    /// a second for them, where they can find the new one.
    pub resumed: bool,
}

/// Listens for workers from its opening until it is dropped or finished; batch after batch.
#[derive(Debug)]
pub struct ZenohEvaluator {
    inputs: Sender<Input>,
    desk: Option<JoinHandle<()>>,
    attendance: Arc<Attendance>,
    board: Board,
    endpoints: Vec<String>,
    interrupted: Arc<AtomicBool>,
}

impl ZenohEvaluator {
    /// Starts to listen. When `interrupted` becomes true, a batch under way ends with
    /// [`EvaluateError::Interrupted`] within a tenth of a second.
    ///
    /// # Errors
    /// [`DispatchError`].
    pub fn open(
        campaign: Campaign,
        listen: &Listen,
        interrupted: Arc<AtomicBool>,
    ) -> Result<Self, DispatchError> {
        let known_address = listen.endpoint.is_some() || listen.config.is_some();
        let settle = if campaign.resumed && known_address { SETTLE } else { Duration::ZERO };
        let settings = Settings { settle, ..Settings::new(campaign.id) };
        let Campaign { scene, accuracy, accuracy_name, .. } = campaign;
        if scene.len() > MAX_SCENE {
            return Err(DispatchError::SceneTooLarge { bytes: scene.len(), limit: MAX_SCENE });
        }
        let order = WorkOrder { scene, accuracy, accuracy_name, tasks: vec![] };
        Reply { acknowledged: vec![], next: Next::Work(order.clone()) }.check()?;

        let (inputs, received) = channel();
        let gate = Arc::new(Gate::default());
        let (claims, questions, liveness) = (inputs.clone(), inputs.clone(), inputs.clone());
        let (entrance, other_entrance) = (Arc::clone(&gate), Arc::clone(&gate));
        // The desk lives as long as the session, so what cannot be passed on comes after its end.
        let transport = Transport::open(
            listen,
            move |asker| {
                if entrance.enter(asker.size()) {
                    let _ = claims.send(Input::Claim(asker));
                }
            },
            move |asker| {
                if other_entrance.enter(asker.size()) {
                    let _ = questions.send(Input::Asked(asker));
                }
            },
            move |worker, there| {
                let _ = liveness.send(Input::Liveness(worker, there));
            },
        )?;
        let endpoints = transport.endpoints().to_vec();
        let attendance = Arc::new(Attendance::default());
        let board = Board::default();
        let desk = Desk::new(settings, order, transport, Arc::clone(&attendance), board.clone(), gate);
        let desk = std::thread::Builder::new()
            .name("coordinator-desk".into())
            .spawn(move || desk.run(&received))
            .map_err(|error| DispatchError::Messaging(format!("cannot start a thread: {error}")))?;
        tracing::info!("workers can connect to {}", endpoints.join(", "));
        Ok(Self { inputs, desk: Some(desk), attendance, board, endpoints, interrupted })
    }

    /// Where workers can connect, e.g. `tcp/127.0.0.1:37021`.
    pub fn endpoints(&self) -> &[String] {
        &self.endpoints
    }

    /// Where the study posts how far it is.
    pub fn board(&self) -> Board {
        self.board.clone()
    }

    /// To look at the farm from elsewhere in this process.
    pub fn look(&self) -> Look {
        Look(self.inputs.clone())
    }

    /// Who is connected, to be looked at from elsewhere.
    pub fn attendance(&self) -> Arc<Attendance> {
        Arc::clone(&self.attendance)
    }

    /// Workers that are connected now.
    pub fn workers(&self) -> Vec<ConnectedWorker> {
        self.attendance.workers()
    }

    /// Simulations that can run at once now: the slots of all workers.
    pub fn concurrency(&self) -> u32 {
        self.workers().iter().map(|worker| worker.slots).sum()
    }

    /// Waits until `enough` is true of the connected workers; false if it did not become so in time.
    pub fn wait_for_workers(
        &self,
        timeout: Duration,
        enough: impl FnMut(&[ConnectedWorker]) -> bool,
    ) -> bool {
        self.attendance.wait_for(timeout, enough)
    }

    /// Ends the campaign: tells the workers to leave and stops listening. Dropped without it, the coordinator
    /// just goes away, and its workers wait for its return.
    pub fn finish(self) {
        if self.inputs.send(Input::Finish).is_ok() && !self.wait_for_workers(FAREWELL, <[_]>::is_empty) {
            tracing::debug!("{} workers have not left yet", self.workers().len());
        }
    }

    fn send(&self, input: Input) -> Result<(), EvaluateError> {
        self.inputs.send(input).map_err(|_| desk_ended())
    }

    /// Begins what comes and takes outcomes until there is no more of either.
    fn collect(&self, pursuit: &mut dyn Pursuit) -> Result<(), EvaluateError> {
        let (sender, deliveries) = channel();
        let (mut beginnings, mut open) = (Beginnings::default(), BTreeSet::new());
        let mut given_up = None;
        loop {
            let requests = beginnings.take(pursuit)?;
            if !requests.is_empty() {
                open.extend(requests.iter().map(|request| request.id));
                self.send(Input::Submit(requests, sender.clone()))?;
            }
            if open.is_empty() && beginnings.ended() {
                return given_up.map_or(Ok(()), Err);
            }
            let stopping = self.interrupted.load(Ordering::Relaxed);
            // What has arrived when the user stops is recorded still.
            let next = if stopping {
                deliveries.try_recv().map_err(|_| EvaluateError::Interrupted)
            } else {
                match deliveries.recv_timeout(LOOK_UP) {
                    Ok(delivery) => Ok(delivery),
                    Err(RecvTimeoutError::Timeout)
                        if self.desk.as_ref().is_some_and(|d| !d.is_finished()) =>
                    {
                        continue;
                    }
                    Err(_) => Err(desk_ended()),
                }
            };
            // What has arrived by now is made durable together: the disk takes as long for many as for one.
            let mut arrived = Vec::new();
            for delivery in std::iter::once(next?).chain(deliveries.try_iter()).take(MOST_TOGETHER) {
                match delivery {
                    Delivery::Outcome(finished) => arrived.push(*finished),
                    Delivery::GivenUp { task, reason } => {
                        open.remove(&task);
                        given_up.get_or_insert(EvaluateError::GivenUp { id: task, reason });
                        // What would come of it can no longer be told: nothing more is begun.
                        beginnings.end();
                    }
                }
            }
            if !arrived.is_empty() {
                let ids: Vec<u64> = arrived.iter().map(|finished| finished.id).collect();
                pursuit.record_all(arrived)?;
                for id in &ids {
                    open.remove(id);
                }
                self.send(Input::Recorded(ids))?;
            }
        }
    }
}

/// Looks at a farm; costs nothing while nobody does.
#[derive(Debug, Clone)]
pub struct Look(Sender<Input>);

impl Look {
    /// The status now; `None` if the farm has ended or does not answer in time.
    pub fn status(&self, timeout: Duration) -> Option<Status> {
        let (whom, told) = channel();
        self.0.send(Input::Look(whom)).ok()?;
        told.recv_timeout(timeout).ok()
    }
}

impl Evaluator for ZenohEvaluator {
    /// A task that ended several workers is given up; what is under way goes on, and its end is the error.
    fn pursue(&mut self, pursuit: &mut dyn Pursuit) -> Result<(), EvaluateError> {
        let done = self.collect(pursuit);
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
        if let Some(desk) = self.desk.take()
            && desk.join().is_err()
        {
            tracing::error!("the dispatch thread panicked");
        }
    }
}

fn desk_ended() -> EvaluateError {
    EvaluateError::Transport("the dispatch thread has ended".into())
}

/// Most that a message may hold, so that the limit of a scene can never be the larger one.
const _: () = assert!(MAX_SCENE < wire::MAX_PAYLOAD / 2);
