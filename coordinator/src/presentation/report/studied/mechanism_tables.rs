//! Tables of a mechanism: bodies with their motion, joints, loads and gravity, and the curves by which loads and drives vary and that
//! outputs should follow. Together with the tables of hinges, formulas and variables they state everything that the scene contains.

use super::exact::{ExactTexts, exact, exact_number};
use crate::presentation::report::format::{UNKNOWN, joined};
use crate::presentation::report::{WrittenScene, captioned, table_of_text};
use common::scene::quantity::{ANGLE, ANGULAR_VELOCITY, Kind, LENGTH, NUMBER, SPEED};
use common::scene::{
    Attachment, Curve, Drive, Form, JointKind, Key, Load, Motion, OutputUnit, Over, Point, Scene, Table,
    Value,
};
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
    let rows = scene.bodies.iter().map(|body| {
        let texts = ExactTexts::below(written, format!("bodies.{}", body.name));
        let (motion, own) = match &body.motion {
            Motion::Fixed => ("fixed".to_owned(), None),
            Motion::Driven { position, drive, inertia } => {
                let about = texts.pair("position", *position, "mm");
                let own = inertia.as_ref().map(|of| (of.mass, of.inertia, of.centre_of_mass));
                (format!("driven about {about}, {}", how(drive, &texts)), own)
            }
            Motion::Free { mass, inertia, centre_of_mass, .. } => {
                ("free".to_owned(), Some((*mass, *inertia, *centre_of_mass)))
            }
        };
        let own = own.map(|(mass, inertia, centre)| {
            let centre = texts.pair("centre_of_mass", centre, "mm");
            [texts.value("mass", mass, "g"), texts.value("inertia", inertia, "kg m^2"), centre]
        });
        let [mass, inertia, centre] = own.unwrap_or([UNKNOWN; 3].map(str::to_owned));
        let points = body.points.iter().map(|Point { name, position }| {
            format!("{name} {}", texts.pair(&format!("points.{name}"), *position, "mm"))
        });
        [
            ("body", body.name.clone()),
            ("motion", motion),
            ("mass", mass),
            ("inertia", inertia),
            ("centre of mass [mm]", centre),
            ("points [mm]", joined(points, "; ")),
        ]
    });
    stated("bodies", "Bodies; inertia about the centre of mass; points in the frame of the body", rows)
}

fn how(drive: &Drive, texts: &ExactTexts<'_>) -> String {
    let start = |angle: f64| texts.value("start_angle", angle, "deg");
    match drive {
        Drive::ConstantSpeed { start_angle, speed } => {
            format!("{}, from {}", texts.value("speed", *speed, "r/min"), start(*start_angle))
        }
        Drive::Angle(_) => "angle by a table over time".to_owned(),
        Drive::Speed { start_angle, .. } => {
            format!("speed by a table over time, from {}", start(*start_angle))
        }
    }
}

/// Approximate state of the free bodies at time zero.
pub(super) fn starts(scene: &Scene, written: &WrittenScene) -> Markup {
    let rows = scene.bodies.iter().filter_map(|body| {
        let Motion::Free { start_position, start_angle, start_velocity, start_speed, .. } = &body.motion
        else {
            return None;
        };
        let texts = ExactTexts::below(written, format!("bodies.{}", body.name));
        let velocity = start_velocity.map(|velocity| texts.pair("start_velocity", velocity, "mm/s"));
        let speed = start_speed.map(|speed| texts.value("start_speed", speed, "r/min"));
        let [velocity, speed] = [velocity, speed].map(|text| text.unwrap_or_else(|| UNKNOWN.to_owned()));
        Some([
            ("body", body.name.clone()),
            ("position [mm]", texts.pair("start_position", *start_position, "mm")),
            ("angle", texts.value("start_angle", *start_angle, "deg")),
            ("velocity [mm/s]", velocity),
            ("angular velocity", speed),
        ])
    });
    let title = "State of the free bodies at time zero: approximate positions, from which joints and drives are closed; velocities where they are given";
    stated("starts", title, rows)
}

