//! Evaluations by a program of this machine: one process per slot, which keeps running between requests.
//!
//! A request is one line on its standard input, `{"id": 7, "sample": {"width": 0.02, ...}, "cycles": [1, ...]}`. A reply
//! is one line on its standard output: `{"id": 7, "outputs": {"deflection": [0.003]}}`, with numerical errors of the
//! same shape under `errors` if the program estimates any, or `{"id": 7, "failure": "..."}`. A process that exceeds the
//! time limit is killed and replaced; a process that exits is replaced and gets the request once more.

use super::process::{LineError, Process};
use super::reply::{Expected, parse, shown};
use super::simulator_error::SimulatorError;
use super::slots::{Slot, StopSignal};
use super::{EvaluateError, EvaluationResult, Request};
use common::failure::SimulationFailure;
use common::random::Distribution;
use common::scene::{Program, Scene};
use serde::Serialize;
use serde_json::{Map, Value};
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

/// Attempts at a sample at which the program exits.
const ATTEMPTS: usize = 2;

/// Command, time limit and expected shape, shared by all slots.
#[derive(Debug)]
pub struct Setup {
    command: Vec<String>,
    folder: PathBuf,
    /// Time limit of one evaluation as stated in the scene [s].
    seconds: f64,
    timeout: Duration,
    expected: Expected,
    /// Means of the inputs `(d,)`.
    nominal: Vec<f64>,
    /// Whether any process has replied; before the first reply, an exit says nothing about the sample.
    answered: AtomicBool,
}

impl Setup {
    /// Setup of `program` for `scene`; `timeout` bounds one evaluation [s].
    pub fn new(program: &Program, timeout: f64, scene: &Scene) -> Self {
        Self {
            command: program.command.clone(),
            folder: PathBuf::from(&program.folder),
            seconds: timeout,
            timeout: Duration::try_from_secs_f64(timeout).unwrap_or(Duration::MAX),
            expected: Expected::from_scene(scene),
            nominal: scene.variables.iter().map(|v| Distribution::mean(&v.distribution)).collect(),
            answered: AtomicBool::new(false),
        }
    }

    fn name(&self) -> String {
        self.command.join(" ")
    }

    fn line(&self, id: u64, sample: &[f64]) -> String {
        #[derive(Serialize)]
        struct Line<'a> {
            id: u64,
            sample: Map<String, Value>,
            cycles: &'a [u32],
        }
        let values = self.expected.inputs.iter().cloned().zip(sample.iter().map(|value| Value::from(*value)));
        let line = Line { id, sample: values.collect(), cycles: &self.expected.cycles };
        let text = serde_json::to_string(&line).expect("a map of numbers by name is JSON");
        text + "\n"
    }

    /// Result of a reply line, or what is wrong with the line.
    fn outcome(&self, id: u64, line: &str) -> Result<EvaluationResult, String> {
        let reply = parse(line).map_err(|error| format!("\"{}\" is no JSON: {error}", shown(line)))?;
        let Value::Object(reply) = reply else {
            return Err(format!("\"{}\" is no object {{\"id\": ..., \"outputs\": ...}}", shown(line)));
        };
        if reply.get("id").and_then(Value::as_u64) != Some(id) {
            let found = reply.get("id").map_or("none".to_owned(), Value::to_string);
            return Err(format!("its id is {found}, expected {id}"));
        }
        if let Some(failure) = reply.get("failure") {
            let message = failure.as_str().map_or_else(|| failure.to_string(), str::to_owned);
            return Ok(Err(SimulationFailure::Reported { message }));
        }
        let by_name = |key: &str| match reply.get(key) {
            None => Ok(None),
            Some(Value::Object(values)) => Ok(Some(values)),
            Some(other) => {
                Err(format!("\"{key}\" is {}, expected values by name", shown(&other.to_string())))
            }
        };
        let outputs = by_name("outputs")?.ok_or("it has neither \"outputs\" nor \"failure\"")?;
        self.expected.evaluation(outputs, by_name("errors")?, by_name("start")?)
    }
}

/// A slot with at most one running process.
#[derive(Debug)]
pub struct ProgramSlot {
    setup: Arc<Setup>,
    number: usize,
    process: Option<Process>,
}

