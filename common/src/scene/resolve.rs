//! Turns the tables of a scene file into a [`Scene`]: one pass, every fault, overrides applied.

use super::bodies::bodies;
use super::body_row::BodyRow;
use super::clearance::materials;
use super::conditions::{ConditionRow, PARAMETERS, condition_rows};
use super::context::{Context, Overrides};
use super::elements::{limit_states, loads, outputs};
use super::faults::{Fault, FaultKind, Faults};
use super::joints::joints;
use super::life::life;
use super::model::{Life, Scene, StudySettings};
use super::quantity::{ACCELERATION, Quantity};
use super::section::{COUNT_LIMIT, Section, VALUE_LIMIT};
use super::simulator::{Model, cycles, external, simulator};
use super::units::Units;
use super::variables::{Changed, Changes, MeasuredVariable, correlations, variables};
use super::wear_model::wear_model;
use crate::accuracy::{AccuracyNameError, LevelsError, NamedAccuracy};
use std::collections::{BTreeMap, BTreeSet};
use toml::Table;

/// Result of one pass over a scene.
pub(super) struct Resolved {
    /// The scene; without random variables and correlations unless these were asked for.
    pub(super) scene: Scene,
    /// Operating conditions as written; those of the scene are still empty.
    pub(super) conditions: Vec<ConditionRow>,
    /// Random variables that have measured samples.
    pub(super) measured: Vec<MeasuredVariable>,
    /// Every quantity read, by the path of its key.
    pub(super) seen: BTreeMap<String, Quantity>,
    /// Parameters that something depends on.
    pub(super) used: BTreeSet<String>,
}

/// Reads a whole scene; `with_variables`, also its random variables and correlations, whose nominal values follow from its quantities.
///
/// # Errors
/// Every fault found.
pub(super) fn resolve(
    origin: &str,
    document: &Table,
    overrides: &Overrides,
    with_variables: bool,
) -> Result<Resolved, Faults> {
    let cx = Context::new(origin, overrides);
    let mut file = Section::new(&cx, "", document);
    if let Some(parameters) = file.get("parameters") {
        match parameters.as_table() {
            Some(table) => cx.read_parameters(table),
            None => drop(file.wrong_type("parameters", parameters, "a table")),
        }
    }
    let variables_written = document.get("variables").and_then(toml::Value::as_array).map_or(0, Vec::len);
    let (changes, life, limits, scene) = parts(&mut file, variables_written);
    let mut conditions = Vec::new();
    if changes != Changes::None {
        conditions = condition_rows(&mut file, life.as_ref());
    }
    // The parameters of a variable or a correlation are no quantities of the scene that an override could set.
    let seen = cx.seen.take();
    let changed = Changed { may: changes, seen: &seen, is_faulty: cx.fault_count() > 0 };
    let (mut read, mut correlated) = (vec![], vec![]);
    if with_variables {
        read = variables(&mut file, changed, scene.as_ref().map(|scene| &scene.units));
        correlated = correlations(&mut file, &read, changed.is_faulty);
        if !read.is_empty() && limits == 0 {
            file.missing("limit_states", "at least one limit state for a study");
        }
    } else {
        let _ = (file.get("variables"), file.get("correlations"));
    }
    file.finish();
    // After another fault, a key may be unread only because of it.
    if cx.fault_count() == 0 {
        for key in overrides.keys() {
            file.reference(key, "quantity", key, seen.keys().map(String::as_str));
        }
    }
    match scene {
        Some(scene) if cx.fault_count() == 0 => {
            let (variables, measured): (_, Vec<_>) = read.into_iter().filter_map(|(_, read)| read).unzip();
            let mut scene = Scene { variables, correlations: correlated, ..scene };
            scene.units.add_limits(&scene.outputs, &scene.limit_states, document);
            let measured = measured.into_iter().flatten().collect();
            let mut used = cx.parameters.borrow().used();
            if scene.simulator.is_some() {
                // The program receives them.
                let changed = conditions.iter().flat_map(|row| row.changes.keys());
                used.extend(changed.filter_map(|key| key.strip_prefix(PARAMETERS)).map(str::to_owned));
            }
            Ok(Resolved { scene, conditions, measured, seen, used })
        }
        _ => Err(Faults(without_followers(cx.take_faults()))),
    }
}

