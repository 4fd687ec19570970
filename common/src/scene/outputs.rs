//! Reads the outputs of a scene, and the limit states over them.

use super::body_row::{BodyRow, MotionWord, body, place};
use super::faults::FaultKind;
use super::joint::JointKind;
use super::joints::JointRow;
use super::model::{Fails, LimitState};
use super::output::{Output, OutputKind, SignedBody};
use super::quantity::*;
use super::read::{Context, Range};
use super::section::Section;

/// Columns that result files have of their own, beside one for each limit state.
const COLUMNS: [&str; 4] = ["cycles", "total", "standard_error", "numerical"];

/// An output as far as it could be read; a faulty one keeps its name, so that references to it find it.
pub(super) struct OutputRow {
    name: String,
    /// The kind of its values, unless its type is not known.
    kind: Option<Kind>,
    /// The output, unless faulty.
    pub(super) output: Option<Output>,
    /// Whether an external simulator returns it: then its values are numbers in its own unit, of any sign.
    declared: bool,
}

impl OutputRow {
    /// An output that a scene declares of an external simulator.
    pub(super) fn declared(name: &str, output: Option<Output>) -> Self {
        OutputRow { name: name.to_owned(), kind: Some(NUMBER), output, declared: true }
    }
}

#[derive(Clone, Copy)]
enum Word {
    LargestWear,
    AngularVelocityDifference,
    AngleDifference,
    PeakJointForce,
    PositionError,
    DrivingTorque,
}

/// Reads `[[outputs]]`.
pub(super) fn outputs(
    cx: &mut Context,
    file: &mut Section,
    bodies: &[BodyRow],
    joints: &[JointRow],
) -> Vec<OutputRow> {
    let words = [
        ("largest-wear", (Word::LargestWear, LENGTH)),
        ("angular-velocity-difference", (Word::AngularVelocityDifference, ANGULAR_VELOCITY)),
        ("angle-difference", (Word::AngleDifference, ANGLE)),
        ("peak-joint-force", (Word::PeakJointForce, FORCE)),
        ("position-error", (Word::PositionError, LENGTH)),
        ("driving-torque", (Word::DrivingTorque, TORQUE)),
    ];
    let mut outputs = Vec::new();
    for (name, mut row) in file.rows(cx, "outputs") {
        let (word, kind) = row.word(cx, "type", &words).unzip();
        let output = word.and_then(|word| output(cx, &mut row, word, bodies, joints));
        row.finish(cx);
        let output = output.map(|kind| Output { name: name.to_owned(), kind });
        outputs.push(OutputRow { name: name.to_owned(), kind, output, declared: false });
    }
    outputs
}

fn output(
    cx: &mut Context,
    row: &mut Section,
    word: Word,
    bodies: &[BodyRow],
    joints: &[JointRow],
) -> Option<OutputKind> {
    let mut signed = |key| signed_body(cx, row, key, bodies);
    match word {
        Word::LargestWear => largest_wear(cx, row, joints),
        Word::AngularVelocityDifference => {
            let (a, b) = (signed("a"), signed("b"));
            Some(OutputKind::AngularVelocityDifference { a: a?, b: b? })
        }
        Word::AngleDifference => {
            let (a, b) = (signed("a"), signed("b"));
            Some(OutputKind::AngleDifference { a: a?, b: b? })
        }
        Word::PeakJointForce => {
            let chosen = match row.get("joints") {
                None => (0..joints.len()).collect(),
                Some(_) => chosen_joints(cx, row, joints)?,
            };
            Some(OutputKind::PeakJointForce { joints: chosen })
        }
        Word::PositionError => {
            let at = place(cx, row, "at", bodies)?;
            moves(cx, row.key("at"), bodies, at.body, MotionWord::Free, "free")?;
            Some(OutputKind::PositionError { at })
        }
        Word::DrivingTorque => {
            let body = body(cx, row, "body", bodies)?;
            moves(cx, row.key("body"), bodies, body, MotionWord::Driven, "driven")?;
            Some(OutputKind::DrivingTorque { body })
        }
    }
}

/// The body must move in the way that the output is about.
fn moves(
    cx: &mut Context,
    key: String,
    bodies: &[BodyRow],
    body: usize,
    word: MotionWord,
    in_words: &str,
) -> Option<()> {
    // How a faulty body moves may not be known; that is its own fault.
    if bodies[body].word? == word {
        return Some(());
    }
    let fitting = bodies.iter().filter(|other| other.word == Some(word)).map(|other| other.name.as_str());
    let there_are = listed(fitting);
    cx.inconsistent(key, format!("body \"{}\" is not {in_words}{there_are}", bodies[body].name));
    None
}

