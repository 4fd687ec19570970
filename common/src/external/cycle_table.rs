//! One cycle as a table of comma-separated values: `time`, `JOINT.FIELD` as a reply names them, and the outputs, whose last value counts.

use super::reply::{is_non_finite_word, shown};
use serde_json::{Map, Value};

/// The object of a reply that the table stands for.
///
/// # Errors
/// The line and the column that is no number.
pub fn of_table(text: &str) -> Result<Map<String, Value>, String> {
    let mut lines = text.lines();
    let header = lines.next().unwrap_or_default();
    let names: Vec<&str> = header.split(',').map(|name| name.trim().trim_matches('"')).collect();
    if !names.contains(&"time") && !names.iter().any(|name| name.ends_with(".time")) {
        return Err(format!("line 1: \"{}\" has no column time", shown(header)));
    }
    let mut columns: Vec<Vec<Value>> = vec![vec![]; names.len()];
    for (k, line) in lines.enumerate().filter(|(_, line)| !line.trim().is_empty()) {
        let cells: Vec<&str> = line.split(',').map(str::trim).collect();
        if cells.len() != names.len() {
            return Err(format!("line {}: {} values, expected {}", k + 2, cells.len(), names.len()));
        }
        for ((cell, column), name) in cells.into_iter().zip(&mut columns).zip(&names) {
            let number = cell.parse().ok().and_then(serde_json::Number::from_f64).map(Value::Number);
            let word = is_non_finite_word(cell).then(|| Value::from(cell));
            let value = number.or(word);
            column.push(
                value.ok_or_else(|| format!("line {}, column {name}: \"{cell}\" is no number", k + 2))?,
            );
        }
    }
    let (mut reply, mut joints, mut outputs) = (Map::new(), Map::new(), Map::new());
    for (name, mut column) in names.into_iter().zip(columns) {
        if name == "time" {
            reply.insert(name.into(), column.into());
        } else if let Some((joint, field)) = name.split_once('.') {
            let of_joint = joints.entry(joint).or_insert_with(|| Value::Object(Map::new()));
            of_joint[field] = column.into();
        } else if let Some(last) = column.pop() {
            outputs.insert(name.into(), last);
        }
    }
    reply.insert("joints".into(), joints.into());
    reply.insert("outputs".into(), outputs.into());
    Ok(reply)
}
