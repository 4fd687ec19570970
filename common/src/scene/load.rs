//! Loads on bodies: springs, forces, torques and motors.

use super::attachment::Attachment;
use super::drive::Curve;
use serde::{Deserialize, Serialize};

/// A load on one body, or between two.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub enum Load {
    /// Spring acting along a fixed direction d on a point p of a body against an anchor point a of another:
    /// with y = d . (p - a), the force on p is -stiffness (y - free_length) d, and its opposite acts on a.
    DirectionalSpring {
        /// Name, unique in its scene.
        name: String,
        /// Point of application.
        at: Attachment,
        /// Anchor point, from which y is measured.
        anchor: Attachment,
        /// Unit direction d in the global frame `(2,)` [1].
        direction: [f64; 2],
        /// Force per length [N/m].
        stiffness: f64,
        /// y at which the force vanishes, y_0 [m].
        free_length: f64,
    },
    /// Constant force on a point of a body, in the global frame.
    ConstantForce {
        /// Name, unique in its scene.
        name: String,
        /// Point of application.
        at: Attachment,
        /// Force `(2,)` [N].
        force: [f64; 2],
    },
    /// Constant torque on a body.
    ConstantTorque {
        /// Name, unique in its scene.
        name: String,
        /// Index of the body.
        body: usize,
        /// Torque, counter-clockwise positive [N m].
        torque: f64,
    },
    /// Spring and damper between two points, along the line that joins them: with l its length, the pull is
    /// stiffness (l - free_length) + damping dl/dt.
    Spring {
        /// Name, unique in its scene.
        name: String,
        /// Place of one end.
        a: Attachment,
        /// Place of the other end.
        b: Attachment,
        /// Force per length [N/m].
        stiffness: f64,
        /// Damping [N s/m].
        damping: f64,
        /// Length without force [m].
        free_length: f64,
    },
    /// Torsion spring and damper between two bodies: with phi = angle_a - angle_b, the torque on a is
    /// -stiffness (phi - free_angle) - damping dphi/dt, its opposite acts on b.
    TorsionSpring {
        /// Name, unique in its scene.
        name: String,
        /// Index of one body.
        a: usize,
        /// Index of the other body.
        b: usize,
        /// Stiffness [N m/rad].
        stiffness: f64,
        /// Damping [N m s/rad].
        damping: f64,
        /// phi without torque [rad].
        free_angle: f64,
    },
    /// Force on a point of a body along a fixed direction of the global frame, its size given by a curve.
    VariableForce {
        /// Name, unique in its scene.
        name: String,
        /// Point of application.
        at: Attachment,
        /// Unit direction in the global frame `(2,)` [1].
        direction: [f64; 2],
        /// Size over time or angle [N].
        size: Curve,
    },
    /// Torque on a body, given by a curve.
    VariableTorque {
        /// Name, unique in its scene.
        name: String,
        /// Index of the body.
        body: usize,
        /// Torque over time or angle, counter-clockwise positive [N m].
        torque: Curve,
    },
    /// A motor with a linear characteristic: torque = stall_torque (1 - omega / no_load_speed) on a body.
    Motor {
        /// Name, unique in its scene.
        name: String,
        /// Index of the body that it drives.
        body: usize,
        /// Torque at rest [N m].
        stall_torque: f64,
        /// Speed without torque [rad/s].
        no_load_speed: f64,
    },
}
