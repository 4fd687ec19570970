//! Opening a campaign file to read it: nothing is locked and nothing is written beside it, so that a study in a folder
//! without write permission can be read, and a study that is running.
//!
//! SQLite reads a file with a write-ahead log through a shared index in the file's folder. Where that index is missing and
//! cannot be created, a file without a log does not change and is read as it is; a file with a log, which a killed study
//! leaves, is read from a temporary copy. Where the folder can be written, SQLite creates index and log to read a file, and
//! removes them only at the end of a connection that may write: a file without a log is therefore opened for writing, and
//! changes through the connection are refused.

use super::connection::{FILE_NAME, connect};
use super::error::StoreError;
use rusqlite::{Connection, ErrorCode, OpenFlags};
use std::fmt::Write;
use std::path::{Path, PathBuf};
use tempfile::TempDir;

/// A connection for reading.
pub struct ReadConnection {
    /// The connection to the campaign file or to its copy.
    pub connection: Connection,
    /// Folder of the copy, removed at the end.
    pub copy: Option<TempDir>,
}

/// Opens the campaign file at `path` for reading.
///
/// # Errors
/// [`StoreError::NotACampaign`], or what the file system or SQLite report.
pub fn connect_read_only(path: &Path) -> Result<ReadConnection, StoreError> {
    match shared(path) {
        Ok(connection) => Ok(ReadConnection { connection, copy: None }),
        Err(error) if !needs_index(&error) => Err(named(path, error)),
        Err(_) if has_log(path) => from_copy(path),
        Err(_) => unchanging(path),
    }
}

/// Opens the file beside other connections, and reads from it once.
fn shared(path: &Path) -> Result<Connection, StoreError> {
    let flags = if has_log(path) {
        OpenFlags::SQLITE_OPEN_READ_ONLY
    } else {
        // Read-only all the same where the file or the file system is.
        OpenFlags::SQLITE_OPEN_READ_WRITE
    };
    let connection = connect(path, flags)?;
    let failed = |source| StoreError::Database { path: path.into(), source };
    connection.pragma_update(None, "query_only", true).map_err(failed)?;
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
    Ok(ReadConnection { connection, copy: None })
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
    Ok(ReadConnection { connection, copy: Some(copy) })
}

fn probe(path: &Path, connection: &Connection) -> Result<(), StoreError> {
    connection
        .query_row("SELECT count(*) FROM sqlite_schema", [], |_| Ok(()))
        .map_err(|source| StoreError::Database { path: path.into(), source })
}

/// Whether the shared index is missing and cannot be created.
fn needs_index(error: &StoreError) -> bool {
    let StoreError::Database { source, .. } = error else { return false };
    matches!(source.sqlite_error_code(), Some(ErrorCode::CannotOpen | ErrorCode::ReadOnly))
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
