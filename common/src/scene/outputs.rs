//! Reads the outputs of a scene, and the limit states over them.

use super::body_row::{BodyRow, MotionWord, body, place};
use super::context::Range;
use super::faults::FaultKind;
use super::joint::JointKind;
use super::joints::JointRow;
use super::model::{Fails, LimitState};
use super::output::{Output, OutputKind, SignedBody};
use super::quantity::*;
use super::section::Section;

/// Columns that result files have besides one for each limit state.
const COLUMNS: [&str; 4] = ["cycles", "total", "standard_error", "numerical"];

/// An output while its scene is read; a faulty one keeps its name, so that references to it are found.
pub(super) struct OutputRow {
    name: String,
    /// Kind of its values; none if its type is unknown.
    kind: Option<Kind>,
    /// The output, unless faulty.
    pub(super) output: Option<Output>,
    /// True if an external simulator returns it: its values are then plain numbers of any sign.
    declared: bool,
}

impl OutputRow {
    /// An output that an external simulator returns.
    pub(super) fn declared(name: &str, output: Option<Output>) -> Self {
        OutputRow {
            name: name.to_owned(),
            kind: Some(Kind::from_dimension(NUMBER.dimension)),
            output,
            declared: true,
        }
    }
}

/// The words of `type`.
#[derive(Clone, Copy)]
enum OutputWord {
    LargestWear,
    AngularVelocityDifference,
    AngleDifference,
    PeakJointForce,
    PositionError,
    DrivingTorque,
}

/// Reads `[[outputs]]`; a faulty output keeps its row.
pub(super) fn outputs(file: &mut Section, bodies: &[BodyRow], joints: &[JointRow]) -> Vec<OutputRow> {
    let words = [
        ("largest-wear", (OutputWord::LargestWear, LENGTH)),
        ("angular-velocity-difference", (OutputWord::AngularVelocityDifference, ANGULAR_VELOCITY)),
        ("angle-difference", (OutputWord::AngleDifference, ANGLE)),
        ("peak-joint-force", (OutputWord::PeakJointForce, FORCE)),
        ("position-error", (OutputWord::PositionError, LENGTH)),
        ("driving-torque", (OutputWord::DrivingTorque, TORQUE)),
    ];
    let mut outputs = Vec::new();
    for (name, mut row) in file.rows("outputs") {
        let (word, kind) = row.word("type", &words).unzip();
        let output = word.and_then(|word| output(&mut row, word, bodies, joints));
        row.finish();
        let output = output.map(|kind| Output { name: name.to_owned(), kind });
        outputs.push(OutputRow { name: name.to_owned(), kind, output, declared: false });
    }
    outputs
}

fn output(
    row: &mut Section,
    word: OutputWord,
    bodies: &[BodyRow],
    joints: &[JointRow],
) -> Option<OutputKind> {
    let mut signed = |key| signed_body(row, key, bodies);
    match word {
        OutputWord::LargestWear => largest_wear(row, joints),
        OutputWord::AngularVelocityDifference => {
            let (a, b) = (signed("a"), signed("b"));
            Some(OutputKind::AngularVelocityDifference { a: a?, b: b? })
        }
        OutputWord::AngleDifference => {
            let (a, b) = (signed("a"), signed("b"));
            Some(OutputKind::AngleDifference { a: a?, b: b? })
        }
        OutputWord::PeakJointForce => {
            let chosen = match row.get("joints") {
                None => (0..joints.len()).collect(),
                Some(_) => chosen_joints(row, joints)?,
            };
            Some(OutputKind::PeakJointForce { joints: chosen })
        }
        OutputWord::PositionError => {
            let at = place(row, "at", bodies)?;
            moves(row, "at", bodies, at.body, MotionWord::Free, "free")?;
            Some(OutputKind::PositionError { at })
        }
        OutputWord::DrivingTorque => {
            let body = body(row, "body", bodies)?;
            moves(row, "body", bodies, body, MotionWord::Driven, "driven")?;
            Some(OutputKind::DrivingTorque { body })
        }
    }
}

/// Checks that the body moves in the way that the output requires.
fn moves(
    row: &Section,
    key: &str,
    bodies: &[BodyRow],
    body: usize,
    word: MotionWord,
    in_words: &str,
) -> Option<()> {
    // The motion of a faulty body may be unknown; that fault has been recorded.
    if bodies[body].word? == word {
        return Some(());
    }
    let fitting = bodies.iter().filter(|other| other.word == Some(word)).map(|other| other.name.as_str());
    let there_are = listed(fitting);
    row.inconsistent(key, format!("body \"{}\" is not {in_words}{there_are}", bodies[body].name));
    None
}

/// The names that could be chosen instead, for a message; empty if there are none.
fn listed<'a>(names: impl Iterator<Item = &'a str>) -> String {
    let names: Vec<&str> = names.collect();
    if names.is_empty() { String::new() } else { format!("; there are: {}", names.join(", ")) }
}

fn chosen_joints(row: &mut Section, joints: &[JointRow]) -> Option<Vec<usize>> {
    let names = row.texts("joints", "a list of names of joints")?;
    if names.is_empty() {
        row.inconsistent("joints", "is empty, expected at least one joint");
    }
    let known = joints.iter().map(|joint| joint.name.as_str());
    let found: Vec<_> =
        names.iter().map(|name| row.reference("joints", "joint", name, known.clone())).collect();
    found.into_iter().collect::<Option<Vec<_>>>().filter(|chosen| !chosen.is_empty())
}

