//! Reads `[simulator]`: a study of an external simulator instead of a mechanism, a program or an FMU on this machine, or a model
//! behind the UM-Bridge protocol. Its random variables are the inputs, its outputs and life are declared.
//!
//! Scenes whose simulator gives one cycle: the joints that wear, the outputs of the wear and those of the program, and the life. The bodies
//! are those of the program, which the scene does not describe.

use super::body_row::{BodyRow, MotionWord};
use super::clearance::materials;
use super::context::Range;
use super::elements::{OutputRow, typed_output, typed_words};
use super::joints::{JointRow, worn_joint};
use super::key_table::Form;
use super::load::Load;
use super::model::{
    CycleProgram, CycleTier, ExternalSimulator, FileExchange, Life, Motion, Program, SimulatorKind,
    UmBridgeModel,
};
use super::output::OutputKind;
use super::quantity::{NUMBER, TIME};
use super::section::{CHECKPOINT_LIMIT, COUNT_LIMIT, Section, record};
use super::wear_model::{WearModel, wear_model};
use std::path::{Component, Path};
use toml::{Table, Value};

/// Default of the time that one evaluation may take [s].
const TIMEOUT: f64 = 600.0;
/// Default of the name of a model, as is customary for UM-Bridge servers.
const USUAL_MODEL: &str = "forward";
/// Cost of an evaluation over that of one at the next coarser level of a simulator, unless its scene names it [1]: half of every length in two
/// directions.
const LEVEL_COST: f64 = 4.0;
/// The file with the request in the working folder of an evaluation.
pub const REQUEST_FILE: &str = "request.json";

/// Reads `[simulator]`; the outer `None` without one, the inner one if it is faulty.
pub(super) fn simulator(file: &mut Section) -> Option<Option<ExternalSimulator>> {
    file.get("simulator")?;
    let Some(mut section) = file.section_if_any("simulator") else { return Some(None) };
    let given = cycle_program(&mut section);
    let read = record!(ExternalSimulator {
        levels: levels(&mut section, given.as_ref().is_some_and(Option::is_some)),
        level_cost: with_levels(&mut section, "level_cost", |section, key| {
            section.quantity_or(key, NUMBER, Range::Within(1.0, 1000.0), LEVEL_COST)
        }),
        finest_is_exact: with_levels(&mut section, "finest_is_exact", |section, key| section
            .boolean_or(key, false)),
        kind: kind(&mut section),
        timeout: section.quantity_or("timeout", TIME, Range::Positive, TIMEOUT),
        version: section.text_or("version", "a text, e.g. \"2024.1\"", "").map(str::to_owned),
        cycles: given,
    });
    section.finish();
    Some(read)
}

/// Reads the program, the FMU or the server, of which there is one.
fn kind(section: &mut Section) -> Option<SimulatorKind> {
    match ["program", "fmu", "umbridge"].map(|key| section.get(key).is_some()) {
        [true, false, false] => program(section).map(SimulatorKind::Program),
        [false, true, false] => fmu(section).map(SimulatorKind::Program),
        [false, false, true] => umbridge(section).map(SimulatorKind::UmBridge),
        [false, false, false] => {
            let expected = "a program, e.g. program = [\"python3\", \"beam.py\"], an FMU, e.g. fmu = \"beam.fmu\", or a server, \
                            e.g. umbridge = \"http://127.0.0.1:4242\"";
            section.missing("program", expected).and(None)
        }
        _ => {
            let message = "has more than one of program, fmu and umbridge, expected one of them";
            section.inconsistent_table(message).and(None)
        }
    }
}

/// Reads an FMU, which the program `hingewise.fmu` runs with the mapping as its arguments.
fn fmu(section: &mut Section) -> Option<Program> {
    let file = section.text("fmu", "the name of a file, e.g. \"mechanism.fmu\"");
    let python =
        section.text_or("python", "the path of a Python with the packages hingewise and fmpy", "python3");
    let folder = section.text_or("folder", "a folder", ".");
    let map = section.get("map").map_or(Some(vec![]), |map| mapping(section, "", map));
    let mut command = [python?, "-m", "hingewise.fmu", file?].map(str::to_owned).to_vec();
    let fmu = Some(command[3].clone());
    command.extend(map?);
    Some(Program { command, folder: folder?.to_owned(), exchange: None, fmu })
}

