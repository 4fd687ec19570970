//! Bodies that outputs refer to: free ones, driven ones, and a driven one held at an angle.

use super::attachment::Attachment;
use super::body_row::{BodyRow, MotionWord, body, place};
use super::context::Range;
use super::joints::listed;
use super::output_values::{HeldInput, SignedBody};
use super::quantity::ANGLE;
use super::section::Section;

/// Reads a place on a free body.
pub(super) fn free_place(row: &mut Section, bodies: &[BodyRow]) -> Option<Attachment> {
    let at = place(row, "at", bodies)?;
    moves(row, "at", bodies, at.body, MotionWord::Free, "free")?;
    Some(at)
}

/// Reads the name of a free body.
pub(super) fn free_body(row: &mut Section, bodies: &[BodyRow]) -> Option<usize> {
    let found = body(row, "body", bodies)?;
    moves(row, "body", bodies, found, MotionWord::Free, "free")?;
    Some(found)
}

/// Checks that the body moves in the way that the output requires.
pub(super) fn moves(
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

/// Reads where the drives are held, if that is given: `input_angle`, and `input` unless there is only one driven body; the outer `None` if it
/// is faulty.
pub(super) fn held_input(row: &mut Section, bodies: &[BodyRow]) -> Option<Option<HeldInput>> {
    let named = row.get("input").is_some();
    let input = match named {
        true => body(row, "input", bodies).and_then(|found| {
            moves(row, "input", bodies, found, MotionWord::Driven, "driven").map(|()| found)
        }),
        false => None,
    };
    if row.get("input_angle").is_none() {
        if named {
            row.missing("input_angle", "an angle at which the input is held");
            return None;
        }
        return Some(None);
    }
    let angle = row.quantity("input_angle", ANGLE, Range::Any);
    if named {
        return Some(Some(HeldInput { body: input?, angle: angle? }));
    }
    let mut driven = (0..bodies.len()).filter(|&body| bodies[body].word == Some(MotionWord::Driven));
    match (driven.next(), driven.next()) {
        (Some(only), None) => Some(Some(HeldInput { body: only, angle: angle? })),
        (None, _) => {
            row.inconsistent("input_angle", "there is no driven body that could be held");
            None
        }
        (Some(_), Some(_)) => {
            row.missing("input", "the name of the driven body that is held, since there are several");
            None
        }
    }
}

/// Reads a body `{ body, sign, label }`.
pub(super) fn signed_body(row: &mut Section, key: &'static str, bodies: &[BodyRow]) -> Option<SignedBody> {
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
