//! An operating condition of a life.

use super::joint::{Clearance, ContactDamping, JointKind};
use super::model::Scene;
use serde::{Deserialize, Serialize};

/// An operating condition: a share of the cycles of a life, in which some quantities of the scene have other values.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Condition {
    /// Name, unique in its scene.
    pub name: String,
    /// Share of the cycles, > 0; those of all conditions of a scene add up to 1 [1].
    pub share: f64,
    /// The scene under this condition, on the same bores; without random variables and conditions of its own.
    pub scene: Scene,
}

impl Condition {
    /// Name of the first joint whose bore in `scene` is not that of this condition; `None` if all are the same. Friction, damping and
    /// the wear coefficient of a joint that wears may differ.
    pub(super) fn other_bore(&self, scene: &Scene) -> Option<&str> {
        let pairs = self.scene.joints.iter().zip(&scene.joints);
        let mut other = pairs.filter(|(own, base)| match (&own.kind, &base.kind) {
            (JointKind::Clearance(own), JointKind::Clearance(base)) => bore(own) != bore(base),
            _ => false,
        });
        other.next().map(|(own, _)| own.name.as_str())
    }
}

/// A joint with clearance with what conditions may change set to one value.
fn bore(clearance: &Clearance) -> Clearance {
    Clearance {
        contact_damping: ContactDamping::None,
        film_damping: 0.0,
        friction: 0.0,
        friction_speed: 1.0,
        wear_coefficient: if clearance.wear_coefficient > 0.0 { 1.0 } else { 0.0 },
        ..clearance.clone()
    }
}
