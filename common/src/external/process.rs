//! A program that keeps running between requests, with one line per request and one per reply, or that runs once per
//! evaluation. It runs in a separate process group: a signal to this process does not reach it, and its child processes
//! end with it. The group also ends when this process is killed.

use super::guard::{Guard, guarded};
use super::slot::StopSignal;
use crate::locks::locked;
use rustix::process::{Pid, Signal, WaitId, WaitIdOptions, kill_process_group, waitid};
use std::collections::{BTreeSet, VecDeque};
use std::io::{BufRead, BufReader, Read, Write};
use std::os::unix::process::{CommandExt, ExitStatusExt};
use std::path::Path;
use std::process::{Child, ExitStatus, Stdio};
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, channel, sync_channel};
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

/// Longest line read from a program [bytes]; the rest of a longer one counts as the next line.
const LONGEST_LINE: u64 = 64 << 20;
/// Lines of standard output that are read ahead. A program that writes more waits until they are read, so that its
/// output takes no memory here.
const LINES_AHEAD: usize = 1;
/// Last lines of standard error (of all output of a program that runs once) kept for error messages.
const KEPT_LINES: usize = 5;
/// Characters kept of each of these lines.
const KEPT_OF_LINE: usize = 400;
/// Time for a program to exit once its standard input is closed.
const FAREWELL: Duration = Duration::from_millis(500);
/// Interval at which the exit of a program is polled once its input is closed.
const EXIT_POLL: Duration = Duration::from_millis(5);
/// Interval at which the exit of a program is polled while a reply is awaited.
const EXIT_LOOK: Duration = Duration::from_millis(250);

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
    /// The stop signal was set, or the program was ended without contact.
    Stopped,
}

/// A running program. When dropped, its standard input is closed, and it is killed if it does not exit.
///
/// The process is reaped last: until then the system gives its number, and that of its group, to no other, so
/// that no signal reaches a stranger.
#[derive(Debug)]
pub struct Process {
    child: Child,
    group: i32,
    guard: Arc<Guard>,
    contact: Option<usize>,
    /// How it ended, once it was reaped.
    status: Option<String>,
    /// Whether it ended with exit status 0.
    succeeded: bool,
    /// Whether it was killed by another process.
    was_killed: bool,
    /// Lines for the writing thread; dropping it closes the program's standard input.
    input: Option<Sender<String>>,
    lines: Receiver<String>,
    stderr: Arc<Mutex<VecDeque<String>>>,
}

