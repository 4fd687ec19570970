//! `worker --completions` and `worker --man`: the command line for shells and for `man`.

use clap::Command;
use clap_complete::Shell;
use std::io::{self, Write};

/// Name of the program, as shells know it.
const PROGRAM: &str = "worker";

/// Prints the completions of a command line for a shell.
///
/// # Errors
/// The error of standard output.
pub fn print_completions(mut command: Command, shell: Shell) -> io::Result<()> {
    let mut script = Vec::new();
    clap_complete::generate(shell, &mut command, PROGRAM, &mut script);
    io::stdout().write_all(&script)
}

/// Prints the manual page of a command line.
///
/// # Errors
/// The error of standard output.
pub fn print_manual(command: Command) -> io::Result<()> {
    let mut page = Vec::new();
    clap_mangen::Man::new(command).render(&mut page)?;
    io::stdout().write_all(&page)
}
