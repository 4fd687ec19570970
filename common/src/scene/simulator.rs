//! Reads `[simulator]`: a study of somebody else's simulator instead of a mechanism, a program on this machine or a
//! model behind the UM-Bridge protocol. Its random variables are the inputs, its outputs and life are declared.

use super::faults::FaultKind;
use super::limits::COUNT_LIMIT;
use super::model::{ExternalSimulator, Life, Program, SimulatorKind, UmBridgeModel};
use super::output::{Output, OutputKind};
use super::outputs::OutputRow;
use super::quantity::TIME;
use super::read::{Context, Range};
use super::section::Section;
use std::path::Path;
use toml::{Table, Value};

/// An evaluation may take this long unless the scene says otherwise [s].
const TIMEOUT: f64 = 600.0;
/// Name that UM-Bridge servers give their model by custom.
const USUAL_MODEL: &str = "forward";
/// Most checkpoints of a life: a surrogate stands for each.
const CHECKPOINT_LIMIT: u32 = 100_000;

/// Reads `[simulator]`; the outer `None` without one, the inner one if it is faulty.
pub(super) fn simulator(cx: &mut Context, file: &mut Section) -> Option<Option<ExternalSimulator>> {
    file.get("simulator")?;
    let Some(mut section) = file.section_if_any(cx, "simulator") else { return Some(None) };
    let kind = match (section.get("program").is_some(), section.get("umbridge").is_some()) {
        (true, false) => program(cx, &mut section).map(SimulatorKind::Program),
        (false, true) => umbridge(cx, &mut section).map(SimulatorKind::UmBridge),
        (true, true) => {
            cx.inconsistent(&section.path, "has both a program and an umbridge server, expected one of them");
            None
        }
        (false, false) => {
            let expected = "a program, e.g. program = [\"python3\", \"beam.py\"], or a server, e.g. umbridge = \
                            \"http://127.0.0.1:4242\"";
            cx.fault(section.key("program"), FaultKind::Missing { expected: expected.to_owned() });
            None
        }
    };
    let timeout = section.quantity_or(cx, "timeout", TIME, Range::Positive, TIMEOUT);
    section.finish(cx);
    Some((|| Some(ExternalSimulator { kind: kind?, timeout: timeout? }))())
}

fn program(cx: &mut Context, section: &mut Section) -> Option<Program> {
    let command = section.texts(cx, "program", "a list of words, e.g. [\"python3\", \"beam.py\"]");
    let folder = section.text_or(cx, "folder", "a folder", ".");
    let command: Vec<String> = command?.into_iter().map(str::to_owned).collect();
    if command.first().is_none_or(String::is_empty) {
        cx.inconsistent(section.key("program"), "is empty, expected a program and its arguments");
        return None;
    }
    Some(Program { command, folder: folder?.to_owned() })
}

fn umbridge(cx: &mut Context, section: &mut Section) -> Option<UmBridgeModel> {
    let url = section.text(cx, "umbridge", "an address, e.g. \"http://127.0.0.1:4242\"");
    let model = section.text_or(cx, "model", "the name of a model", USUAL_MODEL);
    let config = match section.get("config") {
        None => Some(Table::new()),
        Some(Value::Table(config)) => Some(config.clone()),
        Some(other) => {
            cx.wrong_type(&section.key("config"), other, "a table".to_owned());
            None
        }
    };
    let url = url?.trim_end_matches('/');
    if url.strip_prefix("http://").is_none_or(str::is_empty) {
        let (value, allowed) = (format!("\"{url}\""), "http://HOST:PORT".to_owned());
        cx.fault(section.key("umbridge"), FaultKind::OutOfRange { value, allowed });
        return None;
    }
    Some(UmBridgeModel { url: url.to_owned(), model: model?.to_owned(), config: config? })
}

/// Reads `[life]` of a simulator: its checkpoints; a single one if there is no such table.
pub(super) fn declared_life(cx: &mut Context, file: &mut Section) -> Option<Life> {
    let life = |cycles, checkpoint_every| Life { period: 0.0, cycles, checkpoint_every, settle_cycles: 0 };
    if file.get("life").is_none() {
        return Some(life(1, 1));
    }
    let mut section = file.section_if_any(cx, "life")?;
    let cycles = section.integer(cx, "cycles", 1..=COUNT_LIMIT, None);
    let every = section.integer(cx, "checkpoint_every", 1..=COUNT_LIMIT, None);
    let key = section.key("cycles");
    section.finish(cx);
    // Both fit: COUNT_LIMIT is below u32::MAX.
    let (cycles, every) = (cycles? as u32, every? as u32);
    let allowed = if !cycles.is_multiple_of(every) {
        format!("a multiple of checkpoint_every = {every}")
    } else if cycles / every > CHECKPOINT_LIMIT {
        format!("at most {CHECKPOINT_LIMIT} checkpoints")
    } else {
        return Some(life(cycles, every));
    };
    cx.fault(key, FaultKind::OutOfRange { value: cycles.to_string(), allowed });
    None
}

/// Reads `[[outputs]]` of a simulator; `life` may be faulty.
pub(super) fn declared_outputs(cx: &mut Context, file: &mut Section, life: Option<&Life>) -> Vec<OutputRow> {
    let checkpoints = life.map(|life| life.checkpoints().len());
    let mut outputs = Vec::new();
    for (name, mut row) in file.rows(cx, "outputs") {
        let unit = row.text_or(cx, "unit", "a unit, as it is to be shown", "");
        let values = match row.get("values") {
            None => Some(false),
            Some(_) => values(cx, &mut row, checkpoints),
        };
        row.finish(cx);
        let kind =
            unit.zip(values).map(|(unit, single)| OutputKind::External { unit: unit.to_owned(), single });
        outputs.push(OutputRow::declared(name, kind.map(|kind| Output { name: name.to_owned(), kind })));
    }
    if outputs.is_empty() {
        let expected = "at least one output, e.g. [[outputs]] name = \"deflection\" unit = \"mm\"".to_owned();
        cx.fault("outputs", FaultKind::Missing { expected });
    }
    outputs
}

/// Whether an output has a single value for the whole life, by the number of its values.
fn values(cx: &mut Context, row: &mut Section, checkpoints: Option<usize>) -> Option<bool> {
    let values = row.integer(cx, "values", 1..=COUNT_LIMIT, None)?;
    let checkpoints = checkpoints?;
    if values as usize == checkpoints {
        return Some(false);
    }
    if values == 1 {
        return Some(true);
    }
    let allowed = format!("1, or one for each of the {checkpoints} checkpoints of the life");
    cx.fault(row.key("values"), FaultKind::OutOfRange { value: values.to_string(), allowed });
    None
}

/// Writes down in which folder the program of a scene file runs: that of the file, or `folder` as seen from there.
/// Whether there was anything to write.
pub(super) fn settle_folder(document: &mut Table, folder: Option<&Path>) -> bool {
    let section = document.get_mut("simulator").and_then(Value::as_table_mut);
    let Some(section) = section.filter(|section| section.contains_key("program")) else { return false };
    let Some(folder) = folder else { return false };
    let below = match section.get("folder") {
        None => ".",
        Some(Value::String(below)) => below,
        // The reader says what is wrong with it.
        Some(_) => return false,
    };
    let folder = if folder.as_os_str().is_empty() { Path::new(".") } else { folder };
    let whole = folder.join(below);
    // A folder that is not there is named as it stands when the program is started.
    let whole = whole.canonicalize().unwrap_or(whole);
    section.insert("folder".to_owned(), Value::String(whole.display().to_string()));
    true
}
