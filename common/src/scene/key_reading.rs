//! Reads the keys of an element by the table of its kind: its quantities and curves, and the bodies and joints that it refers to.

use super::body_row::{BodyRow, MotionWord, body, place};
use super::context::Range;
use super::joint::{JointKind, WearingSurfaces};
use super::joints::{JointRow, chosen_joints, listed};
use super::key_table::{Form, Key, Value};
use super::quantity::{ANGLE, Kind, LENGTH, NUMBER};
use super::section::Section;
use super::tables::curve;
use super::values::{Curve, ErrorMeasure, HeldInput, ImpactMeasure, SignedBody, WearQuantity};

/// Reads all keys of a row; `None` for a faulty value.
pub(super) fn values(
    row: &mut Section,
    keys: &[Key],
    bodies: &[BodyRow],
    joints: &[JointRow],
) -> Vec<Option<Value>> {
    keys.iter().map(|key| value(row, key, bodies, joints)).collect()
}

fn value(row: &mut Section, key: &Key, bodies: &[BodyRow], joints: &[JointRow]) -> Option<Value> {
    let name = key.name;
    Some(match key.form {
        Form::Name => row.peek("name")?.as_str()?.to_owned().into(),
        Form::Place => place(row, name, bodies)?.into(),
        Form::FreePlace => {
            let at = place(row, name, bodies)?;
            moves(row, name, bodies, at.body, MotionWord::Free).map(|_| at)?.into()
        }
        Form::Body => body(row, name, bodies)?.into(),
        Form::FreeBody => moving_body(row, name, bodies, MotionWord::Free)?.into(),
        Form::DrivenBody => moving_body(row, name, bodies, MotionWord::Driven)?.into(),
        Form::SignedBody => signed_body(row, name, bodies)?.into(),
        Form::Direction => direction(row, name)?.into(),
        Form::Pair(kind) => row.pair(name, kind)?.into(),
        Form::Number(kind, range) => row.quantity(name, kind, range)?.into(),
        Form::NumberOr(kind, range, default) => row.quantity_or(name, kind, range, default)?.into(),
        Form::Curve(kind) => curve(row, name, kind, bodies)?.into(),
        Form::Wanted(kind) => curve_if_any(row, name, kind, bodies)?.into(),
        Form::WantedPoint => {
            let [x, y] = ["wanted_x", "wanted_y"].map(|name| curve_if_any(row, name, LENGTH, bodies));
            [x?, y?].into()
        }
        Form::Factor => factor(row, name, bodies)?.into(),
        Form::Joints => match row.get(name) {
            None => (0..joints.len()).collect::<Vec<_>>().into(),
            Some(_) => chosen_joints(row, joints)?.into(),
        },
        Form::StruckJoints => struck_joints(row, joints)?.into(),
        Form::WornJoints => worn_joints(row, wear_quantity(row)?, joints)?.into(),
        Form::WearQuantity => wear_quantity(row)?.into(),
        Form::ErrorMeasure => row.word_or(name, &ErrorMeasure::WORDS, ErrorMeasure::default())?.into(),
        Form::ImpactMeasure => row.word_or(name, &ImpactMeasure::WORDS, ImpactMeasure::default())?.into(),
        Form::Held => held_input(row, bodies)?.into(),
        Form::Cycles | Form::Word(_) | Form::Elsewhere => return None,
    })
}

/// The quantity of the wear that the word of a row states.
fn wear_quantity(row: &Section) -> Option<WearQuantity> {
    let word = row.peek("type")?.as_str()?;
    WearQuantity::WORDS.into_iter().find(|(known, _)| *known == word).map(|(_, quantity)| quantity)
}

/// Reads a direction; of unit length.
fn direction(row: &mut Section, key: &'static str) -> Option<[f64; 2]> {
    let [x, y] = row.pair(key, NUMBER)?;
    let length = (x * x + y * y).sqrt();
    if length == 0.0 || !length.is_finite() {
        return row.out_of_range(key, format!("[{x}, {y}]"), "a direction, e.g. [0, 1]").and(None);
    }
    Some([x / length, y / length])
}

