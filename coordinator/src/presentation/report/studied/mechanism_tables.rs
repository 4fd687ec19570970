//! Tables of a mechanism: bodies with their motion, joints, hinges with clearance, and materials. Together with the tables of loads,
//! formulas and variables they state everything that the scene contains.

use super::exact::ExactTexts;
use crate::presentation::report::format::UNKNOWN;
use crate::presentation::report::page::captioned;
use crate::presentation::report::tables::table_of_text;
use crate::presentation::report::written::WrittenScene;
use common::scene::{
    Attachment, Clearance, ContactDamping, ControlPoints, Drive, JointKind, Motion, Scene, Value,
    WearingSurfaces,
};
use maud::{Markup, html};

/// All tables of bodies, joints and materials.
pub fn tables(scene: &Scene, written: &WrittenScene) -> Markup {
    html! {
            (bodies(scene, written))
            (starts(scene, written))
            (joints(scene, written))
            (hinges(scene, written))
    (super::materials::materials(scene, written))
        }
}

/// A table of rows of texts, each with the head of its column; nothing without a row.
pub(super) fn stated<const N: usize>(
    name: &str,
    title: &str,
    rows: impl Iterator<Item = [(&'static str, String); N]>,
) -> Markup {
    let mut rows = rows.peekable();
    let Some(first) = rows.peek() else { return html! {} };
    let head = first.each_ref().map(|(head, _)| *head);
    captioned(name, title, table_of_text(&head, rows.map(|row| row.map(|(_, text)| text))))
}

fn bodies(scene: &Scene, written: &WrittenScene) -> Markup {
    let (texts, dash) = (ExactTexts(written), || UNKNOWN.to_owned());
    let rows = scene.bodies.iter().map(|body| {
        let key = |last: &str| format!("bodies.{}.{last}", body.name);
        let mass = |mass: f64| texts.value(&key("mass"), mass, "g");
        let inertia = |inertia: f64| texts.value(&key("inertia"), inertia, "kg m^2");
        let centre = |centre: [f64; 2]| texts.pair(&key("centre_of_mass"), centre, "mm");
        let rest = match &body.motion {
            Motion::Fixed => ["fixed".to_owned(), dash(), dash(), dash()],
            Motion::Driven { position, drive, inertia: own } => {
                let about = texts.pair(&key("position"), *position, "mm");
                [
                    format!("driven about {about}, {}", how(drive, &texts, &body.name)),
                    own.as_ref().map_or_else(dash, |of| mass(of.mass)),
                    own.as_ref().map_or_else(dash, |of| inertia(of.inertia)),
                    own.as_ref().map_or_else(dash, |of| centre(of.centre_of_mass)),
                ]
            }
            Motion::Free { mass: m, inertia: i, centre_of_mass, .. } => {
                ["free".to_owned(), mass(*m), inertia(*i), centre(*centre_of_mass)]
            }
        };
        let point = |point: &common::scene::Point| {
            format!(
                "{} {}",
                point.name,
                texts.pair(&key(&format!("points.{}", point.name)), point.position, "mm")
            )
        };
        let points: Vec<String> = body.points.iter().map(point).collect();
        let [motion, mass, inertia, centre] = rest;
        [
            ("body", body.name.clone()),
            ("motion", motion),
            ("mass", mass),
            ("inertia", inertia),
            ("centre of mass [mm]", centre),
            ("points [mm]", points.join("; ")),
        ]
    });
    stated("bodies", "Bodies; inertia about the centre of mass; points in the frame of the body", rows)
}

fn how(drive: &Drive, texts: &ExactTexts<'_>, body: &str) -> String {
    let start = |angle: f64| texts.value(&format!("bodies.{body}.start_angle"), angle, "deg");
    match drive {
        Drive::ConstantSpeed { start_angle, speed } => {
            let speed = texts.value(&format!("bodies.{body}.speed"), *speed, "r/min");
            format!("{speed}, from {}", start(*start_angle))
        }
        Drive::Angle(_) => "angle by a table over time".to_owned(),
        Drive::Speed { start_angle, .. } => {
            format!("speed by a table over time, from {}", start(*start_angle))
        }
    }
}

/// Approximate state of the free bodies at time zero.
fn starts(scene: &Scene, written: &WrittenScene) -> Markup {
    let texts = ExactTexts(written);
    let rows = scene.bodies.iter().filter_map(|body| {
        let Motion::Free { start_position, start_angle, start_velocity, start_speed, .. } = &body.motion
        else {
            return None;
        };
        let key = |last: &str| format!("bodies.{}.{last}", body.name);
        let none = || UNKNOWN.to_owned();
        let velocity = start_velocity.map_or_else(none, |v| texts.pair(&key("start_velocity"), v, "m/s"));
        let speed = start_speed.map_or_else(none, |speed| texts.value(&key("start_speed"), speed, "r/min"));
        Some([
            ("body", body.name.clone()),
            ("position [mm]", texts.pair(&key("start_position"), *start_position, "mm")),
            ("angle", texts.value(&key("start_angle"), *start_angle, "deg")),
            ("velocity [m/s]", velocity),
            ("angular velocity", speed),
        ])
    });
    stated(
        "starts",
        "State of the free bodies at time zero: approximate positions, from which joints and drives are closed; velocities where they are given",
        rows,
    )
}

/// A place: its body, the name of its point where that is known, and its position in the frame of the body.
fn place(scene: &Scene, written: &WrittenScene, key: &str, at: &Attachment) -> String {
    let body = &scene.bodies[at.body].name;
    let texts = ExactTexts(written);
    match written.name(&format!("{key}.point")) {
        Some(point) => {
            let position = texts.pair(&format!("bodies.{body}.points.{point}"), at.position, "mm");
            format!("{body}.{point} {position}")
        }
        None => format!("{body} {}", texts.pair("", at.position, "mm")),
    }
}

/// The bodies or joints that the value of a key names.
pub(super) fn subject(scene: &Scene, written: &WrittenScene, key: &str, value: &Value) -> String {
    let body = |index: usize| scene.bodies[index].name.as_str();
    match value {
        Value::Place(at) => place(scene, written, key, at),
        Value::Body(index) => body(*index).to_owned(),
        Value::SignedBody(signed) => {
            let sign = if signed.sign < 0.0 { "\u{2212}" } else { "+" };
            format!("{sign}{} ({})", body(signed.body), signed.label)
        }
        Value::Joints(joints) => {
            joints.iter().map(|joint| scene.joints[*joint].name.as_str()).collect::<Vec<_>>().join(", ")
        }
        _ => String::new(),
    }
}

fn joints(scene: &Scene, written: &WrittenScene) -> Markup {
    let texts = ExactTexts(written);
    let rows = scene.joints.iter().map(|joint| {
        let key = |last: &str| format!("joints.{}.{last}", joint.name);
        let angle = |last: &str, angle: f64| texts.value(&key(last), angle, "deg");
        let kind = match &joint.kind {
            JointKind::Revolute => "revolute, ideal".to_owned(),
            JointKind::Prismatic { axis, angle: turned } => {
                format!("prismatic along {}, turned by {}", angle("axis", *axis), angle("angle", *turned))
            }
            JointKind::Fixed { angle: turned } => format!("rigid, turned by {}", angle("angle", *turned)),
            JointKind::Clearance(_) => "hinge with clearance".to_owned(),
            JointKind::Guide(_) => "slider in a guide with clearance".to_owned(),
            JointKind::Slot { axis } => format!("pin in a slot along {}", angle("axis", *axis)),
            JointKind::LinearDrive(Drive::ConstantSpeed { start_angle: length, speed }) => format!(
                "linear drive, {} at the start, {}",
                texts.value(&key("length"), *length, "mm"),
                texts.value(&key("speed"), *speed, "mm/s")
            ),
            JointKind::LinearDrive(_) => "linear drive by its curve".to_owned(),
            JointKind::Cam { direction: [x, y], .. } => {
                format!("cam, follower along {}, by its curve", angle("axis", y.atan2(*x)))
            }
            JointKind::Mesh(mesh) => {
                let (word, ..) = joint.kind.words();
                let keys = if word == "rack" { ["", "radius"] } else { ["radius_a", "radius_b"] };
                let radii = keys.iter().zip(mesh.radii).filter(|(_, radius)| *radius > 0.0);
                let radii: Vec<String> =
                    radii.map(|(name, radius)| texts.value(&key(name), radius, "mm")).collect();
                let pressure = angle("pressure_angle", mesh.pressure_angle);
                format!(
                    "{}, pitch radius {}, pressure angle {pressure}",
                    word.replace('-', " "),
                    radii.join(" and ")
                )
            }
        };
        let (_, ends, size) = joint.kind.words();
        let size = size.unwrap_or_default();
        let friction = joint.friction.map_or(String::new(), |friction| {
            format!(
                "; friction {}, friction speed {}, {} {}",
                texts.number(&key("friction"), friction.coefficient),
                texts.value(&key("friction_speed"), friction.speed, "mm/s"),
                size.replace('_', " "),
                texts.value(&key(size), friction.size, "mm")
            )
        });
        let [first, second] = [(ends[0], &joint.journal), (ends[1], &joint.bushing)]
            .map(|(end, at)| place(scene, written, &key(end), at));
        [
            ("joint", joint.name.clone()),
            ("kind", kind + &friction),
            ("journal, or first body [mm]", first),
            ("bushing, or second body [mm]", second),
        ]
    });
    stated("joints", "Joints, with their places in the frames of the bodies", rows)
}

/// Hinges with clearance, with what is modelled of them.
fn hinges(scene: &Scene, written: &WrittenScene) -> Markup {
    let texts = ExactTexts(written);
    let rows = scene.joints.iter().filter_map(|joint| {
        let JointKind::Clearance(clearance) = &joint.kind else { return None };
        let name = joint.name.as_str();
        let key = |last: &str| format!("joints.{name}.{last}");
        // One of the two follows from the other and the radius of the journal.
        let stated = |last: &str| written.quantity(&key(last)).is_some();
        let by_clearance = stated("radial_clearance");
        let following = |text: String, follows: bool| if follows { format!("({text})") } else { text };
        let radial = match by_clearance {
            true => texts.value(
                &key("radial_clearance"),
                nominal_clearance(scene, written, name, clearance),
                "um",
            ),
            false => rounded(clearance.radial_clearance(), 1e6, "µm"),
        };
        let radius = match by_clearance {
            true => rounded(clearance.bushing_radius, 1e3, "mm"),
            false => texts.value(&key("bushing_radius"), clearance.bushing_radius, "mm"),
        };
        let wall = clearance
            .wall
            .map_or(String::new(), |wall| format!("; wall {}", texts.value(&key("wall"), wall, "mm")));
        let coefficient = |last: &str, value: f64| texts.value(&key(last), value, "1/Pa");
        let wear = coefficient("wear_coefficient", clearance.wear_coefficient);
        let wear = match (clearance.wears, clearance.journal_wear_coefficient) {
            (WearingSurfaces::Bushing, _) => wear,
            (WearingSurfaces::Journal, _) => format!("{wear} (journal)"),
            (WearingSurfaces::Both, None) => format!("{wear} (both surfaces)"),
            (WearingSurfaces::Both, Some(journal)) => {
                format!("{wear}; journal {}", coefficient("journal_wear_coefficient", journal))
            }
        };
        let law = clearance.contact_law.name();
        let damping = damping(&clearance.contact_damping, &texts, &key("contact_damping"));
        Some([
            ("hinge", name.to_owned()),
            ("journal radius", texts.value(&key("journal_radius"), clearance.journal_radius, "mm")),
            ("radial clearance", following(radial.replace("um", "µm"), !by_clearance)),
            ("bushing radius", following(radius, by_clearance)),
            ("width", texts.value(&key("width"), clearance.width, "mm")),
            ("wear coefficient", wear),
            ("friction", texts.number(&key("friction"), clearance.friction)),
            ("friction speed", texts.value(&key("friction_speed"), clearance.friction_speed, "mm/s")),
            ("film damping", texts.value(&key("film_damping"), clearance.film_damping, "N s/m")),
            (
                "control points",
                match clearance.control_points {
                    ControlPoints::Number(number) => number.to_string(),
                    ControlPoints::ByArc => "by the contact arc".to_owned(),
                },
            ),
            ("law and damping of the contact", format!("{law}; {damping}{wall}")),
        ])
    });
    stated(
        "hinges",
        "Hinges with clearance; values in parentheses follow from the others; friction is regularised at the friction speed; a hinge \
         with the wear coefficient 0 does not wear",
        rows,
    )
}

/// The radial clearance of a hinge that states one: the mean of a variable that sets it, else what is written.
fn nominal_clearance(scene: &Scene, written: &WrittenScene, joint: &str, clearance: &Clearance) -> f64 {
    let key = format!("joints.{joint}.radial_clearance");
    let variable = scene.variables.iter().find(|variable| variable.changes.contains(&key));
    let mean = variable.map(|variable| variable.distribution.parent_mean());
    mean.or(written.quantity(&key)).unwrap_or(clearance.radial_clearance())
}

/// A value that follows from others.
fn rounded(value: f64, factor: f64, unit: &str) -> String {
    format!("{}\u{a0}{unit}", crate::presentation::report::format::seven_digits(factor * value))
}

pub(super) fn damping(damping: &ContactDamping, texts: &ExactTexts<'_>, key: &str) -> String {
    match damping {
        ContactDamping::None => "none".to_owned(),
        ContactDamping::HuntCrossley { factor } => {
            format!("hunt-crossley, {}", texts.value(&format!("{key}.hunt_crossley"), *factor, "s/m"))
        }
        ContactDamping::Restitution { law, coefficient, least_speed } => {
            let law = law.word();
            let e = texts.number(&format!("{key}.restitution"), *coefficient);
            let least = texts.value(&format!("{key}.least_speed"), *least_speed, "mm/s");
            format!("{law}, e = {e}, approach at least {least}")
        }
    }
}
