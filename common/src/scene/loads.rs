//! Reads loads: springs, forces, torques, motors, drags.

use super::body_row::BodyRow;
use super::key_reading::{Named, values};
use super::key_table::{Form, Key, Value};
use super::load::Load;
use super::section::Section;

/// Reads `[[loads]]`; faulty ones are left out.
pub(super) fn loads(file: &mut Section, bodies: &[BodyRow]) -> Vec<Load> {
    let words: Vec<_> = Load::KINDS.iter().map(|kind| (kind.words[0].0, kind)).collect();
    let mut loads = Vec::new();
    for (_, mut row) in file.rows("loads") {
        if let Some(kind) = row.word("type", &words) {
            let read = values(&mut row, kind.keys, Named { bodies, joints: &[] });
            let is_consistent = check(&row, kind.keys, &read).is_some();
            let read = read.into_iter().collect::<Option<_>>().filter(|_| is_consistent);
            loads.extend(read.and_then(|read| Load::from_values(kind.name, read)));
        }
        row.finish();
    }
    loads
}

/// Checks the values of a load against each other.
fn check(row: &Section, keys: &[Key], values: &[Option<Value>]) -> Option<()> {
    let value = |name: &str| keys.iter().zip(values).find(|(key, _)| key.name == name)?.1.as_ref();
    let number = |name: &str| value(name).map_or(0.0, |value| f64::from(value.clone()));
    let contradiction = match (value("a"), value("b")) {
        (Some(Value::Place(a)), Some(Value::Place(b))) if a.body == b.body => "a and b are on the same body",
        (Some(Value::Body(a)), Some(Value::Body(b))) if a == b => "a and b are the same body",
        _ if value("upper").is_some() && value("lower").is_some() && number("lower") >= number("upper") => {
            "lower is not below upper"
        }
        _ if number("stall_torque") * number("no_load_speed") < 0.0 => {
            "stall_torque and no_load_speed have opposite signs: the torque would grow with the speed"
        }
        _ => return check_drag(row, keys),
    };
    row.inconsistent_table(contradiction);
    None
}

/// Checks that a drag has at least one of its coefficients.
fn check_drag(row: &Section, keys: &[Key]) -> Option<()> {
    let in_words = |name: &str| match keys.iter().find(|key| key.name == name)?.form {
        Form::NumberOr(kind, ..) => Some(kind.in_words()),
        _ => None,
    };
    let (Some(linear), Some(quadratic)) = (in_words("linear"), in_words("quadratic")) else {
        return Some(());
    };
    if row.peek("linear").is_none() && row.peek("quadratic").is_none() {
        row.missing("quadratic", format!("{quadratic}, or linear, {linear}"));
        return None;
    }
    Some(())
}