fn largest_wear(row: &mut Section, joints: &[JointRow]) -> Option<OutputKind> {
    let chosen: Vec<usize> = match row.get("joints") {
        None => (0..joints.len()).filter(|&i| joints[i].unworn.is_none()).collect(),
        Some(_) => chosen_joints(row, joints)?,
    };
    let faults = row.cx.fault_count();
    for joint in chosen.iter().map(|&i| &joints[i]) {
        if let Some(reason) = joint.unworn {
            let wearing = joints.iter().filter(|other| other.unworn.is_none());
            let there_are = listed(wearing.map(|other| other.name.as_str()));
            row.inconsistent(
                "joints",
                format!("joint \"{}\" {reason} and does not wear{there_are}", joint.name),
            );
        }
    }
    // An override may set a wear coefficient to 0, to see the mechanism in its new state.
    let no_wear = |&i: &usize| match joints[i].joint.as_ref().map(|joint| &joint.kind) {
        Some(JointKind::Clearance(clearance)) => clearance.wear_coefficient == 0.0 && row.cx.as_written(),
        _ => false,
    };
    if chosen.is_empty() {
        row.inconsistent(
            "joints",
            "there is no joint that wears, i.e. with clearance and without wear = false",
        );
    } else if row.cx.fault_count() == faults && chosen.iter().all(no_wear) {
        row.inconsistent("joints", "every wear_coefficient of these joints is 0: they do not wear");
    }
    (row.cx.fault_count() == faults).then_some(OutputKind::LargestWear { joints: chosen })
}

fn signed_body(row: &mut Section, key: &'static str, bodies: &[BodyRow]) -> Option<SignedBody> {
    let mut section = row.section(key, "a body { body, sign, label }")?;
    let name = section.text("body", "the name of a body");
    let sign = section.integer("sign", -1..=1, Some(1));
    if sign == Some(0) {
        section.out_of_range("sign", "0", "1 or -1");
    }
    let label = section.text_or("label", "what a reader calls it", name.unwrap_or_default());
    section.finish();
    let body = section.reference("body", "body", name?, bodies.iter().map(|body| body.name.as_str()))?;
    Some(SignedBody { body, sign: sign? as f64, label: label?.to_owned() })
}

/// Reads `[[limit_states]]`; a threshold is of the kind of its output.
pub(super) fn limit_states(file: &mut Section, outputs: &[OutputRow]) -> Vec<Option<LimitState>> {
    let mut limit_states = Vec::new();
    for (name, mut row) in file.rows("limit_states") {
        if COLUMNS.contains(&name) {
            let (value, reason) = (name.to_owned(), "it is a column of result files".to_owned());
            row.fault("name", FaultKind::BadName { value, reason });
        }
        let known = outputs.iter().map(|output| output.name.as_str());
        let declared = outputs.iter().any(|output| output.declared);
        let output = row.text("output", "the name of an output");
        let output = output.and_then(|output| row.reference("output", "output", output, known));
        let kind = output.and_then(|output| outputs[output].kind);
        // The outputs of a mechanism are sizes.
        let range = if declared { Range::Any } else { Range::Positive };
        let sides = sides(&mut row, kind, range);
        row.finish();
        let state =
            |(output, (threshold, fails))| LimitState { name: name.to_owned(), output, threshold, fails };
        limit_states.push(output.zip(sides).map(state));
    }
    limit_states
}

/// Reads threshold and side of a limit state: `threshold` with `fails`, or `lower` and `upper`, outside of which it fails. A threshold
/// of an unknown kind is left unread.
fn sides(row: &mut Section, kind: Option<Kind>, range: Range) -> Option<(f64, Fails)> {
    let words = [("above", Fails::Above), ("below", Fails::Below), ("outside", Fails::Outside { lower: 0.0 })];
    let two = ["lower", "upper"].into_iter().find(|key| row.peek(key).is_some());
    let fails = match row.get("fails") {
        None => Some(if two.is_some() { words[2].1 } else { Fails::Above }),
        Some(_) => row.word("fails", &words),
    };
    let one_sided = !matches!(fails, Some(Fails::Outside { .. }));
    let surplus = if one_sided { two } else { Some("threshold").filter(|key| row.peek(key).is_some()) };
    if fails.is_none() || surplus.is_some() {
        for key in ["threshold", "lower", "upper"] {
            row.get(key);
        }
    }
    if let (Some(key), Some(_)) = (surplus, fails) {
        row.inconsistent(
            key,
            "expected threshold, or lower and upper with fails = \"outside\", not some of both",
        );
        return None;
    }
    let mut threshold = |key| match kind {
        Some(kind) => row.quantity(key, kind, range),
        None => row.get(key).and(None),
    };
    if one_sided {
        let fails = fails?;
        return Some((threshold("threshold")?, fails));
    }
    let (lower, upper) = (threshold("lower"), threshold("upper"));
    let (lower, upper) = (lower?, upper?);
    if lower >= upper {
        row.inconsistent("lower", "expected lower < upper");
        return None;
    }
    Some((upper, Fails::Outside { lower }))
}
