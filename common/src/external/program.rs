//! Evaluations by a program of this machine. Either one process per slot keeps running between requests, or the program
//! runs once per evaluation, with files in and out ([`super::working_folder`]).
//!
//! A request is one line on its standard input, `{"id": 7, "sample": {"width": 0.02, ...}, "cycles": [1, ...]}`. A reply
//! is one line on its standard output: `{"id": 7, "outputs": {"deflection": [0.003]}}`, with numerical errors of the
//! same shape under `errors` if the program estimates any, or `{"id": 7, "failure": "..."}`. A process that exceeds the
//! time limit is killed and replaced; a process that exits is replaced and gets the request once more.

use super::guard::check_executable;
use super::process::{LineError, Process};
use super::reply::{Expected, NoResult, outcome, parse, shown};
use super::results_file::{self, of_object};
use super::slot::{SampleResult, SimulatorError, Slot, SlotError, SlotRequest, StopSignal};
use super::working_folder::{self, check_file};
use crate::failure::{SimulationFailure, last_words};
use crate::outputs::Evaluation;
use crate::scene::{Program, Scene};
use serde::{Serialize, Serializer};
use serde_json::{Map, Value};
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

/// Attempts at a sample at which the program exits.
const ATTEMPTS: usize = 2;

/// Command, time limit and expected shape, shared by all slots.
#[derive(Debug)]
pub struct Setup {
    program: Program,
    /// Time limit of one evaluation as stated in the scene [s].
    seconds: f64,
    timeout: Duration,
    expected: Expected,
    /// Means of the inputs `(d,)`.
    nominal: Vec<f64>,
    /// Names of the levels of accuracy; empty without any.
    levels: Vec<String>,
    /// Whether any process has replied; before the first reply, an exit says nothing about the sample.
    answered: AtomicBool,
}

impl Setup {
    /// Setup of `program` for `scene`; `timeout` bounds one evaluation [s].
    pub fn new(program: &Program, timeout: f64, scene: &Scene) -> Self {
        let expected = Expected::from_scene(scene);
        let means: Vec<f64> = scene.variables.iter().map(|v| v.distribution.mean()).collect();
        Self {
            program: program.clone(),
            seconds: timeout,
            timeout: Duration::try_from_secs_f64(timeout).unwrap_or(Duration::MAX),
            nominal: expected.values(&means, scene.conditions.first()),
            expected,
            levels: scene.simulator.as_ref().map_or(vec![], |simulator| simulator.levels.clone()),
            answered: AtomicBool::new(false),
        }
    }

    /// Name of a level, of the first one beyond the last, for variants of a scene; `None` if the simulator has none.
    fn level(&self, level: u8) -> Option<&str> {
        self.levels.get(usize::from(level)).or(self.levels.first()).map(String::as_str)
    }

    fn line(&self, id: u64, level: u8, sample: &[f64]) -> String {
        #[derive(Serialize)]
        struct Line<'a> {
            id: u64,
            sample: SampleByName<'a>,
            cycles: &'a [u32],
            #[serde(skip_serializing_if = "Option::is_none")]
            level: Option<&'a str>,
        }
        let (level, cycles) = (self.level(level), &self.expected.cycles[..]);
        let sample = SampleByName { names: &self.expected.inputs, values: sample };
        let line = Line { id, sample, cycles, level };
        serde_json::to_string(&line).expect("a map of numbers by name is JSON")
    }

    /// Object of a reply line to evaluation `id`, or what is wrong with the line.
    fn object(&self, id: u64, line: &str) -> Result<Map<String, Value>, String> {
        let reply = parse(line).map_err(|error| format!("\"{}\" is no JSON: {error}", shown(line)))?;
        let Value::Object(reply) = reply else {
            return Err(format!("\"{}\" is no object {{\"id\": ..., \"outputs\": ...}}", shown(line)));
        };
        match reply.get("id") {
            Some(found) if found.as_u64() == Some(id) => Ok(reply),
            Some(found) => Err(format!("its id is {found}, expected {id}")),
            None => Err(format!("its id is none, expected {id}")),
        }
    }

    /// The reply to evaluation `id` of a program that answers in lines; a results file has no number.
    pub(super) fn line_reply(&self, id: u64, text: &str) -> Result<Option<Map<String, Value>>, String> {
        match &self.program.exchange {
            None => self.object(id, text).map(Some),
            Some(_) => Ok(None),
        }
    }

    /// The error of a reply that breaks the protocol.
    pub(super) fn broken(&self, id: u64, fault: String) -> SimulatorError {
        SimulatorError::of_reply(&format!("\"{}\"", key_and_name(&self.program).1), id, &fault)
    }

    /// Result of a reply line, or of the text of a results file.
    fn outcome(&self, id: u64, text: &str) -> Result<Evaluation, NoResult> {
        match &self.program.exchange {
            None => of_object(&self.expected, &self.object(id, text)?),
            Some(files) => results_file::read(&self.expected, text).map_err(|none| none.of(&files.results)),
        }
    }
}