/// The faults without those of references to what another fault left out: a row without a name, a list or table that is misspelt or of
/// another type.
fn without_followers(mut faults: Vec<Fault>) -> Vec<Fault> {
    for (list, missed) in [
        ("materials", &["material"][..]),
        ("bodies", &["body", "point", "quantity"]),
        ("points", &["point"]),
        ("joints", &["joint", "quantity"]),
        ("loads", &["quantity"]),
        ("outputs", &["output"]),
        ("variables", &["random variable"]),
        ("parameters", &[]),
    ] {
        let is_points = |fault: &Fault| list == "points" && fault.key.starts_with("bodies.");
        let is_cause = |fault: &Fault| match &fault.kind {
            FaultKind::UnknownReference(..) => false,
            FaultKind::UnknownKey { nearest, .. } if !fault.key.starts_with(&format!("{list}[")) => {
                nearest.as_deref() == Some(list) && (is_points(fault) || !fault.key.contains('.'))
            }
            _ if is_points(fault) => fault.key.ends_with(".points"),
            _ => fault.key == list || fault.key.starts_with(&format!("{list}[")),
        };
        let follows = |fault: &Fault| match &fault.kind {
            FaultKind::UnknownReference(what, _) => missed.contains(what),
            FaultKind::Expression(..) => missed.is_empty(),
            _ => false,
        };
        if faults.iter().any(is_cause) {
            faults.retain(|fault| !follows(fault));
        }
    }
    faults
}

/// The parts of a scene of `variables` random variables that are neither these nor conditions, as far as they could be read: what the variables
/// may change, the life, the number of limit states, and the scene without the rest, unless a part is faulty.
fn parts(file: &mut Section, variables: usize) -> (Changes, Option<Life>, usize, Option<Scene>) {
    let head = head(file);
    check_responsibility(file);
    // The outer `None` for a mechanism, the inner one for a faulty simulator.
    let simulator = simulator(file);
    // A faulty simulator may still say that it gives cycles.
    let gives = file.peek("simulator").and_then(|simulator| simulator.get("gives"));
    let is_cycle = gives.and_then(toml::Value::as_str) == Some("cycle");
    let (changes, model) = match simulator {
        // The body that stands for the mechanism may be changed.
        Some(_) if is_cycle => (Changes::Optional, cycles(file)),
        Some(_) => (Changes::None, external(file)),
        None => (Changes::Required, mechanism(file)),
    };
    if let Some(life) = &model.life {
        check_size(file, life, model.outputs.len());
    }
    let limit_states = limit_states(file, &model.outputs);
    let units = Units::read(file);
    let study = study(file, simulator.is_none() || is_cycle, variables);
    let (life, limits) = (model.life, limit_states.len());
    let scene = || {
        let (name, title, control_points_of_model) = head?;
        let (study, (accuracy, levels)) = study?;
        let Model { bodies, joints, loads, gravity, outputs, wear, life } = model;
        Some(Scene {
            name,
            title,
            bodies: bodies.into_iter().map(BodyRow::checked).collect::<Option<_>>()?,
            joints: joints.into_iter().map(|row| row.joint).collect::<Option<_>>()?,
            loads,
            gravity: gravity?,
            outputs: outputs.into_iter().map(|row| row.output).collect::<Option<_>>()?,
            conditions: Vec::new(),
            variables: Vec::new(),
            correlations: Vec::new(),
            limit_states: limit_states.into_iter().collect::<Option<_>>()?,
            units: units?,
            control_points_of_model,
            wear: wear?,
            life: life?,
            study,
            accuracy,
            levels,
            simulator: simulator.map_or(Some(None), |read| read.map(Some))?,
        })
    };
    (changes, life, limits, scene())
}

/// Reads a mechanism.
fn mechanism(file: &mut Section) -> Model {
    let materials = materials(file);
    let bodies = bodies(file, &materials);
    let joints = joints(file, &bodies, &materials);
    let loads = loads(file, &bodies);
    let gravity = file.pair_or("gravity", ACCELERATION, [0.0; 2]);
    let outputs = outputs(file, &bodies, &joints);
    let life = life(file, &bodies, &joints, &loads, &outputs);
    let read = joints.iter().filter_map(|row| row.joint.as_ref());
    let wear = wear_model(file, read);
    Model { bodies, joints, loads, gravity, outputs, wear, life }
}