impl Process {
    /// Starts `command`, a program with its arguments, with the working directory `directory`. A relative path of the program
    /// starts at `folder`. With `contact` it ends without that contact ([`limit_contact`](super::limit_contact)).
    ///
    /// # Errors
    /// The operating system cannot start the program.
    pub fn start(
        command: &[String],
        folder: &Path,
        directory: &Path,
        contact: Option<usize>,
    ) -> std::io::Result<Self> {
        let (mut shell, guard) = guarded(command, folder, contact)?;
        let mut child = shell
            .current_dir(directory)
            .process_group(0)
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()?;
        let group = i32::try_from(child.id()).map_err(std::io::Error::other)?;
        locked(&RUNNING).insert(group);
        let (input, requests) = channel::<String>();
        let (sender, lines) = sync_channel(LINES_AHEAD);
        let stderr = Arc::new(Mutex::new(VecDeque::new()));
        let pipes = (child.stdin.take(), child.stdout.take(), child.stderr.take());
        let process = Self {
            child,
            group,
            guard,
            contact,
            status: None,
            succeeded: false,
            was_killed: false,
            input: Some(input),
            lines,
            stderr: Arc::clone(&stderr),
        };
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
                keep(&stderr, &line);
                true
            });
        })?;
        Ok(process)
    }

    /// Sends a line, which ends with a newline, and waits for one line in return, at most `timeout`.
    ///
    /// An exit is noticed by the end of standard output, and, where a child process of the program keeps that open, by
    /// the process itself.
    ///
    /// # Errors
    /// [`LineError`].
    pub fn ask(&mut self, line: String, timeout: Duration, stop: &StopSignal) -> Result<String, LineError> {
        if let Some(input) = &self.input {
            // If the writing thread has ended, the program has exited.
            let _ = input.send(line);
        }
        let started = Instant::now();
        loop {
            let left = timeout.saturating_sub(started.elapsed());
            match stop.wait(&self.lines, left.min(EXIT_LOOK)) {
                None => return Err(LineError::Stopped),
                Some(Ok(reply)) => return Ok(reply),
                Some(Err(RecvTimeoutError::Disconnected)) => return Err(self.ended()),
                Some(Err(RecvTimeoutError::Timeout)) if self.has_exited() => {
                    // A line may still be in the pipe.
                    let last = stop.wait(&self.lines, FAREWELL).and_then(Result::ok);
                    return last.ok_or_else(|| self.ended());
                }
                Some(Err(RecvTimeoutError::Timeout)) if left <= EXIT_LOOK => return Err(LineError::TimedOut),
                Some(Err(RecvTimeoutError::Timeout)) => {}
            }
        }
    }

    /// Closes the program's input and waits for its exit, at most `timeout`. Its standard output counts as messages for
    /// the user, like standard error. `Ok` if it ends with exit status 0; what is left of its group is killed.
    ///
    /// # Errors
    /// [`LineError`].
    pub fn complete(&mut self, timeout: Duration, stop: &StopSignal) -> Result<(), LineError> {
        self.input = None;
        let started = Instant::now();
        let mut open = true;
        while !self.has_exited() {
            let left = timeout.saturating_sub(started.elapsed());
            if stop.is_set() {
                return Err(LineError::Stopped);
            }
            if left.is_zero() {
                return Err(LineError::TimedOut);
            }
            if !open {
                std::thread::sleep(EXIT_POLL.min(left));
                continue;
            }
            match stop.wait(&self.lines, left.min(EXIT_LOOK)) {
                Some(Ok(line)) => keep(&self.stderr, &line),
                // It usually exits right after.
                Some(Err(RecvTimeoutError::Disconnected)) => open = false,
                None | Some(Err(RecvTimeoutError::Timeout)) => {}
            }
        }
        let status = self.end();
        while let Ok(line) = self.lines.recv_timeout(FAREWELL) {
            keep(&self.stderr, &line);
        }
        if self.succeeded { Ok(()) } else { Err(self.ended_with(status)) }
    }

    /// True if the program needs what an evaluation with this contact needs, if any.
    pub fn serves(&self, contact: Option<usize>) -> bool {
        contact.is_none() || contact == self.contact
    }

    /// The last lines of standard error.
    pub fn last_lines(&self) -> String {
        // They may still be in the pipe.
        wait_until(|| Arc::strong_count(&self.stderr) == 1);
        locked(&self.stderr).iter().cloned().collect::<Vec<_>>().join(" / ")
    }

    fn ended(&mut self) -> LineError {
        let status = self.finish();
        self.ended_with(status)
    }

    fn ended_with(&self, status: String) -> LineError {
        if self.was_killed && self.guard.has_ended_programs() {
            return LineError::Stopped;
        }
        LineError::Ended { status, stderr: self.last_lines() }
    }

    /// True if the program has exited; it is not reaped.
    fn has_exited(&self) -> bool {
        let options = WaitIdOptions::EXITED | WaitIdOptions::NOHANG | WaitIdOptions::NOWAIT;
        self.status.is_some()
            || Pid::from_raw(self.group).is_some_and(|process| {
                waitid(WaitId::Pid(process), options).is_ok_and(|ended| ended.is_some())
            })
    }

    /// Kills the program and its child processes at once.
    pub fn kill(mut self) {
        self.end();
    }

    /// Closes the program's input, waits for its exit, kills what is left of its group; returns how it ended.
    fn finish(&mut self) -> String {
        self.input = None;
        wait_until(|| self.has_exited());
        let has_exited = self.has_exited();
        let status = self.end();
        if has_exited { status } else { "its standard output closed".to_owned() }
    }

    /// Kills the program, if it runs, with its child processes, and then reaps it; returns how it ended.
    fn end(&mut self) -> String {
        if let Some(status) = &self.status {
            return status.clone();
        }
        let had_exited = self.has_exited();
        kill_group(self.group);
        locked(&RUNNING).remove(&self.group);
        let ended = self.child.wait();
        self.succeeded = ended.as_ref().is_ok_and(ExitStatus::success);
        self.was_killed = had_exited && ended.as_ref().is_ok_and(|status| status.signal().is_some());
        let status = ended.map_or_else(|error| error.to_string(), |status| status.to_string());
        self.status = Some(status.clone());
        status
    }
}

impl Drop for Process {
    fn drop(&mut self) {
        self.finish();
    }
}

/// Waits until a condition holds, at most [`FAREWELL`].
fn wait_until(holds: impl Fn() -> bool) {
    let started = Instant::now();
    while !holds() && started.elapsed() < FAREWELL {
        std::thread::sleep(EXIT_POLL);
    }
}

/// Appends a line to the last ones.
fn keep(kept: &Mutex<VecDeque<String>>, line: &str) {
    let mut kept = locked(kept);
    kept.push_back(line.chars().take(KEPT_OF_LINE).collect());
    if kept.len() > KEPT_LINES {
        kept.pop_front();
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
    while let Ok(1..) = from.by_ref().take(LONGEST_LINE).read_until(b'\n', &mut line) {
        let text = String::from_utf8(std::mem::take(&mut line));
        let mut text = text.unwrap_or_else(|error| String::from_utf8_lossy(error.as_bytes()).into_owned());
        text.truncate(text.trim_end_matches(['\n', '\r']).len());
        if !take(text) {
            return;
        }
    }
}

fn spawn(what: &str, work: impl FnOnce() + Send + 'static) -> std::io::Result<()> {
    std::thread::Builder::new().name(format!("simulator {what}")).spawn(work).map(drop)
}

#[cfg(test)]
mod tests {
    use super::*;

    const PATIENCE: Duration = Duration::from_secs(30);

    fn shell(script: &str) -> Process {
        let command = ["sh", "-c", script].map(str::to_owned);
        Process::start(&command, Path::new("."), Path::new("."), None).unwrap()
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
    fn issue_an_exit_is_noticed_while_a_child_process_holds_standard_output() {
        let mut process = shell("read line; sleep 300 & exit 3");
        let started = Instant::now();
        let error = ask(&mut process, "go", PATIENCE).unwrap_err();
        let status = "exit status: 3".to_owned();
        assert_eq!(error, LineError::Ended { status, stderr: String::new() });
        assert!(started.elapsed() < PATIENCE / 2, "{:?}", started.elapsed());
        // Nothing is killed once the process was reaped.
        assert!(process.has_exited() && !locked(&RUNNING).contains(&process.group));
        assert_eq!(process.end(), "exit status: 3");
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
