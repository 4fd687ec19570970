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
use std::fmt::Write;
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
    let failed = |source| StoreError::Database { path: path.into(), source };
    let connection =
        Connection::open_with_flags(path, flags | OpenFlags::SQLITE_OPEN_NO_MUTEX).map_err(failed)?;
    connection.busy_timeout(PATIENCE).map_err(failed)?;
    Ok(connection)
}

/// A connection for reading.
pub struct ReadConnection {
    /// The connection to the campaign file or to its copy.
    pub connection: Connection,
    /// What is removed after the connection has ended.
    pub after: AfterReading,
}

/// What is removed after a file has been read.
#[derive(Debug, Default)]
#[allow(dead_code)] // kept for their Drop
pub struct AfterReading {
    /// Folder of the copy.
    pub copy: Option<TempDir>,
    /// Index and log that the connection created.
    pub left: Option<LeftFiles>,
}

/// Removes index and log of the campaign file at this path when dropped, by a connection that may write. SQLite removes them if no
/// other connection uses the file.
#[derive(Debug)]
pub struct LeftFiles(PathBuf);

impl Drop for LeftFiles {
    fn drop(&mut self) {
        // Files that stay are of no harm: the next study that writes removes them.
        if let Ok(connection) = connect(&self.0, OpenFlags::SQLITE_OPEN_READ_WRITE) {
            let _ = probe(&self.0, &connection);
        }
    }
}

/// Opens the campaign file at `path` for reading.
///
/// # Errors
/// [`StoreError::NotACampaign`], or what the file system or SQLite report.
pub fn connect_read_only(path: &Path) -> Result<ReadConnection, StoreError> {
    let is_in_use = log_of(path).exists();
    match shared(path) {
        Ok(connection) => {
            let left = (!is_in_use).then(|| LeftFiles(path.to_path_buf()));
            Ok(ReadConnection { connection, after: AfterReading { left, copy: None } })
        }
        Err(error) if !needs_index(&error) => Err(named(path, error)),
        Err(_) if has_log(path) => from_copy(path),
        Err(_) => unchanging(path),
    }
}

/// Opens the file beside other connections, and reads from it once.
fn shared(path: &Path) -> Result<Connection, StoreError> {
    let connection = connect(path, OpenFlags::SQLITE_OPEN_READ_ONLY)?;
    probe(path, &connection)?;
    Ok(connection)
}

/// Opens a file that no process changes.
pub(super) fn unchanging(path: &Path) -> Result<ReadConnection, StoreError> {
    let flags =
        OpenFlags::SQLITE_OPEN_READ_ONLY | OpenFlags::SQLITE_OPEN_URI | OpenFlags::SQLITE_OPEN_NO_MUTEX;
    let uri = format!("file:{}?immutable=1", escaped(path));
    let failed = |source| StoreError::Database { path: path.into(), source };
    let connection = Connection::open_with_flags(uri, flags).map_err(failed)?;
    probe(path, &connection).map_err(|error| named(path, error))?;
    Ok(ReadConnection { connection, after: AfterReading::default() })
}

/// Copies the file with its log into a temporary folder and opens the copy.
pub(super) fn from_copy(path: &Path) -> Result<ReadConnection, StoreError> {
    let failed = |source| StoreError::Folder { dir: std::env::temp_dir(), source };
    let copy = TempDir::new().map_err(failed)?;
    let target = copy.path().join(FILE_NAME);
    for (from, to) in [(path.to_path_buf(), target.clone()), (log_of(path), log_of(&target))] {
        std::fs::copy(from, to).map_err(failed)?;
    }
    let connection = connect(&target, OpenFlags::SQLITE_OPEN_READ_WRITE)?;
    probe(path, &connection).map_err(|error| named(path, error))?;
    Ok(ReadConnection { connection, after: AfterReading { copy: Some(copy), left: None } })
}

fn probe(path: &Path, connection: &Connection) -> Result<(), StoreError> {
    connection
        .query_row("SELECT count(*) FROM sqlite_schema", [], |_| Ok(()))
        .map_err(|source| StoreError::Database { path: path.into(), source })
}

/// Whether the shared index is missing and cannot be created, e.g. on a full disk.
fn needs_index(error: &StoreError) -> bool {
    let StoreError::Database { source, .. } = error else { return false };
    matches!(
        source.sqlite_error_code(),
        Some(ErrorCode::CannotOpen | ErrorCode::ReadOnly | ErrorCode::SystemIoFailure | ErrorCode::DiskFull)
    )
}

fn named(path: &Path, error: StoreError) -> StoreError {
    match error {
        StoreError::Database { source, .. }
            if source.sqlite_error_code() == Some(ErrorCode::NotADatabase) =>
        {
            StoreError::NotACampaign { path: path.into() }
        }
        error => error,
    }
}

fn has_log(path: &Path) -> bool {
    std::fs::metadata(log_of(path)).is_ok_and(|log| log.len() > 0)
}

fn log_of(path: &Path) -> PathBuf {
    let mut log = path.as_os_str().to_owned();
    log.push("-wal");
    log.into()
}

/// A path as part of a URI.
fn escaped(path: &Path) -> String {
    let mut text = String::new();
    for byte in path.as_os_str().as_encoded_bytes() {
        if byte.is_ascii_alphanumeric() || b"/-_.~".contains(byte) {
            text.push(char::from(*byte));
        } else {
            // Writing to a String cannot fail.
            let _ = write!(text, "%{byte:02X}");
        }
    }
    text
}
