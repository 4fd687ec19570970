//! A program that keeps running between requests: it reads one line per request and writes one line per reply. It
//! runs in a separate process group: a signal to the study does not reach it, and its child processes end with it.

use super::slots::{StopSignal, WaitError};
use rustix::process::{Pid, Signal, kill_process_group};
use std::collections::{BTreeSet, VecDeque};
use std::io::{BufRead, BufReader, Read, Write};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::sync::mpsc::{Receiver, Sender, channel};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

/// Longest line read from a program [bytes].
const LONGEST_LINE: u64 = 64 << 20;
/// Last lines of standard error kept for error messages.
const KEPT_LINES: usize = 5;
/// Characters kept of each of these lines.
const KEPT_OF_LINE: usize = 400;
/// Time for a program to exit once its standard input is closed.
const FAREWELL: Duration = Duration::from_millis(500);
/// Interval at which the exit of a program is polled.
const EXIT_POLL: Duration = Duration::from_millis(5);

/// Process groups that are running.
static RUNNING: Mutex<BTreeSet<i32>> = Mutex::new(BTreeSet::new());

/// Kills every program started by this process. For an exit that drops nothing.
pub fn kill_all() {
    for group in &*locked(&RUNNING) {
        kill_group(*group);
    }
}

/// Reasons for a request without a reply line.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum LineError {
    /// No reply within the timeout.
    TimedOut,
    /// The program has exited.
    Ended {
        /// Exit status, e.g. `exit status: 3`.
        status: String,
        /// The last lines of its standard error.
        stderr: String,
    },
    /// The stop signal was set.
    Stopped,
}

/// A running program. When dropped, its standard input is closed, and it is killed if it does not exit.
#[derive(Debug)]
pub struct Process {
    child: Child,
    group: i32,
    /// Lines for the writing thread; dropping it closes the program's standard input.
    input: Option<Sender<String>>,
    lines: Receiver<String>,
    stderr: Arc<Mutex<VecDeque<String>>>,
}

impl Process {
    /// Starts `command`, a program with its arguments, in `folder`. A relative path of the program starts at `folder`.
    ///
    /// # Errors
    /// The operating system cannot start the program.
    pub fn start(command: &[String], folder: &Path) -> std::io::Result<Self> {
        use std::os::unix::process::CommandExt;
        let [program, arguments @ ..] = command else {
            return Err(std::io::Error::other("the command is empty"));
        };
        let named = PathBuf::from(program);
        let named = if named.components().count() > 1 { folder.join(named) } else { named };
        let mut child = Command::new(named)
            .args(arguments)
            .current_dir(folder)
            .process_group(0)
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()?;
        let group = i32::try_from(child.id()).map_err(std::io::Error::other)?;
        locked(&RUNNING).insert(group);
        let (input, requests) = channel::<String>();
        let (sender, lines) = channel();
        let stderr = Arc::new(Mutex::new(VecDeque::new()));
        let pipes = (child.stdin.take(), child.stdout.take(), child.stderr.take());
        let process = Self { child, group, input: Some(input), lines, stderr: Arc::clone(&stderr) };
        let (Some(mut to), Some(from), Some(errors)) = pipes else { unreachable!("all three are piped") };
        spawn("input", move || {
            // A program that stops reading is detected by the missing reply.
            while let Ok(request) = requests.recv()
                && to.write_all(request.as_bytes()).and_then(|()| to.flush()).is_ok()
            {}
        })?;
        spawn("output", move || each_line(from, |line| sender.send(line).is_ok()))?;
        spawn("stderr", move || {
            each_line(errors, |line| {
                tracing::debug!("simulator: {line}");
                let mut kept = locked(&stderr);
                kept.push_back(line.chars().take(KEPT_OF_LINE).collect());
                if kept.len() > KEPT_LINES {
                    kept.pop_front();
                }
                true
            });
        })?;
        Ok(process)
    }

    /// Sends a line, which ends with a newline, and waits for one line in return, at most `timeout`.
    ///
    /// # Errors
    /// [`LineError`].
    pub fn ask(&mut self, line: String, timeout: Duration, stop: &StopSignal) -> Result<String, LineError> {
        if let Some(input) = &self.input {
            // If the writing thread has ended, the program has exited and its output will end too.
            let _ = input.send(line);
        }
        stop.wait(&self.lines, timeout).map_err(|none| match none {
            WaitError::TimedOut => LineError::TimedOut,
            WaitError::Stopped => LineError::Stopped,
            WaitError::Disconnected => {
                let status = self.finish();
                // The last lines of standard error may still be in the pipe.
                self.wait_for_stderr();
                let stderr = locked(&self.stderr).iter().cloned().collect::<Vec<_>>().join(" / ");
                LineError::Ended { status, stderr }
            }
        })
    }

