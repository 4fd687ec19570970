//! Tables of loads, gravity, and the curves by which loads and drives vary and that outputs should follow.

use super::exact::{ExactTexts, exact, exact_number};
use super::mechanism_tables::place;
use crate::presentation::report::page::captioned;
use crate::presentation::report::tables::{cells, table_of_text};
use crate::presentation::report::written::WrittenScene;
use common::scene::{Curve, Drive, Load, Motion, OutputUnit, Over, Scene, Table};
use maud::{Markup, html};

/// Loads with all their values, and every curve with its points.
pub fn tables(scene: &Scene, written: &WrittenScene) -> Markup {
    let mut rows: Vec<Vec<Markup>> = scene.loads.iter().map(|load| row(scene, written, load)).collect();
    if scene.gravity != [0.0; 2] {
        let pair = ExactTexts(written).pair("gravity", scene.gravity, "m/s^2");
        rows.push(cells([
            "gravity".to_owned(),
            "gravity".to_owned(),
            "every body".to_owned(),
            format!("acceleration {pair} m/s²"),
        ]));
    }
    let curves = curves(scene, written);
    html! {
        @if rows.is_empty() {
            p { "There are no loads but those of the joints." }
        } @else {
            (captioned("loads", "Loads", table_of_text(&["load", "type", "acts on [mm]", "values"], rows.into_iter())))
        }
        @if !curves.is_empty() {
            (captioned(
                "curves",
                "Curves of loads and drives, and of what outputs should be: values at arguments, smooth between them",
                table_of_text(&["curve of", "over", "repeated", "points", "from"], curves.into_iter()),
            ))
        }
    }
}

fn row(scene: &Scene, written: &WrittenScene, load: &Load) -> Vec<Markup> {
    let texts = ExactTexts(written);
    let body = |k: usize| scene.bodies[k].name.clone();
    let (name, word, on, values) = match load {
        Load::DirectionalSpring { name, at, anchor, direction: [x, y], stiffness, free_length } => {
            let key = |last: &str| format!("loads.{name}.{last}");
            let [at, anchor] =
                [("at", at), ("anchor", anchor)].map(|(end, of)| place(scene, written, &key(end), of));
            (
                name,
                "directional-spring",
                format!("{at}, anchor {anchor}"),
                format!(
                    "along ({}, {}), stiffness {}, free length {}",
                    exact_number(*x),
                    exact_number(*y),
                    texts.value(&key("stiffness"), *stiffness, "N/m"),
                    texts.value(&key("free_length"), *free_length, "mm")
                ),
            )
        }
        Load::ConstantForce { name, at, force } => {
            let key = |last: &str| format!("loads.{name}.{last}");
            let force = texts.pair(&key("force"), *force, "N");
            (name, "constant-force", place(scene, written, &key("at"), at), format!("force {force} N"))
        }
        Load::ConstantTorque { name, body: on, torque } => {
            let torque = texts.value(&format!("loads.{name}.torque"), *torque, "N m");
            (name, "constant-torque", body(*on), format!("torque {torque}"))
        }
        Load::Spring { name, a, b, stiffness, damping, free_length } => {
            let key = |last: &str| format!("loads.{name}.{last}");
            let [a, b] = [("a", a), ("b", b)].map(|(end, of)| place(scene, written, &key(end), of));
            (
                name,
                "spring",
                format!("{a}, {b}"),
                format!(
                    "spring of {}, damping {}, free length {}",
                    texts.value(&key("stiffness"), *stiffness, "N/m"),
                    texts.value(&key("damping"), *damping, "N s/m"),
                    texts.value(&key("free_length"), *free_length, "mm")
                ),
            )
        }
        Load::TorsionSpring { name, a, b, stiffness, damping, free_angle } => {
            let key = |last: &str| format!("loads.{name}.{last}");
            (
                name,
                "torsion-spring",
                format!("{}, {}", body(*a), body(*b)),
                format!(
                    "stiffness {}, damping {}, free angle {}",
                    texts.value(&key("stiffness"), *stiffness, "N m/rad"),
                    texts.value(&key("damping"), *damping, "N m s/rad"),
                    texts.value(&key("free_angle"), *free_angle, "deg")
                ),
            )
        }
        Load::VariableForce { name, at, direction: [x, y], .. } => (
            name,
            "force",
            place(scene, written, &format!("loads.{name}.at"), at),
            format!("along ({}, {}), by its curve", exact_number(*x), exact_number(*y)),
        ),
        Load::VariableTorque { name, body: on, .. } => (name, "torque", body(*on), "by its curve".to_owned()),
        Load::Motor { name, body: on, stall_torque, no_load_speed } => {
            let stall = texts.value(&format!("loads.{name}.stall_torque"), *stall_torque, "N m");
            let speed = texts.value(&format!("loads.{name}.no_load_speed"), *no_load_speed, "r/min");
            (name, "motor", body(*on), format!("stall torque {stall}, no-load speed {speed}"))
        }
        Load::Drag { name, at, direction: [x, y], linear, quadratic, flow, factor } => {
            let key = |last: &str| format!("loads.{name}.{last}");
            (
                name,
                "drag",
                place(scene, written, &key("at"), at),
                format!(
                    "along ({}, {}), linear {}, quadratic {}, flow {}{}",
                    exact_number(*x),
                    exact_number(*y),
                    texts.value(&key("linear"), *linear, "N s/m"),
                    texts.value(&key("quadratic"), *quadratic, "N s^2/m^2"),
                    texts.value(&key("flow"), *flow, "m/s"),
                    by_factor(factor.as_ref())
                ),
            )
        }
        Load::RotationalDrag { name, body: on, linear, quadratic, factor } => {
            let key = |last: &str| format!("loads.{name}.{last}");
            let linear = texts.value(&key("linear"), *linear, "N m s/rad");
            let quadratic = texts.value(&key("quadratic"), *quadratic, "N m s^2/rad^2");
            let values = format!("linear {linear}, quadratic {quadratic}{}", by_factor(factor.as_ref()));
            (name, "rotational-drag", body(*on), values)
        }
    };
    cells([name.clone(), word.to_owned(), on, values])
}

