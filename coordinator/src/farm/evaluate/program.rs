//! Evaluations by a program of this machine: one process per slot, which lives on from request to request.
//!
//! A request is one line on its standard input, `{"id": 7, "sample": {"width": 0.02, ...}, "cycles": [1, ...]}`, a reply
//! one line on its standard output: `{"id": 7, "outputs": {"deflection": [0.003]}}`, with numerical errors of the same
//! shape under `errors` if it knows any, or `{"id": 7, "failure": "..."}`. A process that takes too long is ended and
//! replaced; one that ends by itself is replaced and asked once more.

use super::external::SimulatorError;
use super::process::{NoLine, Process};
use super::reply::{Expected, parse, shown};
use super::slots::{Slot, Stop};
use super::{EvaluateError, Outcome, Request};
use common::failure::SimulationFailure;
use common::random::Distribution;
use common::scene::{Program, Scene};
use serde::Serialize;
use serde_json::{Map, Value};
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

/// How often a sample is tried at whose evaluation the program ends.
const ATTEMPTS: usize = 2;

/// What the slots share.
#[derive(Debug)]
pub struct Setup {
    command: Vec<String>,
    folder: PathBuf,
    /// Seconds, as the scene has them, and as the clock does.
    seconds: f64,
    timeout: Duration,
    expected: Expected,
    /// Means of the inputs `(d,)`.
    nominal: Vec<f64>,
    /// Whether a process has answered yet: before that, an end says nothing about the sample.
    answered: AtomicBool,
}

impl Setup {
    /// For a scene; `timeout` is that of one evaluation [s].
    pub fn new(program: &Program, timeout: f64, scene: &Scene) -> Self {
        Self {
            command: program.command.clone(),
            folder: PathBuf::from(&program.folder),
            seconds: timeout,
            timeout: Duration::try_from_secs_f64(timeout).unwrap_or(Duration::MAX),
            expected: Expected::of(scene),
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

    /// The outcome in a line, or what is wrong with it.
    fn outcome(&self, id: u64, line: &str) -> Result<Outcome, String> {
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
        self.expected.evaluation(outputs, by_name("errors")?)
    }
}

/// One process, or the place of one.
#[derive(Debug)]
pub struct ProgramSlot {
    setup: Arc<Setup>,
    number: usize,
    process: Option<Process>,
}

/// How an attempt at a line went.
enum Attempt {
    Line(String),
    Crashed { status: String, stderr: String },
    TooLate,
}

impl ProgramSlot {
    /// Slot `number`; nothing is started yet.
    pub fn new(setup: Arc<Setup>, number: usize) -> Self {
        Self { setup, number, process: None }
    }

    /// Starts the program if it does not run.
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

    /// Sends a sample and waits for a line, the program being started if need be.
    fn attempt(&mut self, id: u64, sample: &[f64], stop: &Stop) -> Result<Attempt, EvaluateError> {
        self.start()?;
        let line = self.setup.line(id, sample);
        let process = self.process.as_mut().expect("it was started just now");
        let none = match process.ask(line, self.setup.timeout, stop) {
            Ok(line) => return Ok(Attempt::Line(line)),
            Err(none) => none,
        };
        if let Some(process) = self.process.take() {
            process.kill();
        }
        match none {
            NoLine::TooLate => Ok(Attempt::TooLate),
            NoLine::Ended { status, stderr } => Ok(Attempt::Crashed { status, stderr }),
            NoLine::Stopped => Err(EvaluateError::Interrupted),
        }
    }

    /// A program that has ended at a sample although no process has answered anything yet is tried at the means: if it
    /// ends there too, it is the program that is wrong, and not the sample.
    fn check_program(&mut self, request: &Request, stop: &Stop) -> Result<(), EvaluateError> {
        if self.setup.answered.load(Ordering::Relaxed) {
            return Ok(());
        }
        let nominal = self.setup.nominal.clone();
        match self.attempt(request.id, &nominal, stop)? {
            Attempt::Crashed { status, stderr } => {
                Err(SimulatorError::Dead { program: self.setup.name(), status, stderr }.into())
            }
            Attempt::Line(line) => self.taken(request.id, &line).map(drop),
            Attempt::TooLate => Ok(()),
        }
    }

    /// What a line says.
    fn taken(&mut self, id: u64, line: &str) -> Result<Outcome, EvaluateError> {
        match self.setup.outcome(id, line) {
            Ok(outcome) => {
                self.setup.answered.store(true, Ordering::Relaxed);
                Ok(outcome)
            }
            Err(fault) => {
                // Whatever else it has to say would be taken for the next answer.
                if let Some(process) = self.process.take() {
                    process.kill();
                }
                Err(SimulatorError::Protocol { who: format!("\"{}\"", self.setup.name()), id, fault }.into())
            }
        }
    }
}

impl Slot for ProgramSlot {
    fn evaluate(&mut self, request: &Request, stop: &Stop) -> Result<Outcome, EvaluateError> {
        let mut crash = None;
        for _ in 0..ATTEMPTS {
            match self.attempt(request.id, &request.sample, stop)? {
                Attempt::Line(line) => return self.taken(request.id, &line),
                Attempt::TooLate => {
                    return Ok(Err(SimulationFailure::TimedOut { seconds: self.setup.seconds }));
                }
                Attempt::Crashed { status, stderr } => {
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
