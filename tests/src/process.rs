//! Child processes of a test: their output is read line by line, and they are killed when dropped.

use crate::PATIENCE;
use std::io::{BufRead, BufReader};
use std::process::{Child, Command, ExitStatus, Stdio};
use std::sync::{Arc, Condvar, Mutex};
use std::time::{Duration, Instant};

/// Unit of the times in /proc: ticks per second, a constant of Linux.
const TICKS: f64 = 100.0;

/// A child process with its standard output.
pub struct Process {
    child: Child,
    output: Arc<Output>,
}

/// Lines of standard output with their time, and whether it has ended.
#[derive(Default)]
struct Output {
    lines: Mutex<(Vec<(Instant, String)>, bool)>,
    changed: Condvar,
}

impl Process {
    /// Starts a command; its standard output is recorded, its standard error is that of the test.
    pub fn start(command: &mut Command) -> Self {
        let mut child = command.stdout(Stdio::piped()).spawn().expect("the program starts");
        let pipe = BufReader::new(child.stdout.take().expect("it is piped"));
        let output = Arc::new(Output::default());
        let recorded = Arc::clone(&output);
        std::thread::spawn(move || {
            for line in pipe.lines().map_while(Result::ok) {
                recorded.lines.lock().expect("no holder panics").0.push((Instant::now(), line));
                recorded.changed.notify_all();
            }
            recorded.lines.lock().expect("no holder panics").1 = true;
            recorded.changed.notify_all();
        });
        Self { child, output }
    }

    /// All lines so far that begin with `word`, without the word.
    pub fn lines(&self, word: &str) -> Vec<String> {
        let lines = self.output.lines.lock().expect("no holder panics");
        lines.0.iter().filter_map(|(_, line)| Some(line.strip_prefix(word)?.trim().to_owned())).collect()
    }

    /// Waits for the `n`-th line (from 1) that begins with `word`; returns the line without the word. `None` if the output
    /// ends before.
    pub fn line(&self, word: &str, n: usize, timeout: Duration) -> Option<String> {
        let missing = |(lines, ended): &mut (Vec<(Instant, String)>, bool)| {
            !*ended && lines.iter().filter(|(_, line)| line.starts_with(word)).count() < n
        };
        let lines = self.output.lines.lock().expect("no holder panics");
        let (lines, waited) =
            self.output.changed.wait_timeout_while(lines, timeout, missing).expect("no holder panics");
        assert!(!waited.timed_out(), "no line \"{word}\" within {timeout:?}");
        drop(lines);
        self.lines(word).into_iter().nth(n - 1)
    }

    /// Sends a signal, e.g. `KILL`.
    pub fn signal(&self, name: &str) {
        let sent = Command::new("kill").args([&format!("-{name}"), &self.child.id().to_string()]).status();
        assert!(sent.expect("kill runs").success(), "SIG{name} could not be sent");
    }

    /// Its exit status if it has ended.
    pub fn ended(&mut self) -> Option<ExitStatus> {
        self.child.try_wait().expect("it is a child of this process")
    }

    /// Waits for the exit of the process, at most `timeout`.
    pub fn end(&mut self, timeout: Duration) -> ExitStatus {
        let started = Instant::now();
        loop {
            if let Some(status) = self.ended() {
                return status;
            }
            assert!(started.elapsed() < timeout, "the process did not end within {timeout:?}");
            std::thread::sleep(Duration::from_millis(5));
        }
    }

    /// Resident memory [MiB]; `None` after its exit, or without /proc.
    pub fn resident(&self) -> Option<f64> {
        let status = std::fs::read_to_string(format!("/proc/{}/status", self.child.id())).ok()?;
        let line = status.lines().find_map(|line| line.strip_prefix("VmRSS:"))?;
        line.trim().strip_suffix(" kB")?.parse::<f64>().ok().map(|kib| kib / 1024.0)
    }

    /// Time of all its threads on the processors [s]; `None` after its exit, or without /proc.
    pub fn processor_time(&self) -> Option<f64> {
        let stat = std::fs::read_to_string(format!("/proc/{}/stat", self.child.id())).ok()?;
        // The name of the program, in parentheses, may have spaces; user and system time are fields 14 and 15.
        let fields: Vec<&str> = stat.rsplit_once(')')?.1.split_whitespace().collect();
        let ticks = |field: usize| fields.get(field - 3)?.parse::<f64>().ok();
        Some((ticks(14)? + ticks(15)?) / TICKS)
    }

    /// Kills the process.
    pub fn kill(&mut self) {
        self.child.kill().expect("it is a child of this process");
        self.end(PATIENCE);
    }
}

impl Drop for Process {
    fn drop(&mut self) {
        // It may have ended already.
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}
