//! Where the program of a command is, and whether it can be executed.

use std::io::{Error, ErrorKind, Result};
use std::path::{Path, PathBuf};

/// Path of the program of a command: a relative path starts at `folder`, a bare name is searched for by the system.
///
/// # Errors
/// The command is empty.
pub fn program_path(command: &[String], folder: &Path) -> Result<PathBuf> {
    let Some(program) = command.first() else {
        return Err(Error::other("the command is empty"));
    };
    let named = PathBuf::from(program);
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
    let found = std::fs::metadata(file).map_err(|error| match error.kind() {
        ErrorKind::NotFound => {
            Error::new(ErrorKind::NotFound, format!("there is no file {}", file.display()))
        }
        _ => error,
    })?;
    if found.is_file() && found.permissions().mode() & 0o111 != 0 {
        return Ok(());
    }
    let reason = format!("{} may not be executed; allow it with chmod +x", file.display());
    Err(Error::new(ErrorKind::PermissionDenied, reason))
}
