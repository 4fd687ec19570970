//! Connections of SQLite to a campaign file.

use super::error::StoreError;
use rusqlite::{Connection, OpenFlags};
use std::path::Path;
use std::time::Duration;

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
