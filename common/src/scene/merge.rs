//! `extends`: a scene that changes tables of another one.
//!
//! Tables merge key by key; lists of named tables merge row by row, by name, new rows at the end; everything else is
//! replaced. What `scene.without` names is left out first.

use super::csv_import::SOURCE;
use toml::{Table, Value};

/// Keys of a variable that give its distribution without measured samples.
const PARAMETERS: [&str; 9] =
    ["distribution", "mean", "std", "truncation", "lower", "upper", "mode", "diameter", "capability"];

/// Keys of a curve or of samples whose values the scene states.
const VALUES: [&str; 3] = ["at", "value", "values"];

/// Merges `over` into `base`, in place.
pub(super) fn merge(base: &mut Table, over: Table) {
    if VALUES.iter().any(|key| over.contains_key(*key)) {
        base.remove(SOURCE);
    }
    for (key, value) in over {
        match (base.get_mut(&key), value) {
            (Some(Value::Table(below)), Value::Table(above)) => merge(below, above),
            (Some(Value::Array(below)), Value::Array(above)) if named(below) && named(&above) => {
                merge_rows(below, above);
            }
            (_, value) => {
                base.insert(key, value);
            }
        }
    }
}

/// Removes a key, or a row of a list of named tables, by its path, e.g. `loads.push`: false if there is none.
pub(super) fn leave_out(base: &mut Table, path: &str) -> bool {
    let (first, rest) = match path.split_once('.') {
        Some((first, rest)) => (first, Some(rest)),
        None => (path, None),
    };
    let Some(rest) = rest else { return base.remove(first).is_some() };
    match base.get_mut(first) {
        Some(Value::Table(inner)) => leave_out(inner, rest),
        Some(Value::Array(rows)) => {
            let (row, rest) = match rest.split_once('.') {
                Some((row, rest)) => (row, Some(rest)),
                None => (rest, None),
            };
            let Some(place) = rows.iter().position(|other| name(other) == Some(row)) else { return false };
            match rest {
                None => {
                    rows.remove(place);
                    true
                }
                Some(rest) => rows[place].as_table_mut().is_some_and(|row| leave_out(row, rest)),
            }
        }
        _ => false,
    }
}

fn name(row: &Value) -> Option<&str> {
    row.as_table()?.get("name")?.as_str()
}

fn named(rows: &[Value]) -> bool {
    !rows.is_empty() && rows.iter().all(|row| name(row).is_some())
}

/// Removes the measured samples of a variable whose distribution is given by parameters above, and the reverse.
fn replace_distribution(below: &mut Table, above: &Table) {
    let is_parameter = |key: &str| PARAMETERS.contains(&key);
    if above.contains_key("samples") {
        below.retain(|key, _| key != "fit" && !is_parameter(key));
    } else if below.contains_key("samples") && above.keys().any(|key| is_parameter(key)) {
        below.retain(|key, _| key != "samples" && key != "fit");
    }
}

/// Removes the thresholds of a limit state on whose place others stand above: one where two are given, and the reverse.
fn replace_thresholds(below: &mut Table, above: &Table) {
    let two = |row: &Table| row.contains_key("lower") || row.contains_key("upper");
    let had_two = two(below);
    if !below.contains_key("output") || had_two == two(above) {
        return;
    }
    if above.contains_key("threshold") {
        below.retain(|key, _| !["lower", "upper", "fails"].contains(&key));
    } else if !had_two {
        below.retain(|key, _| !["threshold", "fails"].contains(&key));
    }
}

fn merge_rows(base: &mut Vec<Value>, over: Vec<Value>) {
    let inherited = base.len();
    for row in over {
        let place = base[..inherited].iter().position(|below| name(below) == name(&row));
        match (place.map(|i| &mut base[i]), row) {
            (Some(Value::Table(below)), Value::Table(above)) => {
                replace_distribution(below, &above);
                replace_thresholds(below, &above);
                merge(below, above);
            }
            // Rows of the same file with one name stay two rows: the reader reports the duplicate.
            (_, row) => base.push(row),
        }
    }
}