/// Checks that all outputs at all checkpoints fit into a worker's message.
fn check_size(file: &Section, life: &Life, outputs: usize) {
    let count = (life.cycles / life.checkpoint_every) as usize;
    if count * outputs > VALUE_LIMIT {
        let message = format!("{count} checkpoints of {outputs} outputs are more than {VALUE_LIMIT} values");
        file.inconsistent("life.checkpoint_every", message);
    }
}

/// Reads `[scene]`: name and title, and of a mechanism whether its control points are a part of the model.
fn head(file: &mut Section) -> Option<(String, String, bool)> {
    let simulator = file.get("simulator").map(|simulator| simulator.get("gives"));
    let has_joints = simulator.is_none_or(|gives| gives.is_some());
    let mut section = file.section("scene", "a table [scene] with name and title")?;
    let name = section.text("name", "a short name");
    let title = section.text_or("title", "one line for people", name.unwrap_or_default());
    let of_model =
        if has_joints { section.boolean_or("control_points_of_model", false) } else { Some(false) };
    section.finish();
    Some((name?.to_owned(), title?.to_owned(), of_model?))
}

/// Keys of `[report]`: who is responsible for a study, and what its reader should know. They change no result.
pub const RESPONSIBILITY: [&str; 6] = ["author", "project", "revision", "checked", "approved", "note"];

/// Checks `[report]`, whose texts only the report of a study shows.
fn check_responsibility(file: &mut Section) {
    let Some(mut section) = file.section_if_any("report") else { return };
    for key in RESPONSIBILITY {
        section.text_or(key, "a text", "");
    }
    section.finish();
}

/// Accuracy of an evaluation, and the levels of a study by active learning.
type Levels = (NamedAccuracy, Vec<NamedAccuracy>);

/// Reads `[study]`: defaults of a study of `variables` random variables, and the accuracies of a mechanism.
fn study(file: &mut Section, simulates: bool, variables: usize) -> Option<(StudySettings, Levels)> {
    let default = StudySettings::for_variables(variables);
    let Some(mut section) = file.section_if_any("study") else {
        return Some((default, Levels::default()));
    };
    let mut count = |key, default: usize| section.integer(key, 1..=COUNT_LIMIT, Some(default as i64));
    let population = count("population", default.population);
    let initial = count("initial", default.initial);
    let batch = count("batch", default.batch);
    let max_evaluations = count("max_evaluations", default.max_evaluations);
    let seed = section.integer("seed", 0..=i64::MAX, Some(default.seed as i64));
    for (key, bound) in [("population", population), ("max_evaluations", max_evaluations)] {
        if let Some((initial, bound)) = initial.zip(bound)
            && bound < initial
        {
            section.out_of_range(key, bound.to_string(), format!(">= initial = {initial}"));
        }
    }
    let accuracy = if simulates { levels(&mut section) } else { Some(Levels::default()) };
    section.finish();
    let study = StudySettings {
        population: population? as usize,
        initial: initial? as usize,
        batch: batch? as usize,
        max_evaluations: max_evaluations? as usize,
        seed: seed? as u64,
    };
    Some((study, accuracy?))
}

/// Reads `accuracy` and `levels`; the first level is the accuracy unless that is given.
fn levels(section: &mut Section) -> Option<Levels> {
    const EXPECTED: &str = "the name of an accuracy, e.g. \"balanced\" or \"balanced+jump-2000\"";
    const LIST: &str =
        "one to three names of accuracies, from the coarsest to the finest, e.g. [\"draft\", \"balanced\"]";
    let (has_accuracy, has_levels) = (section.get("accuracy").is_some(), section.get("levels").is_some());
    let mut single = None;
    if has_accuracy || !has_levels {
        let name = section.text_or("accuracy", EXPECTED, "balanced")?;
        single = Some(accuracy(section, "accuracy", name)?);
    }
    if !has_levels {
        return Some((single?, vec![]));
    }
    let names = section.texts("levels", LIST)?;
    let named = names.iter().map(|name| accuracy(section, "levels", name));
    let levels: Vec<NamedAccuracy> = named.collect::<Option<_>>()?;
    match LevelsError::of(&levels) {
        Some(error) => section.inconsistent("levels", error.to_string()).and(None),
        None => Some((single.unwrap_or_else(|| levels[0].clone()), levels)),
    }
}

fn accuracy(section: &Section, key: &str, name: &str) -> Option<NamedAccuracy> {
    name.parse().map_err(|error: AccuracyNameError| section.inconsistent(key, error.to_string())).ok()
}
