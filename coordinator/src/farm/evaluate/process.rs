//! A program that lives on between requests: a line in, a line out. It runs in a process group of its own, so that a
//! signal to the study does not reach it, and all that it started ends with it.

use super::slots::{NoMessage, Stop};
use rustix::process::{Pid, Signal, kill_process_group};
use std::collections::{BTreeSet, VecDeque};
use std::io::{BufRead, BufReader, Read, Write};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::sync::mpsc::{Receiver, Sender, channel};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

/// Longest line that is read [bytes].
const LONGEST_LINE: u64 = 64 << 20;
/// Lines of standard error that are kept, and bytes of each.
const KEPT_LINES: usize = 5;
const KEPT_OF_LINE: usize = 400;
/// How long a program may take to leave once its input has ended.
const FAREWELL: Duration = Duration::from_millis(500);
/// How often that is looked at.
const GLANCE: Duration = Duration::from_millis(5);

/// Process groups that run now.
static RUNNING: Mutex<BTreeSet<i32>> = Mutex::new(BTreeSet::new());

/// Ends every program that was started here, for a process that is about to end without dropping anything.
pub fn kill_all() {
    for group in &*locked(&RUNNING) {
        kill_group(*group);
    }
}

/// Why there is no line.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum NoLine {
    /// None within the time given.
    TooLate,
    /// The program has ended.
    Ended {
        /// How, e.g. `exit status: 3`.
        status: String,
        /// The last lines of its standard error.
        stderr: String,
    },
    /// The user wants to stop.
    Stopped,
}

/// A program at work. Dropped, it is asked to leave by the end of its input, and ended if it does not.
#[derive(Debug)]
pub struct Process {
    child: Child,
    group: i32,
    /// To the thread that writes; the program's input ends when this is dropped.
    input: Option<Sender<String>>,
    lines: Receiver<String>,
    stderr: Arc<Mutex<VecDeque<String>>>,
}

impl Process {
    /// Starts a program, a word and its arguments, in a folder. A program that is named by a path is looked for from
    /// there.
    ///
    /// # Errors
    /// The system cannot start it.
    pub fn start(command: &[String], folder: &Path) -> std::io::Result<Self> {
        use std::os::unix::process::CommandExt;
        let [program, arguments @ ..] = command else {
            return Err(std::io::Error::other("no program is named"));
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
        let (Some(mut to), Some(from), Some(complaints)) = pipes else { unreachable!("all three are piped") };
        spawn("input", move || {
            // Whoever does not read any more is found out by what it does not answer.
            while let Ok(request) = requests.recv()
                && to.write_all(request.as_bytes()).and_then(|()| to.flush()).is_ok()
            {}
        })?;
        spawn("output", move || each_line(from, |line| sender.send(line).is_ok()))?;
        spawn("stderr", move || {
            each_line(complaints, |line| {
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

    /// Sends a line, which ends with a newline, and waits for the next one in return.
    ///
    /// # Errors
    /// [`NoLine`].
    pub fn ask(&mut self, line: String, patience: Duration, stop: &Stop) -> Result<String, NoLine> {
        if let Some(input) = &self.input {
            // The thread that writes has left: the program has ended, and so will its output.
            let _ = input.send(line);
        }
        stop.wait(&self.lines, patience).map_err(|none| match none {
            NoMessage::TooLate => NoLine::TooLate,
            NoMessage::Stopped => NoLine::Stopped,
            NoMessage::Ended => {
                let status = self.leave();
                // What it wrote before it ended may still be on its way.
                self.wait_for_complaints();
                let stderr = locked(&self.stderr).iter().cloned().collect::<Vec<_>>().join(" / ");
                NoLine::Ended { status, stderr }
            }
        })
    }

    /// Ends the program at once, with all that it started.
    pub fn kill(mut self) {
        self.end();
    }

    /// Waits a little for the end of the program, then sees to it; how it ended.
    fn leave(&mut self) -> String {
        self.input = None;
        let started = Instant::now();
        loop {
            match self.child.try_wait() {
                Ok(Some(status)) => return status.to_string(),
                Ok(None) if started.elapsed() < FAREWELL => std::thread::sleep(GLANCE),
                _ => {
                    self.end();
                    return "its standard output closed".to_owned();
                }
            }
        }
    }

    /// Waits a little until nobody writes to standard error any more.
    fn wait_for_complaints(&self) {
        let started = Instant::now();
        while Arc::strong_count(&self.stderr) > 1 && started.elapsed() < FAREWELL {
            std::thread::sleep(GLANCE);
        }
    }

    fn end(&mut self) {
        kill_group(self.group);
        // It was killed: all there is to wait for is the system.
        let _ = self.child.wait();
    }
}

impl Drop for Process {
    fn drop(&mut self) {
        self.leave();
        // What it started and left behind.
        kill_group(self.group);
        locked(&RUNNING).remove(&self.group);
    }
}

fn kill_group(group: i32) {
    if let Some(group) = Pid::from_raw(group) {
        // A group that is gone needs no killing.
        let _ = kill_process_group(group, Signal::KILL);
    }
}

/// Gives every line to `take`, without its end, until there are no more or it wants none.
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

/// Nobody panics with one of these locks held.
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

    fn ask(process: &mut Process, line: &str, patience: Duration) -> Result<String, NoLine> {
        process.ask(format!("{line}\n"), patience, &Stop::default())
    }

    #[test]
    fn lines_go_back_and_forth() {
        let mut process = shell("while read line; do echo \"got $line\"; done");
        for k in 0..100 {
            assert_eq!(ask(&mut process, &k.to_string(), PATIENCE), Ok(format!("got {k}")));
        }
    }

    #[test]
    fn an_end_is_told_with_status_and_last_words() {
        let mut process = shell("read line; for k in 1 2 3 4 5 6; do echo no $k >&2; done; exit 3");
        let stderr = "no 2 / no 3 / no 4 / no 5 / no 6".to_owned();
        let status = "exit status: 3".to_owned();
        assert_eq!(ask(&mut process, "go", PATIENCE), Err(NoLine::Ended { status, stderr }));
    }

    #[test]
    fn who_reads_nothing_and_says_nothing_is_too_late() {
        let mut process = shell("exec sleep 600");
        // More than a pipe holds.
        let line = "x".repeat(1 << 20);
        assert_eq!(ask(&mut process, &line, Duration::from_millis(100)), Err(NoLine::TooLate));
        process.kill();
    }

    #[test]
    fn what_a_program_started_ends_with_it() {
        let mut process = shell("sleep 600 & echo $!; read line; read line");
        let grandchild = ask(&mut process, "", PATIENCE).unwrap();
        let there = || Path::new("/proc").join(&grandchild).join("cmdline").exists();
        assert!(there() || !Path::new("/proc/self").exists());
        process.kill();
        let started = Instant::now();
        // The system takes it away when it gets to it; a zombie has no command line left.
        let alive = || {
            std::fs::read(Path::new("/proc").join(&grandchild).join("cmdline"))
                .is_ok_and(|line| !line.is_empty())
        };
        while alive() {
            assert!(started.elapsed() < PATIENCE, "process {grandchild} lives on");
            std::thread::yield_now();
        }
    }
}