/// Reads a curve, if there is one; the outer `None` if it is faulty.
fn curve_if_any(
    row: &mut Section,
    key: &'static str,
    kind: Kind,
    bodies: &[BodyRow],
) -> Option<Option<Curve>> {
    row.if_any(key, |row, key| curve(row, key, kind, bodies))
}

/// Reads the curve of a factor, if there is one; the outer `None` if it is faulty.
fn factor(row: &mut Section, key: &'static str, bodies: &[BodyRow]) -> Option<Option<Curve>> {
    let factor = curve_if_any(row, key, NUMBER, bodies)?;
    let least = factor.as_ref().map_or(0.0, |factor| factor.table.range()[0]);
    if least < 0.0 {
        return row.out_of_range(&format!("{key}.value"), least, ">= 0: a drag slows down").and(None);
    }
    Some(factor)
}

/// Reads the name of a body that moves in this way.
fn moving_body(row: &mut Section, key: &'static str, bodies: &[BodyRow], word: MotionWord) -> Option<usize> {
    let found = body(row, key, bodies)?;
    moves(row, key, bodies, found, word)
}

/// The body, if it moves in the way that the output requires.
fn moves(row: &Section, key: &str, bodies: &[BodyRow], body: usize, word: MotionWord) -> Option<usize> {
    // The motion of a faulty body may be unknown; that fault has been recorded.
    if bodies[body].word? == word {
        return Some(body);
    }
    let fitting = bodies.iter().filter(|other| other.word == Some(word)).map(|other| other.name.as_str());
    let there_are = listed(fitting);
    let in_words = if word == MotionWord::Free { "free" } else { "driven" };
    row.inconsistent(key, format!("body \"{}\" is not {in_words}{there_are}", bodies[body].name)).and(None)
}

/// Reads where the drives are held, if that is given: `input_angle`, and `input` unless there is only one driven body; the outer `None` if it
/// is faulty.
fn held_input(row: &mut Section, bodies: &[BodyRow]) -> Option<Option<HeldInput>> {
    let input = row.if_any("input", |row, key| moving_body(row, key, bodies, MotionWord::Driven));
    if row.get("input_angle").is_none() {
        if row.get("input").is_some() {
            return row.missing("input_angle", "an angle at which the input is held").and(None);
        }
        return Some(None);
    }
    let angle = row.quantity("input_angle", ANGLE, Range::Any);
    let mut driven = (0..bodies.len()).filter(|&body| bodies[body].word == Some(MotionWord::Driven));
    match input?.map_or_else(|| (driven.next(), driven.next()), |body| (Some(body), None)) {
        (Some(body), None) => Some(Some(HeldInput { body, angle: angle? })),
        (None, _) => row.inconsistent("input_angle", "there is no driven body that could be held").and(None),
        (Some(_), Some(_)) => {
            let expected = "the name of the driven body that is held, since there are several";
            row.missing("input", expected).and(None)
        }
    }
}

/// Reads a body `{ body, sign, label }`.
fn signed_body(row: &mut Section, key: &'static str, bodies: &[BodyRow]) -> Option<SignedBody> {
    let mut section = row.section(key, "a body { body, sign, label }")?;
    let body = body(&mut section, "body", bodies);
    let sign = section.integer("sign", -1..=1, Some(1));
    if sign == Some(0) {
        section.out_of_range("sign", "0", "1 or -1");
    }
    let name = body.map_or("", |body| &bodies[body].name);
    let label = section.text_or("label", "what a reader calls it", name).map(str::to_owned);
    section.finish();
    Some(SignedBody { body: body?, sign: sign? as f64, label: label? })
}

