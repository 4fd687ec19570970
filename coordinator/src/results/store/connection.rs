//! Connections of SQLite to a campaign file.
//!
//! To read it, nothing is locked and nothing is written beside it, so that a study in a folder
//! without write permission can be read, and a study that is running.
//!
//! SQLite reads a file with a write-ahead log through a shared index in the file's folder. Where that index is missing and
//! cannot be created, a file without a log does not change and is read as it is; a file with a log, which a killed study
//! leaves, is read from a temporary copy. Where the folder can be written, SQLite creates index and log to read a file, and
//! removes them only at the end of a connection that may write: [`LeftFiles`] is such a connection after the last read.

use super::error::StoreError;
use rusqlite::{Connection, ErrorCode, OpenFlags};
use std::fmt::Debug;
use std::path::{Path, PathBuf};
use std::time::Duration;
use tempfile::TempDir;

/// Name of the campaign file in its folder.
pub const FILE_NAME: &str = "campaign.db";

/// Longest wait for a reader that holds the file.
const PATIENCE: Duration = Duration::from_secs(10);

/// Opens the file at `path`.
///
/// # Errors
/// [`StoreError::Database`].
pub fn connect(path: &Path, flags: OpenFlags) -> Result<Connection, StoreError> {
    let flags = flags | OpenFlags::SQLITE_OPEN_NO_MUTEX;
    let connection = Connection::open_with_flags(path, flags).map_err(StoreError::of(path))?;
    connection.busy_timeout(PATIENCE).map_err(StoreError::of(path))?;
    Ok(connection)
}

/// What is held until a campaign file is closed: the lock of its folder, the folder of the copy that is read, or [`LeftFiles`]; `()` beside a
/// running study and of a file that does not change.
pub type Held = Box<dyn Debug + Send>;

/// Removes index and log of the campaign file at this path when dropped, by a connection that may write. SQLite removes them if no
/// other connection uses the file.
#[derive(Debug)]
pub struct LeftFiles(PathBuf);

impl Drop for LeftFiles {
    fn drop(&mut self) {
        // Files that stay are of no harm: the next study that writes removes them.
        if let Ok(connection) = connect(&self.0, OpenFlags::SQLITE_OPEN_READ_WRITE) {
            let _ = has_no_table(&self.0, &connection);
        }
    }
}

/// Opens the campaign file at `path` for reading.
///
/// # Errors
/// [`StoreError::NotACampaign`], or what the file system or SQLite report.
pub fn connect_read_only(path: &Path) -> Result<(Connection, Held), StoreError> {
    let is_in_use = log_of(path).exists();
    // Beside other connections, and read from once.
    let opened = connect(path, OpenFlags::SQLITE_OPEN_READ_ONLY);
    match opened.and_then(|connection| has_no_table(path, &connection).map(|_| connection)) {
        Ok(connection) if is_in_use => Ok((connection, Box::new(()))),
        Ok(connection) => Ok((connection, Box::new(LeftFiles(path.to_path_buf())))),
        Err(error) if !needs_index(&error) => Err(named(path, error)),
        Err(_) if std::fs::metadata(log_of(path)).is_ok_and(|log| log.len() > 0) => from_copy(path),
        Err(_) => unchanging(path),
    }
}

/// Opens a file that no process changes.
pub(super) fn unchanging(path: &Path) -> Result<(Connection, Held), StoreError> {
    let flags =
        OpenFlags::SQLITE_OPEN_READ_ONLY | OpenFlags::SQLITE_OPEN_URI | OpenFlags::SQLITE_OPEN_NO_MUTEX;
    let uri = format!("file:{}?immutable=1", escaped(path));
    let connection = Connection::open_with_flags(uri, flags).map_err(StoreError::of(path))?;
    has_no_table(path, &connection).map_err(|error| named(path, error))?;
    Ok((connection, Box::new(())))
}

/// Copies the file with its log into a temporary folder and opens the copy.
pub(super) fn from_copy(path: &Path) -> Result<(Connection, Held), StoreError> {
    let failed = |source| StoreError::Folder(std::env::temp_dir(), source);
    let copy = TempDir::new().map_err(failed)?;
    let target = copy.path().join(FILE_NAME);
    for (from, to) in [(path.to_path_buf(), target.clone()), (log_of(path), log_of(&target))] {
        std::fs::copy(from, to).map_err(failed)?;
    }
    let connection = connect(&target, OpenFlags::SQLITE_OPEN_READ_WRITE)?;
    has_no_table(path, &connection).map_err(|error| named(path, error))?;
    Ok((connection, Box::new(copy)))
}

/// Whether the file has no table; an error if it cannot be read.
pub fn has_no_table(path: &Path, connection: &Connection) -> Result<bool, StoreError> {
    let sql = "SELECT count(*) = 0 FROM sqlite_schema";
    connection.query_row(sql, [], |row| row.get(0)).map_err(StoreError::of(path))
}

/// Whether the shared index is missing and cannot be created, e.g. on a full disk.
fn needs_index(error: &StoreError) -> bool {
    let StoreError::Database(_, source) = error else { return false };
    matches!(
        source.sqlite_error_code(),
        Some(ErrorCode::CannotOpen | ErrorCode::ReadOnly | ErrorCode::SystemIoFailure | ErrorCode::DiskFull)
    )
}

/// The error, by its own name for a file that is no database.
pub fn named(path: &Path, error: StoreError) -> StoreError {
    match error {
        StoreError::Database(_, source) if source.sqlite_error_code() == Some(ErrorCode::NotADatabase) => {
            StoreError::NotACampaign(path.into())
        }
        error => error,
    }
}

fn log_of(path: &Path) -> PathBuf {
    let mut log = path.as_os_str().to_owned();
    log.push("-wal");
    log.into()
}

/// A path as part of a URI.
fn escaped(path: &Path) -> String {
    let escaped = |byte: &u8| match byte {
        plain if plain.is_ascii_alphanumeric() || b"/-_.~".contains(plain) => char::from(*plain).to_string(),
        other => format!("%{other:02X}"),
    };
    path.as_os_str().as_encoded_bytes().iter().map(escaped).collect()
}
