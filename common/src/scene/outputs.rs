//! Reads the outputs of a scene.

use super::body_row::{BodyRow, MotionWord, body};
use super::context::Range;
use super::drive::Curve;
use super::joint::JointKind;
use super::joints::{JointRow, chosen_joints, listed};
use super::output::{ErrorMeasure, ImpactMeasure, Output, OutputKind, SignedBody};
use super::output_bodies::{free_body, free_place, held_input, moves};
use super::quantity::*;
use super::section::Section;
use super::tables::curve;
use super::wear_output::WearQuantity;
use super::wear_outputs::wear;

/// An output while its scene is read; a faulty one keeps its name, so that references to it are found.
pub(super) struct OutputRow {
    pub(super) name: String,
    /// Kind of its values; none if its type is unknown.
    pub(super) kind: Option<Kind>,
    /// The output, unless faulty.
    pub(super) output: Option<Output>,
    /// True if an external simulator returns it: its values are then plain numbers of any sign.
    pub(super) declared: bool,
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
    AngleError,
    Acceleration,
    AngularAcceleration,
    Impacts,
    ImpactEnergy,
    DrivingTorque,
    Backlash,
    PositionBacklash,
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
        ("angle-error", (OutputWord::AngleError, ANGLE)),
        ("acceleration", (OutputWord::Acceleration, ACCELERATION)),
        ("angular-acceleration", (OutputWord::AngularAcceleration, ANGULAR_ACCELERATION)),
        ("impacts", (OutputWord::Impacts, NUMBER)),
        ("impact-energy", (OutputWord::ImpactEnergy, ENERGY)),
        ("driving-torque", (OutputWord::DrivingTorque, TORQUE)),
        ("backlash", (OutputWord::Backlash, ANGLE)),
        ("position-backlash", (OutputWord::PositionBacklash, LENGTH)),
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
            let at = free_place(row, bodies);
            let wanted = ["wanted_x", "wanted_y"].map(|key| wanted(row, key, LENGTH, bodies));
            let measure = error_measure(row);
            let [x, y] = wanted;
            Some(OutputKind::PositionError { at: at?, wanted: [x?, y?], measure: measure? })
        }
        OutputWord::AngleError => {
            let body = free_body(row, bodies);
            let wanted = wanted(row, "wanted", ANGLE, bodies);
            let measure = error_measure(row);
            Some(OutputKind::AngleError { body: body?, wanted: wanted?, measure: measure? })
        }
        OutputWord::Acceleration => Some(OutputKind::Acceleration { at: free_place(row, bodies)? }),
        OutputWord::AngularAcceleration => {
            Some(OutputKind::AngularAcceleration { body: free_body(row, bodies)? })
        }
        OutputWord::Impacts => Some(OutputKind::Impacts { joints: struck_joints(row, joints)? }),
        OutputWord::ImpactEnergy => {
            let struck = struck_joints(row, joints);
            let words = [("total", ImpactMeasure::Total), ("largest", ImpactMeasure::Largest)];
            let measure = row.word_or("measure", &words, ImpactMeasure::Total);
            Some(OutputKind::ImpactEnergy { joints: struck?, measure: measure? })
        }
        OutputWord::DrivingTorque => {
            let body = body(row, "body", bodies)?;
            moves(row, "body", bodies, body, MotionWord::Driven, "driven")?;
            Some(OutputKind::DrivingTorque { body })
        }
        OutputWord::Backlash => {
            let body = free_body(row, bodies);
            let held = held_input(row, bodies);
            Some(OutputKind::Backlash { body: body?, held: held? })
        }
        OutputWord::PositionBacklash => {
            let at = free_place(row, bodies);
            let direction = row.quantity_or("direction", ANGLE, Range::Any, 0.0);
            let held = held_input(row, bodies);
            Some(OutputKind::PositionBacklash { at: at?, direction: direction?, held: held? })
        }
    }
}

/// Reads what is wanted, if it is given; the outer `None` if it is faulty.
fn wanted(row: &mut Section, key: &'static str, kind: Kind, bodies: &[BodyRow]) -> Option<Option<Curve>> {
    if row.get(key).is_none() {
        return Some(None);
    }
    curve(row, key, kind, bodies).map(Some)
}

/// Reads the measure of an error over the cycle.
fn error_measure(row: &mut Section) -> Option<ErrorMeasure> {
    let words = [("largest", ErrorMeasure::Largest), ("rms", ErrorMeasure::RootMeanSquare)];
    row.word_or("measure", &words, ErrorMeasure::Largest)
}

/// Reads joints and guides with clearance, by default all of them.
fn struck_joints(row: &mut Section, joints: &[JointRow]) -> Option<Vec<usize>> {
    let has_clearance = |joint: &JointRow| {
        // The kind of a faulty joint may be unknown; that fault has been recorded.
        let joint = joint.joint.as_ref();
        joint.is_none_or(|joint| matches!(joint.kind, JointKind::Clearance(_) | JointKind::Guide(_)))
    };
    let with_clearance =
        || joints.iter().filter(|joint| has_clearance(joint)).map(|joint| joint.name.as_str());
    let chosen: Vec<usize> = match row.get("joints") {
        None => (0..joints.len()).filter(|&k| has_clearance(&joints[k])).collect(),
        Some(_) => chosen_joints(row, joints)?,
    };
    if chosen.is_empty() {
        row.inconsistent("joints", "there is no joint with clearance");
        return None;
    }
    if let Some(ideal) = chosen.iter().map(|&k| &joints[k]).find(|joint| !has_clearance(joint)) {
        let there_are = listed(with_clearance());
        row.inconsistent("joints", format!("joint \"{}\" has no clearance{there_are}", ideal.name));
        return None;
    }
    Some(chosen)
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
