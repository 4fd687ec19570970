//! Reads the outputs of a scene, and the limit states over them.

use super::body_row::{BodyRow, MotionWord, body, place};
use super::context::Range;
use super::faults::FaultKind;
use super::joints::JointRow;
use super::model::{Fails, LimitState};
use super::output::{Output, OutputKind, SignedBody};
use super::quantity::*;
use super::section::Section;
use super::wear_output::WearQuantity;
use super::wear_outputs::wear;

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
    Wear(WearQuantity),
    AngularVelocityDifference,
    AngleDifference,
    PeakJointForce,
    PositionError,
    DrivingTorque,
}

/// Reads `[[outputs]]`; a faulty output keeps its row.
pub(super) fn outputs(file: &mut Section, bodies: &[BodyRow], joints: &[JointRow]) -> Vec<OutputRow> {
    let words = [
        ("largest-wear", (OutputWord::Wear(WearQuantity::LargestDepth), LENGTH)),
        ("bushing-wear", (OutputWord::Wear(WearQuantity::BushingDepth), LENGTH)),
        ("journal-wear", (OutputWord::Wear(WearQuantity::JournalDepth), LENGTH)),
        ("clearance-growth", (OutputWord::Wear(WearQuantity::ClearanceGrowth), LENGTH)),
        ("worn-volume", (OutputWord::Wear(WearQuantity::Volume), VOLUME)),
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
        OutputWord::Wear(quantity) => wear(row, quantity, joints),
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
pub(super) fn listed<'a>(names: impl Iterator<Item = &'a str>) -> String {
    let names: Vec<&str> = names.collect();
    if names.is_empty() { String::new() } else { format!("; there are: {}", names.join(", ")) }
}

pub(super) fn chosen_joints(row: &mut Section, joints: &[JointRow]) -> Option<Vec<usize>> {
    let names = row.texts("joints", "a list of names of joints")?;
    if names.is_empty() {
        row.inconsistent("joints", "is empty, expected at least one joint");
    }
    let known = joints.iter().map(|joint| joint.name.as_str());
    let found: Vec<_> =
        names.iter().map(|name| row.reference("joints", "joint", name, known.clone())).collect();
    found.into_iter().collect::<Option<Vec<_>>>().filter(|chosen| !chosen.is_empty())
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
        let threshold = match output.and_then(|output| outputs[output].kind) {
            Some(kind) => {
                row.quantity("threshold", kind, if declared { Range::Any } else { Range::Positive })
            }
            None => row.get("threshold").and(None),
        };
        let fails = match declared.then(|| row.get("fails")).flatten() {
            None => Some(Fails::Above),
            Some(_) => row.word("fails", &[("above", Fails::Above), ("below", Fails::Below)]),
        };
        row.finish();
        let state =
            |((output, threshold), fails)| LimitState { name: name.to_owned(), output, threshold, fails };
        limit_states.push(output.zip(threshold).zip(fails).map(state));
    }
    limit_states
}
