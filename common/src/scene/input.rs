//! Files that people write besides scenes, TOML or CSV: read by the same [`Section`]s, with all faults at once, each with its line.

use super::context::{Context, NONE};
use super::csv_file::{Cell, CsvRow, csv_rows};
use super::document::document;
use super::extends::read_input as read;
use super::faults::{Fault, Faults};
use super::layers::Layer;
use super::section::Section;
use std::path::Path;
use toml::Table;

/// A TOML file with its text, so that a fault has its place.
#[derive(Debug, Clone)]
pub struct InputFile {
    /// Its tables as written.
    pub document: Table,
    layer: Layer,
}

impl InputFile {
    /// Reads a file.
    ///
    /// # Errors
    /// The file cannot be read, or is not valid TOML.
    pub fn load(path: &Path) -> Result<Self, Faults> {
        Self::parse(&read(path)?, &path.display().to_string())
    }

    /// A file from its text; `origin` names it in faults.
    ///
    /// # Errors
    /// The text is not valid TOML.
    pub fn parse(text: &str, origin: &str) -> Result<Self, Faults> {
        let document = document(text, origin)?;
        let layer = Layer { file: origin.to_owned(), text: text.to_owned(), imported: vec![] };
        Ok(Self { document, layer })
    }

    /// The file as it is called in faults.
    pub fn origin(&self) -> &str {
        &self.layer.file
    }

    /// What `reader` makes of the whole file, unless it records a fault; a key that it does not ask for is one.
    ///
    /// # Errors
    /// All faults, with their places.
    pub fn read<T>(&self, reader: impl FnOnce(&mut Section) -> T) -> Result<T, Faults> {
        let cx = Context::new(self.origin(), &NONE);
        let mut file = Section::new(&cx, "", &self.document);
        let read = reader(&mut file);
        file.finish();
        self.faultless(cx.take_faults()).map(|()| read)
    }

    /// Refuses the file for contradictions to something else, each a key and what is wrong with its value.
    ///
    /// # Errors
    /// These faults, with their places, if there are any.
    pub fn refuse_for(&self, faults: impl IntoIterator<Item = (String, String)>) -> Result<(), Faults> {
        let fault = |(key, what): (String, String)| Fault::new(self.origin(), key, what);
        self.faultless(faults.into_iter().map(fault).collect())
    }

    fn faultless(&self, faults: Vec<Fault>) -> Result<(), Faults> {
        if faults.is_empty() { Ok(()) } else { Err(self.layer.located(Faults(faults))) }
    }
}

/// What `reader` makes of the rows of a CSV text, each with its line and its cells as texts by `columns`, unless it records a fault; empty
/// cells are absent. A first line of names of columns is a heading, which may have another order; so is one that begins with the first.
///
/// # Errors
/// All faults, with their places; the key of a fault is its column.
pub fn read_rows<T>(
    text: &str,
    file: &str,
    columns: &[&str],
    reader: impl FnOnce(&mut [(u64, Section)]) -> T,
) -> Result<T, Faults> {
    let all = csv_rows(text);
    let named = |cell: &Cell| columns.iter().copied().find(|name| cell.text.eq_ignore_ascii_case(name));
    let first = all.first().map_or(&[][..], |row| &row.cells);
    let heading: Option<Vec<&str>> = first.iter().map(named).collect();
    let is_heading = !all.is_empty() && (heading.is_some() || named(&first[0]) == Some(columns[0]));
    let ordered = heading.filter(|heading| heading.len() > 1);
    let columns = ordered.as_deref().unwrap_or(columns);
    let rows = &all[usize::from(is_heading)..];
    let table = |row: &CsvRow| -> Table {
        let cells = columns.iter().zip(&row.cells).filter(|(_, cell)| !cell.text.is_empty());
        cells.map(|(column, cell)| ((*column).to_owned(), cell.text.into())).collect()
    };
    let tables: Vec<Table> = rows.iter().map(table).collect();
    let cx = Context::new(file, &NONE);
    let (expected, names) = (columns.len(), columns.join(", "));
    if rows.is_empty() {
        cx.inconsistent("", format!("the file has no row; expected lines of {names}"));
    }
    let mut sections = Vec::new();
    for (row, table) in rows.iter().zip(&tables) {
        let section = Section::new(&cx, row.line.to_string(), table);
        if row.cells.len() <= expected {
            sections.push((row.line, section));
            continue;
        }
        // Which cells are meant for which column is not known.
        let found = row.cells.len();
        let what = format!(
            "{found} cells, expected {expected}: {names}; a comma within a number separates cells, too"
        );
        section.inconsistent(columns[expected - 1], what);
    }
    let read = reader(&mut sections);
    let place = |fault: Fault| {
        let (line, column) = fault.key.split_once('.').unwrap_or_default();
        let row = rows.iter().find(|row| row.line.to_string() == line);
        let cell = row.and_then(|row| row.cells.get(columns.iter().position(|other| *other == column)?));
        let end = row.map_or(text.trim_end().len(), |row| row.cells[row.cells.len() - 1].span.end);
        Fault::at(file, text, cell.map_or(end..end, |cell| cell.span.clone()), column, fault.kind)
    };
    let mut faults: Vec<Fault> = cx.take_faults().into_iter().map(place).collect();
    faults.sort_by_key(|fault| fault.location.as_ref().map(|place| (place.line, place.column)));
    if faults.is_empty() { Ok(read) } else { Err(Faults(faults)) }
}

#[cfg(test)]
mod tests {
    use super::super::context::Range;
    use super::super::quantity::LENGTH;
    use super::*;

    #[test]
    fn all_faults_of_a_file_have_their_lines() {
        let text = "[[rows]]\nwidth = \"3 N\"\nhieght = 2\n[[rows]]\n";
        let file = InputFile::parse(text, "rows.toml").unwrap();
        let read = file.read(|file| {
            for mut row in file.unnamed_rows("rows") {
                let _ = row.quantity("width", LENGTH, Range::Positive);
                let _ = row.get("height");
                row.finish();
            }
        });
        let Faults(faults) = read.unwrap_err();
        let places: Vec<String> =
            faults.iter().map(|fault| fault.location.as_ref().unwrap().to_string()).collect();
        assert_eq!(places, ["rows.toml:2:9", "rows.toml:3:1", "rows.toml:4:1"]);
        assert!(faults[1].to_string().contains("did you mean \"height\"?"), "{}", faults[1]);
        assert!(InputFile::parse("a =", "rows.toml").is_err());
    }
}
