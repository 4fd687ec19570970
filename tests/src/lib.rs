//! Shared parts of the integration tests: simulators made of closures, in-process coordinators and workers, waits with a
//! time limit.

pub mod beam_study;
pub mod command_line;
pub mod deployed;
pub mod faults;
pub mod journaled;
pub mod mutated_frames;
pub mod practice_study;
pub mod process;
pub mod router;
pub mod simulated_farm;

use common::accuracy::{Accuracy, Tier};
use common::external::{OpenedSimulator, SimulatorError};
use common::failure::SimulationFailure;
use common::outputs::{Diagnostics, Evaluation};
use common::scene::Scene;
use coordinator::farm::dispatch::{CampaignSpec, ConnectedWorker, Listen, ZenohEvaluator};
use coordinator::farm::evaluate::external::on_slots;
use coordinator::farm::evaluate::{EvaluateError, Evaluator, Finished, Request};
use std::collections::BTreeMap;
use std::io::Write;
use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::channel;
use std::sync::{Arc, Condvar, Mutex};
use std::time::Duration;
use worker::service::{self, Job, ServiceConfig, Simulator, WorkerHandle};
use zenoh::{Config, Session};

/// Time limit of every wait; only a defect takes longer.
pub const PATIENCE: Duration = Duration::from_secs(30);

/// Outcomes by number of the evaluation.
pub type Outcomes = BTreeMap<u64, Result<Evaluation, SimulationFailure>>;

/// Opens the simulator of a scene, which gives whole lives, on `slots` slots of this process.
///
/// # Errors
/// [`SimulatorError`].
pub fn open_simulator(scene: &Scene, slots: usize) -> Result<Box<dyn Evaluator>, SimulatorError> {
    let simulator = scene.simulator.as_ref().expect("the scene names its simulator");
    let opened = OpenedSimulator::open(simulator, scene)?;
    on_slots((0..slots).map(|number| opened.slot(number)).collect(), Arc::default())
}

/// A simulator from a closure on the sample.
pub struct ClosureSimulator<F>(pub F);

impl<F> Simulator for ClosureSimulator<F>
where
    F: Fn(&[f64]) -> Result<Evaluation, SimulationFailure> + Send + Sync,
{
    fn simulate(&self, job: &Job) -> Result<Evaluation, SimulationFailure> {
        self.0(job.sample())
    }
}

/// A result that depends on every bit of the sample; every seventh sample fails.
///
/// # Errors
/// For samples whose first value is 3 modulo 7.
pub fn practice_result(sample: &[f64]) -> Result<Evaluation, SimulationFailure> {
    let x = sample[0];
    if x as u64 % 7 == 3 {
        return Err(SimulationFailure::WearStep { cycle: 64_000, joint: "1".into(), error: x.sqrt() });
    }
    Ok(Evaluation {
        cycles: vec![1000, 2000],
        histories: vec![vec![x.sin(), (2.0 * x).sin()], vec![x.exp_m1().ln_1p(), x.sqrt()]],
        errors: vec![vec![0.0; 2]; 2],
        joints: vec![],
        first_cycle: None,
        worn: None,
        start: vec![],
        diagnostics: Diagnostics { steps: x as u64, ..Diagnostics::default() },
    })
}

/// Requests `ids`, each with a different sample.
pub fn requests(ids: std::ops::Range<u64>) -> Vec<Request> {
    ids.map(|id| Request {
        id,
        sample: vec![id as f64, 0.1 * id as f64],
        with_first_cycle: false,
        accuracy: None,
        level: 0,
        not_by: vec![],
    })
    .collect()
}

/// The campaign of the tests; their simulators ignore its scene and settings.
pub fn campaign() -> CampaignSpec {
    let accuracy = Accuracy {
        step_tolerance: 1e-4,
        largest_step: 0.01,
        steps_bound: 100_000,
        wear_samples: 200,
        cycle_jump: 1000,
        wear_tolerance: 0.01,
        warm_up: 0.5,
        tier: Tier::Dynamic,
        points: 1,
        wear_error: true,
    };
    CampaignSpec {
        id: 17,
        scene: "name = \"practice\"".into(),
        accuracy,
        accuracy_name: "draft".into(),
        build: Some(worker::BUILD),
        shape: None,
        simulator: None,
        cross_check: None,
        resumed: false,
    }
}

/// A coordinator on a free loopback port.
pub fn coordinator() -> ZenohEvaluator {
    coordinator_at(None, Arc::default())
}

/// A coordinator at an endpoint.
pub fn coordinator_at(endpoint: Option<&str>, interrupted: Arc<AtomicBool>) -> ZenohEvaluator {
    let listen = Listen { endpoint: endpoint.map(Into::into), config: None, insecure: false };
    ZenohEvaluator::open(campaign(), &listen, interrupted).expect("a loopback port can be listened on")
}

