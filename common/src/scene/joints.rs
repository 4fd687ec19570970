//! Reads joints: ideal ones between two places, and those with clearance between journal and bushing.
//!
//! Reads ideal joints of one condition: gear pairs, racks, belts, linear drives, cams. The line of action and the phase of what meshes are those
//! of the start positions and angles.

use super::body_row::{BodyRow, place};
use super::clearance::{FRICTION, MaterialRow, clearance, guide};
use super::context::Range;
use super::faults::FaultKind;
use super::joint::{IdealFriction, Joint, JointKind, Mesh, MeshForm};
use super::model::Motion;
use super::monotone::monotone_value;
use super::quantity::{ANGLE, LENGTH, NUMBER, SPEED};
use super::section::{Section, record};
use super::tables::{curve, over_time};
use super::values::{Attachment, Curve, Drive, Over};
use std::f64::consts::FRAC_PI_2;

/// Table of the keys of all joints with clearance that do not have their own.
const DEFAULTS: &str = "joint_defaults";

/// A joint while its scene is read; a faulty one keeps its name, so that references to it are found.
pub(super) struct JointRow {
    pub(super) name: String,
    /// Reason why it does not wear; none if it wears.
    pub(super) unworn: Option<&'static str>,
    /// The joint; none if it is faulty.
    pub(super) joint: Option<Joint>,
}

/// Reads `[[joints]]`; a faulty joint keeps its row.
pub(super) fn joints(file: &mut Section, bodies: &[BodyRow], materials: &[MaterialRow]) -> Vec<JointRow> {
    let mut joints = Vec::new();
    let given = file.get(DEFAULTS);
    let defaults = given.and_then(toml::Value::as_table);
    if let Some(value) = given.filter(|value| !value.is_table()) {
        file.wrong_type(DEFAULTS, value, "a table of keys of joints with clearance");
    }
    let mut known: Vec<&'static str> = Vec::new();
    for (name, mut row) in file.rows("joints") {
        if row.peek("type").and_then(toml::Value::as_str) == Some("clearance") {
            row.defaults = defaults;
        }
        let (unworn, joint) = joint(&mut row, name, bodies, materials);
        row.finish();
        if defaults.is_some() {
            known.extend(&row.known);
        }
        joints.push(JointRow { name: name.to_owned(), unworn, joint });
    }
    for key in defaults.into_iter().flat_map(toml::Table::keys).filter(|key| !known.contains(&key.as_str())) {
        file.fault(&format!("{DEFAULTS}.{key}"), FaultKind::unknown_key(key, known.iter().copied()));
    }
    if joints.is_empty() {
        file.missing("joints", "at least one joint, [[joints]]");
    }
    moving_centres(file, &joints, bodies);
    joints
}

/// Records the wheels of gear pairs, racks and belts whose bearings are on a body that moves.
fn moving_centres(file: &mut Section, joints: &[JointRow], bodies: &[BodyRow]) {
    let read = || joints.iter().filter_map(|row| row.joint.as_ref());
    for joint in read() {
        let JointKind::Mesh(mesh) = &joint.kind else { continue };
        let wheels =
            [&joint.journal, &joint.bushing].into_iter().skip(usize::from(mesh.form == MeshForm::Rack));
        let bearings = wheels.flat_map(|wheel| {
            let hinges =
                read().filter(|other| matches!(other.kind, JointKind::Revolute | JointKind::Clearance(_)));
            hinges.filter_map(move |hinge| match [&hinge.journal, &hinge.bushing] {
                [own, other] if own == wheel => Some(other),
                [other, own] if own == wheel => Some(other),
                _ => None,
            })
        });
        let moves = |place: &&Attachment| !matches!(bodies[place.body].motion, None | Some(Motion::Fixed));
        if let Some(place) = bearings.into_iter().find(moves) {
            let what = format!(
                "the bearing of a wheel is on body \"{}\", which moves: the line of action is fixed, so both wheels turn on a fixed body",
                bodies[place.body].name
            );
            file.fault(&format!("joints.{}", joint.name), FaultKind::Inconsistent(what));
        }
    }
}

