//! Reads tables of a quantity over time or over the angle of a body: `{ over, at, value, repeat }`.

use super::body_row::{BodyRow, MotionWord, body};
use super::csv_import::SOURCE;
use super::faults::in_first_unit;
use super::quantity::{ANGLE, Kind, TIME};
use super::section::Section;
use super::values::{Curve, Over, Table};
use std::f64::consts::TAU;

/// Values that should be equal may differ by this much of the largest one: the rounding of expressions, no more.
const ROUNDING: f64 = 1e-12;
/// A span fits into another one if their ratio is whole to within this: six digits of a time written by hand.
const FIT: f64 = 1e-6;

/// How often `span` fits into `whole`, if it does a whole number of times.
pub(super) fn repetitions(whole: f64, span: f64) -> Option<f64> {
    let ratio = whole / span;
    let nearest = ratio.round();
    (nearest >= 1.0 && (ratio - nearest).abs() <= FIT * nearest).then_some(nearest)
}

/// Distance from the first argument to the last.
pub(super) fn span(table: &Table) -> f64 {
    table.at[table.at.len() - 1] - table.at[0]
}

/// Reads a table over time. One of angles goes on from where it ended, if it repeats; others end with the value they start with.
pub(super) fn over_time(row: &mut Section, key: &'static str, kind: Kind) -> Option<Table> {
    let mut section = row.section(key, "a table { over, at, value, repeat }")?;
    let over = section.choice("over", "\"time\"", &[("time", TIME)]);
    points(&mut section, over, kind, kind == ANGLE)
}

/// Reads a table over time or over the angle of a body.
pub(super) fn curve(row: &mut Section, key: &'static str, kind: Kind, bodies: &[BodyRow]) -> Option<Curve> {
    let mut section = row.section(key, "a table { over, at, value, repeat }")?;
    let over = over(&mut section, bodies);
    let arguments = over.map(|over| if over == Over::Time { TIME } else { ANGLE });
    let table = points(&mut section, arguments, kind, false)?;
    let over = over?;
    if table.repeat && matches!(over, Over::Angle(_)) && repetitions(TAU, span(&table)).is_none() {
        let span = in_first_unit(span(&table), ANGLE);
        let message = format!("repeats every {span}, and 360 deg is not a multiple of that");
        return section.inconsistent("at", message).and(None);
    }
    Some(Curve { over, table })
}

/// Reads `over`: `"time"` or `{ angle = BODY }`.
fn over(section: &mut Section, bodies: &[BodyRow]) -> Option<Over> {
    if !section.get("over").is_some_and(toml::Value::is_table) {
        return section.choice("over", "\"time\" or { angle = \"BODY\" }", &[("time", Over::Time)]);
    }
    let mut over = section.section_if_any("over")?;
    let found = body(&mut over, "angle", bodies);
    over.finish();
    let found = found?;
    if bodies[found].word == Some(MotionWord::Fixed) {
        let name = &bodies[found].name;
        let message = format!("the angle of \"{name}\" does not change: it is fixed");
        return over.inconsistent("angle", message).and(None);
    }
    Some(Over::Angle(found))
}

/// Reads the points of a table whose arguments are of a known kind, unless `over` was faulty. Of one that `goes_on` two points would be a
/// straight line, for which there is a speed.
fn points(section: &mut Section, arguments: Option<Kind>, kind: Kind, goes_on: bool) -> Option<Table> {
    let at = match arguments {
        Some(arguments) => section.quantities("at", arguments),
        None => section.get("at").and(None),
    };
    let value = section.quantities("value", kind);
    let repeat = section.boolean_or("repeat", true);
    // Known keys: what they name is in the table since the scene was read.
    let _ = (section.get("csv"), section.get("columns"));
    let _ = section.text_or(SOURCE, "where the values are from", "");
    section.finish();

    let (arguments, at, mut value, repeat) = (arguments?, at?, value?, repeat?);
    let faults = section.cx.fault_count();
    let needed = if repeat && goes_on { 3 } else { 2 };
    if at.len() < needed {
        section.inconsistent("at", format!("has {} of the at least {needed} arguments of a table", at.len()));
    }
    if at.len() != value.len() {
        section.inconsistent("value", format!("has {} values for {} arguments", value.len(), at.len()));
    }
    for (i, pair) in at.windows(2).enumerate().filter(|(_, pair)| pair[0] >= pair[1]) {
        let [before, here] = [pair[0], pair[1]].map(|x| in_first_unit(x, arguments));
        let allowed = format!("> {before}, the argument before it");
        section.out_of_range(&format!("at.{}", i + 2), here, allowed);
    }
    if section.cx.fault_count() > faults {
        return None;
    }
    if repeat && !goes_on {
        let (first, end) = (value[0], value.len() - 1);
        let largest = value.iter().fold(0.0, |largest: f64, x| largest.max(x.abs()));
        if (value[end] - first).abs() > ROUNDING * largest {
            let [first, last] = [first, value[end]].map(|x| in_first_unit(x, kind));
            let message = format!(
                "starts with {first} and ends with {last}: a table that repeats ends with the value it starts with"
            );
            return section.inconsistent("value", message).and(None);
        }
        value[end] = first;
    }
    Some(Table { at, value, repeat })
}
