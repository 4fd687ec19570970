//! Reads the columns of a CSV file: a head with names and units in brackets, then rows of numbers.
//!
//! Cells are separated by the first of `;`, tab and `,` that the head has, and may be quoted. Lines without content or that begin
//! with `#` are skipped. Every cell keeps its place in the text, for faults.

use super::expression_error::instead_of_comma;
use super::faults::{Fault, FaultKind, Faults, nearest};
use std::ops::Range;

/// At most this many faults of one file are reported.
const FAULT_LIMIT: usize = 10;

/// A column that was asked for: its numbers and where they stand.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct CsvColumn {
    /// Path of the list that the column becomes in a scene, e.g. `loads.push.size.at`.
    pub(super) key: String,
    /// The CSV file.
    pub(super) file: String,
    /// Text of that file.
    pub(super) text: String,
    /// Unit in the head; none if the head has none.
    pub(super) unit: Option<String>,
    /// Bytes of the unit in the text, or of the whole head.
    pub(super) unit_span: Range<usize>,
    /// Bytes of the head in the text.
    pub(super) head_span: Range<usize>,
    /// The numbers `(n,)`, in that unit.
    pub(super) numbers: Vec<f64>,
    /// Bytes of each number in the text `(n,)`.
    pub(super) spans: Vec<Range<usize>>,
}

impl CsvColumn {
    /// The bytes in the CSV file of what a path below the column names: a number, the unit, or the head.
    pub(super) fn span(&self, path: &str) -> Option<Range<usize>> {
        let rest = path.strip_prefix(&self.key)?;
        match rest.strip_prefix('.') {
            None => rest.is_empty().then(|| self.head_span.clone()),
            Some("unit") => Some(self.unit_span.clone()),
            Some(number) => {
                let number = number.strip_prefix("values.").unwrap_or(number);
                self.spans.get(number.parse::<usize>().ok()?.checked_sub(1)?).cloned()
            }
        }
    }
}

/// A CSV file split into cells.
#[derive(Debug)]
pub(super) struct CsvFile<'t> {
    file: &'t str,
    text: &'t str,
    head: Vec<Cell<'t>>,
    rows: Vec<Vec<Cell<'t>>>,
}

/// A line of a CSV text.
#[derive(Debug, Clone, PartialEq)]
pub struct CsvRow<'t> {
    /// Number of the line, from 1.
    pub line: u64,
    /// Its cells, at least one.
    pub cells: Vec<Cell<'t>>,
}

/// The text of a cell without quotes and spaces around it, and its bytes in the file.
#[derive(Debug, Clone, PartialEq)]
pub struct Cell<'t> {
    /// What it says, without quotes and spaces around it.
    pub text: &'t str,
    /// Its bytes in the text of the file.
    pub span: Range<usize>,
}

/// The lines of a CSV text that are not empty, nor nothing but separators, and do not begin with `#`. The separator is the first of `;`, tab and `,` that the
/// first of them has.
pub fn csv_rows(text: &str) -> Vec<CsvRow<'_>> {
    let with_content = |(_, line): &(u64, Range<usize>)| {
        let line = text[line.clone()].trim_matches(|c: char| c.is_whitespace() || [';', ','].contains(&c));
        !line.is_empty() && !line.starts_with('#')
    };
    let mut lines = (1..).zip(lines(text)).filter(with_content).peekable();
    let separator = lines.peek().map_or(',', |(_, first)| separator(&text[first.clone()]));
    lines.map(|(line, bytes)| CsvRow { line, cells: cells(text, bytes, separator) }).collect()
}

/// The separator of the cells of a line.
fn separator(line: &str) -> char {
    [';', '\t'].into_iter().find(|c| line.contains(*c)).unwrap_or(',')
}

impl<'t> CsvFile<'t> {
    /// Splits the text of `file` into cells; `key` is the key that names the file.
    ///
    /// # Errors
    /// There is no head, or no row under it, or rows have another number of cells than the head.
    pub(super) fn read(file: &'t str, text: &'t str, key: &str) -> Result<Self, Faults> {
        let at_end = |message: &str| {
            let end = text.trim_end().len();
            Err(Faults(vec![Fault::at(file, text, end..end, key, message)]))
        };
        let mut rows = csv_rows(text).into_iter().map(|row| row.cells);
        let Some(head) = rows.next() else {
            return at_end("has no head, expected a line such as `angle [deg], force [N]`");
        };
        // A spreadsheet fills lines without content with separators.
        let rows: Vec<_> = rows.filter(|row| row.iter().any(|cell| !cell.text.is_empty())).collect();
        if rows.is_empty() {
            return at_end("has no row under its head");
        }
        let csv = CsvFile { file, text, head, rows };
        let faults: Vec<Fault> =
            csv.rows.iter().filter_map(|row| csv.uneven(row, key)).take(FAULT_LIMIT).collect();
        if faults.is_empty() { Ok(csv) } else { Err(Faults(faults)) }
    }

