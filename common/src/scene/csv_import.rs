//! `{ csv = "load.csv", columns = [...] }`: puts the columns of CSV files into a scene when it is read, so that its text stands alone.
//!
//! A curve of a load or a drive gets `at` and `value`, the samples of a variable `values`, each with the unit of its head, and `source` with
//! the name of the file and the SHA-256 of its content. Paths are relative to the file of the scene. The places of all numbers are kept, so that later faults point into the CSV file.

use super::csv_file::{CsvColumn, CsvFile};
use super::faults::{FaultKind, Faults};
use crate::text_file::read_text;
use std::path::Path;
use toml::{Table, Value};

/// Lists of a scene and the keys of their rows that may name a CSV file.
const PLACES: [(&str, &[&str]); 4] = [
    ("loads", &["size", "torque", "factor"]),
    ("bodies", &["speed", "angle"]),
    ("outputs", &["wanted", "wanted_x", "wanted_y"]),
    ("variables", &["samples"]),
];

/// Key of a curve or of samples with the file that they are from, and the hash of its content.
pub(super) const SOURCE: &str = "source";

/// Puts the columns of all CSV files that a document names into it; `folder` is that of its file.
///
/// # Errors
/// Files that cannot be read, columns that they do not have, and cells that are no numbers.
pub(super) fn import(
    document: &mut Table,
    origin: &str,
    folder: Option<&Path>,
) -> Result<Vec<CsvColumn>, Faults> {
    let mut read = Vec::new();
    for (list, keys) in PLACES {
        let rows = document.get_mut(list).and_then(Value::as_array_mut).into_iter().flatten();
        for (number, row) in rows.enumerate() {
            let Some(row) = row.as_table_mut() else { continue };
            let name = row.get("name").and_then(Value::as_str);
            let path =
                name.map_or_else(|| format!("{list}[{}]", number + 1), |name| format!("{list}.{name}"));
            for key in keys {
                let table = row.get_mut(*key).and_then(Value::as_table_mut);
                let Some(table) = table.filter(|table| table.contains_key("csv")) else { continue };
                let request = ImportRequest { path: format!("{path}.{key}"), origin, folder };
                read.push(request.read(table, *key == "samples"));
            }
        }
    }
    Ok(all(read.into_iter())?.concat())
}

/// One table of a scene that names a CSV file.
struct ImportRequest<'r> {
    /// Path of the table.
    path: String,
    origin: &'r str,
    folder: Option<&'r Path>,
}

impl ImportRequest<'_> {
    /// Replaces `csv` and `columns` of a curve by `at` and `value`, or `csv` and `column` of samples by `unit` and `values`.
    fn read(&self, table: &mut Table, is_sample: bool) -> Result<Vec<CsvColumn>, Faults> {
        let (key, expected, [first, second]) = match is_sample {
            true => ("column", "the name of a column", ["unit", "values"]),
            false => {
                ("columns", "a list of the two columns, of the arguments and the values", ["at", "value"])
            }
        };
        if table.contains_key(first) || table.contains_key(second) {
            return Err(self.one("csv", format!("give either csv, or {first} and {second}, not both")));
        }
        let (file, text) = self.file(table)?;
        let csv = CsvFile::read(&file, &text, &format!("{}.csv", self.path))?;
        let heads = csv.heads();
        let count = if is_sample { 1 } else { 2 };
        let names = match table.remove(key) {
            None if heads.len() == count => heads,
            None => {
                let expected = format!("{expected}; the file has: {}", heads.join(", "));
                return Err(self.one(key, FaultKind::Missing(expected)));
            }
            Some(Value::String(name)) if is_sample => vec![name],
            Some(Value::Array(names)) if !is_sample => {
                names.iter().filter_map(Value::as_str).map(str::to_owned).collect()
            }
            Some(_) => vec![],
        };
        if names.len() != count {
            return Err(self.one(key, format!("expected {expected}")));
        }
        let places = [("columns.1", first), ("columns.2", second)];
        let read = names.iter().zip(places).map(|(name, (place, part))| {
            let (place, path) = match is_sample {
                true => (key, self.path.clone()),
                false => (place, format!("{}.{part}", self.path)),
            };
            let column = csv.find(name).map_err(|kind| self.one(place, kind))?;
            csv.column(column, &path)
        });
        let imported = all(read)?;
        for (column, part) in imported.iter().zip([first, second]) {
            match is_sample {
                true => table.extend(list(column)),
                false => drop(table.insert(part.to_owned(), Value::Table(list(column)))),
            }
        }
        Ok(imported)
    }

    /// Name and text of the file that a table names; name and hash take the place of its key.
    fn file(&self, table: &mut Table) -> Result<(String, String), Faults> {
        let Some(Value::String(name)) = table.remove("csv") else {
            return Err(self.one("csv", "expected the path of a CSV file, relative to the file of the scene"));
        };
        let Some(folder) = self.folder else {
            let what = format!("\"{name}\" cannot be found: this scene has no file that it is relative to");
            return Err(self.one("csv", what));
        };
        let path = folder.join(&name);
        let text = read_text(&path, "a CSV file")
            .map_err(|why| self.one("csv", format!("{} cannot be read: {why}", path.display())))?;
        // The values state where they are from.
        let hash = ring::digest::digest(&ring::digest::SHA256, text.as_bytes());
        let hash: String = hash.as_ref().iter().map(|byte| format!("{byte:02x}")).collect();
        table.insert(SOURCE.to_owned(), Value::String(format!("{name}, SHA-256 {hash}")));
        Ok((path.display().to_string(), text))
    }

    fn one(&self, key: &str, kind: impl Into<FaultKind>) -> Faults {
        Faults::one(self.origin, &format!("{}.{key}", self.path), kind)
    }
}

/// All results, or the faults of all.
fn all<T>(read: impl Iterator<Item = Result<T, Faults>>) -> Result<Vec<T>, Faults> {
    let mut faults = Vec::new();
    let found = read.filter_map(|read| read.map_err(|Faults(more)| faults.extend(more)).ok()).collect();
    if faults.is_empty() { Ok(found) } else { Err(Faults(faults)) }
}

/// A column as a table of a scene, `{ unit, values }`.
fn list(column: &CsvColumn) -> Table {
    let mut table = Table::new();
    if let Some(unit) = &column.unit {
        table.insert("unit".to_owned(), Value::String(unit.clone()));
    }
    let numbers = column.numbers.iter().map(|number| Value::Float(*number)).collect();
    table.insert("values".to_owned(), Value::Array(numbers));
    table
}
