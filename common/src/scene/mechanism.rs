//! Reads bodies, materials, joints and loads.

use super::drive::*;
use super::faults::{FaultKind, six_digits};
use super::joint::*;
use super::load::*;
use super::model::*;
use super::quantity::*;
use super::read::{Context, Range};
use super::section::{Section, pair};

/// Fewer points cannot carry a spline of a bore, more are finer than any contact arc needs.
const CONTROL_POINTS: std::ops::RangeInclusive<i64> = 8..=360;
/// Control points of the wear profile unless the joint says otherwise.
const CONTROL_POINTS_DEFAULT: i64 = 36;
/// Poisson's ratio of an isotropic material that does not shrink sideways under pressure.
const POISSON: Range = Range::Within(0.0, 0.5);

/// Reads `[[bodies]]`. A faulty body keeps its place and points, so that references to it find it.
pub(super) fn bodies(cx: &mut Context, file: &mut Section) -> Vec<Body> {
    let mut bodies = Vec::new();
    for (name, mut row) in file.rows(cx, "bodies") {
        let motion = motion(cx, &mut row);
        let points = points(cx, &mut row);
        row.finish(cx);
        bodies.push(Body { name: name.to_owned(), motion: motion.unwrap_or(Motion::Fixed), points });
    }
    if bodies.is_empty() {
        cx.fault("bodies", FaultKind::Missing { expected: "at least one body, [[bodies]]".to_owned() });
    }
    bodies
}

fn motion(cx: &mut Context, row: &mut Section) -> Option<Motion> {
    #[derive(Clone, Copy)]
    enum Word {
        Fixed,
        Driven,
        Free,
    }
    let words = [("fixed", Word::Fixed), ("driven", Word::Driven), ("free", Word::Free)];
    match row.word(cx, "motion", &words)? {
        Word::Fixed => Some(Motion::Fixed),
        Word::Driven => {
            let position = row.pair(cx, "position", LENGTH);
            let start_angle = row.quantity_or(cx, "start_angle", ANGLE, Range::Any, 0.0);
            let speed = row.quantity(cx, "speed", ANGULAR_VELOCITY, Range::Any);
            if speed == Some(0.0) {
                let (value, allowed) = ("0".to_owned(), "not 0".to_owned());
                cx.fault(row.key("speed"), FaultKind::OutOfRange { value, allowed });
            }
            let drive = Drive::ConstantSpeed { start_angle: start_angle?, speed: speed? };
            Some(Motion::Driven { position: position?, drive, inertia: None })
        }
        Word::Free => {
            let mass = row.quantity(cx, "mass", MASS, Range::Positive);
            let inertia = row.quantity(cx, "inertia", INERTIA, Range::Positive);
            let centre_of_mass = row.pair(cx, "centre_of_mass", LENGTH);
            let start_position = row.pair(cx, "start_position", LENGTH);
            let start_angle = row.quantity(cx, "start_angle", ANGLE, Range::Any);
            Some(Motion::Free {
                mass: mass?,
                inertia: inertia?,
                centre_of_mass: centre_of_mass?,
                start_position: start_position?,
                start_angle: start_angle?,
                start_velocity: [0.0; 2],
                start_speed: 0.0,
            })
        }
    }
}

fn points(cx: &mut Context, row: &mut Section) -> Vec<Point> {
    let Some(section) = row.section_if_any(cx, "points") else { return Vec::new() };
    let mut points = Vec::new();
    for (name, value) in section.entries() {
        // A faulty point keeps its name, so that references to it are not faults as well.
        let position = pair(cx, &section.key(name), value, LENGTH).unwrap_or_default();
        points.push(Point { name: name.clone(), position });
    }
    points
}

/// Reads `[materials.NAME]`.
pub(super) fn materials(cx: &mut Context, file: &mut Section) -> Vec<(String, Option<Material>)> {
    let mut materials = Vec::new();
    for (name, mut section) in file.named(cx, "materials") {
        let elastic_modulus = section.quantity(cx, "elastic_modulus", PRESSURE, Range::Positive);
        let poisson_ratio = section.quantity(cx, "poisson_ratio", NUMBER, POISSON);
        section.finish(cx);
        let material = elastic_modulus.zip(poisson_ratio);
        let material =
            material.map(|(elastic_modulus, poisson_ratio)| Material { elastic_modulus, poisson_ratio });
        materials.push((name.to_owned(), material));
    }
    materials
}