    /// The fault of a row with another number of cells than the head.
    fn uneven(&self, row: &[Cell], key: &str) -> Option<Fault> {
        let (found, expected) = (row.len(), self.head.len());
        if found == expected {
            return None;
        }
        let first = self.head.first().zip(self.head.last());
        let head = first.map_or("", |(first, last)| &self.text[first.span.start..last.span.end]);
        const COMMAS: &str = "; if these are decimal commas, write decimal points: 0.5; if they separate thousands, leave them out: 9000";
        let advice = if separator(head) == ',' && found > expected { COMMAS } else { "" };
        let message = format!("has {found} values, the head has {expected} columns{advice}");
        let span = row.first().map_or(0, |cell| cell.span.start)..row.last().map_or(0, |cell| cell.span.end);
        Some(self.fault(span, key, message))
    }

    /// Heads of the columns, with their units.
    pub(super) fn heads(&self) -> Vec<String> {
        self.head.iter().map(|cell| cell.text.to_owned()).collect()
    }

    /// The place of the column that is called `name`, with or without its unit.
    ///
    /// # Errors
    /// [`FaultKind::UnknownReference`] with the nearest name; its place is that of the name in the scene.
    pub(super) fn find(&self, name: &str) -> Result<usize, FaultKind> {
        let plain = |text: &str| text.split_whitespace().collect::<String>();
        let asked = plain(name);
        let is_called = |cell: &Cell| plain(cell.text) == asked || plain(split_unit(cell.text).0) == asked;
        self.head.iter().position(is_called).ok_or_else(|| {
            // Without units, which are most of a short head.
            let near = nearest(split_unit(name).0, self.head.iter().map(|cell| split_unit(cell.text).0));
            let head = self.head.iter().find(|cell| Some(split_unit(cell.text).0) == near.as_deref());
            let known: Vec<&str> = self.head.iter().map(|cell| cell.text).collect();
            FaultKind::unknown_near("column", name, &head.map(|cell| cell.text.to_owned()), &known)
        })
    }

    /// A column, which becomes the list `key` of a scene.
    ///
    /// # Errors
    /// Cells that are no numbers, each with its place.
    pub(super) fn column(&self, column: usize, key: &str) -> Result<CsvColumn, Faults> {
        let cells = || self.rows.iter().map(|row| &row[column]);
        let number = |cell: &Cell| cell.text.parse::<f64>().ok().filter(|number| number.is_finite());
        let wrong = cells().filter(|cell| number(cell).is_none()).take(FAULT_LIMIT);
        let fault = |cell: &Cell| self.fault(cell.span.clone(), key, not_a_number(cell.text));
        let faults: Vec<Fault> = wrong.map(fault).collect();
        if !faults.is_empty() {
            return Err(Faults(faults));
        }
        let head = &self.head[column];
        let unit = split_unit(head.text).1.filter(|unit| !["", "-", "1"].contains(unit));
        let place = |unit: &str| {
            let at = head.span.start + (unit.as_ptr() as usize - head.text.as_ptr() as usize);
            at..at + unit.len()
        };
        Ok(CsvColumn {
            key: key.to_owned(),
            file: self.file.to_owned(),
            text: self.text.to_owned(),
            unit: unit.map(str::to_owned),
            unit_span: unit.map_or(head.span.clone(), place),
            head_span: head.span.clone(),
            numbers: cells().filter_map(number).collect(),
            spans: cells().map(|cell| cell.span.clone()).collect(),
        })
    }

    fn fault(&self, span: Range<usize>, key: &str, message: String) -> Fault {
        Fault::at(self.file, self.text, span, key, message)
    }
}

/// Why a cell is no number, and what to write instead.
fn not_a_number(cell: &str) -> String {
    let has_comma = cell.contains(',') && cell.replace(',', "").parse::<f64>().is_ok();
    if cell.is_empty() {
        "is empty, expected a number".to_owned()
    } else if let Some((before, after)) = cell.split_once(',').filter(|_| has_comma) {
        format!("`{cell}` has a comma: {}", instead_of_comma(before, after))
    } else if cell.trim_end_matches(|c: char| !c.is_ascii_digit()).parse::<f64>().is_ok() {
        format!("`{cell}` is not a number: the unit stands in the head, e.g. `force [N]`")
    } else {
        format!("`{cell}` is not a finite number")
    }
}