/// The texts `NAME=VARIABLE` of a `map`, or of a table in it whose keys follow the text `before` in a name.
fn mapping(section: &Section, before: &str, map: &Value) -> Option<Vec<String>> {
    let expected = "a table of variables of the FMU by name, e.g. { \"*.angle\" = \"*_phi\", peak = \"largest(torque)\" }";
    let Some(map) = map.as_table() else {
        return section.wrong_type("map", map, expected).and(None);
    };
    let pair = |(name, value): (&String, &Value)| match value.as_str() {
        Some(variable) => Some(vec![format!("{before}{name}={variable}")]),
        None => mapping(section, &format!("{before}{name}."), value),
    };
    Some(map.iter().map(pair).collect::<Option<Vec<_>>>()?.concat())
}

/// Reads the cycles that a simulator gives, of `[simulator]`; none if they are faulty.
fn cycle_program(section: &mut Section) -> Option<Option<CycleProgram>> {
    let is_cycle = section.word_or("gives", &[("life", false), ("cycle", true)], false)?;
    if !is_cycle {
        return Some(None);
    }
    let tier = section.word("tier", &CycleTier::WORDS);
    let journal = section.if_any("journal", |section, key| section.text(key, "a folder").map(str::to_owned));
    Some(Some(CycleProgram { tier: tier?, journal: journal? }))
}

/// Reads the names of the levels of accuracy; empty without any, none if they are faulty.
fn levels(section: &mut Section, gives_cycles: bool) -> Option<Vec<String>> {
    let expected =
        "two or three names, from the coarsest to the finest, e.g. [\"coarse mesh\", \"fine mesh\"]";
    let names = section.if_any("levels", |section, key| section.texts(key, expected))?;
    let names: Vec<String> = names.into_iter().flatten().map(str::to_owned).collect();
    if section.get("levels").is_none() {
        return Some(names);
    }
    let is_wrong = |(k, name): (usize, &String)| name.is_empty() || names[..k].contains(name);
    if !(2..=3).contains(&names.len()) || names.iter().enumerate().any(is_wrong) {
        let found = format!("{names:?}");
        return section.out_of_range("levels", found, "two or three different names").and(None);
    }
    let contradiction = if section.get("config").is_some_and(|config| config.get("level").is_some()) {
        "take the place of the key level of config, expected one of them"
    } else if section.get("fmu").is_some() || gives_cycles {
        "are of a program that gives whole lives; an FMU has none, cycles have the accuracies of [study]"
    } else {
        return Some(names);
    };
    section.inconsistent("levels", contradiction).and(None)
}

