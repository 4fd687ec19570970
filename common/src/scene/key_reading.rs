//! Reads the keys of an element by the table of its kind.

use super::body_row::{BodyRow, MotionWord, body, place};
use super::drive::Curve;
use super::joints::{JointRow, chosen_joints};
use super::key_table::{Form, Key, Value};
use super::output_bodies::{free_body, free_place, held_input, moves, signed_body};
use super::output_values::{ErrorMeasure, ImpactMeasure};
use super::quantity::{Kind, LENGTH, NUMBER};
use super::section::Section;
use super::tables::curve;
use super::wear_output::WearQuantity;
use super::wear_outputs::{struck_joints, worn_joints};

/// Bodies and joints to which the keys of an element refer.
#[derive(Clone, Copy)]
pub(super) struct Named<'a> {
    pub(super) bodies: &'a [BodyRow],
    pub(super) joints: &'a [JointRow],
}

/// Reads all keys of a row; `None` for a faulty value.
pub(super) fn values(row: &mut Section, keys: &[Key], named: Named) -> Vec<Option<Value>> {
    keys.iter().map(|key| value(row, key, named)).collect()
}

fn value(row: &mut Section, key: &Key, Named { bodies, joints }: Named) -> Option<Value> {
    let name = key.name;
    Some(match key.form {
        Form::Name => row.peek("name")?.as_str()?.to_owned().into(),
        Form::Place => place(row, name, bodies)?.into(),
        Form::FreePlace => free_place(row, bodies)?.into(),
        Form::Body => body(row, name, bodies)?.into(),
        Form::FreeBody => free_body(row, bodies)?.into(),
        Form::DrivenBody => {
            let body = body(row, name, bodies)?;
            moves(row, name, bodies, body, MotionWord::Driven, "driven")?;
            body.into()
        }
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
    WearQuantity::ALL.into_iter().find(|quantity| quantity.word() == word)
}

/// Reads a direction; of unit length.
fn direction(row: &mut Section, key: &'static str) -> Option<[f64; 2]> {
    let [x, y] = row.pair(key, NUMBER)?;
    let length = (x * x + y * y).sqrt();
    if length == 0.0 || !length.is_finite() {
        row.out_of_range(key, format!("[{x}, {y}]"), "a direction, e.g. [0, 1]");
        return None;
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
    if row.get(key).is_none() {
        return Some(None);
    }
    curve(row, key, kind, bodies).map(Some)
}

/// Reads the curve of a factor, if there is one; the outer `None` if it is faulty.
fn factor(row: &mut Section, key: &'static str, bodies: &[BodyRow]) -> Option<Option<Curve>> {
    let factor = curve_if_any(row, key, NUMBER, bodies)?;
    let values = factor.iter().flat_map(|factor| &factor.table.value);
    let least = values.copied().fold(f64::INFINITY, f64::min);
    if least < 0.0 {
        row.out_of_range(&format!("{key}.value"), least.to_string(), ">= 0: a drag slows down");
        return None;
    }
    Some(factor)
}
