//! The texts of a scene, its own and those of the scenes that it extends, and where a fault is in them.
//!
//! A path such as `joints.crank.friction`, `loads[2].name` or `loads.push.size.value.2` leads through tables by their keys, through
//! lists of tables by the name or the number of a row, and through lists of values by their number or as `.x` and `.y`.

use super::csv_file::CsvColumn;
use super::faults::{Fault, FaultKind, Faults};
use super::location::Location;
use std::ops::Range;
use toml::Spanned;
use toml::de::{DeString, DeTable, DeValue};

/// Parameters that are defined as another parameter are followed through this many definitions.
const ALIAS_LIMIT: usize = 64;

/// The text of one file, or of a built-in scene.
#[derive(Debug, Clone)]
pub(super) struct Layer {
    /// The file, or the name of a built-in scene.
    pub(super) file: String,
    /// Its text, which is valid TOML.
    pub(super) text: String,
    /// The columns of CSV files that it names.
    pub(super) imported: Vec<CsvColumn>,
}

impl Layer {
    /// Faults of this text alone, with the file and the place of each.
    pub(super) fn located(&self, faults: Faults) -> Faults {
        located(std::slice::from_ref(self), faults)
    }
}

/// A layer and the tables in its text with their places.
type ParsedLayer<'t> = (&'t Layer, Spanned<DeTable<'t>>);

/// How far a path leads into one of the layers, or into a CSV file that it names.
struct Found<'t> {
    file: &'t str,
    /// Text of the file.
    source: &'t str,
    /// Bytes of the key of the last part that was found; those of the whole list or table for a row.
    key: Range<usize>,
    /// Bytes of its value; of a row of a list those of its name, if it has one.
    value: Range<usize>,
    /// The value if it is a text.
    text: Option<String>,
    /// Number of bytes of the path that were found.
    found: usize,
    /// True if all of it was found.
    whole: bool,
}

impl Found<'_> {
    fn location(&self, span: &Range<usize>) -> Location {
        Location::new(self.file, self.source, span.clone())
    }
}

/// Faults of a scene with the file and the place of each, as far as they have one. Of its `layers` its own text is the first, then come those of
/// the scenes that it extends.
pub(super) fn located(layers: &[Layer], Faults(faults): Faults) -> Faults {
    let parsed = parsed(layers);
    Faults(faults.into_iter().map(|fault| locate(&parsed, fault)).collect())
}

/// The place of a key, or of the last part of its path that is in a text.
pub(super) fn location(layers: &[Layer], key: &str) -> Option<Location> {
    let found = find(&parsed(layers), key)?;
    Some(found.location(&found.value))
}

fn parsed(layers: &[Layer]) -> Vec<ParsedLayer<'_>> {
    layers.iter().filter_map(|layer| Some((layer, DeTable::parse(&layer.text as &str).ok()?))).collect()
}

/// The longest part of a path that one of the layers has; of equal ones that of the first layer, whose values count.
fn find<'t>(layers: &[ParsedLayer<'t>], path: &str) -> Option<Found<'t>> {
    // Merged rows have other numbers than those of one file.
    let numbered_rows = layers.len() == 1;
    let place = |(layer, document): &ParsedLayer<'t>| {
        let in_csv = layer.imported.iter().find_map(|column| {
            let (key, found) = (column.span(path)?, path.len());
            let (file, source, value) = (&*column.file, &*column.text, key.clone());
            Some(Found { file, source, key, value, text: None, found, whole: true })
        });
        in_csv.or_else(|| trace(layer, document.get_ref(), path, numbered_rows))
    };
    // Of equal ones `max_by_key` takes the last.
    layers.iter().rev().filter_map(place).max_by_key(|found| found.found)
}

fn locate(layers: &[ParsedLayer<'_>], mut fault: Fault) -> Fault {
    if fault.location.is_some() || fault.key.is_empty() {
        return fault;
    }
    let Some(found) = find(layers, &fault.key) else {
        // What is missing at the top belongs at the end of the file.
        if let (FaultKind::Missing(_), Some((own, _))) = (&fault.kind, layers.first()) {
            let end = own.text.trim_end().len();
            fault.location = Some(Box::new(Location::new(&own.file, &own.text, end..end)));
        }
        return fault;
    };
    let used = found.location(&span_of(&found, &fault.kind));
    if let FaultKind::Duplicate(what, value) = &fault.kind {
        let first = find(layers, &format!("{what}.{value}"));
        fault.used_at = first.map(|first| Box::new(first.location(&first.value)));
    }
    let is_of_a_value = matches!(fault.kind, FaultKind::OfAValue(_));
    let location = match definition(layers, &found).filter(|_| found.whole && is_of_a_value) {
        Some(definition) => {
            fault.used_at = Some(Box::new(used));
            definition.location(&definition.value)
        }
        None => used,
    };
    fault.file.clone_from(&location.file);
    fault.location = Some(Box::new(location));
    fault
}

/// The bytes to point at: an unknown key itself, a key that cannot be a name, the piece of an expression that cannot be read, otherwise the value.
fn span_of(found: &Found, kind: &FaultKind) -> Range<usize> {
    // In quotes or without.
    let key = found.source.get(found.key.clone()).unwrap_or_default();
    match kind {
        FaultKind::UnknownKey { .. } if found.whole => found.key.clone(),
        FaultKind::BadName(name, _) if key.trim_matches(['"', '\'']) == name => found.key.clone(),
        FaultKind::Expression(_, Some(piece)) if found.whole => {
            piece_in(found.source, &found.value, piece).unwrap_or_else(|| found.value.clone())
        }
        _ => found.value.clone(),
    }
}

/// The first place of a piece in a part of a text where it is no part of a longer word.
fn piece_in(text: &str, part: &Range<usize>, piece: &str) -> Option<Range<usize>> {
    let is_word = |c: Option<char>| c.is_some_and(|c| c.is_alphabetic() || c == '_');
    let starts = text.get(part.clone())?.match_indices(piece).map(|(at, _)| part.start + at);
    let is_name = is_word(piece.chars().next());
    let mut alone = starts.filter(|at| {
        let (before, after) = (text[..*at].chars().next_back(), text[at + piece.len()..].chars().next());
        !is_name || !(is_word(before) || is_word(after) || after.is_some_and(char::is_numeric))
    });
    alone.next().map(|at| at..at + piece.len())
}

/// The definition of the parameter that a value consists of, through parameters that consist of one again.
fn definition<'t>(layers: &[ParsedLayer<'t>], value: &Found) -> Option<Found<'t>> {
    let mut name = value.text.clone();
    let mut definition = None;
    for _ in 0..ALIAS_LIMIT {
        // A plain number names no other parameter.
        let parameter = name.as_deref().map(str::trim).filter(|name| !name.is_empty());
        let found = parameter.and_then(|parameter| find(layers, &format!("parameters.{parameter}")));
        let Some(found) = found.filter(|found| found.whole) else { break };
        name.clone_from(&found.text);
        definition = Some(found);
    }
    definition
}

/// Follows `path`; none if not even its first part is there. Rows by number are followed only if `numbered_rows`.
fn trace<'t>(layer: &'t Layer, document: &DeTable<'_>, path: &str, numbered_rows: bool) -> Option<Found<'t>> {
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
    Some(Found {
        file: &layer.file,
        source: &layer.text,
        key: key_span,
        value: name.map_or_else(|| value.span(), Spanned::span),
        text: value.get_ref().as_str().map(str::to_owned),
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
        let layer = Layer { file: "s".into(), text: TEXT.into(), imported: vec![] };
        let found = trace(&layer, document.get_ref(), path, numbered_rows)?;
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
