//! Reads a list of quantities: `["0 mm", "2 mm"]`, or `{ unit = "mm", values = [0, 2] }`, which has the unit once.

use super::context::{Context, Range};
use super::csv_import::SOURCE;
use super::faults::FaultKind;
use super::quantity::Kind;
use toml::{Table, Value};

/// Keys of a list with one unit; the last one says where the values are from.
const KEYS: [&str; 3] = ["unit", "values", SOURCE];

/// The list at `path` `(n,)` [SI]; the paths of its entries end in `.1`, `.2`, ...
pub(super) fn quantity_list(cx: &Context, path: &str, value: &Value, kind: Kind) -> Option<Vec<f64>> {
    match value {
        Value::Array(list) => all(list.iter().enumerate().map(|(i, value)| {
            let key = format!("{path}.{}", i + 1);
            cx.quantity(&key, value, kind, Range::Any)
        })),
        Value::Table(table) => with_one_unit(cx, path, table, kind),
        other => {
            let expected = format!("a list, each {}, or {{ unit, values }}", kind.in_words());
            cx.wrong_type(path, other, expected);
            None
        }
    }
}

fn with_one_unit(cx: &Context, path: &str, table: &Table, kind: Kind) -> Option<Vec<f64>> {
    let before = cx.fault_count();
    for key in table.keys().filter(|key| !KEYS.contains(&key.as_str())) {
        cx.fault(format!("{path}.{key}"), FaultKind::unknown_key(key, KEYS.into_iter()));
    }
    let unit_key = format!("{path}.unit");
    let unit = match table.get("unit") {
        None if kind.takes_bare_numbers() => "",
        None => {
            cx.fault(unit_key, FaultKind::Missing { expected: format!("the unit of {}", kind.in_words()) });
            return None;
        }
        Some(Value::String(unit)) => unit,
        Some(other) => {
            cx.wrong_type(&unit_key, other, "a unit, e.g. \"mm\"".to_owned());
            return None;
        }
    };
    // One fault for a unit of another kind, not one for each value.
    if !unit.is_empty() {
        cx.value(&unit_key, &Value::String(format!("1 {unit}")), Some(kind))?;
    }
    let values_key = format!("{path}.values");
    let values = match table.get("values") {
        Some(Value::Array(values)) => values,
        Some(other) => {
            cx.wrong_type(&values_key, other, "a list of numbers".to_owned());
            return None;
        }
        None => {
            cx.fault(values_key, FaultKind::Missing { expected: "a list of numbers".to_owned() });
            return None;
        }
    };
    let found = all(values.iter().enumerate().map(|(i, value)| {
        let number = match value {
            Value::Integer(number) => *number as f64,
            Value::Float(number) => *number,
            other => {
                let expected = "a number: the unit stands beside the list".to_owned();
                cx.wrong_type(&format!("{values_key}.{}", i + 1), other, expected);
                return None;
            }
        };
        // With the bits of the same value written with its unit.
        let written =
            if unit.is_empty() { Value::Float(number) } else { Value::String(format!("{number:?} {unit}")) };
        cx.quantity(&format!("{path}.{}", i + 1), &written, kind, Range::Any)
    }));
    found.filter(|_| cx.fault_count() == before)
}

/// All values, or none if one is faulty; every one of them is read.
fn all(read: impl Iterator<Item = Option<f64>>) -> Option<Vec<f64>> {
    let read: Vec<Option<f64>> = read.collect();
    read.into_iter().collect()
}
