//! The process group of a program ends with the process that started it, even if that one is killed and can end nothing.
//!
//! The program is started by a shell. Before it executes the program, the shell starts a guard in the same process group,
//! which reads from a pipe that only this process can write to, and never does. When this process ends, by whatever cause,
//! the system closes the pipe, and the guard kills the group. A program that ends before, or is killed at its time limit,
//! takes the guard of its group with it. A program that moves to another process group or session has no guard.

use super::executable::{check_executable, program_path};
use rustix::io::{FdFlags, fcntl_setfd};
use std::io::{Error, PipeReader, PipeWriter, Result};
use std::os::fd::AsRawFd;
use std::path::Path;
use std::process::Command;
use std::sync::Mutex;

/// Script of the shell; its arguments are the number of the pipe and the command.
///
/// The guard is no child process of the program, which may wait for all of its own, and has none of its pipes. Without
/// `/dev/fd` there is no guard.
const SCRIPT: &str =
    "( { read -r _; kill -s KILL 0; } >/dev/null 2>&1 </dev/fd/\"$0\" & ) 2>/dev/null; exec \"$@\"";

/// The pipe: its end for writing is inherited by no program, its end for reading by all.
static PIPE: Mutex<Option<(PipeReader, PipeWriter)>> = Mutex::new(None);

/// The command with a guard, to be started as the leader of a process group. A relative path of the program starts at
/// `folder`.
///
/// # Errors
/// The program is missing or not executable, or the system has no more pipes.
pub fn guarded(command: &[String], folder: &Path) -> Result<Command> {
    check_executable(command, folder)?;
    let mut shell = Command::new("/bin/sh");
    shell.args(["-c", SCRIPT, &pipe()?.to_string()]);
    shell.arg(program_path(command, folder)?).args(&command[1..]);
    Ok(shell)
}

/// Number of the pipe's end for reading.
fn pipe() -> Result<i32> {
    let mut pipe = PIPE.lock().map_err(|_| Error::other("the pipe of the guards is locked"))?;
    if pipe.is_none() {
        let (reader, writer) = std::io::pipe()?;
        // The end for writing is closed when a program is executed.
        fcntl_setfd(&reader, FdFlags::empty())?;
        *pipe = Some((reader, writer));
    }
    pipe.as_ref().map(|(reader, _)| reader.as_raw_fd()).ok_or_else(|| Error::other("there is no pipe"))
}
