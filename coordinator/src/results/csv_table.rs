//! CSV text of results and figures: a header and rows of as many cells, quoted where RFC 4180 requires it. Names and
//! texts that a spreadsheet would take for a formula begin with an apostrophe.
//!
//! # Source
//! Shafranovich (2005), RFC 4180, Common format and MIME type for comma-separated values files.

/// The text with these names of its columns and these rows of one cell per column, one line each.
pub fn csv<C: AsRef<str>, R: AsRef<str>>(
    columns: impl IntoIterator<Item = C>,
    rows: impl IntoIterator<Item: IntoIterator<Item = R>>,
) -> String {
    let columns: Vec<String> = columns.into_iter().map(|cell| plain_text(cell.as_ref())).collect();
    let rows = rows.into_iter().map(|row| row.into_iter().map(|cell| plain_text(cell.as_ref())).collect());
    let mut writer = csv::Writer::from_writer(Vec::new());
    for cells in std::iter::once(columns).chain(rows) {
        writer.write_record(cells).expect("a row in memory has as many cells as there are columns");
    }
    let bytes = writer.into_inner().expect("writing to memory does not fail");
    String::from_utf8(bytes).expect("cells are text")
}

/// A cell as it is written: with an apostrophe before a first character from which spreadsheets read a formula, unless it is a number, and
/// with spaces for control characters, which a terminal would obey.
pub fn plain_text(cell: &str) -> String {
    let obeyed = |c: char| c.is_control() && !matches!(c, '\n' | '\t' | '\r');
    let cell = cell.replace(obeyed, " ");
    let is_formula = cell.starts_with(['=', '+', '-', '@', '\t', '\r']) && cell.parse::<f64>().is_err();
    if is_formula { format!("'{cell}") } else { cell }
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
        let none: [[&str; 5]; 0] = [];
        let table = csv(["=HYPERLINK(1),<b>", "+a", "-b", "@c", "d=e"], none);
        assert_eq!(table, "\"'=HYPERLINK(1),<b>\",'+a,'-b,'@c,d=e\n");
        assert_eq!(plain_text("\u{1b}[2J=1"), " [2J=1");
        assert_eq!((plain_text("=1+1"), plain_text("-1.5e-3")), ("'=1+1".into(), "-1.5e-3".into()));
    }

    #[test]
    fn cells_are_quoted_only_where_they_need_it() {
        let rows = [["a \"b\"", &number(0.1 + 0.2)], ["", &number(f64::NAN)]];
        assert_eq!(
            csv(["name", "R, total"], rows),
            "name,\"R, total\"\n\"a \"\"b\"\"\",0.30000000000000004\n,\n"
        );
    }
}
