//! Migration of a campaign file from an earlier layout to the present one, in one transaction: the file is complete in
//! the old layout or in the new one.
//!
//! Version 1 kept the errors that an evaluation states in `evaluation.outcome` alone. Version 2 repeats them in the
//! table `output_error`, which is created and filled from them. An outcome that states no errors gets no rows.
//!
//! Version 2 had no legs: version 3 records the settings of the study as its first leg. The repetitions of failed
//! simulations, which follow them under the same sample, are marked.
//!
//! Version 3 had no levels of accuracy: all its evaluations are at the working accuracy.

use super::value_tables::{table_columns, write_stated_errors};
use super::{StoreError, exact, schema};
use rusqlite::{Connection, Transaction};
use std::collections::HashSet;
use std::path::Path;

/// The earliest layout that [`migrate`] starts from.
pub const FROM: i64 = 1;

/// Migrates a file from version `found` to the present one.
///
/// # Errors
/// [`StoreError::Outcome`] if an outcome cannot be read, or [`StoreError::Database`]; the file is then as before.
pub fn migrate(path: &Path, connection: &mut Connection, found: i64) -> Result<(), StoreError> {
    let failed = |source| StoreError::Database { path: path.into(), source };
    let transaction = connection.transaction().map_err(failed)?;
    if found < 2 {
        add_stated_errors(path, &transaction)?;
    }
    if found < 3 {
        add_legs(&transaction).map_err(failed)?;
    }
    transaction
        .execute_batch("ALTER TABLE evaluation ADD COLUMN level INTEGER NOT NULL DEFAULT 0;")
        .map_err(failed)?;
    transaction.pragma_update(None, "user_version", schema::SCHEMA_VERSION).map_err(failed)?;
    transaction.commit().map_err(failed)
}

/// Version 1 to 2.
fn add_stated_errors(path: &Path, transaction: &Transaction<'_>) -> Result<(), StoreError> {
    let failed = |source| StoreError::Database { path: path.into(), source };
    let outputs = table_columns(transaction, "output").map_err(failed)?;
    transaction.execute_batch(&schema::output_table("output_error", &outputs)).map_err(failed)?;
    let outcomes: Vec<(i64, Vec<u8>)> = transaction
        .prepare("SELECT id, outcome FROM evaluation ORDER BY id")
        .and_then(|mut statement| statement.query_map([], |row| Ok((row.get(0)?, row.get(1)?)))?.collect())
        .map_err(failed)?;
    for (id, bytes) in outcomes {
        let outcome = exact::outcome_from_bytes(&bytes).map_err(|reason| {
            let program = schema::program_version(transaction).unwrap_or_default();
            StoreError::Outcome { path: path.into(), id, program, reason }
        })?;
        if let Ok(evaluation) = outcome {
            write_stated_errors(transaction, &outputs, id, &evaluation).map_err(failed)?;
        }
    }
    Ok(())
}

/// Version 2 to 3.
fn add_legs(transaction: &Transaction<'_>) -> rusqlite::Result<()> {
    transaction.execute_batch(&format!(
        "ALTER TABLE evaluation ADD COLUMN stricter INTEGER NOT NULL DEFAULT 0;
CREATE TABLE {};
INSERT INTO leg SELECT 1, created.value, 0, settings.value, command.value, version.value
  FROM campaign AS created, campaign AS settings, campaign AS command, campaign AS version
  WHERE created.key = 'created_at' AND settings.key = 'settings' AND command.key = 'command'
  AND version.key = 'version';",
        schema::LEG
    ))?;
    let rows: Vec<(i64, Vec<u8>, bool)> = transaction
        .prepare("SELECT id, sample, failure IS NOT NULL FROM evaluation ORDER BY id")?
        .query_map([], |row| Ok((row.get(0)?, row.get(1)?, row.get(2)?)))?
        .collect::<Result<_, _>>()?;
    let mut failed = HashSet::new();
    for (id, sample, has_failed) in rows {
        if failed.contains(&sample) {
            transaction.execute("UPDATE evaluation SET stricter = 1 WHERE id = ?1", [id])?;
        } else if has_failed {
            failed.insert(sample);
        }
    }
    Ok(())
}
