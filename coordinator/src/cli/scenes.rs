//! `coordinator scenes`, and the check of a linkage that every command on a mechanism begins with.

use super::{CommandError, Done, print, to_json};
use common::scene::{Faults, Scene, SceneSource};
use serde_json::json;

/// Lists the built-in scenes, or prints the text of the one named by `show`.
///
/// # Errors
/// [`CommandError::Scene`] for an unknown name.
pub fn scenes(show: Option<&str>, as_json: bool) -> Done {
    if let Some(name) = show {
        return print(SceneSource::builtin(name)?.text());
    }
    let sources: Vec<SceneSource> =
        SceneSource::builtin_names().into_iter().map(SceneSource::builtin).collect::<Result<_, _>>()?;
    let list = sources.iter().map(SceneSource::nominal);
    if as_json {
        let row = |scene: &Scene| {
            json!({ "name": scene.name, "title": scene.title, "variables": scene.variables.len(),
                    "limit_states": scene.limit_states.iter().map(|l| &l.name).collect::<Vec<_>>() })
        };
        return print(&to_json(&list.map(row).collect::<Vec<_>>())?);
    }
    let width = sources.iter().map(|source| source.nominal().name.len()).max().unwrap_or(0);
    print(&list.map(|scene| format!("{:width$}  {}\n", scene.name, scene.title)).collect::<String>())
}

/// Checks that the scene, resolved from `source`, has a mechanism that can be modelled, and that its ideal linkage closes through the
/// cycle. Messages name it by `origin`.
///
/// # Errors
/// [`CommandError::BadInput`], or what the linkage does not allow.
pub fn check_linkage(origin: &str, source: &SceneSource, scene: &Scene) -> Done {
    if scene.simulator.is_some() {
        return Err(CommandError::no_mechanism(origin));
    }
    let failed = |failure| located(CommandError::of_simulation(origin, scene, failure), source);
    worker::mechanism::islands(scene).map_err(failed)?;
    let poses = worker::mechanism::ideal_cycle(scene, 2, &mut 0).map_err(failed)?;
    worker::mechanism::turns_per_cycle(scene, &poses).map_err(failed)?;
    Ok(())
}

/// The error with the places of its faults in the texts of the scene.
fn located(mut error: CommandError, source: &SceneSource) -> CommandError {
    if let CommandError::Scene(Faults(faults)) = &mut error {
        for fault in faults.iter_mut().filter(|fault| fault.location.is_none()) {
            fault.location = source.location(&fault.key).map(Box::new);
        }
    }
    error
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn issue_a_start_speed_that_cannot_hold_had_no_fault() {
        let start = "start_angle = \"106.26 deg\"\n";
        let four_bar = SceneSource::builtin("four-bar").expect("built in").text().to_owned();
        let line = four_bar.split(start).next().expect("it is there").lines().count() + 2;
        let text = four_bar.replace(start, &format!("{start}start_speed = \"3 rad/s\"\n"));
        let source = SceneSource::parse(&text, "scene.toml").expect("a valid text");
        match check_linkage("scene.toml", &source, source.nominal()) {
            Err(CommandError::Scene(Faults(faults))) => {
                let place = faults[0].location.as_ref().expect("it has a line").to_string();
                assert!(place.starts_with(&format!("scene.toml:{line}:")), "{place}");
                let message = faults[0].to_string();
                assert!(
                    message.contains("bodies.rocker.start_speed: 3 rad/s cannot hold at the start"),
                    "{message}"
                );
            }
            other => panic!("{other:?}"),
        }
    }
}
