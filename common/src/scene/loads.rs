//! Reads loads: springs, forces, torques, motors.

use super::body_row::{BodyRow, body, place};
use super::faults::FaultKind;
use super::load::Load;
use super::quantity::*;
use super::read::{Context, Range};
use super::section::Section;
use super::tables::curve;

/// Reads `[[loads]]`; faulty ones are left out.
pub(super) fn loads(cx: &mut Context, file: &mut Section, bodies: &[BodyRow]) -> Vec<Load> {
    let mut loads = Vec::new();
    for (name, mut row) in file.rows(cx, "loads") {
        loads.extend(load(cx, &mut row, name.to_owned(), bodies));
        row.finish(cx);
    }
    loads
}

/// Reads the fields of one kind of load.
type Reader = fn(&mut Context, &mut Section, String, &[BodyRow]) -> Option<Load>;

fn load(cx: &mut Context, row: &mut Section, name: String, bodies: &[BodyRow]) -> Option<Load> {
    let words: [(&str, Reader); 8] = [
        ("directional-spring", directional_spring),
        ("constant-force", constant_force),
        ("constant-torque", constant_torque),
        ("spring", spring),
        ("torsion-spring", torsion_spring),
        ("force", force),
        ("torque", torque),
        ("motor", motor),
    ];
    let read = row.word(cx, "type", &words)?;
    read(cx, row, name, bodies)
}

fn directional_spring(cx: &mut Context, row: &mut Section, name: String, bodies: &[BodyRow]) -> Option<Load> {
    let at = place(cx, row, "at", bodies);
    let anchor = place(cx, row, "anchor", bodies);
    let direction = direction(cx, row);
    let stiffness = row.quantity(cx, "stiffness", STIFFNESS, Range::NonNegative);
    let free_length = row.quantity(cx, "free_length", LENGTH, Range::Any);
    Some(Load::DirectionalSpring {
        name,
        at: at?,
        anchor: anchor?,
        direction: direction?,
        stiffness: stiffness?,
        free_length: free_length?,
    })
}

fn constant_force(cx: &mut Context, row: &mut Section, name: String, bodies: &[BodyRow]) -> Option<Load> {
    let at = place(cx, row, "at", bodies);
    let force = row.pair(cx, "force", FORCE);
    Some(Load::ConstantForce { name, at: at?, force: force? })
}

fn constant_torque(cx: &mut Context, row: &mut Section, name: String, bodies: &[BodyRow]) -> Option<Load> {
    let body = body(cx, row, "body", bodies);
    let torque = row.quantity(cx, "torque", TORQUE, Range::Any);
    Some(Load::ConstantTorque { name, body: body?, torque: torque? })
}

fn spring(cx: &mut Context, row: &mut Section, name: String, bodies: &[BodyRow]) -> Option<Load> {
    let (a, b) = (place(cx, row, "a", bodies), place(cx, row, "b", bodies));
    let stiffness = row.quantity(cx, "stiffness", STIFFNESS, Range::NonNegative);
    let damping = row.quantity_or(cx, "damping", DAMPING, Range::NonNegative, 0.0);
    let free_length = row.quantity(cx, "free_length", LENGTH, Range::NonNegative);
    let (a, b) = (a?, b?);
    if a.body == b.body {
        cx.inconsistent(&row.path, "a and b are on the same body");
        return None;
    }
    Some(Load::Spring { name, a, b, stiffness: stiffness?, damping: damping?, free_length: free_length? })
}

fn torsion_spring(cx: &mut Context, row: &mut Section, name: String, bodies: &[BodyRow]) -> Option<Load> {
    let (a, b) = (body(cx, row, "a", bodies), body(cx, row, "b", bodies));
    let stiffness = row.quantity(cx, "stiffness", TORSIONAL_STIFFNESS, Range::NonNegative);
    let damping = row.quantity_or(cx, "damping", TORSIONAL_DAMPING, Range::NonNegative, 0.0);
    let free_angle = row.quantity_or(cx, "free_angle", ANGLE, Range::Any, 0.0);
    let (a, b) = (a?, b?);
    if a == b {
        cx.inconsistent(&row.path, "a and b are the same body");
        return None;
    }
    Some(Load::TorsionSpring {
        name,
        a,
        b,
        stiffness: stiffness?,
        damping: damping?,
        free_angle: free_angle?,
    })
}

fn force(cx: &mut Context, row: &mut Section, name: String, bodies: &[BodyRow]) -> Option<Load> {
    let at = place(cx, row, "at", bodies);
    let direction = direction(cx, row);
    let size = curve(cx, row, "size", FORCE, bodies);
    Some(Load::VariableForce { name, at: at?, direction: direction?, size: size? })
}

fn torque(cx: &mut Context, row: &mut Section, name: String, bodies: &[BodyRow]) -> Option<Load> {
    let body = body(cx, row, "body", bodies);
    let torque = curve(cx, row, "torque", TORQUE, bodies);
    Some(Load::VariableTorque { name, body: body?, torque: torque? })
}

fn motor(cx: &mut Context, row: &mut Section, name: String, bodies: &[BodyRow]) -> Option<Load> {
    let body = body(cx, row, "body", bodies);
    let stall_torque = row.quantity(cx, "stall_torque", TORQUE, Range::Any);
    let no_load_speed = row.quantity(cx, "no_load_speed", ANGULAR_VELOCITY, Range::NotZero);
    let (stall_torque, no_load_speed) = (stall_torque?, no_load_speed?);
    if stall_torque * no_load_speed < 0.0 {
        let message =
            "stall_torque and no_load_speed have opposite signs: the faster, the harder it would push";
        cx.inconsistent(&row.path, message);
        return None;
    }
    Some(Load::Motor { name, body: body?, stall_torque, no_load_speed })
}

/// Reads `direction`; of unit length.
fn direction(cx: &mut Context, row: &mut Section) -> Option<[f64; 2]> {
    let [x, y] = row.pair(cx, "direction", NUMBER)?;
    let length = (x * x + y * y).sqrt();
    if length == 0.0 || !length.is_finite() {
        let (value, allowed) = (format!("[{x}, {y}]"), "a direction, e.g. [0, 1]".to_owned());
        cx.fault(row.key("direction"), FaultKind::OutOfRange { value, allowed });
        return None;
    }
    Some([x / length, y / length])
}
