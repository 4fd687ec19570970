//! Reads the random variables of a scene: as written while the scene is read, and as distributions once the
//! nominal values of what they change are known.

use super::expression::read_unit;
use super::faults::{FaultKind, in_first_unit};
use super::quantity::{Dimension, Kind, NUMBER, Quantity};
use super::read::{Context, Range};
use super::section::Section;
use crate::random::{Distribution, RandomVariable};
use std::collections::BTreeMap;
use toml::Value;

/// Where a distribution is cut unless the scene says otherwise, in standard deviations.
const TRUNCATION: f64 = 3.0;

/// A row of `[[variables]]`, its numbers not yet read: their dimension depends on what the variable changes.
pub(super) struct VariableRow {
    name: String,
    pub(super) changes: Vec<String>,
    truncation: f64,
    unit: Option<String>,
    mean: Option<Value>,
    std: Value,
    lower: Option<Value>,
    upper: Option<Value>,
}

/// Reads `[[variables]]` as written; `inputs` of an external simulator change nothing in the scene.
pub(super) fn variable_rows(cx: &mut Context, file: &mut Section, inputs: bool) -> Vec<VariableRow> {
    let mut rows = Vec::new();
    for (name, mut row) in file.rows(cx, "variables") {
        let changes = if inputs { Some(vec![]) } else { changes(cx, &mut row) };
        let word = row.text_or(cx, "distribution", "truncated-normal", "truncated-normal");
        let known =
            word.and_then(|word| cx.word(&row.key("distribution"), word, &[("truncated-normal", ())]));
        let truncation = row.quantity_or(cx, "truncation", NUMBER, Range::Within(0.1, 10.0), TRUNCATION);
        let unit = row.get("unit").map(|_| row.text(cx, "unit", "a unit, e.g. \"mm\""));
        let [mean, lower, upper] = ["mean", "lower", "upper"].map(|key| row.get(key).cloned());
        let std = row.get("std").cloned();
        if std.is_none() {
            let expected = "a quantity, or a share of the mean such as \"0.2 %\"".to_owned();
            cx.fault(row.key("std"), FaultKind::Missing { expected });
        }
        row.finish(cx);
        rows.extend((|| {
            known?;
            let changes = changes?.into_iter().map(str::to_owned).collect();
            let unit = unit.map(|unit| unit.map(str::to_owned)).map_or(Some(None), |unit| unit.map(Some))?;
            let (truncation, std) = (truncation?, std?);
            Some(VariableRow { name: name.to_owned(), changes, truncation, unit, mean, std, lower, upper })
        })());
    }
    rows
}

/// The keys that a variable changes.
fn changes<'s>(cx: &mut Context, row: &mut Section<'s>) -> Option<Vec<&'s str>> {
    let changes = row.texts(cx, "changes", "a list of keys, e.g. [\"parameters.rod_length\"]");
    if changes.as_ref().is_some_and(Vec::is_empty) {
        cx.inconsistent(row.key("changes"), "is empty: the variable changes nothing");
    }
    changes.filter(|changes| !changes.is_empty())
}

/// Gives the variables their distributions, from the nominal values `seen` at the keys they change.
pub(super) fn variables(
    cx: &mut Context,
    rows: &[VariableRow],
    seen: &BTreeMap<String, Quantity>,
) -> Vec<RandomVariable> {
    let mut owners: BTreeMap<&str, &str> = BTreeMap::new();
    for row in rows {
        for key in &row.changes {
            if let Some(other) = owners.insert(key, &row.name) {
                let place = format!("variables.{}.changes", row.name);
                cx.inconsistent(place, format!("\"{key}\" is already changed by the variable \"{other}\""));
            }
        }
    }
    rows.iter().filter_map(|row| variable(cx, row, seen)).collect()
}

