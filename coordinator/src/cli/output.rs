//! Where results go: standard output or a file.

use super::error::CommandError;
use coordinator::result_files::write_text;
use serde::Serialize;
use std::io::Write;
use std::path::Path;

/// A result as JSON text with its last newline.
pub fn to_json(result: &impl Serialize) -> Result<String, CommandError> {
    let mut text = serde_json::to_string_pretty(result)?;
    text.push('\n');
    Ok(text)
}

/// Prints a text on standard output.
pub fn print(text: &str) -> Result<(), CommandError> {
    let mut out = std::io::stdout().lock();
    out.write_all(text.as_bytes()).and_then(|()| out.flush()).map_err(CommandError::Output)
}

/// Writes a text to a file, or prints it.
pub fn deliver(text: &str, file: Option<&Path>) -> Result<(), CommandError> {
    match file {
        None => print(text),
        Some(path) => Ok(write_text(path, text)?),
    }
}
