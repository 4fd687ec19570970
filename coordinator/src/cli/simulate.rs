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
use common::scene::{Fault, FaultKind, Faults, SceneSource};
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
    let settings = settings(&source, &arguments.set)?;
    if let Some(simulator) = &source.nominal().simulator {
        external::check_accuracy(source.origin(), &arguments.accuracy)?;
        if arguments.report.is_some() {
            return Err(CommandError::NoMechanism { origin: source.origin().to_owned() });
        }
        let text = external::simulate(&source, simulator, &settings)?;
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
        write_text(file, &simulated.report(&arguments.set, source.text())?)?;
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

/// Reads every `--set`; reports all faults at once.
fn settings(source: &SceneSource, all: &[String]) -> Result<Vec<(String, f64)>, CommandError> {
    let mut faults = Vec::new();
    let mut settings = Vec::new();
    for setting in all {
        match source.parse_setting(setting) {
            Ok((name, _)) if settings.iter().any(|(known, _)| *known == name) => {
                faults.push(unsettable(setting, format!("{name} is set twice")));
            }
            Ok(setting) => settings.push(setting),
            Err(found) if is_unknown(&found) && is_other_key(source, setting) => {
                let message = "this key is no random variable and no quantity, and only those can be set; write a scene \
                    that `extends` this one and changes it";
                faults.push(unsettable(setting, message.to_owned()));
            }
            Err(found) => faults.extend(found.0),
        }
    }
    if faults.is_empty() { Ok(settings) } else { Err(Faults(faults).into()) }
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

fn unsettable(setting: &str, message: String) -> Fault {
    Fault::new("--set", setting, FaultKind::Inconsistent { message })
}

fn is_unknown(faults: &Faults) -> bool {
    faults.0.iter().any(|fault| matches!(fault.kind, FaultKind::UnknownReference { .. }))
}

/// Whether the name in `name=value` is a key of the scene with a whole number, a text or a switch, e.g. `life.cycles`.
fn is_other_key(source: &SceneSource, setting: &str) -> bool {
    let name = setting.split_once('=').map_or(setting, |(name, _)| name.trim());
    let mut parts = name.split('.');
    let (Some(first), Ok(document)) = (parts.next(), source.text().parse::<toml::Table>()) else {
        return false;
    };
    let value = parts.try_fold(document.get(first), |value, key| Some(value?.get(key)));
    value.flatten().is_some_and(|value| value.is_integer() || value.is_bool())
}
