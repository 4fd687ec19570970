//! Layout of `campaign.db`, for the program and for queries by users: `campaign` (scene, settings, command, version,
//! times), `evaluation` (one row each), `input` and `output` (values by name, one column per variable or output, SI),
//! `output_error` (the numerical error that an evaluation states of each value of `output`, same columns and units),
//! `learning_round`, `document` (results as JSON), `leg` (settings, command and version of every leg; those of the first
//! leg but for its settings are also in `campaign`, whose settings are those of the last leg). `evaluation.stricter` is 1
//! for the repetition of a failed simulation with finer time steps, and 2 for an outcome that does not fit the scene; `evaluation.level` is the level of accuracy, 0 for
//! the working accuracy of the study. Numbers below zero are evaluations that are no part of
//! the result, see [`super::leg`] and [`super::journal`].
//!
//! The columns `sample` and `outcome` of `evaluation` are what the program reads back: little-endian f64 and
//! CBOR, exact to the last bit, where SQL's REAL would lose a negative zero and a NaN. The tables `input`,
//! `output` and `output_error` repeat them for queries.
//!
//! Version 3 had no column `level`, see [`migrate`]; earlier ones are not read.

use common::scene::Scene;
use rusqlite::{Connection, params};
use std::collections::BTreeSet;

/// Application id of a campaign file: "HgwC".
pub const APPLICATION_ID: i64 = 0x4867_7743;

/// Version of this layout, in `PRAGMA user_version`.
pub const SCHEMA_VERSION: i64 = 4;

/// The earliest layout that [`migrate`] starts from.
pub const EARLIEST_VERSION: i64 = 3;

/// Migrates a file of the layout [`EARLIEST_VERSION`] to the present one in one transaction: the file is complete in the old layout or in the
/// new one. The old one has no levels of accuracy: all its evaluations are at the working accuracy.
///
/// # Errors
/// Those of SQLite; the file is then as before.
pub fn migrate(connection: &mut Connection) -> rusqlite::Result<()> {
    let transaction = connection.transaction()?;
    transaction.execute_batch("ALTER TABLE evaluation ADD COLUMN level INTEGER NOT NULL DEFAULT 0;")?;
    transaction.pragma_update(None, "user_version", SCHEMA_VERSION)?;
    transaction.commit()
}

/// The table of results.
pub const DOCUMENT: &str =
    "document (name TEXT PRIMARY KEY, written_at TEXT NOT NULL, json TEXT NOT NULL) WITHOUT ROWID";

/// The table of legs, see [`super::leg`].
pub const LEG: &str = "leg (
  number INTEGER PRIMARY KEY,
  started_at TEXT NOT NULL,
  evaluations INTEGER NOT NULL,
  settings TEXT NOT NULL,
  command TEXT NOT NULL,
  version TEXT NOT NULL
)";

/// Version of the program that wrote a file of any layout, if it is where all layouts so far have it.
pub fn program_version(connection: &Connection) -> Option<String> {
    let sql = "SELECT value FROM campaign WHERE key = 'version'";
    connection.query_row(sql, [], |row| row.get(0)).ok()
}

/// Statements that create the tables for a scene.
pub fn statements(scene: &Scene) -> String {
    let inputs = columns(scene.variables.iter().map(|variable| variable.name.as_str()));
    let outputs = columns(scene.outputs.iter().map(|output| output.name.as_str()));
    format!(
        "CREATE TABLE campaign (key TEXT PRIMARY KEY, value TEXT NOT NULL) WITHOUT ROWID;
CREATE TABLE evaluation (
  id INTEGER PRIMARY KEY,
  failure TEXT,
  worker TEXT NOT NULL,
  wall_s REAL,
  finished_at TEXT NOT NULL,
  with_first_cycle INTEGER NOT NULL,
  sample BLOB NOT NULL,
  outcome BLOB NOT NULL,
  stricter INTEGER NOT NULL DEFAULT 0,
  level INTEGER NOT NULL DEFAULT 0
);
CREATE TABLE input (
  evaluation INTEGER PRIMARY KEY REFERENCES evaluation (id){inputs}
);
{output};
{output_error};
CREATE TABLE learning_round (round INTEGER PRIMARY KEY, evaluations INTEGER NOT NULL, noted_at TEXT NOT NULL, json TEXT NOT NULL);
CREATE TABLE {DOCUMENT};
CREATE TABLE {LEG};
PRAGMA application_id = {APPLICATION_ID};
PRAGMA user_version = {SCHEMA_VERSION};",
        inputs = reals(&inputs),
        output = output_table("output", &outputs),
        output_error = output_table("output_error", &outputs),
    )
}

/// Records a leg; `texts` are its settings, its command line and the version of the program.
pub fn insert_leg(connection: &Connection, evaluations: usize, texts: [&str; 3]) -> rusqlite::Result<()> {
    let [settings, command, version] = texts;
    connection.execute(
        "INSERT INTO leg (started_at, evaluations, settings, command, version)
         VALUES (strftime('%Y-%m-%dT%H:%M:%fZ', 'now'), ?1, ?2, ?3, ?4)",
        params![evaluations as i64, settings, command, version],
    )?;
    Ok(())
}

/// Statement that creates a table of one row per evaluation and checkpoint, with these quoted columns.
fn output_table(name: &str, columns: &[String]) -> String {
    format!(
        "CREATE TABLE {name} (
  evaluation INTEGER NOT NULL REFERENCES evaluation (id),
  cycles INTEGER NOT NULL{},
  PRIMARY KEY (evaluation, cycles)
) WITHOUT ROWID",
        reals(columns)
    )
}

fn reals(names: &[String]) -> String {
    names.iter().map(|name| format!(",\n  {name} REAL")).collect()
}

/// Quoted names. SQL ignores the case: a name that coincides with another one or with the table's own
/// columns, gets a number.
fn columns<'a>(names: impl Iterator<Item = &'a str>) -> Vec<String> {
    let mut taken = BTreeSet::from(["evaluation".to_string(), "cycles".to_string()]);
    names
        .map(|name| {
            let mut column = name.to_string();
            let mut number = 2;
            while !taken.insert(column.to_lowercase()) {
                column = format!("{name}_{number}");
                number += 1;
            }
            quoted(&column)
        })
        .collect()
}

fn quoted(name: &str) -> String {
    format!("\"{}\"", name.replace('"', "\"\""))
}

/// Quoted names of a table's columns of values, in order.
pub fn table_columns(connection: &Connection, table: &str) -> rusqlite::Result<Vec<String>> {
    let mut statement = connection.prepare(
        "SELECT name FROM pragma_table_info(?1) WHERE name NOT IN ('evaluation', 'cycles') ORDER BY cid",
    )?;
    let names = statement.query_map([table], |row| row.get::<_, String>(0))?;
    names.map(|name| name.map(|name| quoted(&name))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_equal_but_for_case_get_columns_of_their_own() {
        let names = columns(["k", "K", "evaluation", "a\"b"].into_iter());
        assert_eq!(names, ["\"k\"", "\"K_2\"", "\"evaluation_2\"", "\"a\"\"b\""]);
    }
}
