//! Migration of a campaign file from an earlier layout to the present one, in one transaction: the file is complete in
//! the old layout or in the new one.
//!
//! Version 1 kept the errors that an evaluation states in `evaluation.outcome` alone. Version 2 repeats them in the
//! table `output_error`, which is created and filled from them. An outcome that states no errors gets no rows.

use super::value_tables::{table_columns, write_stated_errors};
use super::{StoreError, exact, schema};
use rusqlite::Connection;
use std::path::Path;

/// The layout that [`migrate`] starts from.
pub const FROM: i64 = 1;

/// Migrates a file from version 1 to version 2.
///
/// # Errors
/// [`StoreError::Migration`] if an outcome cannot be read, or [`StoreError::Database`]; the file is then as before.
pub fn migrate(path: &Path, connection: &mut Connection) -> Result<(), StoreError> {
    let failed = |source| StoreError::Database { path: path.into(), source };
    let outputs = table_columns(connection, "output").map_err(failed)?;
    let transaction = connection.transaction().map_err(failed)?;
    transaction.execute_batch(&schema::output_table("output_error", &outputs)).map_err(failed)?;
    let outcomes: Vec<(i64, Vec<u8>)> = transaction
        .prepare("SELECT id, outcome FROM evaluation ORDER BY id")
        .and_then(|mut statement| statement.query_map([], |row| Ok((row.get(0)?, row.get(1)?)))?.collect())
        .map_err(failed)?;
    for (id, bytes) in outcomes {
        let outcome = exact::outcome_from_bytes(&bytes).map_err(|reason| StoreError::Migration {
            path: path.into(),
            found: FROM,
            id,
            reason,
        })?;
        if let Ok(evaluation) = outcome {
            write_stated_errors(&transaction, &outputs, id, &evaluation).map_err(failed)?;
        }
    }
    transaction.pragma_update(None, "user_version", schema::SCHEMA_VERSION).map_err(failed)?;
    transaction.commit().map_err(failed)
}
