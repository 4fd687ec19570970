//! Reads gear pairs, racks and belts. Their lines of action follow from the bearings of their wheels on fixed bodies, elsewhere from the start
//! positions; their phases are those of the start angles.

use super::body_row::BodyRow;
use super::context::Range;
use super::joint::{JointKind, Mesh, MeshForm};
use super::model::Motion;
use super::monotone::monotone_value;
use super::quantity::{ANGLE, LENGTH};
use super::section::Section;
use super::values::{Attachment, Drive};
use std::f64::consts::{FRAC_PI_2, PI};

/// Largest pressure angle [rad].
const LARGEST_PRESSURE_ANGLE: f64 = 0.8;

/// Reads the keys of a gear pair, a belt or a rack; until [`line_of_action`] its direction is the axis of a rack.
pub(super) fn mesh(row: &mut Section, form: MeshForm) -> Option<JointKind> {
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
    let (radii, axis, pressure_angle) = (radii?, axis?, pressure?);
    if pressure_angle.abs() > LARGEST_PRESSURE_ANGLE {
        let found = format!("{:.1} deg", pressure_angle.to_degrees());
        return row.out_of_range("pressure_angle", found, "-45 deg to 45 deg").and(None);
    }
    if form == MeshForm::InternalGear && radii[0] == radii[1] {
        let message = "radius_a and radius_b are equal: one wheel does not fit into the other";
        return row.inconsistent_table(message).and(None);
    }
    let (direction, arms) = (along(axis), [0.0; 2]);
    Some(JointKind::Mesh(Mesh { form, radii, pressure_angle, direction, arms, value: 0.0, gap: 0.0 }))
}

/// The mesh between the places of a and b with its line of action and phase; none where the start of a body is not known. `hinges` are the
/// places of all hinges `(n, 2)`.
///
/// # Errors
/// What is wrong if there is no such line, or it would move.
pub(super) fn line_of_action(
    mesh: &Mesh,
    places: [&Attachment; 2],
    hinges: &[[Attachment; 2]],
    bodies: &[BodyRow],
) -> Result<Option<Mesh>, String> {
    // A rack has no bearing, and a wheel whose motion is given needs none.
    let held = |k: usize| match bodies[places[k].body].motion {
        Some(Motion::Free { .. }) if k == 1 || mesh.form != MeshForm::Rack => {
            bearing(hinges, bodies, places[k])
        }
        _ => Ok(None),
    };
    let bearings = [held(0)?, held(1)?];
    let [a, b] = [0, 1].map(|k| start(bodies, places[k], bearings[k]));
    Option::zip(a, b).map(|(a, b)| in_place(mesh, a, b)).transpose()
}

/// The place on a fixed body of a bearing in which this place of a wheel turns, if it has one [m].
///
/// # Errors
/// What is wrong if the bearing is on a body that moves.
fn bearing(
    hinges: &[[Attachment; 2]],
    bodies: &[BodyRow],
    wheel: &Attachment,
) -> Result<Option<[f64; 2]>, String> {
    let others = hinges.iter().filter_map(|places| match places {
        [own, other] if own == wheel => Some(other),
        [other, own] if own == wheel => Some(other),
        _ => None,
    });
    let mut moving = None;
    for place in others {
        match bodies[place.body].motion {
            Some(Motion::Fixed) => return Ok(Some(place.position)),
            None => {}
            Some(_) => moving = Some(&bodies[place.body].name),
        }
    }
    moving.map_or(Ok(None), |body| {
        Err(format!(
            "the bearing of a wheel is on body \"{body}\", which moves: the line of action is fixed, so both wheels turn on a fixed body"
        ))
    })
}

/// Position of a place [m] and angle of its body [rad] at the start, the position that of its `bearing` if it has one.
fn start(
    bodies: &[BodyRow],
    Attachment { body, position: [px, py] }: &Attachment,
    bearing: Option<[f64; 2]>,
) -> Option<([f64; 2], f64)> {
    let ([x, y], angle) = match bodies[*body].motion.as_ref()? {
        Motion::Fixed => ([0.0; 2], 0.0),
        Motion::Driven { position, drive: Drive::Angle(table), .. } => {
            (*position, monotone_value(table, 0.0))
        }
        Motion::Driven {
            position,
            drive: Drive::ConstantSpeed { start_angle, .. } | Drive::Speed { start_angle, .. },
            ..
        }
        | Motion::Free { start_position: position, start_angle, .. } => (*position, *start_angle),
    };
    let (sin, cos) = angle.sin_cos();
    Some((bearing.unwrap_or([x + cos * px - sin * py, y + sin * px + cos * py]), angle))
}

/// The mesh with its line of action, for position [m] and angle [rad] of the places of a and b.
///
/// # Errors
/// What is wrong if the places leave the line open.
fn in_place(mesh: &Mesh, (a, of_a): ([f64; 2], f64), (b, of_b): ([f64; 2], f64)) -> Result<Mesh, String> {
    let ([ra, rb], pressure) = (mesh.radii, mesh.pressure_angle);
    let d = [a[0] - b[0], a[1] - b[1]];
    let distance = d[0].hypot(d[1]);
    if distance == 0.0 && mesh.form != MeshForm::Rack {
        return Err("the centres of a and b coincide at the start".to_owned());
    }
    // Direction of the line from a to b; side on which the teeth of the flank that the pressure angle names push.
    let (centres, side) = ((-d[1]).atan2(-d[0]), 1f64.copysign(pressure));
    let quarter = side * FRAC_PI_2;
    let (angle, arms, gap) = match mesh.form {
        MeshForm::Gear => (centres - quarter - pressure, [-side * ra, -side * rb], distance - ra - rb),
        MeshForm::InternalGear => {
            let angle = if ra > rb { centres - quarter + pressure } else { centres + quarter - pressure };
            (angle, [-side * ra, side * rb], distance - (ra - rb).abs())
        }
        MeshForm::Belt if distance <= (ra - rb).abs() => {
            return Err("one pulley lies within the other".to_owned());
        }
        MeshForm::Belt => (centres - ((ra - rb) / distance).asin(), [-ra, rb], (distance - ra - rb).min(0.0)),
        MeshForm::Rack => {
            let [x, y] = mesh.direction;
            let across = x * d[1] - y * d[0];
            let turned = if (across > 0.0) == (side > 0.0) { 0.0 } else { PI };
            (y.atan2(x) + pressure + turned, [0.0, side * rb], across.abs() - rb)
        }
    };
    let (direction, arms) = (along(angle), arms.map(|arm| arm * pressure.cos()));
    let value = direction[0] * d[0] + direction[1] * d[1] + arms[0] * of_a + arms[1] * of_b;
    Ok(Mesh { direction, arms, value, gap, ..*mesh })
}

fn along(angle: f64) -> [f64; 2] {
    [angle.cos(), angle.sin()]
}
