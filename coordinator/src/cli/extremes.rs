//! `coordinator extremes`: extreme cases of a scene, compared with runs at half the time step.

use super::error::CommandError;
use super::output::{answer_with, check_answer_destination};
use super::scenes::check_linkage;
use super::shared::{DEFAULT_SCENE, Verbosity};
use clap::Args;
use common::accuracy::NamedAccuracy;
use common::scene::{Scene, SceneSource};
use coordinator::presentation::report::answer::{Answer, AnswerPart, Table};
use serde::Serialize;
use std::path::PathBuf;
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
    unit: String,
    cycles: u32,
    value: f64,
    stated_error: f64,
    difference: f64,
}

/// Arguments of `coordinator extremes`.
#[derive(Debug, Clone, Args)]
pub struct ExtremesArguments {
    /// Scene file, or name of a built-in scene
    #[arg(long, default_value = DEFAULT_SCENE, value_name = "NAME-or-FILE")]
    pub scene: String,
    /// Accuracy of the runs, as for `run`
    #[arg(long, default_value = "balanced", value_name = "NAME")]
    pub accuracy: NamedAccuracy,
    /// Write extremes.html, extremes.md and extremes.json to this folder, created if missing; or the table to this file, which ends in
    /// .md, .txt or .json, instead of standard output
    #[arg(long, value_name = "DIR-or-FILE")]
    pub out: Option<PathBuf>,
}

/// Runs the command.
///
/// # Errors
/// [`CommandError::Simulation`] if a case is outside of its stated error.
pub fn extremes(arguments: &ExtremesArguments, verbosity: Verbosity) -> Result<(), CommandError> {
    check_answer_destination(arguments.out.as_deref())?;
    let source = SceneSource::load(&arguments.scene)?;
    let scene = source.nominal();
    check_linkage(source.origin(), &source, scene)?;
    let cases = cases(scene, &arguments.accuracy.accuracy);
    let threads = std::thread::available_parallelism().map_or(1, usize::from);
    let rows = run_all(&cases, threads, |row| {
        verbosity.say(format_args!("{}, {}: {}", row.case, row.law.name(), verdict(&row.outcome)));
    });
    let printed: Vec<PrintedRow> = rows.iter().map(|row| printed(scene, row)).collect();
    let answer = Answer {
        name: "extremes",
        title: format!("Extreme cases of {}", scene.name),
        parts: vec![AnswerPart::Table(table(&printed))],
        prints_markdown: true,
        ..Answer::default()
    };
    answer_with(&answer, &printed, arguments.out.as_deref(), verbosity.json)?;
    let unsound = rows.iter().filter(|row| !row.outcome.is_sound()).count();
    if unsound > 0 {
        let origin = source.origin().to_owned();
        let cases = rows.len();
        let what = format!(
            "{unsound} of {cases} extremes differ from half the step by more than their stated error, or fail with it"
        );
        return Err(CommandError::Simulation { origin, what });
    }
    Ok(())
}

fn printed<'r>(scene: &'r Scene, row: &'r Row) -> PrintedRow<'r> {
    let outputs = row.compared.iter().map(|c| {
        let output = &scene.outputs[c.output];
        let unit = output.kind.unit();
        let [value, stated_error, difference] = [c.value, c.error, c.difference].map(|si| unit.to_shown(si));
        PrintedOutput {
            name: &output.name,
            unit: unit.symbol().to_owned(),
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
        contact_law: row.law.name(),
        outcome: verdict(&row.outcome),
        failure,
        outputs: outputs.collect(),
        steps: row.steps,
        steps_at_half: row.steps_of_half,
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

/// A table with one line per case and output.
fn table(rows: &[PrintedRow]) -> Table {
    let head = "case | contact law | outcome | output | cycles | value | stated error | difference | steps | at half".split(" | ");
    let of_case = |row: &PrintedRow| {
        let failure = row.failure.iter().map(|failure| [failure.as_str(), "", "", "", ""].map(str::to_owned));
        let outputs = row.outputs.iter().map(|o| {
            let [stated, difference] = [o.stated_error, o.difference].map(|error| format!("{error:.1e}"));
            let value = format!("{:.4} {}", o.value, o.unit);
            [o.name.to_owned(), o.cycles.to_string(), value, stated, difference]
        });
        let line = |middle: [String; 5]| {
            let case = [row.case, row.contact_law, row.outcome].map(str::to_owned);
            let steps = [row.steps, row.steps_at_half].map(|steps| steps.to_string());
            [&case[..], &middle, &steps].concat()
        };
        failure.chain(outputs).map(line).collect::<Vec<_>>()
    };
    Table::new("", head, rows.iter().flat_map(of_case))
}

#[cfg(test)]
mod tests {
    use super::*;
    use common::failure::SimulationFailure;
    use common::scene::ContactLaw;
    use worker::extremes::Compared;

    fn row(outcome: Outcome, compared: Vec<Compared>) -> Row {
        let law = ContactLaw::Foundation;
        Row { case: "6 r/min", law, outcome, compared, depth: None, steps: 12, steps_of_half: 34 }
    }

    #[test]
    fn a_row_is_shown_in_the_units_of_text_and_a_refusal_with_its_reason() {
        let scene = SceneSource::builtin("four-bar").expect("built in").nominal().clone();
        let compared =
            vec![Compared { output: 0, cycles: 1000, value: 2.5e-6, error: 1e-8, difference: 2e-9 }];
        let failure = SimulationFailure::WearStep { cycle: 7, joint: "crank".into(), error: 3.0 };
        let rows = [row(Outcome::Agrees, compared), row(Outcome::Refused(failure.clone()), vec![])];
        let rows: Vec<PrintedRow> = rows.iter().map(|row| printed(&scene, row)).collect();
        let text = table(&rows).in_markdown();
        let lines: Vec<&str> = text.lines().collect();
        assert_eq!(lines.len(), 4);
        let line = "| 6 r/min | foundation | agrees | max_wear_depth | 1000 | 2.5000 µm | 1.0e-2 | 2.0e-3 | 12 | 34 |";
        assert_eq!(lines[2], line);
        assert!(lines[3].contains("| refused |") && lines[3].contains(&failure.to_string()));
        let columns = |line: &str| line.matches('|').count();
        assert!(lines.iter().all(|line| columns(line) == columns(lines[0])), "{text}");
    }
}