/// A place: its body, the name of its point where that is known, and its position in the frame of the body.
fn place(scene: &Scene, written: &WrittenScene, key: &str, at: &Attachment) -> String {
    let body = &scene.bodies[at.body].name;
    let texts = ExactTexts::below(written, format!("bodies.{body}.points"));
    match written.name(&format!("{key}.point")) {
        Some(point) => format!("{body}.{point} {}", texts.pair(point, at.position, "mm")),
        // A place without a name is written at a key of its own.
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
    let rows = scene.joints.iter().map(|joint| {
        let texts = ExactTexts::below(written, format!("joints.{}", joint.name));
        let angle = |last: &str, angle: f64| texts.value(last, angle, "deg");
        let kind = match &joint.kind {
            JointKind::Revolute => "revolute, ideal".to_owned(),
            JointKind::Prismatic { axis, angle: turned } => {
                format!("prismatic along {}, turned by {}", angle("axis", *axis), angle("angle", *turned))
            }
            JointKind::Fixed { angle: turned } => format!("rigid, turned by {}", angle("angle", *turned)),
            JointKind::Clearance(_) => "hinge with clearance".to_owned(),
            JointKind::Guide(_) => "slider in a guide with clearance".to_owned(),
            JointKind::Slot { axis } => format!("pin in a slot along {}", angle("axis", *axis)),
            JointKind::LinearDrive(Drive::ConstantSpeed { start_angle: length, speed }) => {
                let length = texts.value("length", *length, "mm");
                format!("linear drive, {length} at the start, {}", texts.value("speed", *speed, "mm/s"))
            }
            JointKind::LinearDrive(_) => "linear drive by its curve".to_owned(),
            JointKind::Cam { direction: [x, y], .. } => {
                format!("cam, follower along {}, by its curve", angle("axis", y.atan2(*x)))
            }
            JointKind::Mesh(mesh) => {
                let (word, ..) = joint.kind.words();
                let keys = if word == "rack" { ["", "radius"] } else { ["radius_a", "radius_b"] };
                let radii = keys.iter().zip(mesh.radii).filter(|(_, radius)| *radius > 0.0);
                let radii = joined(radii.map(|(name, radius)| texts.value(name, radius, "mm")), " and ");
                let pressure = angle("pressure_angle", mesh.pressure_angle);
                format!("{}, pitch radius {radii}, pressure angle {pressure}", word.replace('-', " "))
            }
        };
        let (_, ends, size) = joint.kind.words();
        let size = size.unwrap_or_default();
        let friction = joint.friction.map_or(String::new(), |friction| {
            format!(
                "; friction {}, friction speed {}, {} {}",
                texts.number("friction", friction.coefficient),
                texts.value("friction_speed", friction.speed, "mm/s"),
                size.replace('_', " "),
                texts.value(size, friction.size, "mm")
            )
        });
        let [first, second] = [(ends[0], &joint.journal), (ends[1], &joint.bushing)]
            .map(|(end, at)| place(scene, written, &texts.key(end), at));
        [
            ("joint", joint.name.clone()),
            ("kind", kind + &friction),
            ("journal, or first body [mm]", first),
            ("bushing, or second body [mm]", second),
        ]
    });
    stated("joints", "Joints, with their places in the frames of the bodies", rows)
}

/// Loads with all their values, and every curve with its points.
pub(super) fn loads(scene: &Scene, written: &WrittenScene) -> Markup {
    let mut rows: Vec<[String; 4]> = scene.loads.iter().map(|load| row(scene, written, load)).collect();
    if scene.gravity != [0.0; 2] {
        let pair = ExactTexts::below(written, "").pair("gravity", scene.gravity, "m/s^2");
        let unit = written.units.symbol("m/s^2").replace("^2", "²");
        rows.push(
            ["gravity", "gravity", "every body", &format!("acceleration {pair} {unit}")].map(str::to_owned),
        );
    }
    let head = ["load", "type", "acts on [mm]", "values"];
    let curves = curves(scene, written);
    html! {
        @if rows.is_empty() {
            p { "There are no loads but those of the joints." }
        } @else {
            (captioned("loads", "Loads", table_of_text(&head, rows)))
        }
        @if !curves.is_empty() {
            (captioned(
                "curves",
                "Curves of loads and drives, and of what outputs should be: values at arguments, smooth between them",
                table_of_text(&["curve of", "over", "repeated", "points", "from"], curves),
            ))
        }
    }
}

fn row(scene: &Scene, written: &WrittenScene, load: &Load) -> [String; 4] {
    let name = load.name();
    let texts = ExactTexts::below(written, format!("loads.{name}"));
    let (mut on, mut values) = (Vec::new(), Vec::new());
    for (key, value) in load.values() {
        match value {
            Value::Place(_) | Value::Body(_) => {
                let anchor = if key.name == "anchor" { "anchor " } else { "" };
                on.push(format!("{anchor}{}", subject(scene, written, &texts.key(key.name), &value)));
            }
            _ => values.extend(in_words(&texts, key, value)),
        }
    }
    [name, load.word().to_owned(), on.join(", "), values.join(", ")]
}

/// The words for the value of a key of a load; `None` for a curve that is not given.
fn in_words(texts: &ExactTexts<'_>, key: &Key, value: Value) -> Option<String> {
    let name = key.name.replace("no_load", "no-load").replace('_', " ");
    Some(match (value, key.form) {
        (Value::Number(number), Form::Number(kind, _) | Form::NumberOr(kind, ..)) => {
            format!("{name} {}", texts.value(key.name, number, unit(kind)))
        }
        (Value::Pair(pair), Form::Pair(kind)) => {
            format!(
                "{name} {} {}",
                texts.pair(key.name, pair, unit(kind)),
                texts.written.units.symbol(unit(kind))
            )
        }
        (Value::Pair([x, y]), _) => format!("along ({}, {})", exact_number(x), exact_number(y)),
        (Value::Curve(_), _) => "by its curve".to_owned(),
        (Value::MaybeCurve(Some(_)), _) => "times its curve".to_owned(),
        _ => return None,
    })
}

/// The unit in which a quantity of a load is stated.
fn unit(kind: Kind) -> &'static str {
    match kind {
        LENGTH => "mm",
        ANGLE => "deg",
        ANGULAR_VELOCITY => "r/min",
        SPEED => "mm/s",
        other => other.si,
    }
}

