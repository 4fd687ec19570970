//! A figure of a report: a drawing with title and caption, and its numbers as CSV.

use crate::results::csv_table::CsvTable;

/// A figure of a report.
#[derive(Debug, Clone, PartialEq)]
pub struct Figure {
    /// Name, letters, digits and hyphens.
    pub name: String,
    /// Title, plain text.
    pub title: String,
    /// Caption, plain text.
    pub caption: String,
    /// Drawing as an SVG document.
    pub svg: String,
    /// Numbers shown, as CSV with a header.
    pub csv: String,
}

/// CSV text with these columns and rows.
pub(super) fn csv(columns: &[&str], rows: impl Iterator<Item = Vec<String>>) -> String {
    let mut table = CsvTable::new(columns);
    rows.for_each(|row| table.push(&row));
    table.into_text()
}