/// Name and unit of a head such as `force [N]`.
fn split_unit(head: &str) -> (&str, Option<&str>) {
    let inside = head.strip_suffix(']').and_then(|head| head.split_once('['));
    inside.map_or((head, None), |(name, unit)| (name.trim_end(), Some(unit.trim())))
}

/// The bytes of every line, without its end and without a byte order mark.
fn lines(text: &str) -> impl Iterator<Item = Range<usize>> {
    let start = if text.starts_with('\u{feff}') { '\u{feff}'.len_utf8() } else { 0 };
    let mut at = start;
    text[start..].split('\n').map(move |line| {
        let span = at..at + line.trim_end_matches('\r').len();
        at += line.len() + 1;
        span
    })
}

/// The cells of one line.
fn cells(text: &str, line: Range<usize>, separator: char) -> Vec<Cell<'_>> {
    let mut ends = Vec::new();
    let mut quoted = false;
    for (at, c) in text[line.clone()].char_indices() {
        match c {
            '"' => quoted = !quoted,
            c if c == separator && !quoted => ends.push(line.start + at),
            _ => {}
        }
    }
    ends.push(line.end);
    let mut start = line.start;
    let cell = |end: usize| {
        let span = trimmed(text, start..end);
        start = end + separator.len_utf8();
        Cell { text: &text[span.clone()], span }
    };
    ends.into_iter().map(cell).collect()
}

/// A piece of a text without spaces and quotes around it.
fn trimmed(text: &str, span: Range<usize>) -> Range<usize> {
    let piece = &text[span.clone()];
    let outer = piece.trim();
    let inner = outer.strip_prefix('"').and_then(|piece| piece.strip_suffix('"')).unwrap_or(outer).trim();
    let start = span.start + (inner.as_ptr() as usize - piece.as_ptr() as usize);
    start..start + inner.len()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn heads_units_and_numbers_keep_their_places() {
        let text = "\u{feff}# test bench 3\r\n\"angle [deg]\"; force [ N ]\r\n\r\n0;\t1.5\r\n 90 ; -2e-1\r\n";
        let csv = CsvFile::read("load.csv", text, "loads.push.size").unwrap();
        assert_eq!(csv.heads(), ["angle [deg]", "force [ N ]"]);
        assert_eq!((csv.find("angle").unwrap(), csv.find("force [N]").unwrap()), (0, 1));
        let force = csv.column(1, "loads.push.size").unwrap();
        assert_eq!((force.unit.as_deref(), &text[force.unit_span]), (Some("N"), "N"));
        assert_eq!(force.numbers, [1.5, -0.2]);
        assert_eq!(&text[force.spans[1].clone()], "-2e-1");
    }

    #[test]
    fn what_is_no_table_of_numbers_is_named_with_its_place() {
        for (text, place, says) in [
            ("", "1:1", "has no head"),
            ("a [mm]\n", "1:7", "has no row"),
            (
                "a [mm],b\n1,2\n0,5,1,5\n",
                "3:1",
                "has 4 values, the head has 2 columns; if these are decimal commas",
            ),
            ("a [mm];b\n1;2\n0,5;1\n", "3:1", "`0,5` has a comma: use a decimal point: 0.5"),
            ("a [lbf];b\n1;2\n0;1\n9,000;1\n", "4:1", "write 9000 if it separates thousands, 9.000 if"),
            ("a [lbf];b\n1,234,567;1\n", "2:1", "digits have no separators: 1234567"),
            ("a,b\n0,9,000\n", "2:1", "if they separate thousands, leave them out: 9000"),
            ("a [mm];b\n1;2\n;1\n", "3:1", "is empty"),
            ("a [mm]\n 12 mm\n", "2:2", "the unit stands in the head"),
            ("a [mm]\nnan\n", "2:1", "is not a finite number"),
        ] {
            let read = CsvFile::read("f.csv", text, "k").and_then(|csv| csv.column(0, "k"));
            let Faults(faults) = read.expect_err(text);
            let found = faults[0].location.as_ref().unwrap().to_string();
            assert_eq!(found, format!("f.csv:{place}"), "{text}");
            assert!(faults[0].to_string().contains(says), "{text}: {}", faults[0]);
        }
        let filled = CsvFile::read("f.csv", "a [mm];b\r\n1;2\r\n;\r\n ; \r\n", "k").unwrap();
        assert_eq!(filled.column(1, "k").unwrap().numbers, [2.0]);
        let text = "gap [um]\n1\n";
        let unknown = CsvFile::read("f.csv", text, "k").unwrap().find("gpa [um]").unwrap_err().to_string();
        assert!(unknown.contains("did you mean \"gap [um]\"?"), "{unknown}");
    }
}
