//! Tables of loads, gravity, and the curves by which loads and drives vary and that outputs should follow.

use super::exact::{ExactTexts, exact, exact_number};
use super::mechanism_tables::subject;
use crate::presentation::report::{WrittenScene, captioned, table_of_text};
use common::scene::quantity::{ANGLE, ANGULAR_VELOCITY, Kind, LENGTH, NUMBER};
use common::scene::{
    Curve, Drive, Form, JointKind, Key, Load, Motion, OutputUnit, Over, Scene, Table, Value,
};
use maud::{Markup, html};

/// Loads with all their values, and every curve with its points.
pub fn tables(scene: &Scene, written: &WrittenScene) -> Markup {
    let mut rows: Vec<[String; 4]> = scene.loads.iter().map(|load| row(scene, written, load)).collect();
    if scene.gravity != [0.0; 2] {
        let pair = ExactTexts(written).pair("gravity", scene.gravity, "m/s^2");
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
    let (mut on, mut values) = (Vec::new(), Vec::new());
    for (key, value) in load.values() {
        let path = format!("loads.{name}.{}", key.name);
        match value {
            Value::Place(_) | Value::Body(_) if key.name == "anchor" => {
                on.push(format!("anchor {}", subject(scene, written, &path, &value)));
            }
            Value::Place(_) | Value::Body(_) => on.push(subject(scene, written, &path, &value)),
            _ => values.extend(in_words(&ExactTexts(written), key, &path, value)),
        }
    }
    [name, load.word().to_owned(), on.join(", "), values.join(", ")]
}

/// The value of a key of a load at this path; `None` for one that says nothing of its own.
fn in_words(texts: &ExactTexts<'_>, key: &Key, path: &str, value: Value) -> Option<String> {
    let name = key.name.replace("no_load", "no-load").replace('_', " ");
    Some(match (value, key.form) {
        (Value::Number(number), Form::Number(kind, _) | Form::NumberOr(kind, ..)) => {
            format!("{name} {}", texts.value(path, number, unit(kind)))
        }
        (Value::Pair(pair), Form::Pair(kind)) => {
            format!("{name} {} {}", texts.pair(path, pair, unit(kind)), texts.0.units.symbol(unit(kind)))
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
        let points: Vec<String> = table
            .at
            .iter()
            .zip(&table.value)
            .map(|(at, v)| format!("{}: {}", exact(*at, argument), value_of(*v, value)))
            .collect();
        let from = written.name(&format!("{key}.source")).unwrap_or("the scene").to_owned();
        [of, over, if table.repeat { "yes" } else { "no" }.to_owned(), points.join("; "), from]
    };
    let drives = scene.bodies.iter().filter_map(|body| match &body.motion {
        Motion::Driven { drive: Drive::Angle(table), .. } => {
            let key = format!("bodies.{}.angle", body.name);
            Some(row(body.name.clone(), key, "time".into(), table, ["s", "deg"]))
        }
        Motion::Driven { drive: Drive::Speed { table, .. }, .. } => {
            let key = format!("bodies.{}.speed", body.name);
            Some(row(body.name.clone(), key, "time".into(), table, ["s", "r/min"]))
        }
        _ => None,
    });
    let joints = scene.joints.iter().filter_map(|joint| match &joint.kind {
        JointKind::LinearDrive(Drive::Angle(table)) => {
            let key = format!("joints.{}.length", joint.name);
            Some(row(joint.name.clone(), key, "time".into(), table, ["s", "mm"]))
        }
        JointKind::Cam { lift, .. } => {
            let over = format!("angle of {}", scene.bodies[joint.bushing.body].name);
            Some(row(joint.name.clone(), format!("joints.{}.lift", joint.name), over, lift, ["deg", "mm"]))
        }
        _ => None,
    });
    let of_curve = |of: String, key: String, curve: &Curve, unit: &'static str| {
        let (over, argument) = match curve.over {
            Over::Time => ("time".to_owned(), "s"),
            Over::Angle(body) => (format!("angle of {}", scene.bodies[body].name), "deg"),
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