/// Reads `{ body = "...", point = "..." }`.
fn attachment(cx: &mut Context, row: &mut Section, key: &'static str, bodies: &[Body]) -> Option<Attachment> {
    let mut place = row.section(cx, key, "a place { body, point }")?;
    let body = place.text(cx, "body", "the name of a body");
    let point = place.text(cx, "point", "the name of a point of that body");
    let (body_key, point_key) = (place.key("body"), place.key("point"));
    place.finish(cx);
    let body = cx.reference(&body_key, "body", body?, bodies.iter().map(|body| body.name.as_str()))?;
    let points = &bodies[body].points;
    let point = cx.reference(&point_key, "point", point?, points.iter().map(|point| point.name.as_str()))?;
    Some(Attachment { body, position: points[point].position })
}

/// Reads `[[joints]]`; names of faulty joints are kept, so that references to them find them.
pub(super) fn joints(
    cx: &mut Context,
    file: &mut Section,
    bodies: &[Body],
    materials: &[(String, Option<Material>)],
) -> Vec<(String, Option<Joint>)> {
    let mut joints = Vec::new();
    for (name, mut row) in file.rows(cx, "joints") {
        let kind = joint_kind(cx, &mut row, materials);
        let journal = attachment(cx, &mut row, "journal", bodies);
        let bushing = attachment(cx, &mut row, "bushing", bodies);
        if let (Some(journal), Some(bushing)) = (journal, bushing)
            && journal.body == bushing.body
        {
            cx.inconsistent(&row.path, "journal and bushing are on the same body");
        }
        row.finish(cx);
        let joint =
            (|| Some(Joint { name: name.to_owned(), journal: journal?, bushing: bushing?, kind: kind? }))();
        joints.push((name.to_owned(), joint));
    }
    if joints.is_empty() {
        cx.fault("joints", FaultKind::Missing { expected: "at least one joint, [[joints]]".to_owned() });
    }
    joints
}

fn joint_kind(
    cx: &mut Context,
    row: &mut Section,
    materials: &[(String, Option<Material>)],
) -> Option<JointKind> {
    match row.word(cx, "type", &[("clearance", true), ("ideal", false)])? {
        true => clearance(cx, row, materials).map(JointKind::Clearance),
        false => Some(JointKind::Revolute),
    }
}

fn clearance(
    cx: &mut Context,
    row: &mut Section,
    materials: &[(String, Option<Material>)],
) -> Option<Clearance> {
    let journal_radius = row.quantity(cx, "journal_radius", LENGTH, Range::Positive);
    let bushing_radius = bushing_radius(cx, row, journal_radius);
    let width = row.quantity(cx, "width", LENGTH, Range::Positive);
    let journal_material = material(cx, row, "journal_material", materials);
    let bushing_material = material(cx, row, "bushing_material", materials);
    let laws = [("local-hertz", ContactLaw::LocalHertz), ("foundation", ContactLaw::Foundation)];
    let law = row.text(cx, "contact_law", "one of local-hertz, foundation");
    let contact_law = law.and_then(|law| cx.word(&row.key("contact_law"), law, &laws));
    let contact_damping = contact_damping(cx, row);
    let film_damping = row.quantity_or(cx, "film_damping", DAMPING, Range::NonNegative, 0.0);
    let friction = row.quantity(cx, "friction", NUMBER, Range::Within(0.0, 2.0));
    let friction_speed = row.quantity(cx, "friction_speed", SPEED, Range::Positive);
    let wear_coefficient = row.quantity(cx, "wear_coefficient", INVERSE_PRESSURE, Range::NonNegative);
    let control_points = row.integer(cx, "control_points", CONTROL_POINTS, Some(CONTROL_POINTS_DEFAULT));
    Some(Clearance {
        journal_radius: journal_radius?,
        bushing_radius: bushing_radius?,
        width: width?,
        journal_material: journal_material?,
        bushing_material: bushing_material?,
        contact_law: contact_law?,
        contact_damping: contact_damping?,
        film_damping: film_damping?,
        friction: friction?,
        friction_speed: friction_speed?,
        wear_coefficient: wear_coefficient?,
        control_points: control_points? as usize,
        wall: None,
    })
}