/// Values of the inputs by name, in the order of the scene, which a map would not keep.
#[derive(Clone, Copy)]
pub(super) struct SampleByName<'a> {
    pub(super) names: &'a [String],
    pub(super) values: &'a [f64],
}

impl Serialize for SampleByName<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_map(self.names.iter().zip(self.values))
    }
}

/// Checks that the program of a scene exists and can be executed, without starting it, and that its files can be read and
/// its templates filled.
///
/// # Errors
/// [`SimulatorError`].
pub fn check_program_file(program: &Program, scene: &Scene) -> Result<(), SimulatorError> {
    let folder = Path::new(&program.folder);
    let of_command = match &program.fmu {
        Some(_) => ("python", program.command[0].clone()),
        None => key_and_name(program),
    };
    check_executable(&program.command, folder).map_err(|reason| not_started(program, of_command, reason))?;
    let files = match &program.exchange {
        Some(files) => working_folder::check(program, files, &Expected::from_scene(scene).inputs),
        None => program.fmu.as_ref().map_or(Ok(()), |fmu| check_file(folder, fmu)),
    };
    files.map_err(|reason| start_error(program, reason))
}

/// The key of the scene that states a program, and its name in messages: the FMU, or the program with its arguments.
fn key_and_name(program: &Program) -> (&'static str, String) {
    program.fmu.clone().map_or_else(|| ("program", program.command.join(" ")), |fmu| ("fmu", fmu))
}

fn start_error(program: &Program, reason: std::io::Error) -> SimulatorError {
    not_started(program, key_and_name(program), reason)
}

fn not_started(program: &Program, (key, name): (&str, String), reason: std::io::Error) -> SimulatorError {
    let fault = format!("\"{name}\" cannot be started in {}: {reason}", program.folder);
    SimulatorError::of_key(key, fault)
}

/// A slot with at most one running process.
#[derive(Debug)]
pub struct ProgramSlot {
    pub(super) setup: Arc<Setup>,
    number: usize,
    process: Option<Process>,
}

impl ProgramSlot {
    /// Slot `number`; the program is started by [`Slot::start`] or by the first request.
    pub fn new(setup: Arc<Setup>, number: usize) -> Self {
        Self { setup, number, process: None }
    }

    /// Starts a program that keeps running, if it is not running; again, if it would not end without `contact`.
    fn start_process(&mut self, contact: Option<usize>) -> Result<(), SimulatorError> {
        if self.process.as_ref().is_none_or(|process| !process.serves(contact)) {
            self.process = None;
            let program = &self.setup.program;
            let folder = Path::new(&program.folder);
            let started = Process::start(&program.command, folder, folder, contact);
            self.process = Some(started.map_err(|reason| start_error(program, reason))?);
        }
        Ok(())
    }

    /// The reply line to a request, of which `text` gives the line for its sample, or the text of the results file of a program that runs once.
    fn attempt(
        &mut self,
        SlotRequest { level, sample, .. }: SlotRequest,
        text: &dyn Fn(&[f64]) -> String,
        stop: &StopSignal,
    ) -> Result<Result<String, LineError>, SlotError> {
        let line = text(sample) + "\n";
        let Setup { program, expected, timeout, .. } = &*self.setup;
        if let Some(files) = &program.exchange {
            let (inputs, level) = ((&expected.inputs[..], sample), self.setup.level(level));
            let run = working_folder::run((program, files), inputs, (level, &line), *timeout, stop);
            return run.map_err(|reason| start_error(program, reason).into());
        }
        self.start_process(stop.contact)?;
        let process = self.process.as_mut().expect("the program was started above");
        let reply = process.ask(line, self.setup.timeout, stop);
        if reply.is_err() {
            self.kill();
        }
        Ok(reply)
    }

    /// Kills the process: further output would be read as the next reply.
    fn kill(&mut self) {
        if let Some(process) = self.process.take() {
            process.kill();
        }
    }

    /// Distinguishes a broken program from a bad sample: if no process has ever replied, the program is run at the means of the
    /// inputs. If it exits there too, the program is at fault.
    ///
    /// # Errors
    /// [`SimulatorError`].
    fn check_program(
        &mut self,
        asked: SlotRequest,
        text: &dyn Fn(&[f64]) -> String,
        stop: &StopSignal,
    ) -> Result<(), SlotError> {
        if self.setup.answered.load(Ordering::Relaxed) {
            return Ok(());
        }
        let nominal = self.setup.nominal.clone();
        match self.attempt(SlotRequest { sample: &nominal, ..asked }, text, stop)? {
            Err(LineError::Ended { status, stderr }) => {
                let (key, name) = key_and_name(&self.setup.program);
                let said = last_words(&stderr);
                let fault = format!("\"{name}\" ended with {status} instead of answering{said}");
                return Err(SimulatorError::of_key(key, fault).into());
            }
            Err(LineError::Stopped) => return Err(SlotError::Stopped),
            Err(LineError::TimedOut) => {}
            Ok(_) => self.setup.answered.store(true, Ordering::Relaxed),
        }
        Ok(())
    }

