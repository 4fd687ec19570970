//! `coordinator extremes`: a scene at the edges of its model, as a table.

use super::arguments::{ExtremesArguments, Talk};
use super::error::CommandError;
use super::output::{deliver, to_json};
use super::scenes::check_linkage;
use common::accuracy::Accuracy;
use common::scene::{ContactLaw, Scene, SceneSource};
use coordinator::output_unit::OutputUnit;
use serde::Serialize;
use std::fmt::Write;
use worker::extremes::{Outcome, Row, cases, run_all};

/// A row as printed; the names are a contract with scripts.
#[derive(Debug, Serialize)]
struct PrintedRow<'r> {
    case: &'r str,
    contact_law: &'static str,
    outcome: &'static str,
    failure: Option<String>,
    outputs: Vec<PrintedOutput<'r>>,
    steps: u64,
    steps_at_half: u64,
}

/// An output at the checkpoint where the two runs differ most, measured by the stated error.
#[derive(Debug, Serialize)]
struct PrintedOutput<'r> {
    name: &'r str,
    unit: &'static str,
    cycles: u32,
    value: f64,
    stated_error: f64,
    difference: f64,
}

/// Runs the command.
pub fn extremes(arguments: &ExtremesArguments, talk: Talk) -> Result<(), CommandError> {
    let source = SceneSource::load(&arguments.scene)?;
    let scene = source.nominal();
    check_linkage(source.origin(), scene)?;
    // The names come from the list of presets.
    let accuracy = Accuracy::by_name(&arguments.accuracy).unwrap_or_default();
    let cases = cases(scene, &accuracy);
    let threads = std::thread::available_parallelism().map_or(1, usize::from);
    let rows = run_all(&cases, threads, |row| {
        if !talk.quiet {
            eprintln!("{}, {}: {}", row.case, name_of(row.law), verdict(&row.outcome));
        }
    });
    let printed: Vec<PrintedRow> = rows.iter().map(|row| printed(scene, row)).collect();
    let text = if talk.json { to_json(&printed)? } else { table(&printed) };
    deliver(&text, arguments.out.as_deref())?;
    let unsound = rows.iter().filter(|row| !row.outcome.is_sound()).count();
    if unsound > 0 {
        let origin = source.origin().to_owned();
        return Err(CommandError::Disagreement { origin, unsound, cases: rows.len() });
    }
    Ok(())
}

fn printed<'r>(scene: &'r Scene, row: &'r Row) -> PrintedRow<'r> {
    let outputs = row.compared.iter().map(|c| {
        let output = &scene.outputs[c.output];
        let unit = OutputUnit::of(&output.kind);
        let [value, stated_error, difference] = [c.value, c.error, c.difference].map(|si| unit.to_shown(si));
        PrintedOutput {
            name: &output.name,
            unit: unit.symbol(),
            cycles: c.cycles,
            value,
            stated_error,
            difference,
        }
    });
    let failure = match &row.outcome {
        Outcome::Refused(failure) | Outcome::Unconfirmed(failure) => Some(failure.to_string()),
        Outcome::Agrees | Outcome::Disagrees => None,
    };
    PrintedRow {
        case: row.case,
        contact_law: name_of(row.law),
        outcome: verdict(&row.outcome),
        failure,
        outputs: outputs.collect(),
        steps: row.steps,
        steps_at_half: row.steps_of_half,
    }
}

fn name_of(law: ContactLaw) -> &'static str {
    match law {
        ContactLaw::LocalHertz => "local-hertz",
        ContactLaw::Foundation => "foundation",
    }
}

fn verdict(outcome: &Outcome) -> &'static str {
    match outcome {
        Outcome::Agrees => "agrees",
        Outcome::Refused(_) => "refused",
        Outcome::Disagrees => "DISAGREES",
        Outcome::Unconfirmed(_) => "UNCONFIRMED",
    }
}

/// One line a case and output, as a table in Markdown.
fn table(rows: &[PrintedRow]) -> String {
    let mut out = String::from(
        "| case | contact law | outcome | output | cycles | value | stated error | difference | steps | at half |\n\
         |---|---|---|---|---|---|---|---|---|---|\n",
    );
    for row in rows {
        let head = format!("| {} | {} | {} |", row.case, row.contact_law, row.outcome);
        let tail = format!("| {} | {} |", row.steps, row.steps_at_half);
        // Writing to a String cannot fail.
        if let Some(failure) = &row.failure {
            let _ = writeln!(out, "{head} {failure} | | | | {tail}");
        }
        for o in &row.outputs {
            let _ = writeln!(
                out,
                "{head} {} | {} | {:.4} {} | {:.1e} | {:.1e} {tail}",
                o.name, o.cycles, o.value, o.unit, o.stated_error, o.difference
            );
        }
    }
    out
}
