//! Drives and loads of a drawing in words.

use crate::presentation::report::format::seven_digits;
use common::scene::{Drive, Form, Load, OutputUnit, Table, Value, filled};

/// The value that is largest in size, with its sign; 0 for none.
pub fn largest(values: &[f64]) -> f64 {
    values.iter().copied().fold(0.0, |most: f64, value| if value.abs() > most.abs() { value } else { most })
}

/// Smallest and largest value of a table, as numbers.
fn range(table: &Table, scale: f64) -> String {
    let least = table.value.iter().copied().fold(f64::INFINITY, f64::min);
    let most = table.value.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    format!("{} to {}", seven_digits(least * scale), seven_digits(most * scale))
}

/// A drive in words, and whether it begins counter-clockwise.
pub fn drive(drive: &Drive) -> (String, bool) {
    let unit = OutputUnit::AngularVelocity;
    match drive {
        Drive::ConstantSpeed { speed, .. } => {
            (unit.after(&seven_digits(unit.to_shown(speed.abs()))), *speed >= 0.0)
        }
        Drive::Angle(table) => {
            let first_change = table.value.windows(2).map(|pair| pair[1] - pair[0]).find(|step| *step != 0.0);
            (
                format!("angle {} deg by table", range(table, 1f64.to_degrees())),
                first_change.unwrap_or(1.0) > 0.0,
            )
        }
        Drive::Speed { table, .. } => (
            format!("{} by table", unit.after(&range(table, unit.to_shown(1.0)))),
            largest(&table.value) >= 0.0,
        ),
    }
}

/// Size of a load in words.
pub fn load(load: &Load) -> String {
    let values = load.values();
    let is_zero = |value: &Value| *value == Value::Number(0.0);
    filled(load.kind().words[0].1, |keys| {
        let mut named = keys.split('|').filter_map(|name| values.iter().find(|(key, _)| key.name == name));
        let shown = named.clone().find(|(_, value)| !is_zero(value)).or_else(|| named.next_back());
        shown.map_or_else(String::new, |(key, value)| size(key.form, value))
    })
}

/// The size of a value of this form, with its unit.
fn size(form: Form, value: &Value) -> String {
    let number = match value {
        Value::Number(number) => seven_digits(number.abs()),
        Value::Pair([x, y]) => seven_digits(x.hypot(*y)),
        Value::Curve(curve) => range(&curve.table, 1.0),
        _ => String::new(),
    };
    match form {
        Form::Number(kind, _) | Form::NumberOr(kind, ..) | Form::Pair(kind) | Form::Curve(kind) => {
            format!("{number} {}", kind.si.replace("^2", "²"))
        }
        _ => number,
    }
}
