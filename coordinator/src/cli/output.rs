//! Output of results to standard output or a file.

use super::error::CommandError;
use coordinator::results::result_files::write_text;
use serde::Serialize;
use std::io::Write;
use std::path::Path;

/// A count with its noun, e.g. `1 joint`, `0 loads`.
pub fn count(n: usize, noun: &str) -> String {
    format!("{n} {noun}{}", if n == 1 { "" } else { "s" })
}

/// A result as JSON text that ends with a newline.
///
/// # Errors
/// [`CommandError::Json`].
pub fn to_json(result: &impl Serialize) -> Result<String, CommandError> {
    let mut text = serde_json::to_string_pretty(result)?;
    text.push('\n');
    Ok(text)
}

/// Prints a text on standard output.
///
/// # Errors
/// [`CommandError::Output`].
pub fn print(text: &str) -> Result<(), CommandError> {
    let mut out = std::io::stdout().lock();
    out.write_all(text.as_bytes()).and_then(|()| out.flush()).map_err(CommandError::Output)
}

/// Checks the destination of a result before the result is computed.
///
/// # Errors
/// [`CommandError::Destination`].
pub fn check_destination(file: Option<&Path>) -> Result<(), CommandError> {
    let Some(file) = file else { return Ok(()) };
    let folder = file.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let fault = if file.is_dir() {
        "is a folder, expected a file".to_owned()
    } else if !folder.is_dir() {
        format!("there is no folder {}", folder.display())
    } else {
        return Ok(());
    };
    Err(CommandError::Destination { file: file.to_path_buf(), fault })
}

/// Writes a text to a file, or prints it.
///
/// # Errors
/// [`CommandError::ResultFile`], [`CommandError::Output`].
pub fn deliver(text: &str, file: Option<&Path>) -> Result<(), CommandError> {
    match file {
        None => print(text),
        Some(path) => Ok(write_text(path, text)?),
    }
}