fn variable(
    cx: &mut Context,
    row: &VariableRow,
    seen: &BTreeMap<String, Quantity>,
) -> Option<RandomVariable> {
    let place = |key: &str| format!("variables.{}.{key}", row.name);
    let nominal = nominal(cx, row, seen)?;
    let dimension = nominal.dimension;
    let mean = match &row.mean {
        Some(written) => quantity(cx, &place("mean"), written, dimension)?,
        None => nominal.value,
    };
    let relative = row.std.as_str().is_some_and(|text| text.trim_end().ends_with('%'));
    let expected = if relative { Dimension::NONE } else { dimension };
    let mut std = quantity(cx, &place("std"), &row.std, expected)?;
    if relative {
        std *= mean.abs();
    }
    if !(std > 0.0 && std.is_finite()) {
        let (value, allowed) =
            (row.std.to_string(), "> 0; leave the variable out to hold it fixed".to_owned());
        cx.fault(place("std"), FaultKind::OutOfRange { value, allowed });
        return None;
    }
    let bound = |cx: &mut Context, key: &str, written: &Option<Value>, default: f64| match written {
        Some(written) => quantity(cx, &place(key), written, dimension),
        None => Some(default),
    };
    let reach = row.truncation * std;
    let lower = bound(cx, "lower", &row.lower, mean - reach);
    let upper = bound(cx, "upper", &row.upper, mean + reach);
    let (lower, upper) = (lower?, upper?);
    if !(lower < mean && mean < upper) {
        let shown = |value| in_first_unit(value, Kind::of(dimension));
        let message = format!(
            "the bounds {} and {} do not enclose the mean {}",
            shown(lower),
            shown(upper),
            shown(mean)
        );
        cx.inconsistent(format!("variables.{}", row.name), message);
        return None;
    }
    let unit = match &row.unit {
        Some(unit) => match read_unit(unit) {
            Ok(found) if found.dimension == dimension => unit.clone(),
            // A simulator's own unit, which nothing here converts.
            Err(_) if row.changes.is_empty() && dimension == Dimension::NONE => unit.clone(),
            found => {
                let bare = row.changes.is_empty() && dimension == Dimension::NONE && found.is_ok();
                let advice = if bare { format!("; write mean = \"{mean} {unit}\"") } else { String::new() };
                cx.inconsistent(place("unit"), format!("\"{unit}\" is no unit of {dimension}{advice}"));
                return None;
            }
        },
        None => dimension.si_unit(),
    };
    Some(RandomVariable {
        name: row.name.clone(),
        distribution: Distribution::TruncatedNormal { mean, std, lower, upper },
        changes: row.changes.clone(),
        unit,
    })
}

/// The value that all keys of the variable share without it; the mean of an input, which has no keys.
fn nominal(cx: &mut Context, row: &VariableRow, seen: &BTreeMap<String, Quantity>) -> Option<Quantity> {
    let place = format!("variables.{}.changes", row.name);
    if row.changes.is_empty() {
        let place = format!("variables.{}.mean", row.name);
        let Some(mean) = &row.mean else {
            let expected = "the mean of this input, a quantity or a plain number".to_owned();
            cx.fault(place, FaultKind::Missing { expected });
            return None;
        };
        return cx.value(&place, mean, None);
    }
    let mut first: Option<Quantity> = None;
    for key in &row.changes {
        cx.reference(&place, "quantity", key, seen.keys().map(String::as_str))?;
        let found = seen[key];
        match first {
            None => first = Some(found),
            Some(first) if first.dimension != found.dimension => {
                let message = format!("\"{key}\" is {}, the others are {}", found.dimension, first.dimension);
                cx.inconsistent(place, message);
                return None;
            }
            Some(first) if first.value != found.value && row.mean.is_none() => {
                let message = format!(
                    "the nominal values differ ({} and {}), so mean must be given",
                    in_first_unit(first.value, Kind::of(first.dimension)),
                    in_first_unit(found.value, Kind::of(found.dimension))
                );
                cx.inconsistent(place, message);
                return None;
            }
            Some(_) => {}
        }
    }
    first
}

fn quantity(cx: &mut Context, key: &str, written: &Value, dimension: Dimension) -> Option<f64> {
    cx.quantity(key, written, Kind::of(dimension), Range::Any)
}