/// An in-process worker for the coordinator at `endpoint`.
pub fn worker_at<F>(endpoint: &str, name: &str, slots: usize, simulate: F) -> WorkerHandle
where
    F: Fn(&[f64]) -> Result<Evaluation, SimulationFailure> + Send + Sync + 'static,
{
    let config = ServiceConfig { name: name.into(), ..ServiceConfig::new(endpoint, slots) };
    service::spawn(config, Arc::new(ClosureSimulator(simulate)))
        .expect("a session to a loopback endpoint opens")
}

/// An in-process worker that is connected to `coordinator`.
pub fn worker<F>(coordinator: &ZenohEvaluator, name: &str, slots: usize, simulate: F) -> WorkerHandle
where
    F: Fn(&[f64]) -> Result<Evaluation, SimulationFailure> + Send + Sync + 'static,
{
    let handle = worker_at(&coordinator.endpoints[0], name, slots, simulate);
    wait_until_connected(coordinator, name);
    handle
}

/// Waits until the worker `name` is connected: one that comes only when the campaign has ended is not told so and looks for the next.
pub fn wait_until_connected(coordinator: &ZenohEvaluator, name: &str) {
    let is_here = |workers: &[ConnectedWorker]| workers.iter().any(|worker| worker.name == name);
    assert!(coordinator.connected.wait_for(PATIENCE, is_here), "{name} connects");
}

/// Evaluates a batch and returns its outcomes; panics if an evaluation is recorded twice.
///
/// # Errors
/// Errors of the evaluator.
pub fn evaluate(coordinator: &mut ZenohEvaluator, batch: &[Request]) -> Result<Outcomes, EvaluateError> {
    let mut outcomes = Outcomes::new();
    coordinator.evaluate(batch, &mut |Finished { id, outcome, .. }| {
        assert!(outcomes.insert(id, outcome).is_none(), "evaluation {id} was recorded twice");
        Ok(())
    })?;
    Ok(outcomes)
}

/// The expected outcomes of [`practice_result`].
pub fn expected(ids: std::ops::Range<u64>) -> Outcomes {
    requests(ids).into_iter().map(|request| (request.id, practice_result(&request.sample))).collect()
}

/// Runs `work` on a separate thread and fails the test if it takes longer than [`PATIENCE`].
pub fn in_time<T: Send + 'static>(work: impl FnOnce() -> T + Send + 'static) -> T {
    within(PATIENCE, work)
}

/// Runs `work` on a separate thread and fails the test if it takes longer than `limit`.
pub fn within<T: Send + 'static>(limit: Duration, work: impl FnOnce() -> T + Send + 'static) -> T {
    let (done, result) = channel();
    let thread = std::thread::spawn(move || done.send(work()));
    match result.recv_timeout(limit) {
        Ok(result) => result,
        Err(_) if thread.is_finished() => panic!("the work under test panicked, see above"),
        Err(_) => panic!("not done after {limit:?}"),
    }
}

/// Blocks simulations until it is opened.
#[derive(Debug, Default)]
pub struct Barrier {
    open: Mutex<bool>,
    changed: Condvar,
}

impl Barrier {
    /// Opens the barrier for good.
    pub fn open(&self) {
        *self.open.lock().expect("no holder panics") = true;
        self.changed.notify_all();
    }

    /// Waits until the barrier is open, at most [`PATIENCE`].
    pub fn pass(&self) {
        let guard = self.open.lock().expect("no holder panics");
        let (_open, timeout) =
            self.changed.wait_timeout_while(guard, PATIENCE, |open| !*open).expect("no holder panics");
        assert!(!timeout.timed_out(), "the barrier was not opened");
    }
}

/// A Zenoh session that is neither coordinator nor worker: `key` is `connect/endpoints` or `listen/endpoints`.
pub fn foreign_session(key: &str, endpoint: &str) -> Session {
    let mut config = Config::default();
    for (key, value) in [
        ("mode", if key == "connect/endpoints" { "\"client\"" } else { "\"peer\"" }),
        ("scouting/multicast/enabled", "false"),
        ("scouting/gossip/enabled", "false"),
        ("scouting/delay", "0"),
        ("listen/endpoints", "[]"),
        (key, &format!("[\"{endpoint}\"]")),
    ] {
        config.insert_json5(key, value).expect("a setting of Zenoh");
    }
    sessions::open(config).expect("a session on the loopback")
}

/// Sets the interruption flag of a coordinator.
pub fn stop(interrupted: &AtomicBool) {
    interrupted.store(true, Ordering::Relaxed);
}

/// A program of this workspace, built next to the test. `cargo test --workspace` builds all of them.
pub fn program(name: &str) -> PathBuf {
    let test = std::env::current_exe().expect("the path of the test program is known");
    let folder = test.ancestors().nth(2).expect("tests lie in target/<profile>/deps");
    let program = folder.join(name);
    assert!(program.exists(), "{} is missing: run `cargo test --workspace`", program.display());
    program
}

/// Reports that a check was skipped. It writes to standard error directly: the test harness captures the output of passing
/// tests.
pub fn skipped(what: &str, reason: &str) {
    // Without standard error there is no reader.
    let _ = writeln!(std::io::stderr(), "not checked: {what}: {reason}");
}
