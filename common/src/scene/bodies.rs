//! Reads bodies: their motion, the drives of those that are driven, their points.

use super::body_row::{BodyRow, MotionWord};
use super::clearance::MaterialRow;
use super::context::Range;
use super::drive::Drive;
use super::model::{MassProperties, Motion, Point};
use super::quantity::*;
use super::section::{Section, record};
use super::shape::shape;
use super::tables::{Repetition, over_time};

/// Reads `[[bodies]]`; a faulty body keeps its row.
pub(super) fn bodies(file: &mut Section, materials: &[MaterialRow]) -> Vec<BodyRow> {
    let words = [("fixed", MotionWord::Fixed), ("driven", MotionWord::Driven), ("free", MotionWord::Free)];
    let bodies = file.each_row("bodies", |name, row| {
        let word = row.word("motion", &words);
        let points = points(row);
        let motion = word.and_then(|word| match word {
            MotionWord::Fixed => Some(Motion::Fixed),
            MotionWord::Driven => driven(row, &points, materials),
            MotionWord::Free => free(row, &points, materials),
        });
        BodyRow { name: name.to_owned(), word, motion, points }
    });
    if bodies.is_empty() {
        file.missing("bodies", "at least one body, [[bodies]]");
    }
    bodies
}

fn driven(row: &mut Section, points: &[Point], materials: &[MaterialRow]) -> Option<Motion> {
    record!(Motion::Driven {
        position: row.pair("position", LENGTH),
        drive: drive(row),
        inertia: driven_inertia(row, points, materials),
    })
}

/// A body is driven at a speed, constant or by a table, or at an angle by a table.
fn drive(row: &mut Section) -> Option<Drive> {
    let expected = || format!("{}, or a table of it, or angle, a table", ANGULAR_VELOCITY.in_words());
    let key = row.either(["speed", "angle"], expected);
    let start = row.get("start_angle");
    if key? == "angle" {
        let table = over_time(row, "angle", ANGLE, Repetition::GoesOn);
        if start.is_some() {
            let message = "belongs to speed; the start is the first value of the table of angles";
            row.inconsistent("start_angle", message);
        }
        return table.map(Drive::Angle);
    }
    let start_angle = row.quantity_or("start_angle", ANGLE, Range::Any, 0.0);
    if row.get("speed").is_some_and(toml::Value::is_table) {
        let table = over_time(row, "speed", ANGULAR_VELOCITY, Repetition::Closed);
        return Some(Drive::Speed { start_angle: start_angle?, table: table? });
    }
    let speed = row.quantity("speed", ANGULAR_VELOCITY, Range::NotZero);
    Some(Drive::ConstantSpeed { start_angle: start_angle?, speed: speed? })
}

/// Mass and moment of inertia of a driven body, or its shape: both or neither.
fn driven_inertia(
    row: &mut Section,
    points: &[Point],
    materials: &[MaterialRow],
) -> Option<Option<MassProperties>> {
    let given = ["mass", "inertia", "centre_of_mass", "shape"].map(|key| row.get(key).is_some());
    if given == [false; 4] {
        return Some(None);
    }
    let shape = row.if_any("shape", |row, _| shape(row, points, materials))?;
    let centre = shape.map_or([0.0; 2], |shape| shape.centre_of_mass);
    let inertia = record!(MassProperties {
        mass: row.quantity_unless("mass", MASS, Range::Positive, shape.map(|shape| shape.mass)),
        inertia: row.quantity_unless("inertia", INERTIA, Range::Positive, shape.map(|shape| shape.inertia)),
        centre_of_mass: row.pair_or("centre_of_mass", LENGTH, centre),
    });
    inertia.map(Some)
}

fn free(row: &mut Section, points: &[Point], materials: &[MaterialRow]) -> Option<Motion> {
    // A faulty shape leaves its quantities open: they are then no faults as well.
    let shape = match row.if_any("shape", |row, _| shape(row, points, materials)) {
        None => Some(MassProperties { mass: 1.0, inertia: 1.0, centre_of_mass: [0.0; 2] }),
        Some(shape) => shape,
    };
    record!(Motion::Free {
        mass: row.quantity_unless("mass", MASS, Range::Positive, shape.map(|shape| shape.mass)),
        inertia: row.quantity_unless("inertia", INERTIA, Range::Positive, shape.map(|shape| shape.inertia)),
        centre_of_mass: match shape {
            Some(shape) => row.pair_or("centre_of_mass", LENGTH, shape.centre_of_mass),
            None => row.pair("centre_of_mass", LENGTH),
        },
        start_position: row.pair("start_position", LENGTH),
        start_angle: row.quantity("start_angle", ANGLE, Range::Any),
        start_velocity: row.if_any("start_velocity", |row, key| row.pair(key, SPEED)),
        start_speed: row.quantity_if_any("start_speed", ANGULAR_VELOCITY, Range::Any),
    })
}

fn points(row: &mut Section) -> Vec<Point> {
    let Some(section) = row.section_if_any("points") else { return Vec::new() };
    // A faulty point keeps its name, so that references to it are not faults as well.
    let position = |name: &str, value| section.as_pair(name, value, LENGTH).unwrap_or_default();
    let point = |(name, value): (&String, _)| Point { name: name.clone(), position: position(name, value) };
    section.entries().map(point).collect()
}
