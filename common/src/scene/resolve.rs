//! Turns the tables of a scene file into a [`Scene`]: one pass, every fault, overrides applied.

use super::drive::*;
use super::faults::{Fault, FaultKind};
use super::joint::*;
use super::mechanism;
use super::model::*;
use super::output::*;
use super::quantity::*;
use super::read::{Context, Overrides, Range};
use super::section::Section;
use super::variables::{VariableRow, variable_rows, variables};
use std::collections::BTreeMap;
use toml::Table;

/// Everything one pass gives.
pub(super) struct Resolved {
    /// The scene, its `variables` still empty.
    pub(super) scene: Scene,
    /// Random variables as written.
    pub(super) variables: Vec<VariableRow>,
    /// Every quantity read, by the path of its key.
    pub(super) seen: BTreeMap<String, Quantity>,
}

/// Largest count or life a scene may ask for; beyond it a slip of the hand is likelier than a wish.
const COUNT_LIMIT: i64 = 100_000_000;

/// Reads a whole scene.
///
/// # Errors
/// Every fault found.
pub(super) fn resolve(origin: &str, document: &Table, overrides: &Overrides) -> Result<Resolved, Vec<Fault>> {
    let mut cx = Context::new(origin, overrides);
    let cx = &mut cx;
    let mut file = Section::new("", document);

    if let Some(parameters) = file.get("parameters") {
        match parameters.as_table() {
            Some(table) => cx.read_parameters(table),
            None => cx.wrong_type("parameters", parameters, "a table".to_owned()),
        }
    }
    let names = head(cx, &mut file);
    let bodies = mechanism::bodies(cx, &mut file);
    let materials = mechanism::materials(cx, &mut file);
    let joints = mechanism::joints(cx, &mut file, &bodies, &materials);
    let loads = mechanism::loads(cx, &mut file, &bodies);
    let gravity = file.pair_or(cx, "gravity", ACCELERATION, [0.0; 2]);
    let outputs = outputs(cx, &mut file, &bodies, &joints);
    let limit_states = limit_states(cx, &mut file, &outputs);
    let life = life(cx, &mut file, &bodies);
    let study = study(cx, &mut file);
    let variables = variable_rows(cx, &mut file);
    if !variables.is_empty() && limit_states.is_empty() {
        cx.fault(
            "limit_states",
            FaultKind::Missing { expected: "at least one limit state for a study".to_owned() },
        );
    }
    file.finish(cx);
    // With other faults about, a key may only be unread because of them.
    if cx.faults.is_empty() {
        cx.check_overrides();
    }

    let faults = std::mem::take(&mut cx.faults);
    let seen = std::mem::take(&mut cx.seen);
    let scene = (|| {
        let (name, title) = names?;
        Some(Scene {
            name,
            title,
            bodies,
            joints: joints.into_iter().map(|(_, joint)| joint).collect::<Option<_>>()?,
            loads,
            gravity: gravity?,
            outputs: outputs.into_iter().map(|(_, _, output)| output).collect::<Option<_>>()?,
            variables: Vec::new(),
            limit_states: limit_states.into_iter().collect::<Option<_>>()?,
            life: life?,
            study: study?,
        })
    })();
    match scene {
        Some(scene) if faults.is_empty() => Ok(Resolved { scene, variables, seen }),
        _ => Err(with_variables(cx, faults, variables, &seen)),
    }
}

/// Adds the faults of those variables whose nominal values could be read all the same.
fn with_variables(
    cx: &mut Context,
    mut faults: Vec<Fault>,
    mut rows: Vec<VariableRow>,
    seen: &BTreeMap<String, Quantity>,
) -> Vec<Fault> {
    rows.retain(|row| row.changes.iter().all(|key| seen.contains_key(key)));
    variables(cx, &rows, seen);
    faults.append(&mut cx.faults);
    faults
}

fn head(cx: &mut Context, file: &mut Section) -> Option<(String, String)> {
    let mut section = file.section(cx, "scene", "a table [scene] with name and title")?;
    let name = section.text(cx, "name", "a short name");
    let title = section.text_or(cx, "title", "one line for people", name.unwrap_or_default());
    section.finish(cx);
    Some((name?.to_owned(), title?.to_owned()))
}

/// Name, kind of value and, unless faulty, the output itself.
type OutputRow = (String, Kind, Option<Output>);

fn outputs(
    cx: &mut Context,
    file: &mut Section,
    bodies: &[Body],
    joints: &[(String, Option<Joint>)],
) -> Vec<OutputRow> {
    let words = [("largest-wear", LENGTH), ("angular-velocity-difference", ANGULAR_VELOCITY)];
    let mut outputs = Vec::new();
    for (name, mut row) in file.rows(cx, "outputs") {
        let word = row.word(cx, "type", &words);
        let kind = match word {
            Some(LENGTH) => largest_wear(cx, &mut row, joints),
            Some(_) => {
                let a = signed_body(cx, &mut row, "a", bodies);
                let b = signed_body(cx, &mut row, "b", bodies);
                a.zip(b).map(|(a, b)| OutputKind::AngularVelocityDifference { a, b })
            }
            None => None,
        };
        row.finish(cx);
        let output = kind.map(|kind| Output { name: name.to_owned(), kind });
        outputs.push((name.to_owned(), word.unwrap_or(NUMBER), output));
    }
    outputs
}