    /// What `read` reads from the reply to a request, and the text of that reply; `text` gives the line for a sample; a process whose line breaks the protocol is killed.
    ///
    /// # Errors
    /// As [`Slot::evaluate`].
    pub(super) fn ask<T>(
        &mut self,
        asked: SlotRequest,
        text: &dyn Fn(&[f64]) -> String,
        stop: &StopSignal,
        read: impl Fn(&Setup, &str) -> Result<T, NoResult>,
    ) -> Result<Result<(T, String), SimulationFailure>, SlotError> {
        let mut crash = None;
        for _ in 0..ATTEMPTS {
            match self.attempt(asked, text, stop)? {
                Ok(reply) => {
                    let broken = |fault| self.setup.broken(asked.id, fault);
                    let read = outcome(read(&self.setup, &reply), broken);
                    match &read {
                        Ok(_) => self.setup.answered.store(true, Ordering::Relaxed),
                        Err(_) => self.kill(),
                    }
                    return read.map(|outcome| outcome.map(|found| (found, reply)));
                }
                Err(LineError::TimedOut) => {
                    return Ok(Err(SimulationFailure::TimedOut { seconds: self.setup.seconds }));
                }
                Err(LineError::Stopped) => return Err(SlotError::Stopped),
                Err(LineError::Ended { status, stderr }) => {
                    tracing::debug!("the simulator ended with {status} at evaluation {}", asked.id);
                    crash = Some(SimulationFailure::Crashed { status, stderr });
                }
            }
        }
        self.check_program(asked, text, stop)?;
        Ok(Err(crash.expect("every attempt ended in a crash")))
    }
}

impl Slot for ProgramSlot {
    fn start(&mut self) -> Result<(), SimulatorError> {
        if self.setup.program.exchange.is_none() { self.start_process(None) } else { Ok(()) }
    }

    fn evaluate(&mut self, asked: SlotRequest<'_>, stop: &StopSignal) -> Result<SampleResult, SlotError> {
        let setup = Arc::clone(&self.setup);
        let text = |sample: &[f64]| setup.line(asked.id, asked.level, sample);
        let outcome = self.ask(asked, &text, stop, |setup, text| setup.outcome(asked.id, text));
        Ok(outcome?.map(|(evaluation, _)| evaluation))
    }

    fn name(&self) -> String {
        format!("program/{}", self.number)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::SceneSource;

    fn scene() -> SceneSource {
        let text = "scene = { name = \"s\" }\nsimulator = { program = [\"sh\"] }\noutputs = [{ name = \"a\" }]\n\
            limit_states = [{ name = \"l\", output = \"a\", threshold = 1 }]\n\
            variables = [{ name = \"z\", mean = 1, std = 1 }, { name = \"a\", mean = 2, std = 1 }]";
        SceneSource::parse(text, "s").unwrap()
    }

    #[test]
    fn sample_keys_keep_the_order_of_the_scene() {
        let program = Program { command: vec!["sh".into()], folder: ".".into(), exchange: None, fmu: None };
        let setup = Setup::new(&program, 1.0, scene().nominal());
        assert_eq!(
            setup.line(3, 0, &[0.5, 2.0]),
            "{\"id\":3,\"sample\":{\"z\":0.5,\"a\":2.0},\"cycles\":[1]}"
        );
    }

    #[test]
    fn a_missing_program_is_found_without_starting_it() {
        let folder = tempfile::tempdir().unwrap();
        let check = |command: &str| {
            let (command, folder) = (vec![command.to_owned()], folder.path().display().to_string());
            check_program_file(&Program { command, folder, exchange: None, fmu: None }, scene().nominal())
        };
        assert!(check("sh").is_ok());
        std::fs::write(folder.path().join("model"), "").unwrap();
        for (command, reason) in [
            ("no-such-program", "no such program in the folders of PATH; install it, or give its path"),
            ("./missing", "there is no file "),
            ("./model", "may not be executed; allow it with chmod +x"),
        ] {
            let said = check(command).unwrap_err().to_string();
            assert!(said.contains(&format!("\"{command}\" cannot be started in")), "{said}");
            assert!(said.contains(reason), "{said}");
        }
        let command = ["no-such-python", "-m", "hingewise.fmu", "a.fmu"].map(str::to_owned).to_vec();
        let fmu = Program { command, folder: ".".to_owned(), exchange: None, fmu: Some("a.fmu".to_owned()) };
        let said = check_program_file(&fmu, scene().nominal()).unwrap_err().to_string();
        assert!(said.contains("simulator.python: \"no-such-python\" cannot be started in ."), "{said}");
    }
}
