//! Tables with one column per variable or output: their columns, and rows of values.

use common::outputs::Evaluation;
use rusqlite::types::Value;
use rusqlite::{Connection, Transaction, params_from_iter};

/// Quoted names of a table's columns of values, in order.
pub fn table_columns(connection: &Connection, table: &str) -> rusqlite::Result<Vec<String>> {
    let mut statement = connection.prepare(
        "SELECT name FROM pragma_table_info(?1) WHERE name NOT IN ('evaluation', 'cycles') ORDER BY cid",
    )?;
    let names = statement.query_map([table], |row| row.get::<_, String>(0))?;
    names.map(|name| name.map(|name| format!("\"{}\"", name.replace('"', "\"\"")))).collect()
}

/// Whether an evaluation states an error of every value.
pub fn states_errors(evaluation: &Evaluation) -> bool {
    let lengths = |rows: &[Vec<f64>]| rows.iter().map(Vec::len).collect::<Vec<_>>();
    lengths(&evaluation.errors) == lengths(&evaluation.histories)
}

/// One row per checkpoint, from values `(outputs, m)`.
pub fn write_rows(
    transaction: &Transaction<'_>,
    table: &str,
    outputs: &[String],
    key: i64,
    cycles: &[u32],
    values: &[Vec<f64>],
) -> rusqlite::Result<()> {
    let sql = insert_statement(table, "evaluation, cycles", outputs);
    let mut statement = transaction.prepare_cached(&sql)?;
    for (row, cycles) in cycles.iter().enumerate() {
        let own = [key.into(), i64::from(*cycles).into()].into_iter();
        statement.execute(params_from_iter(own.chain(values.iter().map(|of| Value::from(of[row])))))?;
    }
    Ok(())
}

/// Names by position, values by parameter: `own` columns of the table first, then `columns`.
pub fn insert_statement(table: &str, own: &str, columns: &[String]) -> String {
    let names: Vec<&str> = own.split(", ").chain(columns.iter().map(String::as_str)).collect();
    let places: Vec<String> = (1..=names.len()).map(|k| format!("?{k}")).collect();
    format!("INSERT INTO {table} ({}) VALUES ({})", names.join(", "), places.join(", "))
}
