//! `coordinator weibull`: the Weibull distribution of lives of a population, beside the reliability of a study.

use super::{CommandError, Destination, Done, OpenedStudy, answer_with, probability};
use clap::Args;
use coordinator::analyses::weibull::{LifeQuestion, WeibullReport, answer, json, read_lives};
use std::path::PathBuf;

pub const EXAMPLES: &str = "\
The file has one unit a line: unit, cycles, state (failed, running or interval), and where they apply mode (the limit state that failed) \
and from (the last life at which a unit that was found failed still ran):

  unit, cycles, state,    mode, from
  A7,   61200,  failed,   wear
  A8,   40000,  running
  A9,   50000,  interval, wear, 45000

or the observations of `update`. With --study the answer says whether the data contradict the reliability of the study, and which of \
the two has the larger evidence.

Examples:
  coordinator weibull fleet.csv
  coordinator weibull fleet.csv --mode wear --reliability 0.999 --confidence 95%
  coordinator weibull fleet.csv --study study --out weibull";

/// Arguments of `coordinator weibull`.
#[derive(Debug, Clone, Args)]
pub struct WeibullArguments {
    /// Lives of the units, CSV
    pub file: PathBuf,
    /// Finished study to compare with
    #[arg(long, value_name = "DIR")]
    pub study: Option<PathBuf>,
    /// Count failures by this limit state alone; those by others are suspensions [default: all, the total of the study]
    #[arg(long, value_name = "NAME")]
    pub mode: Option<String>,
    /// Reliability whose life is stated
    #[arg(long, value_name = "R", default_value = "0.99", value_parser = probability)]
    pub reliability: f64,
    /// Two-sided confidence of the bounds
    #[arg(long, value_name = "SHARE", default_value = "90%", value_parser = probability)]
    pub confidence: f64,
    /// Write weibull.html, weibull.md, weibull.json and figures/ to this folder, created if missing; or the answer to this file
    #[arg(long, value_name = "DIR")]
    pub out: Option<Destination>,
}

/// Runs the command.
///
/// # Errors
/// [`CommandError`].
pub fn weibull(arguments: &WeibullArguments, as_json: bool) -> Done {
    let WeibullArguments { file, study, mode, reliability, confidence, out } = arguments;
    let summary =
        study.as_ref().map(|dir| OpenedStudy::of_units(dir)).transpose()?.map(|opened| opened.summary);
    let end = summary.as_ref().and_then(|summary| summary.reliability.last());
    let question = LifeQuestion {
        mode: mode.as_deref(),
        known: summary.as_ref().map(|summary| summary.limit_states.as_slice()),
        end: end.map_or(f64::INFINITY, |row| f64::from(row.cycles)),
    };
    let lives = read_lives(file, &question)?;
    let mut report = WeibullReport::new(lives, *confidence, *reliability).map_err(|error| {
        let of_mode = mode.as_ref().filter(|_| error.failed == 0);
        let fault =
            of_mode.map_or(error.to_string(), |mode| format!("--mode {mode}: no unit has failed by it"));
        CommandError::refused(file.display(), fault)
    })?;
    if let Some(summary) = &summary {
        report.compare(summary, mode.as_deref().unwrap_or("total")).map_err(CommandError::bad_input)?;
    }
    answer_with(&answer(&report), &json(&report), out.as_ref(), as_json)
}
