//! Output of results to standard output or a file.

use super::error::{CommandError, Done};
use clap::builder::{PathBufValueParser, TypedValueParser, ValueParser, ValueParserFactory};
use coordinator::presentation::report::answer::Answer;
use coordinator::results::result_files::{create_folder, write_text};
use serde::Serialize;
use std::io::Write;
use std::path::{Path, PathBuf};

/// A count with its noun, e.g. `1 joint`, `0 loads`.
pub fn count(n: usize, noun: &str) -> String {
    format!("{n} {noun}{}", if n == 1 { "" } else { "s" })
}

/// A result as JSON text that ends with a newline.
///
/// # Errors
/// [`CommandError::Json`].
pub fn to_json(result: &impl Serialize) -> Done<String> {
    let mut text = serde_json::to_string_pretty(result)?;
    text.push('\n');
    Ok(text)
}

/// Prints a text on standard output.
///
/// # Errors
/// [`CommandError::Output`].
pub fn print(text: &str) -> Done {
    let mut out = std::io::stdout().lock();
    out.write_all(text.as_bytes()).and_then(|()| out.flush()).map_err(CommandError::Output)
}

/// Checks the destination of a result before the result is computed.
///
/// # Errors
/// [`CommandError::BadInput`].
pub fn check_destination(file: Option<&Path>) -> Done {
    let Some(file) = file else { return Ok(()) };
    fault_of_file(file).map_or(Ok(()), |fault| Err(unusable(file, fault)))
}

/// What is wrong with a file as a destination.
fn fault_of_file(file: &Path) -> Option<String> {
    let folder = or_here(file.parent().unwrap_or(file));
    if file.is_dir() {
        return Some("is a folder, expected a file".to_owned());
    }
    (!folder.is_dir()).then(|| format!("there is no folder {}", folder.display()))
}

/// The file that `--out` names: the path itself if it has an ending or is a file, else the file `name` in this folder, which is created.
///
/// # Errors
/// [`CommandError::BadInput`], [`CommandError::ResultFile`].
pub fn file_of(out: &Path, name: &str) -> Done<PathBuf> {
    if !out.is_dir() && (out.exists() || out.extension().is_some()) {
        check_destination(Some(out))?;
        return Ok(out.to_owned());
    }
    create_folder(out)?;
    Ok(out.join(name))
}

/// A folder, or the working folder where its path is empty.
pub fn or_here(folder: &Path) -> &Path {
    if folder.as_os_str().is_empty() { Path::new(".") } else { folder }
}

/// The error of a destination that cannot be written.
pub fn unusable(file: &Path, fault: String) -> CommandError {
    CommandError::refused(format_args!("--out {}", file.display()), fault)
}

/// Writes a text to a file, or prints it.
///
/// # Errors
/// [`CommandError::ResultFile`], [`CommandError::Output`].
pub fn deliver(text: &str, file: Option<&Path>) -> Done {
    match file {
        None => print(text),
        Some(path) => Ok(write_text(path, text)?),
    }
}

/// Where the files of an answer go, checked when the command line is read: before anything is computed.
#[derive(Debug, Clone, PartialEq)]
pub enum Destination {
    /// A file for what is printed otherwise.
    File(PathBuf),
    /// A folder, which is created if missing.
    Folder(PathBuf),
}

impl Destination {
    /// A file or device that exists, or a name that ends as those of texts do; else a folder.
    fn read(out: PathBuf) -> Result<Self, String> {
        let ending = out.extension().map(|ending| ending.to_string_lossy().to_lowercase());
        let is_text = matches!(ending.as_deref(), Some("json" | "md" | "txt"));
        if !out.is_dir() && (out.exists() || is_text) {
            return fault_of_file(&out).map_or(Ok(Self::File(out)), Err);
        }
        let nearest = out.ancestors().map(or_here).find(|folder| folder.exists()).unwrap_or(Path::new("/"));
        let shown = nearest.display();
        if !nearest.is_dir() {
            return Err(format!("{shown} is a file, expected a folder"));
        }
        if nearest.metadata().is_ok_and(|found| found.permissions().readonly()) {
            return Err(format!("nothing can be written to {shown}"));
        }
        Ok(Self::Folder(out))
    }
}

impl ValueParserFactory for Destination {
    type Parser = ValueParser;

    fn value_parser() -> ValueParser {
        PathBufValueParser::new().try_map(Self::read).into()
    }
}

/// Prints an answer, or with `as_json` its `document`. With `out` it also writes its files, NAME.json among them, to this folder, or
/// writes to this file what it would print.
///
/// # Errors
/// [`CommandError::ResultFile`], [`CommandError::Output`].
pub fn answer_with(
    answer: &Answer,
    document: &impl Serialize,
    out: Option<&Destination>,
    as_json: bool,
) -> Done {
    let json = to_json(document)?;
    let mut printed = if as_json { json.clone() } else { answer.text() };
    match out {
        Some(Destination::File(file)) => return Ok(write_text(file, &printed)?),
        Some(Destination::Folder(folder)) => {
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
