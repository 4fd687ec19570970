//! The process group of a program ends with the process that started it, even if that one is killed and can end nothing. A program
//! that may not run without contact also ends if that process is stopped (SIGSTOP) and can end nothing.
//!
//! The program is started by a shell. Before it executes the program, the shell starts a guard in the same process group,
//! which reads from a pipe to which nothing is ever written. When the end for writing is closed, the guard kills the group. A
//! program that ends before, or is killed at its time limit, takes the guard of its group with it. A program that moves to another
//! process group or session has no guard.
//!
//! The end for writing belongs to this process alone, so that the system closes it when this process ends, by whatever cause. For
//! programs that need contact it belongs to another process, the [`Watch`], which ends with this process too, and when this process
//! has not sent it a new time limit within the last one ([`limit_contact`]).

use crate::locks::locked;
use rustix::io::{FdFlags, fcntl_setfd};
use std::collections::BTreeMap;
use std::io::{Error, ErrorKind, PipeReader, PipeWriter, Result, Write};
use std::os::fd::AsRawFd;
use std::os::unix::process::CommandExt;
use std::path::{Path, PathBuf};
use std::process::{Child, ChildStdin, Command, Stdio};
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

/// Script of the shell; its arguments are the number of the pipe and the command.
///
/// The guard is no child process of the program, which may wait for all of its own, and has none of its pipes. Without
/// `/dev/fd` there is no guard.
const SCRIPT: &str =
    "( { read -r _; kill -s KILL 0; } >/dev/null 2>&1 </dev/fd/\"$0\" & ) 2>/dev/null; exec \"$@\"";

