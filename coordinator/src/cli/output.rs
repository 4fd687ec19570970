//! Output of results to standard output or a file.

use super::error::CommandError;
use coordinator::presentation::report::answer::Answer;
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
/// [`CommandError::BadInput`].
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
    Err(unusable(file, fault))
}

/// The error of a destination that cannot be written.
pub fn unusable(file: &Path, fault: String) -> CommandError {
    CommandError::refused(format_args!("--out {}", file.display()), fault)
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

/// Whether `--out` names a file for an answer instead of a folder: a file or device that exists, or a name that ends as those of texts do.
pub fn is_file(out: &Path) -> bool {
    let ending = out.extension().map(|ending| ending.to_string_lossy().to_lowercase());
    let is_text = matches!(ending.as_deref(), Some("json" | "md" | "txt"));
    !out.is_dir() && (out.exists() || is_text)
}

/// Checks the destination of an answer, a file or a folder, before it is computed.
///
/// # Errors
/// [`CommandError::BadInput`].
pub fn check_answer_destination(out: Option<&Path>) -> Result<(), CommandError> {
    check_destination(out.filter(|out| is_file(out)))
}

/// Prints an answer, or with `as_json` its `document`. With `out` it also writes its files, NAME.json among them, to this folder, or
/// writes to this file what it would print.
///
/// # Errors
/// [`CommandError::Report`], [`CommandError::ResultFile`], [`CommandError::Output`].
pub fn answer_with(
    answer: &Answer,
    document: &impl Serialize,
    out: Option<&Path>,
    as_json: bool,
) -> Result<(), CommandError> {
    let json = to_json(document)?;
    let mut printed = if as_json { json.clone() } else { answer.text() };
    match out {
        Some(file) if is_file(file) => return Ok(write_text(file, &printed)?),
        Some(folder) => {
            let page = answer.write(folder)?;
            write_text(&folder.join(format!("{}.json", answer.name)), &json)?;
            if !as_json {
                printed += &format!("\npage: {}\n", page.display());
            }
        }
        None => {}
    }
    print(&printed)
}
