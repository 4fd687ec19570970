//! Reads loads: springs, forces, torques, motors, drags.

use super::body_row::{BodyRow, body, place};
use super::context::Range;
use super::drive::Curve;
use super::load::Load;
use super::quantity::*;
use super::section::Section;
use super::tables::curve;

/// Reads `[[loads]]`; faulty ones are left out.
pub(super) fn loads(file: &mut Section, bodies: &[BodyRow]) -> Vec<Load> {
    let mut loads = Vec::new();
    for (name, mut row) in file.rows("loads") {
        loads.extend(load(&mut row, name.to_owned(), bodies));
        row.finish();
    }
    loads
}

/// Reads the fields of one kind of load.
type Reader = fn(&mut Section, String, &[BodyRow]) -> Option<Load>;

fn load(row: &mut Section, name: String, bodies: &[BodyRow]) -> Option<Load> {
    let words: [(&str, Reader); 10] = [
        ("directional-spring", directional_spring),
        ("constant-force", constant_force),
        ("constant-torque", constant_torque),
        ("spring", spring),
        ("torsion-spring", torsion_spring),
        ("force", force),
        ("torque", torque),
        ("motor", motor),
        ("drag", drag),
        ("rotational-drag", rotational_drag),
    ];
    let read = row.word("type", &words)?;
    read(row, name, bodies)
}

fn directional_spring(row: &mut Section, name: String, bodies: &[BodyRow]) -> Option<Load> {
    let at = place(row, "at", bodies);
    let anchor = place(row, "anchor", bodies);
    let direction = direction(row);
    let stiffness = row.quantity("stiffness", STIFFNESS, Range::NonNegative);
    let free_length = row.quantity("free_length", LENGTH, Range::Any);
    Some(Load::DirectionalSpring {
        name,
        at: at?,
        anchor: anchor?,
        direction: direction?,
        stiffness: stiffness?,
        free_length: free_length?,
    })
}

fn constant_force(row: &mut Section, name: String, bodies: &[BodyRow]) -> Option<Load> {
    let at = place(row, "at", bodies);
    let force = row.pair("force", FORCE);
    Some(Load::ConstantForce { name, at: at?, force: force? })
}

fn constant_torque(row: &mut Section, name: String, bodies: &[BodyRow]) -> Option<Load> {
    let body = body(row, "body", bodies);
    let torque = row.quantity("torque", TORQUE, Range::Any);
    Some(Load::ConstantTorque { name, body: body?, torque: torque? })
}

fn spring(row: &mut Section, name: String, bodies: &[BodyRow]) -> Option<Load> {
    let (a, b) = (place(row, "a", bodies), place(row, "b", bodies));
    let stiffness = row.quantity("stiffness", STIFFNESS, Range::NonNegative);
    let damping = row.quantity_or("damping", DAMPING, Range::NonNegative, 0.0);
    let free_length = row.quantity("free_length", LENGTH, Range::NonNegative);
    let (a, b) = (a?, b?);
    if a.body == b.body {
        row.inconsistent_table("a and b are on the same body");
        return None;
    }
    Some(Load::Spring { name, a, b, stiffness: stiffness?, damping: damping?, free_length: free_length? })
}

fn torsion_spring(row: &mut Section, name: String, bodies: &[BodyRow]) -> Option<Load> {
    let (a, b) = (body(row, "a", bodies), body(row, "b", bodies));
    let stiffness = row.quantity("stiffness", TORSIONAL_STIFFNESS, Range::NonNegative);
    let damping = row.quantity_or("damping", TORSIONAL_DAMPING, Range::NonNegative, 0.0);
    let free_angle = row.quantity_or("free_angle", ANGLE, Range::Any, 0.0);
    let (a, b) = (a?, b?);
    if a == b {
        row.inconsistent_table("a and b are the same body");
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

fn force(row: &mut Section, name: String, bodies: &[BodyRow]) -> Option<Load> {
    let at = place(row, "at", bodies);
    let direction = direction(row);
    let size = curve(row, "size", FORCE, bodies);
    Some(Load::VariableForce { name, at: at?, direction: direction?, size: size? })
}

fn torque(row: &mut Section, name: String, bodies: &[BodyRow]) -> Option<Load> {
    let body = body(row, "body", bodies);
    let torque = curve(row, "torque", TORQUE, bodies);
    Some(Load::VariableTorque { name, body: body?, torque: torque? })
}

fn motor(row: &mut Section, name: String, bodies: &[BodyRow]) -> Option<Load> {
    let body = body(row, "body", bodies);
    let stall_torque = row.quantity("stall_torque", TORQUE, Range::Any);
    let no_load_speed = row.quantity("no_load_speed", ANGULAR_VELOCITY, Range::NotZero);
    let (stall_torque, no_load_speed) = (stall_torque?, no_load_speed?);
    if stall_torque * no_load_speed < 0.0 {
        let message =
            "stall_torque and no_load_speed have opposite signs: the torque would grow with the speed";
        row.inconsistent_table(message);
        return None;
    }
    Some(Load::Motor { name, body: body?, stall_torque, no_load_speed })
}

fn drag(row: &mut Section, name: String, bodies: &[BodyRow]) -> Option<Load> {
    let at = place(row, "at", bodies);
    let direction = direction(row);
    let [linear, quadratic] = coefficients(row, [DAMPING, DRAG]);
    let flow = row.quantity_or("flow", SPEED, Range::Any, 0.0);
    let factor = factor(row, bodies);
    Some(Load::Drag {
        name,
        at: at?,
        direction: direction?,
        linear: linear?,
        quadratic: quadratic?,
        flow: flow?,
        factor: factor?,
    })
}

fn rotational_drag(row: &mut Section, name: String, bodies: &[BodyRow]) -> Option<Load> {
    let body = body(row, "body", bodies);
    let [linear, quadratic] = coefficients(row, [TORSIONAL_DAMPING, TORSIONAL_DRAG]);
    let factor = factor(row, bodies);
    Some(Load::RotationalDrag { name, body: body?, linear: linear?, quadratic: quadratic?, factor: factor? })
}

/// Reads the coefficients `linear` and `quadratic` of a drag, at least one of them.
fn coefficients(row: &mut Section, [linear, quadratic]: [Kind; 2]) -> [Option<f64>; 2] {
    if row.get("linear").is_none() && row.get("quadratic").is_none() {
        row.missing("quadratic", format!("{}, or linear, {}", quadratic.in_words(), linear.in_words()));
    }
    [("linear", linear), ("quadratic", quadratic)]
        .map(|(key, kind)| row.quantity_or(key, kind, Range::NonNegative, 0.0))
}

/// Reads the curve `factor` of a drag, if there is one; the outer `None` for a faulty one.
fn factor(row: &mut Section, bodies: &[BodyRow]) -> Option<Option<Curve>> {
    if row.get("factor").is_none() {
        return Some(None);
    }
    let factor = curve(row, "factor", NUMBER, bodies)?;
    let least = factor.table.value.iter().copied().fold(f64::INFINITY, f64::min);
    if least < 0.0 {
        row.out_of_range("factor.value", least.to_string(), ">= 0: a drag slows down");
        return None;
    }
    Some(Some(factor))
}

/// Reads `direction`; of unit length.
fn direction(row: &mut Section) -> Option<[f64; 2]> {
    let [x, y] = row.pair("direction", NUMBER)?;
    let length = (x * x + y * y).sqrt();
    if length == 0.0 || !length.is_finite() {
        row.out_of_range("direction", format!("[{x}, {y}]"), "a direction, e.g. [0, 1]");
        return None;
    }
    Some([x / length, y / length])
}
