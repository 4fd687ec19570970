//! Reads a list of quantities: `["0 mm", "2 mm"]`, or `{ unit = "mm", values = [0, 2] }`, which has the unit once.

use super::context::Range;
use super::csv_import::SOURCE;
use super::quantity::Kind;
use super::section::Section;
use toml::Value;

impl Section<'_> {
    /// A required list of quantities `(n,)` [SI]; the paths of its entries end in `.1`, `.2`, ...
    pub(super) fn quantities(&mut self, key: &'static str, kind: Kind) -> Option<Vec<f64>> {
        let value = self.require(key, || format!("a list, each {}", kind.in_words()))?;
        match value {
            Value::Array(list) => all(list
                .iter()
                .enumerate()
                .map(|(i, value)| self.as_quantity(&format!("{key}.{}", i + 1), value, kind, Range::Any))),
            Value::Table(table) => with_one_unit(Section::new(self.cx, self.key(key), table), kind),
            other => {
                let expected = format!("a list, each {}, or {{ unit, values }}", kind.in_words());
                self.wrong_type(key, other, expected);
                None
            }
        }
    }
}

/// Reads `{ unit, values }`; a third key says where the values are from.
fn with_one_unit(mut list: Section, kind: Kind) -> Option<Vec<f64>> {
    let before = list.cx.fault_count();
    let unit = match list.get("unit") {
        None if kind.takes_bare_numbers() => Some(""),
        None => {
            list.missing("unit", format!("the unit of {}", kind.in_words()));
            None
        }
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
        list.wrong_type("values", values?, "a list of numbers");
        return None;
    };
    let found = all(values.iter().enumerate().map(|(i, value)| {
        let number = match value {
            Value::Integer(number) => *number as f64,
            Value::Float(number) => *number,
            other => {
                let expected = "a number: the unit stands beside the list";
                list.wrong_type(&format!("values.{}", i + 1), other, expected);
                return None;
            }
        };
        // With the bits of the same value written with its unit.
        let written =
            if unit.is_empty() { Value::Float(number) } else { Value::String(format!("{number:?} {unit}")) };
        list.as_quantity(&(i + 1).to_string(), &written, kind, Range::Any)
    }));
    found.filter(|_| list.cx.fault_count() == before)
}

/// All values, or none if one is faulty; every one of them is read.
fn all(read: impl Iterator<Item = Option<f64>>) -> Option<Vec<f64>> {
    let read: Vec<Option<f64>> = read.collect();
    read.into_iter().collect()
}