fn largest_wear(
    cx: &mut Context,
    row: &mut Section,
    joints: &[(String, Option<Joint>)],
) -> Option<OutputKind> {
    let wears = |joint: &Option<Joint>| {
        joint.as_ref().is_none_or(|joint| matches!(joint.kind, JointKind::Clearance(_)))
    };
    let key = row.key("joints");
    let chosen: Vec<usize> = match row.get("joints") {
        None => (0..joints.len()).filter(|&i| wears(&joints[i].1)).collect(),
        Some(_) => {
            let names = row.texts(cx, "joints", "a list of names of joints")?;
            let known = joints.iter().map(|(name, _)| name.as_str());
            let found: Vec<_> =
                names.iter().map(|name| cx.reference(&key, "joint", name, known.clone())).collect();
            found.into_iter().collect::<Option<_>>()?
        }
    };
    if let Some(&ideal) = chosen.iter().find(|&&i| !wears(&joints[i].1)) {
        cx.inconsistent(key, format!("joint \"{}\" is ideal and does not wear", joints[ideal].0));
        return None;
    }
    if chosen.is_empty() {
        cx.inconsistent(key, "no joint with clearance to watch");
        return None;
    }
    Some(OutputKind::LargestWear { joints: chosen })
}

fn signed_body(
    cx: &mut Context,
    row: &mut Section,
    key: &'static str,
    bodies: &[Body],
) -> Option<SignedBody> {
    let mut section = row.section(cx, key, "a body { body, sign, label }")?;
    let name = section.text(cx, "body", "the name of a body");
    let sign = section.integer(cx, "sign", -1..=1, Some(1));
    if sign == Some(0) {
        cx.fault(
            section.key("sign"),
            FaultKind::OutOfRange { value: "0".to_owned(), allowed: "1 or -1".to_owned() },
        );
    }
    let label = section.text_or(cx, "label", "what a reader calls it", name.unwrap_or_default());
    let body_key = section.key("body");
    section.finish(cx);
    let body = cx.reference(&body_key, "body", name?, bodies.iter().map(|body| body.name.as_str()))?;
    Some(SignedBody { body, sign: sign? as f64, label: label?.to_owned() })
}

fn limit_states(cx: &mut Context, file: &mut Section, outputs: &[OutputRow]) -> Vec<Option<LimitState>> {
    let mut limit_states = Vec::new();
    for (name, mut row) in file.rows(cx, "limit_states") {
        let output = row.text(cx, "output", "the name of an output");
        let key = row.key("output");
        let output = output
            .and_then(|output| cx.reference(&key, "output", output, outputs.iter().map(|o| o.0.as_str())));
        let kind = output.map_or(NUMBER, |output| outputs[output].1);
        let threshold = match output {
            Some(_) => row.quantity(cx, "threshold", kind, Range::Positive),
            None => row.get("threshold").and(None),
        };
        row.finish(cx);
        let both = output.zip(threshold);
        limit_states.push(both.map(|(output, threshold)| LimitState {
            name: name.to_owned(),
            output,
            threshold,
        }));
    }
    limit_states
}

fn life(cx: &mut Context, file: &mut Section, bodies: &[Body]) -> Option<Life> {
    let mut section = file.section(cx, "life", "a table [life] with cycles and checkpoint_every")?;
    let period = match section.get("period") {
        Some(_) => section.quantity(cx, "period", TIME, Range::Positive),
        None => period_of_drive(cx, &section.key("period"), bodies),
    };
    let cycles = section.integer(cx, "cycles", 1..=COUNT_LIMIT, None);
    let every = section.integer(cx, "checkpoint_every", 1..=COUNT_LIMIT, None);
    let key = section.key("cycles");
    section.finish(cx);
    let (cycles, every) = (cycles?, every?);
    if cycles % every != 0 {
        let (value, allowed) = (cycles.to_string(), format!("a multiple of checkpoint_every = {every}"));
        cx.fault(key, FaultKind::OutOfRange { value, allowed });
        return None;
    }
    // Both fit: COUNT_LIMIT is below u32::MAX.
    Some(Life { period: period?, cycles: cycles as u32, checkpoint_every: every as u32, settle_cycles: 1 })
}

/// One turn of the only driven body.
fn period_of_drive(cx: &mut Context, key: &str, bodies: &[Body]) -> Option<f64> {
    let speeds: Vec<f64> = bodies
        .iter()
        .filter_map(|body| match body.motion {
            Motion::Driven { drive: Drive::ConstantSpeed { speed, .. }, .. } => Some(speed),
            _ => None,
        })
        .collect();
    match speeds[..] {
        [speed] => Some(2.0 * std::f64::consts::PI / speed.abs()),
        _ if !cx.faults.is_empty() => None,
        _ => {
            let expected = format!("a time: the scene has {} driven bodies, not one", speeds.len());
            cx.fault(key, FaultKind::Missing { expected });
            None
        }
    }
}

fn study(cx: &mut Context, file: &mut Section) -> Option<StudySettings> {
    let default = StudySettings::default();
    let Some(mut section) = file.section_if_any(cx, "study") else { return Some(default) };
    let mut count = |cx: &mut Context, key, default: usize| {
        section.integer(cx, key, 1..=COUNT_LIMIT, Some(default as i64))
    };
    let population = count(cx, "population", default.population);
    let initial = count(cx, "initial", default.initial);
    let batch = count(cx, "batch", default.batch);
    let max_evaluations = count(cx, "max_evaluations", default.max_evaluations);
    let seed = section.integer(cx, "seed", 0..=i64::MAX, Some(default.seed as i64));
    for (key, bound) in [("population", population), ("max_evaluations", max_evaluations)] {
        if let Some((initial, bound)) = initial.zip(bound)
            && bound < initial
        {
            let (value, allowed) = (bound.to_string(), format!(">= initial = {initial}"));
            cx.fault(section.key(key), FaultKind::OutOfRange { value, allowed });
        }
    }
    section.finish(cx);
    Some(StudySettings {
        population: population? as usize,
        initial: initial? as usize,
        batch: batch? as usize,
        max_evaluations: max_evaluations? as usize,
        seed: seed? as u64,
    })
}
