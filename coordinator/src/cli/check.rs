//! `coordinator check`: every fault and warning of a scene with its place, for people and for editors.

use super::contact_choices::{ContactChange, contact_changes};
use super::draw::{check_picture, look};
use super::external;
use super::measured::MeasuredFinding;
use super::model::Model;
use super::nominal::{findings, nominal_evaluation};
use super::{
    CommandError, Done, SceneArguments, Verbosity, accuracy_name, check_linkage, count, print, to_json,
};
use clap::Args;
use common::accuracy::NamedAccuracy;
use common::external::SimulatorId;
use common::scene::{Fault, FaultKind, Location, Scene, SceneSource, Warning};
use coordinator::presentation::nominal_life::Reached;
use coordinator::presentation::report::format::count as with_separators;
use coordinator::presentation::terminal::while_waiting;
use serde_json::{Value, json};
use std::path::PathBuf;

/// A fault or a warning as editors read it: columns count characters from 1, `end_column` stands after the last one.
fn finding(file: &str, location: Option<&Location>, key: &str, message: &str) -> Value {
    json!({ "file": file, "line": location.map(|at| at.line), "column": location.map(|at| at.column),
            "end_column": location.map(|at| at.end_column), "key": key, "message": message, "used_at": null })
}

/// A fault, with the place where the parameter is used whose definition is at `line`.
fn finding_of_fault(fault: &Fault) -> Value {
    let message = match &fault.kind {
        FaultKind::Syntax { message, .. } => message.clone(),
        kind => kind.to_string(),
    };
    let mut found = finding(&fault.file, fault.location.as_deref(), &fault.key, &message);
    found["used_at"] = fault.used_at.as_ref().map(ToString::to_string).into();
    found
}

pub const EXAMPLES: &str = "\
Faults and warnings are printed with their line and key; warnings are no faults. What is known of the linkage, its loads and the cost is \
printed at once. Then the nominal mechanism is simulated until every limit is passed by more than its error, without --accuracy as coarsely as \
a first look allows, and more finely where an answer is within its error. --quick leaves out cost and life.

Examples:
  coordinator check my.toml
  coordinator check my.toml --quick
  coordinator check my.toml --draw my.svg
  coordinator check my.toml --contact
  coordinator check my.toml --set parameters.crank='25 mm' --accuracy balanced
  coordinator check my.toml --json";

/// Arguments of `coordinator check`.
#[derive(Debug, Clone, Args)]
pub struct CheckArguments {
    #[command(flatten)]
    pub scene: SceneArguments,
    /// Write a drawing of the mechanism, as SVG, and its loads that vary, over the angle of the crank, to FILE-loads.svg
    #[arg(long, value_name = "FILE.svg")]
    pub draw: Option<PathBuf>,
    /// Check text and linkage only: simulate no life
    #[arg(long, conflicts_with = "accuracy")]
    pub quick: bool,
    /// State how much the lives change with twice the film damping, the friction speed and the damping of the contacts
    #[arg(long, conflicts_with = "quick")]
    pub contact: bool,
    /// Accuracy of the simulated life [default: draft, with longer blocks of wear in a long life]
    #[arg(long, value_name = "draft|balanced|reference|NAME", value_parser = accuracy_name(), hide_possible_values = true)]
    pub accuracy: Option<NamedAccuracy>,
}

/// Checks a scene: its text, its bounds, the ideal linkage through a whole cycle and the nominal mechanism against its limits, or that
/// its program exists. Unused parameters and warnings are listed but are no fault. What is known without a simulation of the life is printed
/// before it begins. As JSON, faults are printed too.
///
/// # Errors
/// [`CommandError::Scene`] with all faults, the errors of [`check_linkage`], [`CommandError::BadInput`], or
/// [`CommandError::Failed`] if the nominal mechanism cannot be simulated.
pub fn check(arguments: &CheckArguments, verbosity: Verbosity) -> Done {
    let file = arguments.scene.name.get();
    check_picture(arguments.draw.as_deref())?;
    let checked = run(arguments, verbosity);
    if let (Err(error), true) = (&checked, verbosity.json) {
        let findings: Vec<Value> = match error {
            CommandError::Scene(faults) => faults.0.iter().map(finding_of_fault).collect(),
            error => vec![finding(file, None, "", &error.to_string())],
        };
        print(&to_json(&json!({ "file": file, "valid": false, "faults": findings }))?)?;
    }
    checked
}

