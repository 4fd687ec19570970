//! Follows the path of a key, as faults state it, through the text of a scene.
//!
//! A path such as `joints.crank.friction`, `loads[2].name` or `loads.push.size.value.2` leads through tables by their keys, through
//! lists of tables by the name or the number of a row, and through lists of values by their number or as `.x` and `.y`.

use std::ops::Range;
use toml::Spanned;
use toml::de::{DeString, DeTable, DeValue};

/// How far a path leads into a text.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Trace<'t> {
    /// Bytes of the key of the last part that was found; those of the whole list or table for a row.
    pub(super) key: Range<usize>,
    /// Bytes of its value; of a row of a list those of its name, if it has one.
    pub(super) value: Range<usize>,
    /// The value if it is a text.
    pub(super) text: Option<&'t str>,
    /// Number of bytes of the path that were found.
    pub(super) found: usize,
    /// True if all of it was found.
    pub(super) whole: bool,
}

/// Follows `path`; none if not even its first part is there. Rows by number are followed only if `numbered_rows`.
pub(super) fn trace<'t>(document: &'t DeTable<'_>, path: &str, numbered_rows: bool) -> Option<Trace<'t>> {
    let (key, mut value, mut rest) = in_table(document, path)?;
    let mut key_span = key.span();
    let mut is_row = false;
    while !rest.is_empty() {
        let step = match value.get_ref() {
            DeValue::Table(table) => {
                in_table(table, rest).map(|(key, value, rest)| (key.span(), value, rest, false))
            }
            DeValue::Array(rows) => in_list(rows.iter().collect(), rest, numbered_rows)
                .map(|(value, rest)| (value.span(), value, rest, value.get_ref().is_table())),
            _ => None,
        };
        let Some((span, next, left, row)) = step else { break };
        (key_span, value, rest, is_row) = (span, next, left, row);
    }
    let name = value.get_ref().as_table().filter(|_| is_row).and_then(|row| row.get("name"));
    Some(Trace {
        key: key_span,
        value: name.map_or_else(|| value.span(), Spanned::span),
        text: value.get_ref().as_str(),
        found: path.len() - rest.len(),
        whole: rest.is_empty(),
    })
}

/// What is left of a path after its first part, which must end there.
fn after<'p>(path: &'p str, part: &str) -> Option<&'p str> {
    let rest = path.strip_prefix(part)?;
    if rest.is_empty() || rest.starts_with('[') { Some(rest) } else { rest.strip_prefix('.') }
}

type Entry<'t, 'i, 'p> = (&'t Spanned<DeString<'i>>, &'t Spanned<DeValue<'i>>, &'p str);

/// The entry of a table that a path begins with; keys may have dots, so the longest one counts.
fn in_table<'t, 'i, 'p>(table: &'t DeTable<'i>, path: &'p str) -> Option<Entry<'t, 'i, 'p>> {
    let entries = table.iter().filter_map(|(key, value)| Some((key, value, after(path, key.get_ref())?)));
    entries.min_by_key(|(_, _, rest)| rest.len())
}

/// The entry of a list that a path begins with: `[2]` a row, `2` a value, `x` or `y` of a pair, or the name of a row.
fn in_list<'t, 'i, 'p>(
    list: Vec<&'t Spanned<DeValue<'i>>>,
    path: &'p str,
    numbered_rows: bool,
) -> Option<(&'t Spanned<DeValue<'i>>, &'p str)> {
    let at = |number: &str| number.parse::<usize>().ok()?.checked_sub(1);
    if let Some((number, rest)) = path.strip_prefix('[').and_then(|path| path.split_once(']')) {
        let row = list.get(at(number)?).filter(|_| numbered_rows)?;
        return Some((row, rest.strip_prefix('.').unwrap_or(rest)));
    }
    let name = |row: &'t Spanned<DeValue<'i>>| row.get_ref().as_table()?.get("name")?.get_ref().as_str();
    let named = list.iter().filter_map(|row| Some((*row, after(path, name(row)?)?)));
    if let Some(found) = named.min_by_key(|(_, rest)| rest.len()) {
        return Some(found);
    }
    let (part, rest) = path.split_once('.').unwrap_or((path, ""));
    let place = match part {
        "x" if list.len() == 2 => 0,
        "y" if list.len() == 2 => 1,
        number => at(number)?,
    };
    let value = list.get(place).filter(|value| !value.get_ref().is_table())?;
    Some((value, rest))
}

#[cfg(test)]
mod tests {
    use super::*;

    const TEXT: &str = r#"
top = ["1 m", "2 m"]
[life]
cycles = 0
[[loads]]
name = "push"
size = { at = ["0 s", "1 s"] }
[[loads]]
name = "push.x"
[loads.points]
"a.b" = [3, 4]
"#;

    /// The pieces of the text that key and value of a path are, and whether it leads to its end.
    fn found(path: &str, numbered_rows: bool) -> Option<(&'static str, &'static str, bool)> {
        let document = DeTable::parse(TEXT).unwrap();
        let found = trace(document.get_ref(), path, numbered_rows)?;
        Some((&TEXT[found.key], &TEXT[found.value], found.whole))
    }

    #[test]
    fn paths_lead_through_tables_rows_and_lists() {
        for (path, value) in [
            ("top.y", "\"2 m\""),
            ("top.1", "\"1 m\""),
            ("life.cycles", "0"),
            ("loads.push", "\"push\""),
            ("loads.push.size.at.2", "\"1 s\""),
            ("loads.push.x.points.a.b.x", "3"),
            ("loads[2].name", "\"push.x\""),
            ("loads[1]", "\"push\""),
        ] {
            let (_, found, whole) = found(path, true).unwrap();
            assert_eq!((found, whole), (value, true), "{path}");
        }
        assert_eq!(found("life.cycles", true).unwrap().0, "cycles");
    }

    #[test]
    fn a_path_without_an_end_stops_at_the_last_part_there_is() {
        assert_eq!(found("life.period", true), Some(("life", "[life]", false)));
        assert_eq!(found("loads.push.kind", true).unwrap().1, "\"push\"");
        assert_eq!(found("loads.push.size.over", true).unwrap().1, "{ at = [\"0 s\", \"1 s\"] }");
        assert!(!found("loads[3].name", true).unwrap().2);
        assert!(!found("loads[2].name", false).unwrap().2);
        assert_eq!(found("top.z", true).unwrap().1, "[\"1 m\", \"2 m\"]");
        assert_eq!(found("bodies", true), None);
    }
}