/// What a reader may choose from instead; nothing if there is nothing.
fn listed<'a>(names: impl Iterator<Item = &'a str>) -> String {
    let names: Vec<&str> = names.collect();
    if names.is_empty() { String::new() } else { format!("; there are: {}", names.join(", ")) }
}

fn chosen_joints(cx: &mut Context, row: &mut Section, joints: &[JointRow]) -> Option<Vec<usize>> {
    let names = row.texts(cx, "joints", "a list of names of joints")?;
    let key = row.key("joints");
    if names.is_empty() {
        cx.inconsistent(&key, "is empty: there is nothing to watch");
    }
    let known = joints.iter().map(|joint| joint.name.as_str());
    let found: Vec<_> = names.iter().map(|name| cx.reference(&key, "joint", name, known.clone())).collect();
    found.into_iter().collect::<Option<Vec<_>>>().filter(|chosen| !chosen.is_empty())
}

fn largest_wear(cx: &mut Context, row: &mut Section, joints: &[JointRow]) -> Option<OutputKind> {
    let key = row.key("joints");
    let chosen: Vec<usize> = match row.get("joints") {
        None => (0..joints.len()).filter(|&i| joints[i].unworn.is_none()).collect(),
        Some(_) => chosen_joints(cx, row, joints)?,
    };
    let faults = cx.faults.len();
    for joint in chosen.iter().map(|&i| &joints[i]) {
        if let Some(reason) = joint.unworn {
            let wearing = joints.iter().filter(|other| other.unworn.is_none());
            let there_are = listed(wearing.map(|other| other.name.as_str()));
            cx.inconsistent(&key, format!("joint \"{}\" {reason} and does not wear{there_are}", joint.name));
        }
    }
    // Somebody may set a wear coefficient to 0 from outside to see the mechanism as it is when new.
    let no_wear = |&i: &usize| match joints[i].joint.as_ref().map(|joint| &joint.kind) {
        Some(JointKind::Clearance(clearance)) => clearance.wear_coefficient == 0.0 && cx.as_written(),
        _ => false,
    };
    if chosen.is_empty() {
        cx.inconsistent(key, "there is no joint that wears, i.e. with clearance and without wear = false");
    } else if cx.faults.len() == faults && chosen.iter().all(no_wear) {
        cx.inconsistent(key, "every wear_coefficient of these joints is 0: they do not wear");
    }
    (cx.faults.len() == faults).then_some(OutputKind::LargestWear { joints: chosen })
}

fn signed_body(
    cx: &mut Context,
    row: &mut Section,
    key: &'static str,
    bodies: &[BodyRow],
) -> Option<SignedBody> {
    let mut section = row.section(cx, key, "a body { body, sign, label }")?;
    let name = section.text(cx, "body", "the name of a body");
    let sign = section.integer(cx, "sign", -1..=1, Some(1));
    if sign == Some(0) {
        let (value, allowed) = ("0".to_owned(), "1 or -1".to_owned());
        cx.fault(section.key("sign"), FaultKind::OutOfRange { value, allowed });
    }
    let label = section.text_or(cx, "label", "what a reader calls it", name.unwrap_or_default());
    let body_key = section.key("body");
    section.finish(cx);
    let body = cx.reference(&body_key, "body", name?, bodies.iter().map(|body| body.name.as_str()))?;
    Some(SignedBody { body, sign: sign? as f64, label: label?.to_owned() })
}

/// Reads `[[limit_states]]`; a threshold is of the kind of its output.
pub(super) fn limit_states(
    cx: &mut Context,
    file: &mut Section,
    outputs: &[OutputRow],
) -> Vec<Option<LimitState>> {
    let mut limit_states = Vec::new();
    for (name, mut row) in file.rows(cx, "limit_states") {
        if COLUMNS.contains(&name) {
            let (value, reason) = (name.to_owned(), "it is a column of result files".to_owned());
            cx.fault(row.key("name"), FaultKind::BadName { value, reason });
        }
        let known = outputs.iter().map(|output| output.name.as_str());
        let declared = outputs.iter().any(|output| output.declared);
        let output = row.text(cx, "output", "the name of an output");
        let output = output.and_then(|output| cx.reference(&row.key("output"), "output", output, known));
        let threshold = match output.and_then(|output| outputs[output].kind) {
            Some(kind) => {
                row.quantity(cx, "threshold", kind, if declared { Range::Any } else { Range::Positive })
            }
            None => row.get("threshold").and(None),
        };
        let fails = match declared.then(|| row.get("fails")).flatten() {
            None => Some(Fails::Above),
            Some(_) => row.word(cx, "fails", &[("above", Fails::Above), ("below", Fails::Below)]),
        };
        row.finish(cx);
        let state =
            |((output, threshold), fails)| LimitState { name: name.to_owned(), output, threshold, fails };
        limit_states.push(output.zip(threshold).zip(fails).map(state));
    }
    limit_states
}
