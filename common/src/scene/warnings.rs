//! Warnings about a scene: what is valid but most likely not meant.

use super::drive::{Curve, Drive, Over};
use super::load::Load;
use super::model::{Body, Motion, Scene};
use super::monotone::monotone_integral;
use serde::Serialize;
use std::f64::consts::PI;
use std::fmt;

/// A warning and the key it belongs to.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Warning {
    /// Path of the key, e.g. `loads.push.size`.
    pub key: String,
    /// What is likely not meant, and what to write instead.
    pub message: String,
}

impl fmt::Display for Warning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: {}", self.key, self.message)
    }
}

/// The warnings about a scene: bodies that nothing holds, and loads that are seen in one cycle only, while cycles follow each other.
pub(super) fn warnings(scene: &Scene) -> Vec<Warning> {
    [loose_bodies(scene), single_loads(scene)].concat()
}

fn loose_bodies(scene: &Scene) -> Vec<Warning> {
    let joined = scene.joints.iter().flat_map(|joint| [joint.journal.body, joint.bushing.body]);
    let held: Vec<usize> = joined.chain(scene.loads.iter().flat_map(Load::bodies)).collect();
    let bodies = scene.bodies.iter().enumerate();
    let loose = bodies.filter(|(k, body)| matches!(body.motion, Motion::Free { .. }) && !held.contains(k));
    let warning = |(_, body): (usize, &Body)| Warning {
        key: format!("bodies.{}", body.name),
        message: "is held by no joint and no load: it has no effect on the other bodies".to_owned(),
    };
    loose.map(warning).collect()
}

fn single_loads(scene: &Scene) -> Vec<Warning> {
    if scene.life.is_single_cycle() {
        return Vec::new();
    }
    let varying = scene.loads.iter().filter_map(Load::curve);
    let leaves_its_end = |curve: &Curve| match curve.over {
        _ if curve.table.repeat => false,
        Over::Time => true,
        Over::Angle(body) => has_full_turns(&scene.bodies[body].motion),
    };
    let once = varying.filter(|(_, _, curve, _)| leaves_its_end(curve));
    let warning = |(name, key, ..): (String, &str, _, _)| {
        Warning {
        key: format!("loads.{name}.{key}"),
        message: "does not repeat, but the cycles follow each other: what comes before a measured cycle has the first value; \
                  write repeat = true, or cycles = 1, checkpoint_every = 1, settle_cycles = 0"
            .to_owned(),
    }
    };
    once.map(warning).collect()
}

/// True if a drive turns the body further with every cycle.
fn has_full_turns(motion: &Motion) -> bool {
    let Motion::Driven { drive, .. } = motion else { return false };
    match drive {
        Drive::ConstantSpeed { .. } => true,
        Drive::Angle(table) => (table.value[table.value.len() - 1] - table.value[0]).abs() > PI,
        Drive::Speed { table, .. } => monotone_integral(table).abs() > PI,
    }
}

#[cfg(test)]
mod tests {
    use crate::scene::SceneSource;

    #[test]
    fn issue_a_body_that_nothing_holds_had_no_warning() {
        let loose = "[[bodies]]\nname = \"loose\"\nmotion = \"free\"\nmass = \"1 g\"\ninertia = \"1 g mm^2\"\n\
                     centre_of_mass = [\"0 m\", \"0 m\"]\nstart_position = [\"0 m\", \"0 m\"]\nstart_angle = \"0 deg\"\n";
        let four_bar = SceneSource::builtin("four-bar").expect("built in");
        let with_it = SceneSource::parse(&format!("{}\n{loose}", four_bar.text()), "loose").expect("valid");
        let keys = |source: &SceneSource| source.warnings().into_iter().map(|w| w.key).collect::<Vec<_>>();
        assert_eq!(keys(&with_it), ["bodies.loose"]);
        assert!(keys(&four_bar).is_empty());
    }
}
