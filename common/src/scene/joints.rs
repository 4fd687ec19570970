//! Reads joints: ideal ones between two places, and those with clearance between journal and bushing.
//!
//! Linear drives and cams are read here, gear pairs, racks and belts in `meshes`.

use super::body_row::{BodyRow, place};
use super::clearance::{FRICTION, MaterialRow, clearance, guide};
use super::context::Range;
use super::faults::FaultKind;
use super::joint::{IdealFriction, Joint, JointKind, MeshForm};
use super::meshes::{line_of_action, mesh};
use super::quantity::{ANGLE, LENGTH, NUMBER, SPEED};
use super::section::{Section, record};
use super::tables::{curve, over_time};
use super::values::{Attachment, Curve, Drive, Over};

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
    let mut known: Option<Vec<&'static str>> = None;
    for (name, mut row) in file.rows("joints") {
        let has_clearance = row.peek("type").and_then(toml::Value::as_str) == Some("clearance");
        if has_clearance {
            row.defaults = defaults;
        }
        let (unworn, joint) = joint(&mut row, name, bodies, materials);
        row.finish();
        if has_clearance {
            let shared = row.known.iter().filter(|key| !OF_ONE.contains(key));
            known.get_or_insert_default().extend(shared);
        }
        joints.push(JointRow { name: name.to_owned(), unworn, joint });
    }
    check_defaults(file, defaults, known.as_deref());
    if joints.is_empty() {
        file.missing("joints", "at least one joint, [[joints]]");
    }
    lines_of_action(file, &mut joints, bodies);
    joints
}

/// Sets the lines of action of gear pairs, racks and belts, and records those that cannot be.
fn lines_of_action(file: &mut Section, joints: &mut [JointRow], bodies: &[BodyRow]) {
    let read = joints.iter().filter_map(|row| row.joint.as_ref());
    let hinges = read.filter(|joint| matches!(joint.kind, JointKind::Revolute | JointKind::Clearance(_)));
    let hinges: Vec<[Attachment; 2]> = hinges.map(|hinge| [hinge.journal, hinge.bushing]).collect();
    for row in joints {
        let Some(Joint { kind: JointKind::Mesh(mesh), journal, bushing, .. }) = &mut row.joint else {
            continue;
        };
        match line_of_action(mesh, [journal, bushing], &hinges, bodies) {
            Ok(found) => *mesh = found.unwrap_or_else(|| mesh.clone()),
            Err(what) => drop(file.fault(&format!("joints.{}", row.name), FaultKind::Inconsistent(what))),
        }
    }
}

/// Keys that every joint has for itself.
const OF_ONE: [&str; 4] = ["name", "type", "journal", "bushing"];

/// Records the defaults that have no effect: `known` are the keys of the joints that have them, if there are any.
fn check_defaults(file: &mut Section, defaults: Option<&toml::Table>, known: Option<&[&'static str]>) {
    match (defaults, known) {
        (Some(defaults), Some(known)) => {
            for key in defaults.keys().filter(|key| !known.contains(&key.as_str())) {
                let unknown = FaultKind::unknown_key(key, known.iter().copied());
                file.fault(&format!("{DEFAULTS}.{key}"), unknown);
            }
        }
        (Some(_), None) => drop(file.inconsistent(DEFAULTS, "no joint has type = \"clearance\"")),
        (None, _) => {}
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
        "gear" => mesh(row, MeshForm::Gear),
        "internal-gear" => mesh(row, MeshForm::InternalGear),
        "belt" => mesh(row, MeshForm::Belt),
        "rack" => mesh(row, MeshForm::Rack),
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

/// Reads the distance of the places of a linear drive: by a table over time, or at a constant speed.
fn linear_drive(row: &mut Section) -> Option<Drive> {
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
fn cam(row: &mut Section, bodies: &[BodyRow], places: Option<[Attachment; 2]>) -> Option<JointKind> {
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
