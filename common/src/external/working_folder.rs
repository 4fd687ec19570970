//! One run of a program in a working folder of its own, with files in and out.
//!
//! The folder has the files of the scene, its templates with the values of the sample, and `request.json`. The program
//! runs in it, once, to its end, and leaves its results in a file. The folder is removed afterwards; those of processes that were
//! killed, by the next process of this user that makes one.
//!
//! Templates: text files with values in the place of `{NAME}`, as pre-processors of other programs for design studies
//! use them.

use super::process::{LineError, Process};
use super::slot::StopSignal;
use crate::scene::{FileExchange, Program, REQUEST_FILE};
use std::fs::File;
use std::io::{Error, Read};
use std::path::{Path, PathBuf};
use std::sync::Once;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Duration;

/// Largest file of results [bytes].
const LARGEST_RESULTS: u64 = 64 << 20;
/// Stands for the folder of the program in its arguments.
const FOLDER: &str = "{folder}";
/// Stands for the name of the level of accuracy in its arguments, if the scene has levels.
const LEVEL: &str = "{level}";

/// Checks that the files of a program exist and its templates name inputs only.
///
/// # Errors
/// The first file that cannot be used, with its name.
pub fn check(program: &Program, exchange: &FileExchange, names: &[String]) -> Result<(), Error> {
    let folder = Path::new(&program.folder);
    for name in &exchange.templates {
        filled_template(folder, name, names, &vec![0.0; names.len()])?;
    }
    exchange.files.iter().try_for_each(|name| check_file(folder, name))
}

/// Runs a program, in whose arguments `{folder}` stands for its folder, for the values `(d,)` of its inputs by their names `(d,)`, which the
/// `request` has as JSON, at a level; the text of its results. A program that ends with status 0 and without results counts as ended.
///
/// # Errors
/// A file of the scene cannot be used, or the program cannot be started.
pub fn run(
    (program, exchange): (&Program, &FileExchange),
    (names, values): (&[String], &[f64]),
    (level, request): (Option<&str>, &str),
    timeout: Duration,
    stop: &StopSignal,
) -> Result<Result<String, LineError>, Error> {
    let (folder, from) = (WorkingFolder::create()?, Path::new(&program.folder));
    for name in &exchange.files {
        let copied = folder.place(name).and_then(|to| std::fs::copy(from.join(name), to));
        copied.map_err(|error| in_file(name, &error))?;
    }
    for name in &exchange.templates {
        let filled = filled_template(from, name, names, values)?;
        folder.place(name).and_then(|to| std::fs::write(to, filled)).map_err(|e| in_file(name, &e))?;
    }
    std::fs::write(folder.0.join(REQUEST_FILE), request)?;
    let place = from.canonicalize().unwrap_or_else(|_| from.to_path_buf());
    let mut command = program.command.clone();
    for argument in &mut command[1..] {
        *argument = argument.replace(FOLDER, &place.display().to_string());
        if let Some(level) = level {
            *argument = argument.replace(LEVEL, level);
        }
    }
    let mut process = Process::start(&command, &place, &folder.0, stop.contact)?;
    let results = process.complete(timeout, stop).and_then(|()| {
        read_results(&folder.0.join(&exchange.results)).map_err(|reason| LineError::Ended {
            status: format!("exit status: 0 and no {} ({reason})", exchange.results),
            stderr: process.last_lines(),
        })
    });
    // Before its folder is removed.
    process.kill();
    Ok(results)
}

/// The text of a template in `folder` with these values.
fn filled_template(folder: &Path, name: &str, names: &[String], values: &[f64]) -> Result<String, Error> {
    let text = std::fs::read_to_string(folder.join(name)).map_err(|e| in_file(name, &e))?;
    fill(&text, names, values).map_err(|unknown| in_file(name, &unknown))
}

fn read_results(path: &Path) -> Result<String, Error> {
    let mut text = String::new();
    if File::open(path)?.take(LARGEST_RESULTS + 1).read_to_string(&mut text)? as u64 > LARGEST_RESULTS {
        return Err(Error::other(format!("more than {LARGEST_RESULTS} bytes")));
    }
    Ok(text)
}