/// Reads the joints of an output of this quantity: by default all that wear.
fn worn_joints(row: &mut Section, quantity: WearQuantity, joints: &[JointRow]) -> Option<Vec<usize>> {
    let has = |i: &usize| wearing(&joints[*i]).is_none_or(|(surfaces, ..)| has_quantity(quantity, surfaces));
    let chosen: Vec<usize> = match row.get("joints") {
        None => (0..joints.len()).filter(|&i| joints[i].unworn.is_none()).filter(has).collect(),
        Some(_) => chosen_joints(row, joints)?,
    };
    let faults = row.cx.fault_count();
    for (i, joint) in chosen.iter().map(|&i| (i, &joints[i])) {
        let reason = match joint.unworn {
            Some(reason) => format!("{reason} and does not wear"),
            None if !has(&i) => {
                let wears = wearing(joint).map_or("", |(_, word, _)| word);
                format!("has wears = \"{wears}\"")
            }
            None => continue,
        };
        let others = (0..joints.len()).filter(|other| joints[*other].unworn.is_none() && has(other));
        let there_are = listed(others.map(|other| joints[other].name.as_str()));
        row.inconsistent("joints", format!("joint \"{}\" {reason}{there_are}", joint.name));
    }
    // An override may set a wear coefficient to 0, to see the mechanism in its new state.
    let no_wear = |&i: &usize| {
        wearing(&joints[i]).is_some_and(|(.., coefficients)| coefficients == [0.0; 2] && row.cx.as_written())
    };
    if chosen.is_empty() && joints.iter().any(|joint| joint.unworn.is_none()) {
        let surface = quantity.surface();
        row.inconsistent("joints", format!("there is no joint of which {surface} wears: see its key wears"));
    } else if chosen.is_empty() {
        let message = "there is no joint that wears, i.e. a hinge with clearance and without wear = false, or a guide with the key wears";
        row.inconsistent("joints", message);
    } else if row.cx.fault_count() == faults && chosen.iter().all(no_wear) {
        row.inconsistent("joints", "every wear_coefficient of these joints is 0: they do not wear");
    }
    (row.cx.fault_count() == faults).then_some(chosen)
}

/// True if a quantity of the wear is not zero by definition for a joint of which these surfaces wear.
fn has_quantity(quantity: WearQuantity, wears: WearingSurfaces) -> bool {
    match quantity {
        WearQuantity::BushingDepth => wears != WearingSurfaces::Journal,
        WearQuantity::JournalDepth => wears != WearingSurfaces::Bushing,
        _ => true,
    }
}

/// Surfaces that may wear of a joint that is not faulty, their word in the scene, and the wear coefficients of both `(2,)` [1/Pa].
fn wearing(joint: &JointRow) -> Option<(WearingSurfaces, &'static str, [f64; 2])> {
    let (words, wears, coefficients) = match &joint.joint.as_ref()?.kind {
        JointKind::Clearance(joint) => (WearingSurfaces::OF_HINGE, joint.wears, joint.wear_coefficients()),
        JointKind::Guide(joint) => {
            (WearingSurfaces::OF_GUIDE, joint.wear.as_ref()?.wears, joint.wear_coefficients())
        }
        _ => return None,
    };
    let (word, _) = words.into_iter().find(|(_, choice)| *choice == wears)?;
    Some((wears, word, coefficients))
}

/// Reads joints and guides with clearance, by default all of them.
fn struck_joints(row: &mut Section, joints: &[JointRow]) -> Option<Vec<usize>> {
    // The kind of a faulty joint may be unknown; that fault has been recorded.
    let has_clearance =
        |joint: &JointRow| joint.joint.as_ref().is_none_or(|joint| joint.kind.has_clearance());
    let with_clearance = (0..joints.len()).filter(|&k| has_clearance(&joints[k]));
    let chosen: Vec<usize> = match row.get("joints") {
        None => with_clearance.clone().collect(),
        Some(_) => chosen_joints(row, joints)?,
    };
    if chosen.is_empty() {
        return row.inconsistent("joints", "there is no joint with clearance").and(None);
    }
    if let Some(ideal) = chosen.iter().map(|&k| &joints[k]).find(|joint| !has_clearance(joint)) {
        let there_are = listed(with_clearance.map(|k| joints[k].name.as_str()));
        let message = format!("joint \"{}\" has no clearance{there_are}", ideal.name);
        return row.inconsistent("joints", message).and(None);
    }
    Some(chosen)
}
