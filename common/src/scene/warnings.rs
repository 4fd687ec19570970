//! Warnings about a scene: what is valid but most likely not meant.

use super::drive::{Curve, Drive, Over};
use super::load::Load;
use super::model::{Motion, Scene};
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

/// The warnings about a scene: loads that are seen in one cycle only, while cycles follow each other.
pub(super) fn warnings(scene: &Scene) -> Vec<Warning> {
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
    let warning = |(name, key, ..): (&str, &str, _, _)| {
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
