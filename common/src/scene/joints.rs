//! Reads joints: ideal ones between two places, and those with clearance between journal and bushing.

use super::attachment::Attachment;
use super::body_row::{BodyRow, place};
use super::clearance::{FRICTION, MaterialRow, clearance};
use super::context::Range;
use super::couplings::{cam, linear_drive, mesh};
use super::faults::FaultKind;
use super::guide::guide;
use super::joint::{IdealFriction, Joint, JointKind};
use super::mesh::MeshForm;
use super::quantity::{ANGLE, LENGTH, NUMBER, SPEED};
use super::record::record;
use super::section::Section;
use toml::Table;

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
    let defaults = match file.get(DEFAULTS) {
        Some(value) if !value.is_table() => {
            file.wrong_type(DEFAULTS, value, "a table of keys of joints with clearance");
            None
        }
        value => value.and_then(toml::Value::as_table),
    };
    let mut known: Vec<&'static str> = Vec::new();
    for (name, mut row) in file.rows("joints") {
        if row.peek("type").and_then(toml::Value::as_str) == Some("clearance") {
            row.with_defaults(defaults);
        }
        let (unworn, joint) = joint(&mut row, name, bodies, materials);
        row.finish();
        if defaults.is_some() {
            known.extend(row.known());
        }
        joints.push(JointRow { name: name.to_owned(), unworn, joint });
    }
    for key in defaults.into_iter().flat_map(Table::keys).filter(|key| !known.contains(&key.as_str())) {
        file.fault(&format!("{DEFAULTS}.{key}"), FaultKind::unknown_key(key, known.iter().copied()));
    }
    if joints.is_empty() {
        file.missing("joints", "at least one joint, [[joints]]");
    }
    joints
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
        "clearance" => {
            let wears = row.boolean_or("wear", true);
            unworn = (wears == Some(false)).then_some("has wear = false");
            clearance(row, materials, wears == Some(true), true).map(JointKind::Clearance)
        }
        "slot" => angle("axis").map(|axis| JointKind::Slot { axis }),
        "linear-drive" => linear_drive(row).map(JointKind::LinearDrive),
        "gear" => mesh(row, MeshForm::Gear, bodies, places).map(JointKind::Mesh),
        "internal-gear" => mesh(row, MeshForm::InternalGear, bodies, places).map(JointKind::Mesh),
        "belt" => mesh(row, MeshForm::Belt, bodies, places).map(JointKind::Mesh),
        "rack" => mesh(row, MeshForm::Rack, bodies, places).map(JointKind::Mesh),
        "cam" => cam(row, bodies, places).map(|(direction, lift)| JointKind::Cam { direction, lift }),
        _ => {
            unworn = row.peek("wears").is_none().then_some("is a guide without the key wears");
            guide(row, materials).map(JointKind::Guide)
        }
    };
    let friction = size.map_or(Some(None), |size| friction(row, size));
    if let (Some(journal), Some(bushing)) = (journal, bushing)
        && journal.body == bushing.body
    {
        row.inconsistent_table(format!("{first} and {second} are on the same body"));
    }
    let joint = kind.zip(friction).zip(journal.zip(bushing));
    let name = name.to_owned();
    let joint =
        joint.map(|((kind, friction), (journal, bushing))| Joint { name, journal, bushing, kind, friction });
    (unworn, joint)
}

/// The place of both sides of every joint, on the body that stands for the mechanism.
const PLACE: Attachment = Attachment { body: 0, position: [0.0; 2] };

/// Reads a joint with clearance whose bodies are those of a program.
pub(super) fn worn_joint(row: &mut Section, name: &str, materials: &[MaterialRow]) -> JointRow {
    let is_known = row.word_or("type", &[("clearance", ())], ());
    let wears = row.boolean_or("wear", true);
    let clearance = clearance(row, materials, wears == Some(true), false);
    let joint = clearance.filter(|_| is_known.is_some()).map(|clearance| Joint {
        name: name.to_owned(),
        journal: PLACE,
        bushing: PLACE,
        kind: JointKind::Clearance(clearance),
        friction: None,
    });
    JointRow { name: name.to_owned(), unworn: (wears == Some(false)).then_some("has wear = false"), joint }
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