/// A value in its unit, which a plain number does not have.
fn value_of(value: f64, unit: &str) -> String {
    if unit.is_empty() { exact_number(value) } else { exact(value, unit) }
}

/// Whether a drag has a factor.
fn by_factor(factor: Option<&Curve>) -> &'static str {
    if factor.is_some() { ", times its curve" } else { "" }
}

/// One row per curve, with all its points.
fn curves(scene: &Scene, written: &WrittenScene) -> Vec<Vec<Markup>> {
    let row = |of: String, key: String, over: String, table: &Table, [argument, value]: [&str; 2]| {
        let points: Vec<String> = table
            .at
            .iter()
            .zip(&table.value)
            .map(|(at, v)| format!("{}: {}", exact(*at, argument), value_of(*v, value)))
            .collect();
        let from = written.name(&format!("{key}.source")).unwrap_or("the scene").to_owned();
        cells([of, over, if table.repeat { "yes" } else { "no" }.to_owned(), points.join("; "), from])
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
    let of_curve = |of: String, key: String, curve: &Curve, unit: &'static str| {
        let (over, argument) = match curve.over {
            Over::Time => ("time".to_owned(), "s"),
            Over::Angle(body) => (format!("angle of {}", scene.bodies[body].name), "deg"),
        };
        row(of, key, over, &curve.table, [argument, unit])
    };
    let loads = scene.loads.iter().filter_map(Load::curve).map(|(name, key, curve, unit)| {
        of_curve(name.to_owned(), format!("loads.{name}.{key}"), curve, unit)
    });
    let wanted = scene.outputs.iter().flat_map(|output| {
        let unit = if output.kind.unit() == OutputUnit::Angle { "deg" } else { "mm" };
        let of = |key: &str| {
            [format!("{}, {}", output.name, key.replace('_', " ")), format!("outputs.{}.{key}", output.name)]
        };
        let curves = output.kind.curves().into_iter();
        curves
            .map(|(key, curve)| {
                let [of, key] = of(key);
                of_curve(of, key, curve, unit)
            })
            .collect::<Vec<_>>()
    });
    drives.chain(loads).chain(wanted).collect()
}