/// A value in its unit, which a plain number does not have.
fn value_of(value: f64, unit: &str) -> String {
    if unit.is_empty() { exact_number(value) } else { exact(value, unit) }
}

/// One row per curve, with all its points.
fn curves(scene: &Scene, written: &WrittenScene) -> Vec<[String; 5]> {
    let row = |of: String, key: String, over: String, table: &Table, units: [&str; 2]| {
        let [argument, value] = units.map(|unit| written.units.symbol(unit));
        let points = table.at.iter().zip(&table.value);
        let points = points.map(|(at, v)| format!("{}: {}", exact(*at, argument), value_of(*v, value)));
        let from = written.name(&format!("{key}.source")).unwrap_or("the scene").to_owned();
        [of, over, if table.repeat { "yes" } else { "no" }.to_owned(), joined(points, "; "), from]
    };
    let over_time = || "time".to_owned();
    let angle_of = |body: usize| format!("angle of {}", scene.bodies[body].name);
    let drives = scene.bodies.iter().filter_map(|body| {
        let Motion::Driven { drive, .. } = &body.motion else { return None };
        let (key, table, unit) = match drive {
            Drive::Angle(table) => ("angle", table, "deg"),
            Drive::Speed { table, .. } => ("speed", table, "r/min"),
            Drive::ConstantSpeed { .. } => return None,
        };
        let key = format!("bodies.{}.{key}", body.name);
        Some(row(body.name.clone(), key, over_time(), table, ["s", unit]))
    });
    let joints = scene.joints.iter().filter_map(|joint| {
        let (key, over, table, argument) = match &joint.kind {
            JointKind::LinearDrive(Drive::Angle(table)) => ("length", over_time(), table, "s"),
            JointKind::Cam { lift, .. } => ("lift", angle_of(joint.bushing.body), lift, "deg"),
            _ => return None,
        };
        Some(row(joint.name.clone(), format!("joints.{}.{key}", joint.name), over, table, [argument, "mm"]))
    });
    let of_curve = |of: String, key: String, curve: &Curve, unit: &'static str| {
        let (over, argument) = match curve.over {
            Over::Time => (over_time(), "s"),
            Over::Angle(body) => (angle_of(body), "deg"),
        };
        row(of, key, over, &curve.table, [argument, unit])
    };
    let loads = scene.loads.iter().filter_map(Load::curve).map(|(name, key, curve, kind)| {
        let path = format!("loads.{name}.{key}");
        of_curve(name, path, &curve, if kind == NUMBER { "" } else { kind.si })
    });
    let wanted = scene.outputs.iter().flat_map(|output| {
        let unit = if output.kind.unit() == OutputUnit::Angle { "deg" } else { "mm" };
        let curves = output.kind.curves().into_iter().map(|(key, curve)| {
            let of = format!("{}, {}", output.name, key.replace('_', " "));
            of_curve(of, format!("outputs.{}.{key}", output.name), &curve, unit)
        });
        curves.collect::<Vec<_>>()
    });
    drives.chain(joints).chain(loads).chain(wanted).collect()
}
