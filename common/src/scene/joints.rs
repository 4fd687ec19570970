//! Reads joints: ideal ones between two places, and those with clearance between journal and bushing.

use super::body_row::{BodyRow, place};
use super::clearance::{MaterialRow, clearance};
use super::faults::FaultKind;
use super::joint::{Joint, JointKind};
use super::quantity::ANGLE;
use super::read::{Context, Range};
use super::section::Section;

/// A joint as far as it could be read; a faulty one keeps its name, so that references to it find it.
pub(super) struct JointRow {
    pub(super) name: String,
    /// Why it cannot wear, if it cannot.
    pub(super) unworn: Option<&'static str>,
    /// The joint, unless faulty.
    pub(super) joint: Option<Joint>,
}

/// Reads `[[joints]]`.
pub(super) fn joints(
    cx: &mut Context,
    file: &mut Section,
    bodies: &[BodyRow],
    materials: &[MaterialRow],
) -> Vec<JointRow> {
    let mut joints = Vec::new();
    for (name, mut row) in file.rows(cx, "joints") {
        let (unworn, joint) = joint(cx, &mut row, name, bodies, materials);
        row.finish(cx);
        joints.push(JointRow { name: name.to_owned(), unworn, joint });
    }
    if joints.is_empty() {
        cx.fault("joints", FaultKind::Missing { expected: "at least one joint, [[joints]]".to_owned() });
    }
    joints
}

fn joint(
    cx: &mut Context,
    row: &mut Section,
    name: &str,
    bodies: &[BodyRow],
    materials: &[MaterialRow],
) -> (Option<&'static str>, Option<Joint>) {
    #[derive(Clone, Copy, PartialEq)]
    enum Word {
        Revolute,
        Prismatic,
        Fixed,
        Clearance,
    }
    let words = [
        ("revolute", Word::Revolute),
        ("prismatic", Word::Prismatic),
        ("fixed", Word::Fixed),
        ("clearance", Word::Clearance),
    ];
    let Some(word) = row.word(cx, "type", &words) else { return (None, None) };
    let [first, second] = if word == Word::Clearance { ["journal", "bushing"] } else { ["a", "b"] };
    let mut unworn = Some("is ideal");
    let mut angle = |key| row.quantity_or(cx, key, ANGLE, Range::Any, 0.0);
    let kind = match word {
        Word::Revolute => Some(JointKind::Revolute),
        Word::Prismatic => {
            let (axis, angle) = (angle("axis"), angle("angle"));
            axis.zip(angle).map(|(axis, angle)| JointKind::Prismatic { axis, angle })
        }
        Word::Fixed => angle("angle").map(|angle| JointKind::Fixed { angle }),
        Word::Clearance => {
            let wears = row.boolean_or(cx, "wear", true);
            unworn = (wears == Some(false)).then_some("has wear = false");
            clearance(cx, row, materials, wears == Some(true)).map(JointKind::Clearance)
        }
    };
    let (journal, bushing) = (place(cx, row, first, bodies), place(cx, row, second, bodies));
    if let (Some(journal), Some(bushing)) = (journal, bushing)
        && journal.body == bushing.body
    {
        cx.inconsistent(&row.path, format!("{first} and {second} are on the same body"));
    }
    let joint = kind.zip(journal.zip(bushing));
    let joint =
        joint.map(|(kind, (journal, bushing))| Joint { name: name.to_owned(), journal, bushing, kind });
    (unworn, joint)
}
