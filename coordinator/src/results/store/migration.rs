//! Migration of a campaign file from the layout before to the present one, in one transaction: the file is complete in the old layout or
//! in the new one.
//!
//! Version 3 had no levels of accuracy: all its evaluations are at the working accuracy.

use super::schema;
use rusqlite::Connection;

/// The earliest layout that [`migrate`] starts from.
pub const FROM: i64 = 3;

/// Migrates a file of the layout [`FROM`] to the present one.
///
/// # Errors
/// Those of SQLite; the file is then as before.
pub fn migrate(connection: &mut Connection) -> rusqlite::Result<()> {
    let transaction = connection.transaction()?;
    transaction.execute_batch("ALTER TABLE evaluation ADD COLUMN level INTEGER NOT NULL DEFAULT 0;")?;
    transaction.pragma_update(None, "user_version", schema::SCHEMA_VERSION)?;
    transaction.commit()
}