/// How a process responded to one request.
enum Reply {
    Line(String),
    Crashed { status: String, stderr: String },
    TimedOut,
}

impl ProgramSlot {
    /// Slot `number`; the program is started by [`ProgramSlot::start`] or by the first request.
    pub fn new(setup: Arc<Setup>, number: usize) -> Self {
        Self { setup, number, process: None }
    }

    /// Starts the program if it is not running.
    ///
    /// # Errors
    /// [`SimulatorError::Start`].
    pub fn start(&mut self) -> Result<(), SimulatorError> {
        if self.process.is_none() {
            let Setup { command, folder, .. } = &*self.setup;
            let failed = |reason| SimulatorError::Start {
                program: self.setup.name(),
                folder: folder.display().to_string(),
                reason,
            };
            self.process = Some(Process::start(command, folder).map_err(failed)?);
        }
        Ok(())
    }

    /// Sends a sample and waits for the reply line; starts the program if it is not running.
    fn attempt(&mut self, id: u64, sample: &[f64], stop: &StopSignal) -> Result<Reply, EvaluateError> {
        self.start()?;
        let line = self.setup.line(id, sample);
        let process = self.process.as_mut().expect("the program was started above");
        let none = match process.ask(line, self.setup.timeout, stop) {
            Ok(line) => return Ok(Reply::Line(line)),
            Err(none) => none,
        };
        if let Some(process) = self.process.take() {
            process.kill();
        }
        match none {
            LineError::TimedOut => Ok(Reply::TimedOut),
            LineError::Ended { status, stderr } => Ok(Reply::Crashed { status, stderr }),
            LineError::Stopped => Err(EvaluateError::Interrupted),
        }
    }

    /// Distinguishes a broken program from a bad sample: if no process has ever replied, the program is run at the means of the
    /// inputs. If it exits there too, the program is at fault.
    ///
    /// # Errors
    /// [`SimulatorError::Dead`].
    fn check_program(&mut self, request: &Request, stop: &StopSignal) -> Result<(), EvaluateError> {
        if self.setup.answered.load(Ordering::Relaxed) {
            return Ok(());
        }
        let nominal = self.setup.nominal.clone();
        match self.attempt(request.id, &nominal, stop)? {
            Reply::Crashed { status, stderr } => {
                Err(SimulatorError::Dead { program: self.setup.name(), status, stderr }.into())
            }
            Reply::Line(line) => self.accept(request.id, &line).map(drop),
            Reply::TimedOut => Ok(()),
        }
    }

    /// Parses a reply line; kills the process if the line breaks the protocol.
    fn accept(&mut self, id: u64, line: &str) -> Result<EvaluationResult, EvaluateError> {
        match self.setup.outcome(id, line) {
            Ok(outcome) => {
                self.setup.answered.store(true, Ordering::Relaxed);
                Ok(outcome)
            }
            Err(fault) => {
                // Further output would be read as the next reply.
                if let Some(process) = self.process.take() {
                    process.kill();
                }
                Err(SimulatorError::Protocol { simulator: format!("\"{}\"", self.setup.name()), id, fault }
                    .into())
            }
        }
    }
}

impl Slot for ProgramSlot {
    fn evaluate(&mut self, request: &Request, stop: &StopSignal) -> Result<EvaluationResult, EvaluateError> {
        let mut crash = None;
        for _ in 0..ATTEMPTS {
            match self.attempt(request.id, &request.sample, stop)? {
                Reply::Line(line) => return self.accept(request.id, &line),
                Reply::TimedOut => {
                    return Ok(Err(SimulationFailure::TimedOut { seconds: self.setup.seconds }));
                }
                Reply::Crashed { status, stderr } => {
                    tracing::debug!("the simulator ended with {status} at evaluation {}", request.id);
                    crash = Some(SimulationFailure::Crashed { status, stderr });
                }
            }
        }
        self.check_program(request, stop)?;
        Ok(Err(crash.expect("every attempt ended in a crash")))
    }

    fn name(&self) -> String {
        format!("program/{}", self.number)
    }
}
