//! Drives and loads of a drawing in words.

use crate::presentation::report::format::seven_digits;
use common::scene::{Drive, Load, OutputUnit, Table};

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

/// Name of a load, and its size in words.
pub fn load(load: &Load) -> (String, String) {
    let (name, size) = match load {
        Load::DirectionalSpring { name, stiffness, .. } | Load::Spring { name, stiffness, .. } => {
            (name, format!("{} N/m", seven_digits(*stiffness)))
        }
        Load::ConstantForce { name, force: [x, y], .. } => (name, format!("{} N", seven_digits(x.hypot(*y)))),
        Load::ConstantTorque { name, torque, .. } => (name, format!("{} N m", seven_digits(torque.abs()))),
        Load::TorsionSpring { name, stiffness, .. } => {
            (name, format!("{} N m/rad", seven_digits(*stiffness)))
        }
        Load::VariableForce { name, size, .. } => (name, format!("{} N", range(&size.table, 1.0))),
        Load::VariableTorque { name, torque, .. } => (name, format!("{} N m", range(&torque.table, 1.0))),
        Load::Motor { name, stall_torque, .. } => {
            (name, format!("{} N m at rest", seven_digits(stall_torque.abs())))
        }
        Load::Drag { name, quadratic, .. } if *quadratic > 0.0 => {
            (name, format!("{} N s²/m²", seven_digits(*quadratic)))
        }
        Load::Drag { name, linear, .. } => (name, format!("{} N s/m", seven_digits(*linear))),
        Load::RotationalDrag { name, quadratic, .. } if *quadratic > 0.0 => {
            (name, format!("{} N m s²/rad²", seven_digits(*quadratic)))
        }
        Load::RotationalDrag { name, linear, .. } => (name, format!("{} N m s/rad", seven_digits(*linear))),
    };
    (name.clone(), size)
}
