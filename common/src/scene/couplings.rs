//! Reads ideal joints of one condition: gear pairs, racks, belts, linear drives, cams. The line of action and the phase of what meshes are those
//! of the start positions and angles.

use super::attachment::Attachment;
use super::body_row::BodyRow;
use super::context::Range;
use super::drive::{Curve, Drive, Over, Table};
use super::mesh::{Mesh, MeshForm};
use super::model::Motion;
use super::monotone::monotone_value;
use super::quantity::{ANGLE, LENGTH, SPEED};
use super::section::Section;
use super::tables::{Repetition, curve, over_time};
use std::f64::consts::FRAC_PI_2;

/// Largest pressure angle [rad].
const LARGEST_PRESSURE_ANGLE: f64 = 0.8;

/// Places of a joint: body and point of a, then of b.
type Places = [Attachment; 2];

/// Position of the reference point [m] and angle [rad] of a body at the start.
fn start(body: &BodyRow) -> Option<([f64; 2], f64)> {
    Some(match body.motion.as_ref()? {
        Motion::Fixed => ([0.0; 2], 0.0),
        Motion::Free { start_position, start_angle, .. } => (*start_position, *start_angle),
        Motion::Driven { position, drive, .. } => match drive {
            Drive::ConstantSpeed { start_angle, .. } | Drive::Speed { start_angle, .. } => {
                (*position, *start_angle)
            }
            Drive::Angle(table) => (*position, monotone_value(table, 0.0)),
        },
    })
}

/// Vector from the place of b to that of a at the start [m], and both angles [rad].
fn start_of(bodies: &[BodyRow], places: &Places) -> Option<([f64; 2], [f64; 2])> {
    let [a, b] = places.map(|at| {
        let ([x, y], angle) = start(&bodies[at.body])?;
        let (sin, cos) = angle.sin_cos();
        let [px, py] = at.position;
        Some(([x + cos * px - sin * py, y + sin * px + cos * py], angle))
    });
    let ((a, of_a), (b, of_b)) = (a?, b?);
    Some(([a[0] - b[0], a[1] - b[1]], [of_a, of_b]))
}

/// Reads the keys of a gear pair, a belt or a rack.
pub(super) fn mesh(
    row: &mut Section,
    form: MeshForm,
    bodies: &[BodyRow],
    places: Option<Places>,
) -> Option<Mesh> {
    let radius = |row: &mut Section, key| row.quantity(key, LENGTH, Range::Positive);
    let is_rack = form == MeshForm::Rack;
    let radii = match is_rack {
        true => radius(row, "radius").map(|radius| [0.0, radius]),
        false => Option::zip(radius(row, "radius_a"), radius(row, "radius_b")).map(<[f64; 2]>::from),
    };
    let axis = if is_rack { row.quantity_or("axis", ANGLE, Range::Any, 0.0) } else { Some(0.0) };
    let pressure = match form {
        MeshForm::Belt => Some(0.0),
        _ => row.quantity_or("pressure_angle", ANGLE, Range::Any, 20f64.to_radians()),
    };
    let (radii, axis, pressure) = (radii?, axis?, pressure?);
    if pressure.abs() > LARGEST_PRESSURE_ANGLE {
        row.out_of_range("pressure_angle", format!("{:.1} deg", pressure.to_degrees()), "-45 deg to 45 deg");
        return None;
    }
    let (d, angles) = start_of(bodies, &places?)?;
    let [of_a, of_b] = radii;
    let distance = d[0].hypot(d[1]);
    if form == MeshForm::InternalGear && of_a == of_b {
        row.inconsistent_table("radius_a and radius_b are equal: one wheel does not fit into the other");
        return None;
    }
    if distance == 0.0 && !is_rack {
        row.inconsistent_table("the centres of a and b coincide at the start");
        return None;
    }
    // Direction of the line from a to b, and of the motion of the rack.
    let centres = (-d[1]).atan2(-d[0]);
    let along = |angle: f64| [angle.cos(), angle.sin()];
    let (direction, arms) = match form {
        MeshForm::Gear => (centres + FRAC_PI_2 - pressure, [of_a, of_b]),
        MeshForm::InternalGear => {
            let side = if of_a > of_b { 1.0 } else { -1.0 };
            (centres + FRAC_PI_2 - pressure, [side * of_a, -side * of_b])
        }
        MeshForm::Belt => {
            let slope = ((of_a - of_b) / distance).clamp(-1.0, 1.0).asin();
            (centres - slope, [-of_a, of_b])
        }
        MeshForm::Rack => {
            let [x, y] = along(axis);
            let is_left = x * d[1] - y * d[0] > 0.0;
            (axis + pressure, [0.0, if is_left { of_b } else { -of_b }])
        }
    };
    let (direction, arms) = (along(direction), arms.map(|arm| arm * pressure.cos()));
    let value = direction[0] * d[0] + direction[1] * d[1] + arms[0] * angles[0] + arms[1] * angles[1];
    Some(Mesh { form, radii, pressure_angle: pressure, direction, arms, value })
}

/// Reads the distance of the places of a linear drive: by a table over time, or at a constant speed.
pub(super) fn linear_drive(row: &mut Section) -> Option<Drive> {
    let speed = row.get("speed").is_some();
    if row.get("length").is_some_and(toml::Value::is_table) {
        if speed {
            row.inconsistent("speed", "belongs to a length at the start; the table of lengths has its own");
        }
        let table = over_time(row, "length", LENGTH, Repetition::Closed)?;
        return match table.value.iter().position(|length| *length <= 0.0) {
            None => Some(Drive::Angle(table)),
            Some(k) => {
                row.out_of_range(&format!("length.value.{}", k + 1), format!("{} m", table.value[k]), "> 0");
                None
            }
        };
    }
    let length = row.quantity("length", LENGTH, Range::Positive);
    let speed = row.quantity("speed", SPEED, Range::NotZero);
    Some(Drive::ConstantSpeed { start_angle: length?, speed: speed? })
}

/// Reads the axis and the lift of a cam: the distance of the place of the follower from that of the cam along the axis.
pub(super) fn cam(
    row: &mut Section,
    bodies: &[BodyRow],
    places: Option<Places>,
) -> Option<([f64; 2], Table)> {
    let axis = row.quantity_or("axis", ANGLE, Range::Any, 0.0);
    let lift = curve(row, "lift", LENGTH, bodies);
    let (axis, Curve { over, table }, [_, cam]) = (axis?, lift?, places?);
    if over != Over::Angle(cam.body) {
        let cam = &bodies[cam.body].name;
        row.inconsistent("lift", format!("is a curve over the angle of b: over = {{ angle = \"{cam}\" }}"));
        return None;
    }
    Some(([axis.cos(), axis.sin()], table))
}
