//! Turns the tables of a scene file into a [`Scene`]: one pass, every fault, overrides applied.

use super::bodies::bodies;
use super::body_row::BodyRow;
use super::clearance::materials;
use super::correlations::{CorrelationRow, correlation_rows};
use super::faults::{Fault, FaultKind};
use super::joints::{JointRow, joints};
use super::life::life;
use super::limits::COUNT_LIMIT;
use super::load::Load;
use super::loads::loads;
use super::model::{Life, Scene, StudySettings};
use super::outputs::{OutputRow, limit_states, outputs};
use super::quantity::{ACCELERATION, Quantity};
use super::read::{Context, Overrides};
use super::section::Section;
use super::simulator::{declared_life, declared_outputs, simulator};
use super::variables::{VariableRow, variable_rows, variables};
use crate::accuracy::{AccuracyNameError, NamedAccuracy};
use std::collections::{BTreeMap, BTreeSet};
use toml::Table;

/// Everything one pass gives.
pub(super) struct Resolved {
    /// The scene, its `variables` still empty.
    pub(super) scene: Scene,
    /// Correlations as written; those of the scene are still empty.
    pub(super) correlations: Vec<CorrelationRow>,
    /// Random variables as written.
    pub(super) variables: Vec<VariableRow>,
    /// Every quantity read, by the path of its key.
    pub(super) seen: BTreeMap<String, Quantity>,
    /// Parameters that something depends on.
    pub(super) used: BTreeSet<String>,
}

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
    let simulator = simulator(cx, &mut file);
    let Described { bodies, joints, loads, gravity, outputs, life } = match simulator {
        Some(_) => external(cx, &mut file),
        None => mechanism(cx, &mut file),
    };
    let limit_states = limit_states(cx, &mut file, &outputs);
    let study = study(cx, &mut file, simulator.is_none());
    let variables = variable_rows(cx, &mut file, simulator.is_some());
    let correlations = correlation_rows(cx, &mut file);
    if !variables.is_empty() && limit_states.is_empty() {
        cx.fault(
            "limit_states",
            FaultKind::Missing { expected: "at least one limit state for a study".to_owned() },
        );
    }
    // What a variable or a correlation is like is no quantity of the scene that something could change.
    cx.seen.retain(|key, _| !(key.starts_with("variables.") || key.starts_with("correlations[")));
    file.finish(cx);
    // With other faults about, a key may only be unread because of them.
    if cx.faults.is_empty() {
        cx.check_overrides();
    }

    let faults = std::mem::take(&mut cx.faults);
    let seen = std::mem::take(&mut cx.seen);
    let scene = (|| {
        let (name, title) = names?;
        let (study, accuracy) = study?;
        Some(Scene {
            name,
            title,
            bodies: bodies.into_iter().map(BodyRow::checked).collect::<Option<_>>()?,
            joints: joints.into_iter().map(|row| row.joint).collect::<Option<_>>()?,
            loads,
            gravity: gravity?,
            outputs: outputs.into_iter().map(|row| row.output).collect::<Option<_>>()?,
            variables: Vec::new(),
            correlations: Vec::new(),
            limit_states: limit_states.into_iter().collect::<Option<_>>()?,
            life: life?,
            study,
            accuracy,
            simulator: match simulator {
                Some(read) => Some(read?),
                None => None,
            },
        })
    })();
    match scene {
        Some(scene) if faults.is_empty() => {
            Ok(Resolved { scene, correlations, variables, seen, used: cx.parameters.used() })
        }
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

/// What is simulated and what comes of it, as far as it could be read.
struct Described {
    bodies: Vec<BodyRow>,
    joints: Vec<JointRow>,
    loads: Vec<Load>,
    gravity: Option<[f64; 2]>,
    outputs: Vec<OutputRow>,
    life: Option<Life>,
}

/// A mechanism.
fn mechanism(cx: &mut Context, file: &mut Section) -> Described {
    let bodies = bodies(cx, file);
    let materials = materials(cx, file);
    let joints = joints(cx, file, &bodies, &materials);
    let loads = loads(cx, file, &bodies);
    let gravity = file.pair_or(cx, "gravity", ACCELERATION, [0.0; 2]);
    let outputs = outputs(cx, file, &bodies, &joints);
    let life = life(cx, file, &bodies, &loads);
    Described { bodies, joints, loads, gravity, outputs, life }
}

/// An external simulator: nothing is known of it but what it returns.
fn external(cx: &mut Context, file: &mut Section) -> Described {
    let life = declared_life(cx, file);
    let outputs = declared_outputs(cx, file, life.as_ref());
    Described { bodies: vec![], joints: vec![], loads: vec![], gravity: Some([0.0; 2]), outputs, life }
}

fn head(cx: &mut Context, file: &mut Section) -> Option<(String, String)> {
    let mut section = file.section(cx, "scene", "a table [scene] with name and title")?;
    let name = section.text(cx, "name", "a short name");
    let title = section.text_or(cx, "title", "one line for people", name.unwrap_or_default());
    section.finish(cx);
    Some((name?.to_owned(), title?.to_owned()))
}

/// Defaults of a study, and of the accuracy where the simulator is this program's own.
fn study(cx: &mut Context, file: &mut Section, simulates: bool) -> Option<(StudySettings, NamedAccuracy)> {
    let default = StudySettings::default();
    let Some(mut section) = file.section_if_any(cx, "study") else {
        return Some((default, NamedAccuracy::default()));
    };
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
    let accuracy = if simulates { accuracy(cx, &mut section) } else { Some(NamedAccuracy::default()) };
    section.finish(cx);
    let study = StudySettings {
        population: population? as usize,
        initial: initial? as usize,
        batch: batch? as usize,
        max_evaluations: max_evaluations? as usize,
        seed: seed? as u64,
    };
    Some((study, accuracy?))
}

fn accuracy(cx: &mut Context, section: &mut Section) -> Option<NamedAccuracy> {
    const EXPECTED: &str = "the name of an accuracy, e.g. \"balanced\" or \"balanced+jump-2000\"";
    let name = section.text_or(cx, "accuracy", EXPECTED, "balanced")?;
    name.parse()
        .map_err(|error: AccuracyNameError| cx.fault(section.key("accuracy"), FaultKind::Accuracy(error)))
        .ok()
}