/// Checks that a folder has a file.
///
/// # Errors
/// It has none, with its name.
pub fn check_file(folder: &Path, name: &str) -> Result<(), Error> {
    let about = std::fs::metadata(folder.join(name)).map_err(|e| in_file(name, &e))?;
    if about.is_file() { Ok(()) } else { Err(in_file(name, &"not a file")) }
}

fn in_file(name: &str, reason: &dyn std::fmt::Display) -> Error {
    Error::other(format!("{name}: {reason}"))
}

/// Age below which a folder without a lock may be about to be locked.
const NEW: Duration = Duration::from_secs(60);

/// Beginning of the names of working folders.
const PREFIX: &str = "hingewise-";

/// A new folder for temporary files, removed when dropped. Its process holds a lock on it, which ends with the process however that ends.
#[derive(Debug)]
struct WorkingFolder(PathBuf, #[expect(dead_code, reason = "kept for its lock")] File);

impl WorkingFolder {
    fn create() -> Result<Self, Error> {
        use std::os::unix::fs::DirBuilderExt;
        static NUMBER: AtomicU64 = AtomicU64::new(0);
        static ABANDONED: Once = Once::new();
        ABANDONED.call_once(|| remove_abandoned(&std::env::temp_dir(), NEW));
        loop {
            let number = NUMBER.fetch_add(1, Ordering::Relaxed);
            let name = format!("{PREFIX}{}-{number}", std::process::id());
            let path = std::env::temp_dir().join(name);
            match std::fs::DirBuilder::new().mode(0o700).create(&path) {
                Ok(()) => {
                    let lock = File::open(&path)?;
                    // A file system without locks leaves the folder to the user if the process is killed.
                    let _ = lock.try_lock();
                    return Ok(Self(path, lock));
                }
                // Of an earlier process with this number that was killed.
                Err(error) if error.kind() == std::io::ErrorKind::AlreadyExists => {}
                Err(error) => return Err(error),
            }
        }
    }

    /// Path of a file, whose folder is made.
    fn place(&self, name: &str) -> Result<PathBuf, Error> {
        let path = self.0.join(name);
        std::fs::create_dir_all(path.parent().unwrap_or(Path::new(".")))?;
        Ok(path)
    }
}

/// Removes the working folders in `place` that no process has locked and that have not changed for `at_least`.
fn remove_abandoned(place: &Path, at_least: Duration) {
    for entry in std::fs::read_dir(place).into_iter().flatten().flatten() {
        let name = entry.file_name();
        let is_ours = name.to_str().and_then(|name| name.strip_prefix(PREFIX)).is_some_and(|rest| {
            let number = |word: &str| word.parse::<u64>().is_ok();
            rest.split_once('-').is_some_and(|(process, folder)| number(process) && number(folder))
        });
        // Of the entry itself: a link is no folder.
        let Some(about) = entry.metadata().ok().filter(|about| is_ours && about.is_dir()) else { continue };
        let is_old = about.modified().is_ok_and(|at| at.elapsed().is_ok_and(|age| age >= at_least));
        let lock = File::open(entry.path());
        if is_old
            && lock.is_ok_and(|lock| lock.try_lock().is_ok())
            && std::fs::remove_dir_all(entry.path()).is_ok()
        {
            tracing::info!("{} of a process that was killed is removed", entry.path().display());
        }
    }
}

impl Drop for WorkingFolder {
    fn drop(&mut self) {
        if let Err(error) = std::fs::remove_dir_all(&self.0) {
            tracing::warn!("{} cannot be removed: {error}", self.0.display());
        }
    }
}

/// Replaces each `{NAME}` by the value of that input, in the shortest decimal form that gives the same number, e.g. `0.02`
/// or `2.06e11`. `{{NAME}}` becomes `{NAME}`. Braces around anything but an input or a word (letters, digits and `_`, not
/// first a digit) stay as they are.
///
/// # Errors
/// A name that is no input, with its line and the names of the inputs.
pub fn fill(template: &str, names: &[String], values: &[f64]) -> Result<String, String> {
    let mut filled = String::with_capacity(template.len());
    let mut rest = template;
    while let Some(at) = rest.find('{') {
        filled.push_str(&rest[..at]);
        rest = &rest[at..];
        if let Some(name) = rest.strip_prefix('{').and_then(|inner| in_braces(inner, names))
            && rest[name.len() + 3..].starts_with('}')
        {
            filled.extend(["{", name, "}"]);
            rest = &rest[name.len() + 4..];
        } else if let Some(name) = in_braces(rest, names) {
            let Some(input) = names.iter().position(|input| input == name) else {
                let line = 1 + template[..template.len() - rest.len()].matches('\n').count();
                let inputs = names.join(", ");
                return Err(format!(
                    "line {line}: {{{name}}} is not an input; the inputs are {inputs}; the text itself is written {{{{{name}}}}}"
                ));
            };
            filled.push_str(&number(values[input]));
            rest = &rest[name.len() + 2..];
        } else {
            filled.push('{');
            rest = &rest[1..];
        }
    }
    filled.push_str(rest);
    Ok(filled)
}

/// The name in the braces at the start of `text`: an input, or a word.
fn in_braces<'t>(text: &'t str, names: &[String]) -> Option<&'t str> {
    let inside = text.strip_prefix('{')?;
    let name = &inside[..inside.find('}')?];
    let word = |c: char| c.is_alphanumeric() || c == '_';
    let is_word = name.chars().all(word) && name.chars().next().is_some_and(|first| !first.is_ascii_digit());
    (is_word || names.iter().any(|input| input == name)).then_some(name)
}

