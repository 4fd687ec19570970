//! Quantities that an evaluation returns.

use super::attachment::Attachment;
use serde::{Deserialize, Serialize};

/// A quantity returned at every checkpoint of life.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Output {
    /// Name, unique in its scene, e.g. `max_wear_depth`.
    pub name: String,
    /// What it is.
    pub kind: OutputKind,
}

/// Kinds of output.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub enum OutputKind {
    /// Largest wear depth over the control points of these joints, delta_0 [m].
    LargestWear {
        /// Indices into [`super::Scene::joints`].
        joints: Vec<usize>,
    },
    /// Largest over a cycle of |s_a omega_a - s_b omega_b|, gamma_max [rad/s].
    AngularVelocityDifference {
        /// First body and sign of its angle.
        a: SignedBody,
        /// Second body and sign of its angle.
        b: SignedBody,
    },
    /// Largest over a cycle of |s_a theta_a - s_b theta_b|, angles of the bodies' frames [rad].
    AngleDifference {
        /// First body and sign of its angle.
        a: SignedBody,
        /// Second body and sign of its angle.
        b: SignedBody,
    },
    /// Largest force in these joints over a cycle [N].
    PeakJointForce {
        /// Indices into [`super::Scene::joints`].
        joints: Vec<usize>,
    },
    /// Largest distance over a cycle of a point from where the mechanism with ideal joints has it [m].
    PositionError {
        /// Place on a free body.
        at: Attachment,
    },
    /// Largest size over a cycle of the torque that drives a body [N m].
    DrivingTorque {
        /// Index of the driven body.
        body: usize,
    },
    /// Whatever an external simulator returns under the output's name.
    External {
        /// Its unit, as it is shown; values are not converted.
        unit: String,
        /// Whether it has a single value, which holds for the whole life.
        single: bool,
    },
}

/// A body with the sense in which its angle is reported.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct SignedBody {
    /// Index into [`super::Scene::bodies`].
    pub body: usize,
    /// +1 or -1.
    pub sign: f64,
    /// What a reader calls it, e.g. `right`.
    pub label: String,
}