fn joint(
    row: &mut Section,
    name: &str,
    bodies: &[BodyRow],
    materials: &[MaterialRow],
) -> (Option<&'static str>, Option<Joint>) {
    let words = JointKind::WORDS.map(|words| (words.0, words));
    let Some((word, [first, second], size)) = row.word("type", &words) else { return (None, None) };
    let mut unworn = Some("is ideal");
    let (journal, bushing) = (place(row, first, bodies), place(row, second, bodies));
    let places = journal.zip(bushing).map(<[Attachment; 2]>::from);
    let mut angle = |key| row.quantity_or(key, ANGLE, Range::Any, 0.0);
    let kind = match word {
        "revolute" => Some(JointKind::Revolute),
        "prismatic" => record!(JointKind::Prismatic { axis: angle("axis"), angle: angle("angle") }),
        "fixed" => angle("angle").map(|angle| JointKind::Fixed { angle }),
        "clearance" | "guide" => {
            let (reason, kind) = with_clearance(row, word == "guide", materials, true);
            unworn = reason;
            kind
        }
        "slot" => angle("axis").map(|axis| JointKind::Slot { axis }),
        "linear-drive" => linear_drive(row).map(JointKind::LinearDrive),
        "gear" => mesh(row, MeshForm::Gear, bodies, places),
        "internal-gear" => mesh(row, MeshForm::InternalGear, bodies, places),
        "belt" => mesh(row, MeshForm::Belt, bodies, places),
        "rack" => mesh(row, MeshForm::Rack, bodies, places),
        _ => cam(row, bodies, places),
    };
    let friction = size.map_or(Some(None), |size| friction(row, size));
    if let (Some(journal), Some(bushing)) = (journal, bushing)
        && journal.body == bushing.body
    {
        row.inconsistent_table(format!("{first} and {second} are on the same body"));
    }
    let name = name.to_owned();
    let read =
        || Some(Joint { name, journal: journal?, bushing: bushing?, kind: kind?, friction: friction? });
    (unworn, read())
}

/// The place of both sides of every joint, on the body that stands for the mechanism.
const PLACE: Attachment = Attachment { body: 0, position: [0.0; 2] };

/// Reads the keys of a joint with clearance or a guide, whose friction may be missing unless it `rubs` here, after the reason why it does not wear.
fn with_clearance(
    row: &mut Section,
    is_guide: bool,
    materials: &[MaterialRow],
    rubs: bool,
) -> (Option<&'static str>, Option<JointKind>) {
    if is_guide {
        let unworn = row.peek("wears").is_none().then_some("is a guide without the key wears");
        return (unworn, guide(row, materials, rubs).map(JointKind::Guide));
    }
    let wears = row.boolean_or("wear", true);
    let unworn = (wears == Some(false)).then_some("has wear = false");
    (unworn, clearance(row, materials, wears == Some(true), rubs).map(JointKind::Clearance))
}

/// Reads a joint with clearance, or a guide that wears, whose bodies are those of a program.
pub(super) fn worn_joint(row: &mut Section, name: &str, materials: &[MaterialRow]) -> JointRow {
    let is_guide = row.word_or("type", &[("clearance", false), ("guide", true)], false);
    let (unworn, kind) = with_clearance(row, is_guide == Some(true), materials, false);
    let (kind, of_joint) = (kind.filter(|_| is_guide.is_some()), name.to_owned());
    let joint =
        kind.map(|kind| Joint { name: of_joint, journal: PLACE, bushing: PLACE, kind, friction: None });
    JointRow { name: name.to_owned(), unworn, joint }
}

/// Reads the friction of an ideal joint, of which `size` is the key of the length; outer none if it is faulty, inner none without
/// any of its keys.
fn friction(row: &mut Section, size: &'static str) -> Option<Option<IdealFriction>> {
    // All three are read, so that they are known keys.
    if ["friction", "friction_speed", size].map(|key| row.get(key)).iter().all(Option::is_none) {
        return Some(None);
    }
    let friction = record!(IdealFriction {
        coefficient: row.quantity("friction", NUMBER, FRICTION),
        speed: row.quantity("friction_speed", SPEED, Range::Positive),
        size: row.quantity(size, LENGTH, Range::Positive),
    });
    friction.map(Some)
}

