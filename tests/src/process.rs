//! Processes of a test: heard line by line, told by signals, and gone with the test.

use crate::PATIENCE;
use std::io::{BufRead, BufReader};
use std::process::{Child, Command, ExitStatus, Stdio};
use std::sync::{Arc, Condvar, Mutex};
use std::time::{Duration, Instant};

/// See the module.
pub struct Process {
    child: Child,
    said: Arc<Said>,
}

/// The lines of a process so far, and when each came.
#[derive(Default)]
struct Said {
    lines: Mutex<(Vec<(Instant, String)>, bool)>,
    changed: Condvar,
}

impl Process {
    /// Starts it; its standard output is heard, its standard error goes where that of the test goes.
    pub fn start(command: &mut Command) -> Self {
        let mut child = command.stdout(Stdio::piped()).spawn().expect("the program starts");
        let output = BufReader::new(child.stdout.take().expect("it is piped"));
        let said = Arc::new(Said::default());
        let heard = Arc::clone(&said);
        std::thread::spawn(move || {
            for line in output.lines().map_while(Result::ok) {
                heard.lines.lock().expect("no holder panics").0.push((Instant::now(), line));
                heard.changed.notify_all();
            }
            heard.lines.lock().expect("no holder panics").1 = true;
            heard.changed.notify_all();
        });
        Self { child, said }
    }

    /// All lines so far that begin with `word`, without it.
    pub fn lines(&self, word: &str) -> Vec<String> {
        let lines = self.said.lines.lock().expect("no holder panics");
        lines.0.iter().filter_map(|(_, line)| Some(line.strip_prefix(word)?.trim().to_owned())).collect()
    }

    /// Waits for the `n`-th line (from 1) that begins with `word`; the line without it. `None` if the process says no more.
    pub fn line(&self, word: &str, n: usize, patience: Duration) -> Option<String> {
        let missing = |(lines, ended): &mut (Vec<(Instant, String)>, bool)| {
            !*ended && lines.iter().filter(|(_, line)| line.starts_with(word)).count() < n
        };
        let lines = self.said.lines.lock().expect("no holder panics");
        let (lines, waited) =
            self.said.changed.wait_timeout_while(lines, patience, missing).expect("no holder panics");
        assert!(!waited.timed_out(), "no line \"{word}\" within {patience:?}");
        drop(lines);
        self.lines(word).into_iter().nth(n - 1)
    }

    /// Sends a signal, e.g. `KILL`.
    pub fn signal(&self, name: &str) {
        let sent = Command::new("kill").args([&format!("-{name}"), &self.child.id().to_string()]).status();
        assert!(sent.expect("kill runs").success(), "SIG{name} could not be sent");
    }

    /// Its end, waited for at most so long.
    pub fn end(&mut self, patience: Duration) -> ExitStatus {
        let started = Instant::now();
        loop {
            if let Some(status) = self.child.try_wait().expect("it is a child of this process") {
                return status;
            }
            assert!(started.elapsed() < patience, "the process did not end within {patience:?}");
            std::thread::sleep(Duration::from_millis(5));
        }
    }

    /// Its resident memory [MiB]; `None` of one that has ended, or where there is no /proc.
    pub fn resident(&self) -> Option<f64> {
        let status = std::fs::read_to_string(format!("/proc/{}/status", self.child.id())).ok()?;
        let line = status.lines().find_map(|line| line.strip_prefix("VmRSS:"))?;
        line.trim().strip_suffix(" kB")?.parse::<f64>().ok().map(|kib| kib / 1024.0)
    }

    /// Kills it at once.
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