/// Reads a key that belongs to levels.
fn with_levels<T>(
    section: &mut Section,
    key: &'static str,
    read: impl FnOnce(&mut Section, &'static str) -> Option<T>,
) -> Option<T> {
    if section.peek(key).is_some() && section.peek("levels").is_none() {
        section.get(key);
        return section.inconsistent(key, "belongs to levels, of which there are none").and(None);
    }
    read(section, key)
}

fn program(section: &mut Section) -> Option<Program> {
    let command = section.texts("program", "a list of words, e.g. [\"python3\", \"beam.py\"]");
    let folder = section.text_or("folder", "a folder", ".");
    let exchange = exchange(section);
    let command: Vec<String> = command?.into_iter().map(str::to_owned).collect();
    if command.first().is_none_or(String::is_empty) {
        return section.inconsistent("program", "is empty, expected a program and its arguments").and(None);
    }
    Some(Program { command, folder: folder?.to_owned(), exchange: exchange?, fmu: None })
}

/// Lines over standard input and output, or files if there is a `results`.
fn exchange(section: &mut Section) -> Option<Option<FileExchange>> {
    if section.get("results").is_none() {
        if ["templates", "files"].map(|key| section.get(key).is_some()) == [false; 2] {
            return Some(None);
        }
        let expected = "the file that the program writes, e.g. results = \"results.out\"";
        return section.missing("results", expected).and(None);
    }
    let results = section.text("results", "the name of a file, e.g. \"results.out\"").map(str::to_owned);
    let templates = file_names(section, "templates");
    let files = file_names(section, "files");
    let exchange = FileExchange { results: results?, templates: templates?, files: files? };
    let inputs = || exchange.templates.iter().chain(&exchange.files);
    let results = std::slice::from_ref(&exchange.results);
    for (key, names) in [("results", results), ("templates", &exchange.templates), ("files", &exchange.files)]
    {
        if let Some(name) = names.iter().find(|name| !is_inner(name)) {
            return section.out_of_range(key, format!("\"{name}\""), "a relative path without ..").and(None);
        }
    }
    let twice = inputs().enumerate().find(|(k, name)| inputs().take(*k).any(|other| other == *name));
    if let Some((_, name)) = twice {
        let message = format!("goes with \"{name}\", which is named twice as an input");
        return section.inconsistent("results", message).and(None);
    }
    if inputs().any(|name| *name == exchange.results || *name == REQUEST_FILE)
        || exchange.results == REQUEST_FILE
    {
        let message = format!("and {REQUEST_FILE} are written for each evaluation, and cannot be inputs");
        return section.inconsistent("results", message).and(None);
    }
    Some(Some(exchange))
}

fn file_names(section: &mut Section, key: &'static str) -> Option<Vec<String>> {
    let expected = "a list of file names, e.g. [\"beam.inp\"]";
    let names = section.if_any(key, |section, key| section.texts(key, expected))?;
    Some(names.into_iter().flatten().map(str::to_owned).collect())
}

/// True for a path that leads to a file below its folder.
fn is_inner(name: &str) -> bool {
    !name.is_empty() && Path::new(name).components().all(|part| matches!(part, Component::Normal(_)))
}

fn umbridge(section: &mut Section) -> Option<UmBridgeModel> {
    let url = section.text("umbridge", "an address, e.g. \"http://127.0.0.1:4242\"");
    let model = section.text_or("model", "the name of a model", USUAL_MODEL);
    let config = match section.get("config") {
        None => Some(Table::new()),
        Some(Value::Table(config)) => Some(config.clone()),
        Some(other) => section.wrong_type("config", other, "a table").and(None),
    };
    let url = url?.trim_end_matches('/');
    if url.strip_prefix("http://").is_none_or(str::is_empty) {
        return section.out_of_range("umbridge", format!("\"{url}\""), "http://HOST:PORT").and(None);
    }
    Some(UmBridgeModel { url: url.to_owned(), model: model?.to_owned(), config: config? })
}

/// Reads `[life]` of a simulator: its checkpoints; a single one if there is no such table.
fn declared_life(file: &mut Section) -> Option<Life> {
    if file.get("life").is_none() {
        return Some(Life::of_checkpoints(1, 1));
    }
    let mut section = file.section_if_any("life")?;
    let life = checkpoints(&mut section);
    section.finish();
    life
}

/// Reads the checkpoints of a life, whose cycles have no period yet.
pub(super) fn checkpoints(section: &mut Section) -> Option<Life> {
    let cycles = section.integer("cycles", 1..=COUNT_LIMIT, None);
    let every = section.integer("checkpoint_every", 1..=COUNT_LIMIT, None);
    // Both fit: COUNT_LIMIT is below u32::MAX.
    let (cycles, checkpoint_every) = (cycles? as u32, every? as u32);
    if !cycles.is_multiple_of(checkpoint_every) {
        let allowed = format!("a multiple of checkpoint_every = {checkpoint_every}");
        return section.out_of_range("cycles", cycles, allowed).and(None);
    }
    if cycles / checkpoint_every > CHECKPOINT_LIMIT {
        let allowed = format!("so long that cycles = {cycles} has at most {CHECKPOINT_LIMIT} checkpoints");
        return section.out_of_range("checkpoint_every", checkpoint_every, allowed).and(None);
    }
    Some(Life::of_checkpoints(cycles, checkpoint_every))
}

/// Reads `[[outputs]]` of a simulator, each by `read`.
fn declared_outputs(file: &mut Section, read: impl Fn(&str, &mut Section) -> OutputRow) -> Vec<OutputRow> {
    let outputs = file.each_row("outputs", read);
    if outputs.is_empty() {
        file.missing("outputs", "at least one output, e.g. [[outputs]] name = \"deflection\" unit = \"mm\"");
    }
    outputs
}

/// Reads an output over the `life` of a simulator, which may be faulty.
fn declared_output(name: &str, row: &mut Section, life: Option<&Life>) -> OutputRow {
    let unit = row.text_or("unit", "a unit, as it is to be shown", "");
    let values = match row.get("values") {
        None => Some(false),
        Some(_) => values(row, life.map(|life| life.checkpoints().len())),
    };
    OutputRow::declared(name, unit, values)
}

/// Whether an output has a single value for the whole life, by the number of its values.
fn values(row: &mut Section, checkpoints: Option<usize>) -> Option<bool> {
    let (values, checkpoints) = (row.integer("values", 1..=COUNT_LIMIT, None)?, checkpoints?);
    if values == 1 || values as usize == checkpoints {
        return Some(values as usize != checkpoints);
    }
    let allowed = format!("1, or one for each of the {checkpoints} checkpoints of the life");
    row.out_of_range("values", values, allowed).and(None)
}

/// Sets the folder in which the program of a scene file runs: that of the file, or its `folder` relative to it, and that of its `journal`.
/// Returns true if the document changed.
pub(super) fn settle_folder(document: &mut Table, folder: Option<&Path>) -> bool {
    let section = document.get_mut("simulator").and_then(Value::as_table_mut);
    let (Some(section), Some(folder)) = (section, folder) else { return false };
    let is_program = ["program", "fmu"].iter().any(|key| section.contains_key(*key));
    if !is_program && !section.contains_key("journal") {
        return false;
    }
    let below = match section.get("folder") {
        None => ".",
        Some(Value::String(below)) => below,
        // A fault that the reader reports.
        Some(_) => return false,
    };
    let folder = if folder.as_os_str().is_empty() { Path::new(".") } else { folder };
    let whole = folder.join(below);
    // A folder that does not exist is reported when the program is started.
    let whole = whole.canonicalize().unwrap_or(whole);
    if let Some(Value::String(journal)) = section.get_mut("journal") {
        *journal = whole.join(&*journal).display().to_string();
    }
    if is_program {
        section.insert("folder".to_owned(), Value::String(whole.display().to_string()));
    }
    true
}

/// The model that is simulated and its outputs, as far as they could be read.
pub(super) struct Model {
    pub(super) bodies: Vec<BodyRow>,
    pub(super) joints: Vec<JointRow>,
    pub(super) loads: Vec<Load>,
    pub(super) gravity: Option<[f64; 2]>,
    pub(super) outputs: Vec<OutputRow>,
    pub(super) wear: Option<WearModel>,
    pub(super) life: Option<Life>,
}

/// Reads what an external simulator returns; its inside is not described.
pub(super) fn external(file: &mut Section) -> Model {
    let life = declared_life(file);
    let outputs = declared_outputs(file, |name, row| declared_output(name, row, life.as_ref()));
    let (gravity, wear) = (Some([0.0; 2]), Some(WearModel::default()));
    Model { bodies: vec![], joints: vec![], loads: vec![], gravity, outputs, wear, life }
}

/// Reads joints, outputs and life of a program that gives cycles, on the body that stands for the mechanism.
pub(super) fn cycles(file: &mut Section) -> Model {
    let materials = materials(file);
    let joints = file.each_row("joints", |name, row| worn_joint(row, name, &materials));
    if joints.is_empty() {
        file.missing("joints", "at least one joint that wears, [[joints]]");
    }
    let life = life(file);
    let outputs = outputs(file, &joints);
    let (word, motion) = (Some(MotionWord::Fixed), Some(Motion::Fixed));
    let body = BodyRow { name: "mechanism".to_owned(), word, motion, points: vec![] };
    let wear = wear_model(file, joints.iter().filter_map(|row| row.joint.as_ref()));
    Model { bodies: vec![body], joints, loads: vec![], gravity: Some([0.0; 2]), outputs, wear, life }
}

fn life(file: &mut Section) -> Option<Life> {
    let mut section = file.section("life", "a table [life] with period, cycles and checkpoint_every")?;
    let period = section.quantity("period", TIME, Range::Positive);
    let life = checkpoints(&mut section);
    section.finish();
    Some(Life { period: period?, settle_cycles: 1, ..life? })
}

/// Reads `[[outputs]]`: rows with a `type` are outputs of the wear, the others those of the program.
fn outputs(file: &mut Section, joints: &[JointRow]) -> Vec<OutputRow> {
    let of_wear =
        OutputKind::KINDS.iter().filter(|kind| kind.keys.iter().any(|key| key.form == Form::WornJoints));
    let words: Vec<_> = of_wear.flat_map(typed_words).collect();
    declared_outputs(file, |name, row| {
        if row.peek("type").is_some() {
            return typed_output(name, row, &words, &[], joints);
        }
        OutputRow::declared(name, row.text_or("unit", "a unit, as it is to be shown", ""), Some(false))
    })
}