/// The names that could be chosen instead, for a message; empty if there are none.
pub(super) fn listed<'a>(names: impl Iterator<Item = &'a str>) -> String {
    let names: Vec<&str> = names.collect();
    if names.is_empty() { String::new() } else { format!("; there are: {}", names.join(", ")) }
}

/// Indices of the joints that a row names under `joints`; none if one is unknown.
pub(super) fn chosen_joints(row: &mut Section, joints: &[JointRow]) -> Option<Vec<usize>> {
    let names = row.texts("joints", "a list of names of joints")?;
    if names.is_empty() {
        row.inconsistent("joints", "is empty, expected at least one joint");
    }
    let known = joints.iter().map(|joint| joint.name.as_str());
    let found: Vec<_> =
        names.iter().map(|name| row.reference("joints", "joint", name, known.clone())).collect();
    found.into_iter().collect::<Option<Vec<_>>>().filter(|chosen| !chosen.is_empty())
}

/// Largest pressure angle [rad].
const LARGEST_PRESSURE_ANGLE: f64 = 0.8;

/// Places of a joint: body and point of a, then of b.
type Places = [Attachment; 2];

/// Position of the reference point [m] and angle [rad] of a body at the start.
fn start(body: &BodyRow) -> Option<([f64; 2], f64)> {
    Some(match body.motion.as_ref()? {
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
) -> Option<JointKind> {
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
        let found = format!("{:.1} deg", pressure.to_degrees());
        return row.out_of_range("pressure_angle", found, "-45 deg to 45 deg").and(None);
    }
    let (d, angles) = start_of(bodies, &places?)?;
    let [of_a, of_b] = radii;
    let distance = d[0].hypot(d[1]);
    if form == MeshForm::InternalGear && of_a == of_b {
        let message = "radius_a and radius_b are equal: one wheel does not fit into the other";
        return row.inconsistent_table(message).and(None);
    }
    if distance == 0.0 && !is_rack {
        return row.inconsistent_table("the centres of a and b coincide at the start").and(None);
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
    Some(JointKind::Mesh(Mesh { form, radii, pressure_angle: pressure, direction, arms, value }))
}

/// Reads the distance of the places of a linear drive: by a table over time, or at a constant speed.
pub(super) fn linear_drive(row: &mut Section) -> Option<Drive> {
    let speed = row.get("speed").is_some();
    if row.get("length").is_some_and(toml::Value::is_table) {
        if speed {
            row.inconsistent("speed", "belongs to a length at the start; the table of lengths has its own");
        }
        let table = over_time(row, "length", LENGTH)?;
        return match table.value.iter().position(|length| *length <= 0.0) {
            None => Some(Drive::Angle(table)),
            Some(k) => {
                let (key, value) = (format!("length.value.{}", k + 1), format!("{} m", table.value[k]));
                row.out_of_range(&key, value, "> 0").and(None)
            }
        };
    }
    let length = row.quantity("length", LENGTH, Range::Positive);
    let speed = row.quantity("speed", SPEED, Range::NotZero);
    Some(Drive::ConstantSpeed { start_angle: length?, speed: speed? })
}

/// Reads the axis and the lift of a cam: the distance of the place of the follower from that of the cam along the axis.
pub(super) fn cam(row: &mut Section, bodies: &[BodyRow], places: Option<Places>) -> Option<JointKind> {
    let axis = row.quantity_or("axis", ANGLE, Range::Any, 0.0);
    let lift = curve(row, "lift", LENGTH, bodies);
    let (axis, Curve { over, table }, [_, cam]) = (axis?, lift?, places?);
    if over != Over::Angle(cam.body) {
        let cam = &bodies[cam.body].name;
        let message = format!("is a curve over the angle of b: over = {{ angle = \"{cam}\" }}");
        return row.inconsistent("lift", message).and(None);
    }
    Some(JointKind::Cam { direction: [axis.cos(), axis.sin()], lift: table })
}
