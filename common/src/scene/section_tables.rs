//! Tables and lists below a table: tables of one key and of names, rows with unique names, and lists of quantities,
//! `["0 mm", "2 mm"]`, or `{ unit = "mm", values = [0, 2] }`, which has the unit once.

use super::context::Range;
use super::csv_import::SOURCE;
use super::faults::FaultKind;
use super::quantity::Kind;
use super::section::Section;
use toml::Value;

/// Tables below this one.
impl<'s> Section<'s> {
    /// A required table.
    pub fn section(&mut self, key: &'static str, expected: &str) -> Option<Section<'s>> {
        let value = self.require(key, || expected.to_owned())?;
        self.as_section(key, value, expected)
    }

    /// An optional table.
    pub(super) fn section_if_any(&mut self, key: &'static str) -> Option<Section<'s>> {
        let value = self.get(key)?;
        self.as_section(key, value, "a table")
    }

    /// The tables of a table, each with its name.
    pub(super) fn named(&mut self, key: &'static str) -> Vec<(&'s str, Section<'s>)> {
        let Some(all) = self.section_if_any(key) else { return Vec::new() };
        all.entries()
            .filter_map(|(name, value)| Some((name.as_str(), all.as_section(name, value, "a table")?)))
            .collect()
    }

    fn as_section(&self, key: &str, value: &'s Value, expected: &str) -> Option<Section<'s>> {
        let in_one = if value.is_array() { ", whose head has one bracket on each side" } else { "" };
        let table = value
            .as_table()
            .or_else(|| self.wrong_type(key, value, format!("{expected}{in_one}")).and(None))?;
        Some(Section::new(self.cx, self.key(key), table))
    }

    /// The rows of a list of tables without names; their paths have their numbers, from 1.
    pub fn unnamed_rows(&mut self, key: &'static str) -> Vec<Section<'s>> {
        let Some(value) = self.get(key) else { return Vec::new() };
        let Some(list) = value.as_array() else {
            self.wrong_type(
                key,
                value,
                format!(
                    "a list of tables [[{key}]]: each row begins with this head, and has its name as a key"
                ),
            );
            return Vec::new();
        };
        let row = |(number, value)| self.as_section(&format!("{key}[{number}]"), value, "a table");
        (1..).zip(list).filter_map(row).collect()
    }

    /// What `read` makes of each row of a list of tables with unique names; a key that it does not ask for is a fault.
    pub(super) fn each_row<T>(
        &mut self,
        key: &'static str,
        mut read: impl FnMut(&'s str, &mut Section<'s>) -> T,
    ) -> Vec<T> {
        let read = |(name, mut row): (&'s str, Section<'s>)| {
            let found = read(name, &mut row);
            row.finish();
            found
        };
        self.rows(key).into_iter().map(read).collect()
    }

    /// The rows of a list of tables, each with its unique name, which becomes the last part of its path.
    pub fn rows(&mut self, key: &'static str) -> Vec<(&'s str, Section<'s>)> {
        let path = self.key(key);
        let mut rows: Vec<(&str, Section)> = Vec::new();
        for mut row in self.unnamed_rows(key) {
            let Some(name) = row.text("name", "a name") else {
                row.given_up = true;
                row.finish();
                continue;
            };
            if rows.iter().any(|(taken, _)| *taken == name) {
                row.fault("name", FaultKind::Duplicate(path.clone(), name.to_owned()));
                continue;
            }
            if name.is_empty() || name.contains('.') || name.contains(char::is_control) {
                let reason = "names are not empty and have no dots or control characters";
                row.fault("name", FaultKind::BadName(name.to_owned(), reason));
                continue;
            }
            row.path = format!("{path}.{name}");
            rows.push((name, row));
        }
        rows
    }
}

impl Section<'_> {
    /// A required list of quantities `(n,)` [SI]; the paths of its entries end in `.1`, `.2`, ...
    pub(super) fn quantities(&mut self, key: &'static str, kind: Kind) -> Option<Vec<f64>> {
        let value = self.require(key, || format!("a list, each {}", kind.in_words()))?;
        match value {
            Value::Array(list) => all((1..).zip(list).map(|(number, value)| {
                self.as_quantity(&format!("{key}.{number}"), value, kind, Range::Any)
            })),
            Value::Table(table) => with_one_unit(Section::new(self.cx, self.key(key), table), kind),
            other => {
                let expected = format!("a list, each {}, or {{ unit, values }}", kind.in_words());
                self.wrong_type(key, other, expected).and(None)
            }
        }
    }
}

/// Reads `{ unit, values }`; a third key says where the values are from.
fn with_one_unit(mut list: Section, kind: Kind) -> Option<Vec<f64>> {
    let before = list.cx.fault_count();
    let unit = match list.get("unit") {
        None if kind.takes_bare_numbers() => Some(""),
        None => list.missing("unit", format!("the unit of {}", kind.in_words())).and(None),
        Some(_) => list.text("unit", "a unit, e.g. \"mm\""),
    };
    let values = list.require("values", || "a list of numbers".to_owned());
    let _ = list.get(SOURCE);
    list.finish();
    let unit = unit?;
    // One fault for a unit of another kind, not one for each value.
    if !unit.is_empty() {
        list.cx.value(&list.key("unit"), &Value::String(format!("1 {unit}")), Some(kind))?;
    }
    let Value::Array(values) = values? else {
        return list.wrong_type("values", values?, "a list of numbers").and(None);
    };
    let found = all((1..).zip(values).map(|(place, value)| {
        let number = match value {
            Value::Integer(number) => *number as f64,
            Value::Float(number) => *number,
            other => {
                let expected = "a number: the unit stands beside the list";
                return list.wrong_type(&format!("values.{place}"), other, expected).and(None);
            }
        };
        // With the bits of the same value written with its unit.
        let written =
            if unit.is_empty() { Value::Float(number) } else { Value::String(format!("{number:?} {unit}")) };
        list.as_quantity(&format!("{place}"), &written, kind, Range::Any)
    }));
    found.filter(|_| list.cx.fault_count() == before)
}

/// All values, or none if one is faulty; every one of them is read.
fn all(read: impl Iterator<Item = Option<f64>>) -> Option<Vec<f64>> {
    let read: Vec<Option<f64>> = read.collect();
    read.into_iter().collect()
}