/// The bushing is given by its radius or by the clearance it leaves to its journal.
fn bushing_radius(cx: &mut Context, row: &mut Section, journal_radius: Option<f64>) -> Option<f64> {
    if let Some(written) = row.get("radial_clearance") {
        if row.get("bushing_radius").is_some() {
            cx.inconsistent(&row.path, "give either bushing_radius or radial_clearance, not both");
            return None;
        }
        let clearance = cx.quantity(&row.key("radial_clearance"), written, LENGTH, Range::Positive)?;
        let journal_radius = journal_radius?;
        if clearance < journal_radius {
            return Some(journal_radius + clearance);
        }
        let key = row.key("radial_clearance");
        let value = cx.shown(&key, written, clearance);
        let allowed = format!("smaller than journal_radius = {} mm", six_digits(journal_radius * 1e3));
        cx.fault(key, FaultKind::OutOfRange { value, allowed });
        return None;
    }
    let radius = row.quantity(cx, "bushing_radius", LENGTH, Range::Positive)?;
    let journal_radius = journal_radius?;
    if radius > journal_radius && radius < 2.0 * journal_radius {
        return Some(radius);
    }
    let key = row.key("bushing_radius");
    let value = row.get("bushing_radius").map(|written| cx.shown(&key, written, radius)).unwrap_or_default();
    let allowed = format!(
        "larger than the journal and below twice that, journal_radius = {} mm",
        six_digits(journal_radius * 1e3)
    );
    cx.fault(key, FaultKind::OutOfRange { value, allowed });
    None
}

fn material(
    cx: &mut Context,
    row: &mut Section,
    key: &'static str,
    materials: &[(String, Option<Material>)],
) -> Option<Material> {
    let name = row.text(cx, key, "the name of a material")?;
    let i = cx.reference(&row.key(key), "material", name, materials.iter().map(|(name, _)| name.as_str()))?;
    materials[i].1
}

fn contact_damping(cx: &mut Context, row: &mut Section) -> Option<ContactDamping> {
    const EXPECTED: &str = "\"none\" or { hunt_crossley = \"7.5 s/m\" }";
    match row.get("contact_damping") {
        None => Some(ContactDamping::None),
        Some(toml::Value::String(word)) => {
            cx.word(&row.key("contact_damping"), word, &[("none", ContactDamping::None)])
        }
        Some(toml::Value::Table(_)) => {
            let mut law = row.section_if_any(cx, "contact_damping")?;
            let factor = law.quantity(cx, "hunt_crossley", INVERSE_SPEED, Range::NonNegative);
            law.finish(cx);
            factor.map(|factor| ContactDamping::HuntCrossley { factor })
        }
        Some(other) => {
            cx.wrong_type(&row.key("contact_damping"), other, EXPECTED.to_owned());
            None
        }
    }
}

/// Reads `[[loads]]`.
pub(super) fn loads(cx: &mut Context, file: &mut Section, bodies: &[Body]) -> Vec<Load> {
    let mut loads = Vec::new();
    for (name, mut row) in file.rows(cx, "loads") {
        loads.extend(load(cx, &mut row, name.to_owned(), bodies));
        row.finish(cx);
    }
    loads
}

fn load(cx: &mut Context, row: &mut Section, name: String, bodies: &[Body]) -> Option<Load> {
    #[derive(Clone, Copy)]
    enum Word {
        Spring,
        Force,
        Torque,
    }
    let words = [
        ("directional-spring", Word::Spring),
        ("constant-force", Word::Force),
        ("constant-torque", Word::Torque),
    ];
    match row.word(cx, "type", &words)? {
        Word::Spring => {
            let at = attachment(cx, row, "at", bodies);
            let anchor = attachment(cx, row, "anchor", bodies);
            let direction = row.pair(cx, "direction", NUMBER);
            let stiffness = row.quantity(cx, "stiffness", STIFFNESS, Range::NonNegative);
            let free_length = row.quantity(cx, "free_length", LENGTH, Range::Any);
            let [x, y] = direction?;
            let length = (x * x + y * y).sqrt();
            if length == 0.0 || !length.is_finite() {
                cx.inconsistent(row.key("direction"), "is no direction, expected e.g. [0, 1]");
                return None;
            }
            Some(Load::DirectionalSpring {
                name,
                at: at?,
                anchor: anchor?,
                direction: [x / length, y / length],
                stiffness: stiffness?,
                free_length: free_length?,
            })
        }
        Word::Force => {
            let at = attachment(cx, row, "at", bodies);
            let force = row.pair(cx, "force", FORCE);
            Some(Load::ConstantForce { name, at: at?, force: force? })
        }
        Word::Torque => {
            let body = row.text(cx, "body", "the name of a body");
            let torque = row.quantity(cx, "torque", TORQUE, Range::Any);
            let names = bodies.iter().map(|body| body.name.as_str());
            let body = cx.reference(&row.key("body"), "body", body?, names)?;
            Some(Load::ConstantTorque { name, body, torque: torque? })
        }
    }
}
