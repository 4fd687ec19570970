//! Reads `[life]`: duration and number of the cycles. Everything that repeats in time must fit into a cycle.

use super::body_row::{BodyRow, MotionWord};
use super::context::Range;
use super::elements::OutputRow;
use super::faults::{FaultKind, in_first_unit};
use super::joint::JointKind;
use super::joints::JointRow;
use super::load::Load;
use super::model::{Life, Motion};
use super::monotone::monotone_integral;
use super::quantity::{ANGLE, TIME};
use super::section::Section;
use super::simulator::checkpoints;
use super::tables::{repetitions, span};
use super::values::{Curve, Drive, Over, Table};
use std::f64::consts::TAU;
use toml::Value;

/// Start of a period that is a turn of a body.
const TURN_OF: &str = "turn of ";
/// Most settling cycles: more are a typing error rather than intent.
const SETTLE_LIMIT: i64 = 1000;
/// How a scene is written whose motion is seen once.
const ONCE: &str = " with cycles = 1, checkpoint_every = 1, settle_cycles = 0";
/// An angle that advances by whole turns over a cycle does so to within this: six digits of a turn [turns].
const WHOLE_TURN: f64 = 1e-6;

/// Reads `[life]`; none if it is faulty.
pub(super) fn life(
    file: &mut Section,
    bodies: &[BodyRow],
    joints: &[JointRow],
    loads: &[Load],
    outputs: &[OutputRow],
) -> Option<Life> {
    let strokes = strokes(joints);
    let mut section = file.section("life", "a table [life] with cycles and checkpoint_every")?;
    let written = section.get("period").and_then(Value::as_str);
    let turning = written.and_then(|text| text.trim().strip_prefix(TURN_OF));
    let period = match (turning, section.peek("period")) {
        (Some(name), _) => turn(&section, name.trim(), bodies),
        (None, Some(_)) => section.quantity("period", TIME, Range::Positive).map(|period| (period, None)),
        (None, None) => period_of_drive(&section, bodies, &strokes).map(|period| (period, None)),
    };
    let cycles = checkpoints(&mut section);
    let settle = section.integer("settle_cycles", 0..=SETTLE_LIMIT, Some(1));
    section.finish();
    let ((period, turn_of), cycles, settle) = (period?, cycles?, settle?);
    let life = Life { period, settle_cycles: settle as u32, turn_of, ..cycles };
    // A motion seen once may be cut anywhere.
    if !life.is_single_cycle() {
        check_drives(&section, period, bodies);
        strokes.iter().for_each(|(name, drive)| check_stroke(&section, period, name, drive));
        check_curves(&section, period, loads, outputs);
    }
    Some(life)
}

/// A cycle that is one turn of the free body `name`: the time that it takes at its start speed [s], and its index.
fn turn(life: &Section, name: &str, bodies: &[BodyRow]) -> Option<(f64, Option<usize>)> {
    let body = life.reference("period", "body", name, bodies.iter().map(|body| body.name.as_str()))?;
    if let Some(driven) = bodies.iter().find(|body| body.word == Some(MotionWord::Driven)) {
        let driven = &driven.name;
        let message = format!("is a turn of a body, but the drive of {driven} sets the cycle: write a time");
        return life.inconsistent("period", message).and(None);
    }
    match bodies[body].motion {
        Some(Motion::Free { start_speed: Some(speed), .. }) if speed != 0.0 => {
            Some((TAU / speed.abs(), Some(body)))
        }
        Some(Motion::Free { .. }) => {
            let expected = "about the speed at which it turns once settled, since a turn of it is the cycle";
            life.cx.fault(format!("bodies.{name}.start_speed"), FaultKind::Missing(expected.into())).and(None)
        }
        Some(_) => {
            let message = format!("is a turn of {name}, which does not turn: it is fixed");
            life.inconsistent("period", message).and(None)
        }
        // Its own fault comes first.
        None => None,
    }
}

/// Linear drives with their names.
fn strokes(joints: &[JointRow]) -> Vec<(&str, &Drive)> {
    let joints = joints.iter().filter_map(|row| Some((&*row.name, &row.joint.as_ref()?.kind)));
    let drives = joints.filter_map(|(name, kind)| match kind {
        JointKind::LinearDrive(drive) => Some((name, drive)),
        _ => None,
    });
    drives.collect()
}

