//! Tables of a mechanism: bodies with their motion, joints, hinges with clearance, and materials. Together with the tables of loads,
//! formulas and variables they state everything that the scene contains.

use super::exact::ExactTexts;
use crate::presentation::report::format::UNKNOWN;
use crate::presentation::report::{WrittenScene, captioned, table_of_text};
use common::scene::{Attachment, Drive, JointKind, Motion, Scene, Value};
use maud::{Markup, html};

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

pub(super) fn bodies(scene: &Scene, written: &WrittenScene) -> Markup {
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
pub(super) fn starts(scene: &Scene, written: &WrittenScene) -> Markup {
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
    let title = "State of the free bodies at time zero: approximate positions, from which joints and drives are closed; velocities where they are given";
    stated("starts", title, rows)
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

pub(super) fn joints(scene: &Scene, written: &WrittenScene) -> Markup {
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
