//! Tables of loads, gravity, and the curves by which loads and drives vary.

use super::exact::{ExactTexts, exact, exact_number};
use super::mechanism_tables::{cells, place};
use crate::presentation::report::page::captioned;
use crate::presentation::report::tables::table_of_text;
use crate::presentation::report::written::WrittenScene;
use common::scene::{Curve, Drive, Load, Motion, Over, Scene, Table};
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
    let curves = curves(scene);
    html! {
        @if rows.is_empty() {
            p { "There are no loads but those of the joints." }
        } @else {
            (captioned("loads", "Loads", table_of_text(&["load", "type", "acts on [mm]", "values"], rows.into_iter())))
        }
        @if !curves.is_empty() {
            (captioned(
                "curves",
                "Curves of loads and drives: values at arguments, smooth between them",
                table_of_text(&["curve of", "over", "repeated", "points"], curves.into_iter()),
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
    };
    cells([name.clone(), word.to_owned(), on, values])
}

/// One row per curve, with all its points.
fn curves(scene: &Scene) -> Vec<Vec<Markup>> {
    let row = |of: String, over: String, table: &Table, [argument, value]: [&str; 2]| {
        let points: Vec<String> = table
            .at
            .iter()
            .zip(&table.value)
            .map(|(at, v)| format!("{}: {}", exact(*at, argument), exact(*v, value)))
            .collect();
        cells([of, over, if table.repeat { "yes" } else { "no" }.to_owned(), points.join("; ")])
    };
    let drives = scene.bodies.iter().filter_map(|body| match &body.motion {
        Motion::Driven { drive: Drive::Angle(table), .. } => {
            Some(row(body.name.clone(), "time".into(), table, ["s", "deg"]))
        }
        Motion::Driven { drive: Drive::Speed { table, .. }, .. } => {
            Some(row(body.name.clone(), "time".into(), table, ["s", "r/min"]))
        }
        _ => None,
    });
    let of_load = |name: &String, curve: &Curve, unit: &'static str| {
        let (over, argument) = match curve.over {
            Over::Time => ("time".to_owned(), "s"),
            Over::Angle(body) => (format!("angle of {}", scene.bodies[body].name), "deg"),
        };
        row(name.clone(), over, &curve.table, [argument, unit])
    };
    let loads = scene.loads.iter().filter_map(|load| match load {
        Load::VariableForce { name, size, .. } => Some(of_load(name, size, "N")),
        Load::VariableTorque { name, torque, .. } => Some(of_load(name, torque, "N m")),
        _ => None,
    });
    drives.chain(loads).collect()
}