/// Checks that a linear drive repeats a whole number of times per cycle.
fn check_stroke(life: &Section, period: f64, name: &str, drive: &Drive) {
    let key = format!("joints.{name}.length");
    match drive {
        Drive::Angle(table) if table.repeat => drop(check_fit(life, period, &key, span(table))),
        _ => {
            let message = format!(
                "does not repeat, but the cycles follow each other: write a table that repeats, or see it once{ONCE}"
            );
            life.cx.inconsistent(key, message);
        }
    }
}

/// One turn, or one repetition of the table, of the only driven body, or of the only linear drive of a scene without one.
fn period_of_drive(life: &Section, bodies: &[BodyRow], strokes: &[(&str, &Drive)]) -> Option<f64> {
    // A body without a valid motion may be a driven one; its own fault comes first.
    if bodies.iter().any(|body| body.word.is_none()) {
        return None;
    }
    let driven: Vec<_> = bodies.iter().filter(|body| body.word == Some(MotionWord::Driven)).collect();
    if let ([], [(_, Drive::Angle(table @ Table { repeat: true, .. }))]) = (&driven[..], strokes) {
        return Some(span(table));
    }
    let expected = match driven[..] {
        [body] => match repeats_every(body.drive()?) {
            Some(period) => return Some(period),
            None => format!("a time: the table of \"{}\" does not repeat", body.name),
        },
        _ => format!("a time: the scene has {} driven bodies, not one", driven.len()),
    };
    life.missing("period", expected).and(None)
}

/// Time after which a drive repeats itself [s].
fn repeats_every(drive: &Drive) -> Option<f64> {
    match drive {
        Drive::ConstantSpeed { speed, .. } => Some(TAU / speed.abs()),
        Drive::Angle(table) | Drive::Speed { table, .. } => table.repeat.then(|| span(table)),
    }
}

/// Checks that drives repeat a whole number of times per cycle, so that all cycles are alike.
fn check_drives(life: &Section, period: f64, bodies: &[BodyRow]) {
    for body in bodies {
        let Some(drive) = body.drive() else { continue };
        let place = format!("bodies.{}", body.name);
        let key_of = if matches!(drive, Drive::Angle(_)) { "angle" } else { "speed" };
        let Some(every) = repeats_every(drive) else {
            let message = format!(
                "is false, but the cycles follow each other: let the table repeat, or see it once{ONCE}"
            );
            life.cx.inconsistent(format!("{place}.{key_of}.repeat"), message);
            continue;
        };
        let Some(times) = check_fit(life, period, &place, every) else { continue };
        let (advance, remedy) = match drive {
            Drive::ConstantSpeed { .. } => continue,
            Drive::Angle(table) => (table.value[table.value.len() - 1] - table.value[0], ""),
            Drive::Speed { table, .. } => (
                monotone_integral(table),
                ": change the speeds or the times, which need not be decimal numbers (\"1/15 * 1 s\")",
            ),
        };
        let turns = times * advance / TAU;
        if (turns - turns.round()).abs() > WHOLE_TURN * turns.abs().max(1.0) {
            let advance = in_first_unit(times * advance, ANGLE);
            let message =
                format!("advances by {advance} over a cycle, which is not a whole number of turns{remedy}");
            life.cx.inconsistent(format!("{place}.{key_of}.value"), message);
        }
    }
}

/// Checks that the repeated curves over time of loads and outputs fit into the period.
fn check_curves(life: &Section, period: f64, loads: &[Load], outputs: &[OutputRow]) {
    let of_loads = loads.iter().filter_map(Load::curve);
    let of_loads = of_loads.map(|(name, key, curve, _)| (format!("loads.{name}.{key}"), curve));
    let of_outputs = outputs.iter().filter_map(|row| row.output.as_ref()).flat_map(|output| {
        let curves = output.kind.curves().into_iter();
        curves.map(|(key, curve)| (format!("outputs.{}.{key}", output.name), curve))
    });
    let repeated = |curve: &Curve| curve.over == Over::Time && curve.table.repeat;
    for (place, curve) in of_loads.chain(of_outputs).filter(|(_, curve)| repeated(curve)) {
        check_fit(life, period, &place, span(&curve.table));
    }
}

/// How often a repetition `every` so often fits into the period [s], if it does a whole number of times.
fn check_fit(life: &Section, period: f64, place: &str, every: f64) -> Option<f64> {
    repetitions(period, every).or_else(|| {
        let [period, every] = [period, every].map(|time| in_first_unit(time, TIME));
        let message = format!("a cycle of {period} is not a multiple of {every}, the period of {place}");
        life.inconsistent("period", message).and(None)
    })
}
