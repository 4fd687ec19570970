//! Evaluations by a program of this machine: one process per slot, which keeps running between requests.
//!
//! A request is one line on its standard input, `{"id": 7, "sample": {"width": 0.02, ...}, "cycles": [1, ...]}`. A reply
//! is one line on its standard output: `{"id": 7, "outputs": {"deflection": [0.003]}}`, with numerical errors of the
//! same shape under `errors` if the program estimates any, or `{"id": 7, "failure": "..."}`. A process that exceeds the
//! time limit is killed and replaced; a process that exits is replaced and gets the request once more.

use super::process::{LineError, Process, program_path};
use super::reply::{Expected, parse, shown};
use super::simulator_error::SimulatorError;
use super::slots::{Slot, StopSignal};
use super::{EvaluateError, EvaluationResult, Request};
use common::failure::SimulationFailure;
use common::random::Distribution;
use common::scene::{Program, Scene};
use serde::{Serialize, Serializer};
use serde_json::Value;
use std::path::{Path, PathBuf};
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
            sample: SampleByName<'a>,
            cycles: &'a [u32],
        }
        let sample = SampleByName { names: &self.expected.inputs, values: sample };
        let line = Line { id, sample, cycles: &self.expected.cycles };
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

/// Values of the inputs by name, in the order of the scene, which a map would not keep.
struct SampleByName<'a> {
    names: &'a [String],
    values: &'a [f64],
}

impl Serialize for SampleByName<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_map(self.names.iter().zip(self.values))
    }
}

/// Checks that the program of a scene exists and can be executed, without starting it.
///
/// # Errors
/// [`SimulatorError::Start`].
pub fn check_program_file(program: &Program) -> Result<(), SimulatorError> {
    let folder = PathBuf::from(&program.folder);
    let found = executable(&program.command, &folder);
    found.map_err(|reason| start_error(&program.command, &folder, reason))
}

fn start_error(command: &[String], folder: &Path, reason: std::io::Error) -> SimulatorError {
    SimulatorError::Start { program: command.join(" "), folder: folder.display().to_string(), reason }
}

/// Fails like the start of a command in `folder` would if its program is missing or not executable.
fn executable(command: &[String], folder: &Path) -> std::io::Result<()> {
    let named = program_path(command, folder)?;
    if !folder.is_dir() {
        return Err(std::io::ErrorKind::NotADirectory.into());
    }
    if named.components().count() > 1 {
        return is_executable(&named);
    }
    let path = std::env::var_os("PATH").unwrap_or_default();
    let mut reason = std::io::Error::from(std::io::ErrorKind::NotFound);
    for folder in std::env::split_paths(&path) {
        match is_executable(&folder.join(&named)) {
            Ok(()) => return Ok(()),
            // A file without permission says more than a missing one.
            Err(error) if error.kind() == std::io::ErrorKind::PermissionDenied => reason = error,
            Err(_) => {}
        }
    }
    Err(reason)
}

fn is_executable(file: &Path) -> std::io::Result<()> {
    use std::os::unix::fs::PermissionsExt;
    let found = std::fs::metadata(file)?;
    if found.is_file() && found.permissions().mode() & 0o111 != 0 {
        Ok(())
    } else {
        Err(std::io::ErrorKind::PermissionDenied.into())
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
            let started = Process::start(command, folder);
            self.process = Some(started.map_err(|reason| start_error(command, folder, reason))?);
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

#[cfg(test)]
mod tests {
    use super::*;
    use common::scene::SceneSource;

    #[test]
    fn sample_keys_keep_the_order_of_the_scene() {
        let text = "scene = { name = \"s\" }\nsimulator = { program = [\"sh\"] }\noutputs = [{ name = \"a\" }]\n\
            limit_states = [{ name = \"l\", output = \"a\", threshold = 1 }]\n\
            variables = [{ name = \"z\", mean = 1, std = 1 }, { name = \"a\", mean = 2, std = 1 }]";
        let source = SceneSource::parse(text, "s").unwrap();
        let program = Program { command: vec!["sh".into()], folder: ".".into() };
        let setup = Setup::new(&program, 1.0, source.nominal());
        assert_eq!(
            setup.line(3, &[0.5, 2.0]),
            "{\"id\":3,\"sample\":{\"z\":0.5,\"a\":2.0},\"cycles\":[1]}\n"
        );
    }

    #[test]
    fn a_missing_program_is_found_without_starting_it() {
        let folder = tempfile::tempdir().unwrap();
        let check = |command: &str| {
            let command = vec![command.to_owned()];
            check_program_file(&Program { command, folder: folder.path().display().to_string() })
        };
        assert!(check("sh").is_ok());
        std::fs::write(folder.path().join("model"), "").unwrap();
        for (command, reason) in [("no-such-program", "entity not found"), ("./model", "permission denied")] {
            let said = check(command).unwrap_err().to_string();
            assert!(said.contains(&format!("\"{command}\" cannot be started in")), "{said}");
            assert!(said.ends_with(reason), "{said}");
        }
    }
}
