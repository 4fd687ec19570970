//! A figure of a report: a drawing with its words, and what it shows as numbers.

use crate::results::result_files::field;

/// A figure.
#[derive(Debug, Clone, PartialEq)]
pub struct Figure {
    /// Name, letters, digits and hyphens.
    pub name: String,
    /// Title, plain text.
    pub title: String,
    /// Caption, plain text.
    pub caption: String,
    /// SVG document.
    pub svg: String,
    /// What it shows, CSV with a header.
    pub csv: String,
}

/// CSV with a header; cells are quoted where they need it.
pub(super) fn csv(head: &[&str], rows: impl Iterator<Item = Vec<String>>) -> String {
    let line = |cells: &mut dyn Iterator<Item = &str>| cells.map(field).collect::<Vec<_>>().join(",") + "\n";
    rows.fold(line(&mut head.iter().copied()), |text, row| text + &line(&mut row.iter().map(String::as_str)))
}