/// The shortest decimal text of a number: plain where that is short, otherwise with an exponent.
fn number(value: f64) -> String {
    let magnitude = value.abs();
    if value == 0.0 || (1e-4..1e7).contains(&magnitude) { format!("{value:?}") } else { format!("{value:e}") }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn issue_working_folders_of_killed_processes_stayed() {
        let place = tempfile::tempdir().unwrap();
        let made = |name: &str| {
            let path = place.path().join(name);
            std::fs::create_dir(&path).unwrap();
            std::fs::write(path.join("results.json"), "{}").unwrap();
            path
        };
        let (abandoned, held) = (made("hingewise-4000000-0"), made("hingewise-4000001-7"));
        let (other, named) = (made("hingewise-study"), made("other-1-2"));
        let link = place.path().join("hingewise-1-1");
        std::os::unix::fs::symlink(&other, &link).unwrap();
        let lock = File::open(&held).unwrap();
        lock.try_lock().unwrap();
        remove_abandoned(place.path(), NEW);
        assert!(abandoned.exists(), "it is new");
        remove_abandoned(place.path(), Duration::ZERO);
        assert!(!abandoned.exists());
        assert!(held.exists() && other.exists() && named.exists() && link.exists());
        drop(lock);
        remove_abandoned(place.path(), Duration::ZERO);
        assert!(!held.exists());
    }

    fn filled(template: &str) -> Result<String, String> {
        fill(template, &["E".into(), "width_2".into()], &[2.06e11, 0.1 + 0.2])
    }

    #[test]
    fn values_take_the_place_of_names() {
        assert_eq!(
            filled("*ELASTIC\n{E}, 0.3\n{width_2}").unwrap(),
            "*ELASTIC\n2.06e11, 0.3\n0.30000000000000004"
        );
        // What is no name in braces stays.
        let code = "void f() { return {1}; } {} { E } {E.x} {-E}{";
        assert_eq!(filled(code).unwrap(), code);
        assert_eq!(filled("{{E}} = {E}, {{other}}").unwrap(), "{E} = 2.06e11, {other}");
    }

    #[test]
    fn numbers_keep_every_bit() {
        for value in [0.02, -1e-5, 5e-324, f64::MAX, 1.0 / 3.0, 123_456_789.0, -0.0] {
            assert_eq!(number(value).parse::<f64>().unwrap().to_bits(), value.to_bits(), "{}", number(value));
        }
    }

    #[test]
    fn a_misspelt_name_is_refused_with_its_line() {
        let error = filled("a\nb {Width} c").unwrap_err();
        let said = "line 2: {Width} is not an input; the inputs are E, width_2; the text itself is written {{Width}}";
        assert_eq!(error, said);
    }
}