/// Script of the watch: each line of its standard input is the time until the next one [s], 0 for any time. Without the program
/// `timeout` only the end of this process ends it.
const WATCH: &str = "\
if command -v timeout >/dev/null; then
    limit=0
    while limit=$(timeout \"$limit\" sh -c 'read -r limit && echo \"$limit\"'); do :; done
else
    while read -r _; do :; done
fi";

/// Longest time in which the end of a watch is visible after it has killed a program.
const WATCH_ENDS: Duration = Duration::from_millis(200);
/// Interval at which that is polled.
const POLL: Duration = Duration::from_millis(5);

/// Guards of programs that need no contact (`None`), and of those that need it, by the number of the contact.
static GUARDS: Mutex<BTreeMap<Option<usize>, Arc<Guard>>> = Mutex::new(BTreeMap::new());

/// What ends the programs that were started under it.
#[derive(Debug)]
pub struct Guard {
    /// End of the pipe for reading, inherited by all programs.
    reader: PipeReader,
    /// End for writing, which the system closes with this process; none if the watch has it.
    _writer: Option<PipeWriter>,
    watch: Option<Mutex<Watch>>,
}

/// The process that ends without contact.
#[derive(Debug)]
struct Watch {
    /// Time limits; closed first.
    limits: Option<ChildStdin>,
    process: Child,
}

impl Guard {
    fn new(needs_contact: bool) -> Result<Self> {
        let (reader, writer) = std::io::pipe()?;
        // The end for writing is closed when a program is executed.
        fcntl_setfd(&reader, FdFlags::empty())?;
        if !needs_contact {
            return Ok(Self { reader, _writer: Some(writer), watch: None });
        }
        let mut shell = Command::new("/bin/sh");
        // Signals of a terminal to this process do not reach it.
        shell.args(["-c", WATCH]).process_group(0);
        shell.stdin(Stdio::piped()).stdout(writer).stderr(Stdio::null());
        let mut process = shell.spawn()?;
        let watch = Watch { limits: process.stdin.take(), process };
        Ok(Self { reader, _writer: None, watch: Some(Mutex::new(watch)) })
    }

    /// True if it has ended its programs for lack of contact. It is called when one of them was killed.
    pub fn has_ended_programs(&self) -> bool {
        let Some(watch) = &self.watch else { return false };
        let killed = Instant::now();
        loop {
            if !matches!(locked(watch).process.try_wait(), Ok(None)) {
                return true;
            }
            if killed.elapsed() > WATCH_ENDS {
                return false;
            }
            std::thread::sleep(POLL);
        }
    }

    /// Sends a time limit to the watch.
    fn limit(&self, seconds: u64) -> Result<()> {
        let Some(watch) = &self.watch else { return Ok(()) };
        let watch = &mut *locked(watch);
        let limits = watch.limits.as_mut().ok_or_else(|| Error::other("the watch has no input"))?;
        limits.write_all(format!("{seconds}\n").as_bytes())
    }
}

impl Drop for Watch {
    fn drop(&mut self) {
        self.limits = None;
        // It may have ended already.
        let _ = self.process.kill();
        let _ = self.process.wait();
    }
}

/// The command with a guard, to be started as the leader of a process group, and that guard. A relative path of the program
/// starts at `folder`. With `contact`, the program ends without that contact.
///
/// # Errors
/// The program is missing or not executable, or the system has no more pipes or processes.
pub fn guarded(command: &[String], folder: &Path, contact: Option<usize>) -> Result<(Command, Arc<Guard>)> {
    check_executable(command, folder)?;
    let guard = guard_of(&mut locked(&GUARDS), contact)?;
    let mut shell = Command::new("/bin/sh");
    shell.args(["-c", SCRIPT, &guard.reader.as_raw_fd().to_string()]);
    shell.arg(program_path(command, folder)?).args(&command[1..]);
    Ok((shell, guard))
}

/// Ends the programs that need `contact` once `limit`, rounded down to whole seconds, has passed without another call, also if
/// this process is stopped; without a limit, when this process ends. If they were ended before, programs can be started again.
///
/// # Errors
/// The system has no more pipes or processes.
pub fn limit_contact(contact: usize, limit: Option<Duration>) -> Result<()> {
    let mut guards = locked(&GUARDS);
    // No limit is 0.
    let seconds = limit.map_or(0, |limit| limit.as_secs().max(1));
    let guard = guard_of(&mut guards, Some(contact))?;
    if guard.limit(seconds).is_err() {
        guards.remove(&Some(contact));
        guard_of(&mut guards, Some(contact))?.limit(seconds)?;
    }
    Ok(())
}

fn guard_of(guards: &mut BTreeMap<Option<usize>, Arc<Guard>>, contact: Option<usize>) -> Result<Arc<Guard>> {
    if let Some(guard) = guards.get(&contact) {
        return Ok(Arc::clone(guard));
    }
    let guard = Arc::new(Guard::new(contact.is_some())?);
    guards.insert(contact, Arc::clone(&guard));
    Ok(guard)
}

/// Path of the program of a command: a relative path starts at `folder`, a bare name is searched for by the system.
///
/// # Errors
/// The command is empty.
pub fn program_path(command: &[String], folder: &Path) -> Result<PathBuf> {
    let named = PathBuf::from(command.first().ok_or_else(|| Error::other("the command is empty"))?);
    Ok(if named.components().count() > 1 { folder.join(named) } else { named })
}

/// Fails like the start of a command in `folder` would if its program is missing or not executable.
///
/// # Errors
/// What is wrong, and what can be done.
pub fn check_executable(command: &[String], folder: &Path) -> Result<()> {
    let named = program_path(command, folder)?;
    if !folder.is_dir() {
        return Err(Error::new(ErrorKind::NotADirectory, "there is no such folder"));
    }
    if named.components().count() > 1 {
        return is_executable(&named);
    }
    let path = std::env::var_os("PATH").unwrap_or_default();
    let missing = "there is no such program in the folders of PATH; install it, or give its path";
    let mut reason = Error::new(ErrorKind::NotFound, missing);
    for folder in std::env::split_paths(&path) {
        match is_executable(&folder.join(&named)) {
            Ok(()) => return Ok(()),
            // A file without permission says more than a missing one.
            Err(error) if error.kind() == ErrorKind::PermissionDenied => reason = error,
            Err(_) => {}
        }
    }
    Err(reason)
}

fn is_executable(file: &Path) -> Result<()> {
    use std::os::unix::fs::PermissionsExt;
    let name = file.display();
    let found = std::fs::metadata(file).map_err(|error| match error.kind() {
        ErrorKind::NotFound => Error::new(ErrorKind::NotFound, format!("there is no file {name}")),
        _ => error,
    })?;
    if found.is_file() && found.permissions().mode() & 0o111 != 0 {
        return Ok(());
    }
    let reason = format!("{name} may not be executed; allow it with chmod +x");
    Err(Error::new(ErrorKind::PermissionDenied, reason))
}
