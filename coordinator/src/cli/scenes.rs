//! `coordinator scenes` and `coordinator check`.

use super::error::CommandError;
use super::external;
use super::nominal::nominal_warnings;
use super::output::{count, print, to_json};
use common::scene::{Scene, SceneSource};
use coordinator::farm::evaluate::external::check as check_simulator;
use serde_json::json;

/// Lists the built-in scenes, or prints the text of the one named by `show`.
///
/// # Errors
/// [`CommandError::Scene`] for an unknown name.
pub fn scenes(show: Option<&str>, as_json: bool) -> Result<(), CommandError> {
    if let Some(name) = show {
        return print(SceneSource::builtin(name)?.text());
    }
    let sources: Vec<SceneSource> =
        SceneSource::builtin_names().into_iter().map(SceneSource::builtin).collect::<Result<_, _>>()?;
    let list = sources.iter().map(SceneSource::nominal);
    if as_json {
        let list: Vec<_> = list
            .map(|scene| {
                json!({ "name": scene.name, "title": scene.title, "variables": scene.variables.len(),
                        "limit_states": scene.limit_states.iter().map(|l| &l.name).collect::<Vec<_>>() })
            })
            .collect();
        return print(&to_json(&list)?);
    }
    let width = sources.iter().map(|source| source.nominal().name.len()).max().unwrap_or(0);
    print(&list.map(|scene| format!("{:width$}  {}\n", scene.name, scene.title)).collect::<String>())
}

/// Checks a scene: its text, its bounds, the ideal linkage through a whole cycle and the nominal mechanism against its limits, or that
/// its program exists. Unused parameters and warnings are listed but are no fault.
///
/// # Errors
/// [`CommandError::Scene`] with all faults, the errors of [`check_linkage`], or [`CommandError::Simulator`].
pub fn check(file: &str, as_json: bool) -> Result<(), CommandError> {
    let source = SceneSource::load(file)?;
    let scene = source.nominal();
    match &scene.simulator {
        None => check_linkage(source.origin(), scene)?,
        Some(simulator) => check_simulator(simulator)?,
    }
    let (unused, mut warnings) = (source.unused_parameters(), source.warnings());
    warnings.extend(nominal_warnings(scene));
    if as_json {
        return print(&to_json(&json!({ "file": file, "scene": scene.name, "valid": true,
                                       "unused_parameters": unused, "warnings": warnings }))?);
    }
    let unused = unused.iter().map(|name| format!("{file}: parameters.{name}: nothing reads it\n"));
    let warnings = warnings.iter().map(|warning| format!("{file}: {warning}\n"));
    print(&format!("{file}: valid; {}\n{}", counts(scene), unused.chain(warnings).collect::<String>()))
}

/// Checks that the scene has a mechanism that can be modelled, and that its ideal linkage closes through the cycle.
///
/// # Errors
/// [`CommandError::NoMechanism`], or what the linkage does not allow.
pub fn check_linkage(origin: &str, scene: &Scene) -> Result<(), CommandError> {
    if scene.simulator.is_some() {
        return Err(CommandError::NoMechanism { origin: origin.to_owned() });
    }
    let failed = |failure| CommandError::of_simulation(origin, scene, failure);
    worker::mechanism::islands(scene).map_err(failed)?;
    let poses = worker::mechanism::ideal_cycle(scene, 2, &mut 0).map_err(failed)?;
    worker::mechanism::turns_per_cycle(scene, &poses).map_err(failed)?;
    Ok(())
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
