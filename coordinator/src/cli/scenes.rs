//! `coordinator scenes`, and the check of a linkage that every command on a mechanism begins with.

use super::{CommandError, Done, print, to_json};
use common::scene::{Faults, Joint, JointKind, Motion, OutputUnit, Scene, SceneSource, Warning};
use coordinator::presentation::report::format::with_unit;
use serde_json::json;
use std::f64::consts::{PI, TAU};
use worker::mechanism::{Pose, Prescribed};

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
/// cycle. Messages name it by `origin`. Returns cautions about start angles that the joints override.
///
/// # Errors
/// [`CommandError::BadInput`], or what the linkage does not allow.
pub fn check_linkage(origin: &str, source: &SceneSource, scene: &Scene) -> Done<Vec<Warning>> {
    if scene.simulator.is_some() {
        return Err(CommandError::no_mechanism(origin));
    }
    let failed = |failure| located(CommandError::of_simulation(origin, scene, failure), source);
    worker::mechanism::islands(scene).map_err(failed)?;
    let poses = worker::mechanism::ideal_cycle(scene, 2, &mut 0).map_err(failed)?;
    worker::mechanism::turns_per_cycle(scene, &poses).map_err(failed)?;
    Ok(overridden_starts(scene, &poses[0]))
}

/// Logs cautions about a mechanism.
pub fn warn_of(cautions: &[Warning]) {
    cautions.iter().for_each(|caution| tracing::warn!("{}", caution.message));
}

/// Angle by which an approximate start angle may be off [rad].
const APPROXIMATE: f64 = 10.0 / 180.0 * PI;

/// The free bodies whose angle in the `assembled` mechanism is another one than that of their start.
fn overridden_starts(scene: &Scene, assembled: &Pose) -> Vec<Warning> {
    let given = |body: usize| match &scene.bodies[body].motion {
        Motion::Free { start_angle, .. } => Some(*start_angle),
        _ => None,
    };
    let angle = |body: usize| match assembled.q[body] {
        Some(q) => q[2],
        None => Prescribed::from_body(&scene.bodies[body]).map_or(0.0, |motion| motion.angle(0.0)),
    };
    let shown = |angle: f64| with_unit(&scene.units.of(OutputUnit::Angle), angle).replace('\u{a0}', " ");
    let overridden = |body: usize| {
        let (start, found) = (given(body)?, angle(body));
        let off = start - found;
        if (off - TAU * (off / TAU).round()).abs() < APPROXIMATE {
            return None;
        }
        let holds = |joint: &&Joint| {
            let holds = matches!(
                joint.kind,
                JointKind::Prismatic { .. } | JointKind::Fixed { .. } | JointKind::Guide(_)
            );
            holds && [joint.journal.body, joint.bushing.body].contains(&body)
        };
        let held = scene.joints.iter().find(holds).map_or(String::new(), |joint| {
            let [a, b] = [joint.journal.body, joint.bushing.body];
            let wanted = if a == body { start - angle(b) } else { angle(a) - start };
            format!(": joint {} holds it; angle = \"{}\" there keeps its start", joint.name, shown(wanted))
        });
        let (name, start, found) = (&scene.bodies[body].name, shown(start), shown(found));
        let message =
            format!("the joints close with {name} at {found}, not at its start angle of {start}{held}");
        Some(Warning { key: format!("bodies.{name}.start_angle"), message })
    };
    (0..scene.bodies.len()).filter_map(overridden).collect()
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

    #[test]
    fn issue_a_guide_overrode_a_start_angle_without_a_word() {
        let cautions = |text: &str| {
            let source = SceneSource::parse(text, "geared-cam").expect("valid");
            check_linkage("geared-cam", &source, source.nominal()).expect("closes")
        };
        let geared = include_str!("../../../common/tests/scenes/geared-cam.toml");
        assert_eq!(cautions(geared), []);
        let [caution] = &cautions(&geared.replace("\nangle = \"90 deg\"", ""))[..] else { panic!("one") };
        assert_eq!(caution.key, "bodies.follower.start_angle");
        let said = "follower at 0 deg, not at its start angle of 90.0 deg: joint guide holds it; angle = \"90.0 deg\"";
        assert!(caution.message.contains(said), "{caution}");
    }
}
