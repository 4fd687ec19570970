//! `coordinator simulate`: runs one evaluation in this process and prints it, as JSON for scripts and in lines for a person.

use super::accuracy::AccuracyArguments;
use super::error::CommandError;
use super::evaluation_json::{of_mechanism, of_outputs};
use super::external;
use super::output::{check_destination, deliver, print, to_json};
use super::scenes::check_linkage;
use super::shared::{DEFAULT_SCENE, Verbosity};
use super::simulated::Simulated;
use clap::Args;
use common::scene::{Fault, Faults, SceneSource};
use coordinator::results::result_files::write_text;
use std::io::IsTerminal;
use std::path::{Path, PathBuf};
use std::time::Instant;
use worker::simulate::{self, SimulateOptions};

/// Arguments of `coordinator simulate`.
#[derive(Debug, Clone, Args)]
pub struct SimulateArguments {
    /// Scene file, or name of a built-in scene
    #[arg(long, default_value = DEFAULT_SCENE, value_name = "NAME-or-FILE")]
    pub scene: String,
    /// Set a random variable, or any quantity by its key, e.g. rod_length=40.05mm
    #[arg(long, value_name = "variable=value")]
    pub set: Vec<String>,
    #[command(flatten)]
    pub accuracy: AccuracyArguments,
    /// Write the JSON to this file instead of standard output
    #[arg(long, value_name = "FILE", help_heading = "Output")]
    pub out: Option<PathBuf>,
    /// Write a page with figures: outputs over life against the limits, motion, worn bores, first and last cycle
    #[arg(long, value_name = "FILE.html", help_heading = "Output")]
    pub report: Option<PathBuf>,
}

/// Runs the command.
///
/// # Errors
/// [`CommandError`].
pub fn simulate(arguments: &SimulateArguments, verbosity: Verbosity) -> Result<(), CommandError> {
    check_destination(arguments.out.as_deref())?;
    check_destination(arguments.report.as_deref())?;
    let source = SceneSource::load(&arguments.scene)?;
    let settings = source.parse_settings(&arguments.set)?;
    if source.nominal().simulator.is_some() {
        external::check_accuracy(source.origin(), &arguments.accuracy)?;
        if arguments.report.is_some() {
            return Err(CommandError::no_mechanism(source.origin()));
        }
        let text = external::simulate(&source, &settings)?;
        return deliver(&text, arguments.out.as_deref());
    }
    let scene = source.resolve_with(&settings).map_err(one_of_each_cause)?;
    check_linkage(source.origin(), &source, &scene)?;
    let accuracy = arguments.accuracy.for_one(&scene, verbosity.quiet)?.setting;
    let start = Instant::now();
    let evaluation = simulate::simulate(&scene, &accuracy.accuracy, SimulateOptions::WITH_FIRST_CYCLE)
        .map_err(|failure| CommandError::of_simulation(source.origin(), &scene, failure))?;
    let wall = start.elapsed().as_secs_f64();
    let simulated = Simulated { scene: &scene, accuracy: &accuracy.name, evaluation: &evaluation, wall };
    if let Some(file) = &arguments.report {
        write_text(file, &simulated.report(&arguments.set, source.text()))?;
    }
    // A person reads lines, a script the object.
    let to_person = !verbosity.json && arguments.out.is_none() && std::io::stdout().is_terminal();
    if !to_person {
        let mut all = of_outputs(&scene, &settings, &evaluation, wall);
        all.extend(of_mechanism(&scene, &accuracy.name, &evaluation));
        deliver(&to_json(&all)?, arguments.out.as_deref())?;
    }
    let files: Vec<&Path> =
        [&arguments.out, &arguments.report].into_iter().flatten().map(PathBuf::as_path).collect();
    let has_lines = to_person || arguments.out.is_some();
    if has_lines && !verbosity.quiet && !verbosity.json { print(&simulated.text(&files)) } else { Ok(()) }
}

/// The faults without those that one value has at several keys.
fn one_of_each_cause(Faults(all): Faults) -> Faults {
    let mut found: Vec<Fault> = Vec::new();
    for fault in all {
        if !found.iter().any(|known| known.kind == fault.kind) {
            found.push(fault);
        }
    }
    Faults(found)
}