    /// Kills the program and its child processes at once.
    pub fn kill(mut self) {
        self.end();
    }

    /// Closes the program's input, waits for its exit, kills it if necessary; returns how it ended.
    fn finish(&mut self) -> String {
        self.input = None;
        let started = Instant::now();
        loop {
            match self.child.try_wait() {
                Ok(Some(status)) => return status.to_string(),
                Ok(None) if started.elapsed() < FAREWELL => std::thread::sleep(EXIT_POLL),
                _ => {
                    self.end();
                    return "its standard output closed".to_owned();
                }
            }
        }
    }

    /// Waits until standard error is closed, at most [`FAREWELL`].
    fn wait_for_stderr(&self) {
        let started = Instant::now();
        while Arc::strong_count(&self.stderr) > 1 && started.elapsed() < FAREWELL {
            std::thread::sleep(EXIT_POLL);
        }
    }

    fn end(&mut self) {
        kill_group(self.group);
        // The process was killed; this only reaps it.
        let _ = self.child.wait();
    }
}

impl Drop for Process {
    fn drop(&mut self) {
        self.finish();
        // Child processes that outlived the program.
        kill_group(self.group);
        locked(&RUNNING).remove(&self.group);
    }
}

fn kill_group(group: i32) {
    if let Some(group) = Pid::from_raw(group) {
        // The group may have ended already.
        let _ = kill_process_group(group, Signal::KILL);
    }
}

/// Calls `take` with every line, without its line break, until the end of input or until `take` returns false.
fn each_line(from: impl Read, mut take: impl FnMut(String) -> bool) {
    let mut from = BufReader::new(from);
    let mut line = Vec::new();
    loop {
        line.clear();
        match from.by_ref().take(LONGEST_LINE).read_until(b'\n', &mut line) {
            Ok(0) | Err(_) => return,
            Ok(_) => {
                let text = String::from_utf8_lossy(&line);
                if !take(text.trim_end_matches(['\n', '\r']).to_owned()) {
                    return;
                }
            }
        }
    }
}

fn spawn(what: &str, work: impl FnOnce() + Send + 'static) -> std::io::Result<()> {
    std::thread::Builder::new().name(format!("simulator {what}")).spawn(work).map(drop)
}

/// Locks a mutex. No code panics while it holds one of these locks, so poisoning is ignored.
fn locked<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

#[cfg(test)]
mod tests {
    use super::*;

    const PATIENCE: Duration = Duration::from_secs(30);

    fn shell(script: &str) -> Process {
        let command = ["sh", "-c", script].map(str::to_owned);
        Process::start(&command, Path::new(".")).unwrap()
    }

    fn ask(process: &mut Process, line: &str, patience: Duration) -> Result<String, LineError> {
        process.ask(format!("{line}\n"), patience, &StopSignal::default())
    }

    #[test]
    fn each_line_sent_gets_one_line_in_return() {
        let mut process = shell("while read line; do echo \"got $line\"; done");
        for k in 0..100 {
            assert_eq!(ask(&mut process, &k.to_string(), PATIENCE), Ok(format!("got {k}")));
        }
    }

    #[test]
    fn an_exit_is_reported_with_status_and_last_lines_of_stderr() {
        let mut process = shell("read line; for k in 1 2 3 4 5 6; do echo no $k >&2; done; exit 3");
        let stderr = "no 2 / no 3 / no 4 / no 5 / no 6".to_owned();
        let status = "exit status: 3".to_owned();
        assert_eq!(ask(&mut process, "go", PATIENCE), Err(LineError::Ended { status, stderr }));
    }

    #[test]
    fn a_program_that_neither_reads_nor_writes_times_out() {
        let mut process = shell("exec sleep 600");
        // More than a pipe holds.
        let line = "x".repeat(1 << 20);
        assert_eq!(ask(&mut process, &line, Duration::from_millis(100)), Err(LineError::TimedOut));
        process.kill();
    }

    #[test]
    fn child_processes_end_with_their_program() {
        let mut process = shell("sleep 600 & echo $!; read line; read line");
        let grandchild = ask(&mut process, "", PATIENCE).unwrap();
        let exists = || Path::new("/proc").join(&grandchild).join("cmdline").exists();
        assert!(exists() || !Path::new("/proc/self").exists());
        process.kill();
        let started = Instant::now();
        // The system reaps it later; a zombie has an empty command line.
        let alive = || {
            std::fs::read(Path::new("/proc").join(&grandchild).join("cmdline"))
                .is_ok_and(|line| !line.is_empty())
        };
        while alive() {
            assert!(started.elapsed() < PATIENCE, "process {grandchild} is still running");
            std::thread::yield_now();
        }
    }
}
