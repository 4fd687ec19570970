//! Loads and outputs in one line each, by the sentences of their tables.

use super::joint::{JointKind, Mesh, MeshForm};
use super::key_table::{Form, Key, Value};
use super::load::Load;
use super::model::Scene;
use super::output::OutputKind;
use super::quantity::{ANGLE, ANGULAR_VELOCITY, Kind, LENGTH};
use super::units::Units;
use super::values::{Curve, Drive, HeldInput, Over, Table};

/// A sentence with texts in the places of the keys in braces.
pub fn filled(sentence: &str, text: impl Fn(&str) -> String) -> String {
    let mut parts = sentence.split('{');
    let mut filled = parts.next().unwrap_or_default().to_owned();
    for (key, rest) in parts.filter_map(|part| part.split_once('}')) {
        filled += &text(key);
        filled += rest;
    }
    filled
}

impl Load {
    /// Name, kind, constants and bodies of the load in one line.
    pub fn explanation(&self, scene: &Scene) -> String {
        format!("{}: {}", self.name(), with_values(self.kind().sentence, &self.values(), scene))
    }
}

impl JointKind {
    /// What an ideal joint of one condition is, in words; `None` for the others.
    pub fn coupling(&self, units: &Units) -> Option<String> {
        let length = |length: f64| units.text(length, "mm", 3);
        let between = |[low, high]: [f64; 2], word: &str| {
            let (low, high) = (length(low), length(high));
            let unit = format!(" {}", units.symbol("mm"));
            format!("{} {word} {high}", low.strip_suffix(&unit).unwrap_or(&low))
        };
        let range = |table: &Table| between(table.range(), "to");
        Some(match self {
            JointKind::Slot { axis } => format!("pin in a slot along {}", units.text(*axis, "deg", 3)),
            JointKind::LinearDrive(Drive::ConstantSpeed { start_angle: start, speed }) => {
                format!("linear drive from {} at {}", length(*start), units.text(*speed, "mm/s", 3))
            }
            JointKind::LinearDrive(Drive::Angle(table) | Drive::Speed { table, .. }) => {
                format!("linear drive, {} by a table over time", range(table))
            }
            JointKind::Mesh(Mesh { form, radii: [a, b], .. }) => {
                let (what, ratio) = match form {
                    MeshForm::Gear => ("gear pair, pitch radii", -a / b),
                    MeshForm::InternalGear => ("internal gear, pitch radii", a / b),
                    MeshForm::Belt => ("belt on radii", a / b),
                    MeshForm::Rack => return Some(format!("rack on a wheel of pitch radius {}", length(*b))),
                };
                format!("{what} {}, ratio {ratio:.6}", between([*a, *b], "and"))
            }
            JointKind::Cam { direction: [x, y], lift } => {
                format!("cam, lift {} along {}", range(lift), units.text(y.atan2(*x), "deg", 3))
            }
            _ => return None,
        })
    }
}

impl OutputKind {
    /// Description in words.
    pub fn description(&self, scene: &Scene) -> String {
        let sentence = match self {
            OutputKind::PositionError { wanted, .. } => match wanted.each_ref().map(Option::is_some) {
                [true, true] => "{measure} distance of a point of {at} from its wanted position",
                [true, false] => "{measure} error of x of a point of {at}",
                [false, true] => "{measure} error of y of a point of {at}",
                [false, false] => self.kind().sentence,
            },
            other => other.kind().sentence,
        };
        with_values(sentence, &self.values(), scene)
    }
}

/// A sentence with the values of its keys.
fn with_values(sentence: &str, values: &[(&Key, Value)], scene: &Scene) -> String {
    filled(sentence, |name| {
        let found = values.iter().find(|(key, _)| key.name == name);
        found.map_or_else(String::new, |(key, value)| in_words(key.form, value, scene))
    })
}

/// The value of a key of this form in a sentence.
fn in_words(form: Form, value: &Value, scene: &Scene) -> String {
    let body = |index: usize| scene.bodies[index].name.clone();
    let si = if let Form::Pair(kind) | Form::Curve(kind) = form { kind.si } else { "" };
    match value {
        Value::Place(place) => body(place.body),
        Value::Body(index) => body(*index),
        Value::SignedBody(signed) => signed.label.clone(),
        Value::Pair([x, y]) => match form {
            Form::Pair(kind) if scene.units.symbol(si) != si => {
                format!("({}, {})", quantity(*x, kind, &scene.units), quantity(*y, kind, &scene.units))
            }
            _ => format!("({x}, {y}) {si}").trim_end().to_owned(),
        },
        Value::Number(number) => match form {
            Form::Number(kind, _) | Form::NumberOr(kind, ..) => quantity(*number, kind, &scene.units),
            _ => number.to_string(),
        },
        Value::Curve(curve) => curve_in_words(curve, scene, si),
        Value::MaybeCurve(curve) if matches!(form, Form::Wanted(_)) => {
            if curve.is_some() { "the wanted one" } else { "that with ideal joints" }.to_owned()
        }
        Value::MaybeCurve(Some(factor)) => format!(", times {}", curve_in_words(factor, scene, "")),
        Value::Joints(joints) => match joints[..] {
            [one] => format!("joint {}", scene.joints[one].name),
            _ => format!("{} joints", joints.len()),
        },
        Value::WearQuantity(quantity) => quantity.explanation().to_owned(),
        Value::ErrorMeasure(measure) => measure.explanation().to_owned(),
        Value::ImpactMeasure(measure) => measure.explanation().to_owned(),
        Value::Held(None) => ", largest over the cycle".to_owned(),
        Value::Held(Some(HeldInput { body: held, angle })) => {
            // Without digits that come from rounding.
            let degrees = (angle.to_degrees() * 1e9).round() / 1e9;
            format!(" with {} held at {degrees} deg", body(*held))
        }
        Value::MaybeCurve(None) | Value::TwoCurves(_) | Value::Text(_) | Value::Flag(_) => String::new(),
    }
}

/// A quantity [SI] with its unit, lengths and angles with three decimals.
fn quantity(value: f64, kind: Kind, units: &Units) -> String {
    match kind {
        LENGTH => units.text(value, "mm", 3),
        ANGLE => units.text(value, "deg", 3),
        ANGULAR_VELOCITY => units.text(value, "r/min", 1),
        other if units.symbol(other.si) != other.si => units.text(value, other.si, 3),
        other => format!("{value} {}", other.si),
    }
}

/// Range of the values in `unit` and the argument of the table of a curve.
fn curve_in_words(Curve { over, table }: &Curve, scene: &Scene, unit: &str) -> String {
    let over = match over {
        Over::Time => "time".to_owned(),
        Over::Angle(body) => format!("the angle of {}", scene.bodies[*body].name),
    };
    let [least, most] = table.range();
    let repeat = if table.repeat { "repeated" } else { "once" };
    let range = match scene.units.symbol(unit) {
        chosen if chosen != unit => [least, most].map(|value| scene.units.text(value, unit, 3)).join(" to "),
        unit => format!("{least} to {most} {unit}"),
    };
    format!("{} by a table over {over}, {repeat}", range.trim_end())
}