fn run(arguments: &CheckArguments, verbosity: Verbosity) -> Done {
    let CheckArguments { scene, draw, quick, accuracy, contact } = arguments;
    let file = scene.name.get();
    let at_once = |text: &str| if verbosity.json { Ok(()) } else { print(text) };
    let (source, of_start) = valid_scene(scene)?;
    let scene = source.nominal();
    at_once(&format!("{file}: valid; {}\n", counts(scene)))?;
    let is_mechanism = scene.simulator.is_none();
    let (loads, drawings) = if is_mechanism { look(&source, draw.as_deref())? } else { (vec![], vec![]) };
    at_once(&loads.iter().map(|line| format!("{line}\n")).collect::<String>())?;
    let mut cost = None;
    if is_mechanism && !quick {
        let accuracy = accuracy.as_ref().unwrap_or(&scene.accuracy);
        let doing = "simulating the first cycles, for the cost of a simulation".to_owned();
        cost = while_waiting(verbosity.quiet, doing, |_| Model::new(scene, accuracy).expected());
        at_once(&cost.iter().map(|cost| format!("cost: {cost}\n")).collect::<String>())?;
    }
    let mut evaluation = None;
    let mut changes = Vec::new();
    if !quick {
        let cycles = with_separators(scene.life.cycles.into());
        let doing = format!("simulating {cycles} cycles, or until every limit is passed");
        let given = accuracy.as_ref().map(|named| &named.accuracy);
        let failed = |failure| CommandError::of_simulation(source.origin(), scene, failure);
        evaluation = while_waiting(verbosity.quiet, doing, |say| nominal_evaluation(scene, given, say))
            .map_err(failed)?;
        if let (true, Some(found)) = (*contact, &evaluation) {
            let doing = "simulating other contacts".to_owned();
            changes = while_waiting(verbosity.quiet, doing, |say| contact_changes(scene, given, found, say))
                .map_err(failed)?;
        }
    }
    let unused = &source.unused_parameters;
    let mut found = findings(&source, evaluation.as_ref());
    found.warnings.extend(of_start);
    if verbosity.json {
        let warnings = found.warnings.iter().map(|Warning { key, message }| {
            let place = source.location(key);
            finding(place.as_ref().map_or(file, |place| &place.file), place.as_ref(), key, message)
        });
        return print(&to_json(&json!({ "file": file, "scene": scene.name, "valid": true, "faults": [],
                                       "cost": cost, "loads": loads,
                                       "nominal": found.lives_json(), "contact": changes,
                                       "measured": found.measured, "unused_parameters": unused,
                                       "warnings": warnings.collect::<Value>() }))?);
    }
    let unused = unused.iter().map(|name| (format!("parameters.{name}"), "nothing reads it"));
    let warnings = found.warnings.iter().map(|warning| (warning.key.clone(), warning.message.as_str()));
    let lines = unused.chain(warnings).map(|(key, message)| {
        let place = source.location(&key).map_or_else(|| file.to_owned(), |place| place.to_string());
        format!("{place}: warning: {key}: {message}\n")
    });
    let unworn = found.lives.iter().filter(|life| life.reached == Reached::FromTheStart);
    let mut text = match unworn.map(|life| life.limit.name.as_str()).collect::<Vec<_>>().as_slice() {
        [] => String::new(),
        names => format!("the nominal mechanism fails unworn by {}\n", names.join(" and ")),
    };
    text += &found.lines("nominal");
    text.extend(changes.iter().map(ContactChange::line));
    if *quick && is_mechanism {
        text.push_str("its life was not simulated (--quick)\n");
    }
    text.extend(found.measured.iter().map(MeasuredFinding::lines));
    text.extend(lines);
    text.extend(drawings.iter().map(|file| format!("drawing: {}\n", file.display())));
    match &scene.simulator {
        None if drawings.is_empty() => text += &format!("To see it: coordinator draw {file}\n"),
        None => {}
        Some(simulator) => text += &format!("identity for workers: {}\n", SimulatorId::new(simulator, scene)),
    }
    print(&text)
}

/// The scene with cautions about its start, if its text is valid and what it describes can be simulated.
fn valid_scene(scene: &SceneArguments) -> Done<(SceneSource, Vec<Warning>)> {
    let source = scene.load()?;
    let of_start = match &source.nominal().simulator {
        None => check_linkage(source.origin(), &source, source.nominal())?,
        Some(simulator) => {
            common::external::check(simulator, source.nominal()).map_err(CommandError::bad_input)?;
            vec![]
        }
    };
    Ok((source, of_start))
}

fn counts(scene: &Scene) -> String {
    if scene.simulator.is_some() {
        return external::counts(scene);
    }
    [
        if scene.bodies.len() == 1 { "1 body".to_owned() } else { format!("{} bodies", scene.bodies.len()) },
        count(scene.joints.len(), "joint"),
        count(scene.loads.len(), "load"),
        count(scene.variables.len(), "random variable"),
        count(scene.limit_states.len(), "limit state"),
        count(scene.life.cycles as usize, "cycle"),
    ]
    .join(", ")
}
