//! CSV text of results and figures: a header and rows of as many cells, quoted where RFC 4180 requires it. Names and
//! texts that a spreadsheet would take for a formula begin with an apostrophe.
//!
//! # Source
//! Shafranovich (2005), RFC 4180, Common format and MIME type for comma-separated values files.

use std::borrow::Cow;

/// A table under construction.
#[derive(Debug)]
pub struct CsvTable(csv::Writer<Vec<u8>>);

impl CsvTable {
    /// A table with these names of its columns.
    pub fn new<C: AsRef<str>>(columns: impl IntoIterator<Item = C>) -> Self {
        let mut table = Self(csv::Writer::from_writer(Vec::new()));
        table.push(columns);
        table
    }

    /// Appends a row: one cell per column.
    pub fn push<C: AsRef<str>>(&mut self, cells: impl IntoIterator<Item = C>) {
        let cells = cells.into_iter().map(|cell| plain_text(cell.as_ref()).into_owned());
        self.0.write_record(cells).expect("a row in memory has as many cells as there are columns");
    }

    /// The text, one line per row.
    pub fn into_text(self) -> String {
        let bytes = self.0.into_inner().expect("writing to memory does not fail");
        String::from_utf8(bytes).expect("cells are text")
    }
}

/// A cell as it is written: with an apostrophe before a first character from which spreadsheets read a formula, unless it is a number, and
/// with spaces for control characters, which a terminal would obey.
pub fn plain_text(cell: &str) -> Cow<'_, str> {
    let obeyed = |c: char| c.is_control() && !matches!(c, '\n' | '\t' | '\r');
    if cell.contains(obeyed) {
        return Cow::Owned(plain_text(&cell.replace(obeyed, " ")).into_owned());
    }
    if cell.starts_with(['=', '+', '-', '@', '\t', '\r']) && cell.parse::<f64>().is_err() {
        Cow::Owned(format!("'{cell}"))
    } else {
        Cow::Borrowed(cell)
    }
}

/// Shortest decimal that reads back as the same f64; empty if the value is not finite.
pub fn number(value: f64) -> String {
    if value.is_finite() { format!("{value:?}") } else { String::new() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn issue_no_name_is_a_formula() {
        let table = CsvTable::new(["=HYPERLINK(1),<b>", "+a", "-b", "@c", "d=e"]);
        assert_eq!(table.into_text(), "\"'=HYPERLINK(1),<b>\",'+a,'-b,'@c,d=e\n");
        assert_eq!(plain_text("\u{1b}[2J=1"), " [2J=1");
        assert_eq!((plain_text("=1+1"), plain_text("-1.5e-3")), ("'=1+1".into(), "-1.5e-3".into()));
    }

    #[test]
    fn cells_are_quoted_only_where_they_need_it() {
        let mut table = CsvTable::new(["name", "R, total"]);
        table.push(["a \"b\"", &number(0.1 + 0.2)]);
        table.push([String::new(), number(f64::NAN)]);
        assert_eq!(table.into_text(), "name,\"R, total\"\n\"a \"\"b\"\"\",0.30000000000000004\n,\n");
    }
}
