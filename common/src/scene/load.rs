//! Loads on bodies: springs, forces, torques, motors and drags.

use super::attachment::Attachment;
use super::drive::{Curve, Over};
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
    /// Drag on a point of a body along a fixed direction d of the global frame: with u = d . v - flow, v the velocity of the point, the
    /// force -factor (linear + quadratic |u|) u d.
    Drag {
        /// Name, unique in its scene.
        name: String,
        /// Point of application.
        at: Attachment,
        /// Unit direction d in the global frame `(2,)` [1].
        direction: [f64; 2],
        /// Force per speed [N s/m].
        linear: f64,
        /// Force per square of the speed [N s^2/m^2].
        quadratic: f64,
        /// Speed of the medium along d [m/s].
        flow: f64,
        /// Factor over time or angle; one without it [1].
        factor: Option<Curve>,
    },
    /// Drag of a turning body: the torque -factor (linear + quadratic |omega|) omega.
    RotationalDrag {
        /// Name, unique in its scene.
        name: String,
        /// Index of the body.
        body: usize,
        /// Torque per angular velocity [N m s/rad].
        linear: f64,
        /// Torque per square of the angular velocity [N m s^2/rad^2].
        quadratic: f64,
        /// Factor over time or angle; one without it [1].
        factor: Option<Curve>,
    },
}

impl Load {
    /// Indices of the bodies that the load couples: those it acts on, and the one whose angle its size depends on.
    pub fn bodies(&self) -> Vec<usize> {
        let with_angle = |body: usize, size: &Curve| match size.over {
            Over::Angle(other) => vec![body, other],
            Over::Time => vec![body],
        };
        match self {
            Load::DirectionalSpring { at: a, anchor: b, .. } | Load::Spring { a, b, .. } => {
                vec![a.body, b.body]
            }
            Load::TorsionSpring { a, b, .. } => vec![*a, *b],
            Load::VariableForce { at, size, .. } => with_angle(at.body, size),
            Load::VariableTorque { body, torque, .. } => with_angle(*body, torque),
            Load::Drag { at, factor: Some(factor), .. } => with_angle(at.body, factor),
            Load::RotationalDrag { body, factor: Some(factor), .. } => with_angle(*body, factor),
            Load::ConstantForce { at, .. } | Load::Drag { at, .. } => vec![at.body],
            Load::ConstantTorque { body, .. }
            | Load::Motor { body, .. }
            | Load::RotationalDrag { body, .. } => {
                vec![*body]
            }
        }
    }

    /// Where the load acts and where it is anchored.
    pub(super) fn places_mut(&mut self) -> Vec<&mut Attachment> {
        match self {
            Load::DirectionalSpring { at: a, anchor: b, .. } | Load::Spring { a, b, .. } => vec![a, b],
            Load::ConstantForce { at, .. } | Load::VariableForce { at, .. } | Load::Drag { at, .. } => {
                vec![at]
            }
            Load::TorsionSpring { .. }
            | Load::ConstantTorque { .. }
            | Load::VariableTorque { .. }
            | Load::Motor { .. }
            | Load::RotationalDrag { .. } => vec![],
        }
    }

    /// Name of the load, its key of the table by which it varies, that table and the unit of its values; `None` for a load without one.
    pub fn curve(&self) -> Option<(&str, &'static str, &Curve, &'static str)> {
        match self {
            Load::VariableForce { name, size, .. } => Some((name, "size", size, "N")),
            Load::VariableTorque { name, torque, .. } => Some((name, "torque", torque, "N m")),
            Load::Drag { name, factor: Some(factor), .. }
            | Load::RotationalDrag { name, factor: Some(factor), .. } => Some((name, "factor", factor, "")),
            _ => None,
        }
    }

    /// The table by which the load varies; `None` for a load without one.
    pub fn curve_mut(&mut self) -> Option<&mut Curve> {
        match self {
            Load::VariableForce { size: curve, .. }
            | Load::VariableTorque { torque: curve, .. }
            | Load::Drag { factor: Some(curve), .. }
            | Load::RotationalDrag { factor: Some(curve), .. } => Some(curve),
            _ => None,
        }
    }

    /// Name, kind, constants and bodies of the load in one line, for names of bodies `(bodies,)`.
    pub fn explanation(&self, bodies: &[&str]) -> String {
        match self {
            Load::DirectionalSpring { name, at, stiffness, free_length, direction: [x, y], .. } => format!(
                "{name}: spring of {stiffness} N/m on {} along ({x}, {y}), slack at {:.3} mm",
                bodies[at.body],
                free_length * 1e3
            ),
            Load::ConstantForce { name, at, force: [x, y] } => {
                format!("{name}: force ({x}, {y}) N on {}", bodies[at.body])
            }
            Load::ConstantTorque { name, body, torque } => {
                format!("{name}: torque {torque} N m on {}", bodies[*body])
            }
            Load::Spring { name, a, b, stiffness, damping, free_length } => format!(
                "{name}: spring of {stiffness} N/m, {damping} N s/m between {} and {}, slack at {:.3} mm",
                bodies[a.body],
                bodies[b.body],
                free_length * 1e3
            ),
            Load::TorsionSpring { name, a, b, stiffness, damping, free_angle } => format!(
                "{name}: torsion spring of {stiffness} N m/rad, {damping} N m s/rad between {} and {}, slack at \
                 {:.3} deg",
                bodies[*a],
                bodies[*b],
                free_angle.to_degrees()
            ),
            Load::VariableForce { name, at, direction: [x, y], size } => format!(
                "{name}: force on {} along ({x}, {y}), {}",
                bodies[at.body],
                size.explanation(bodies, "N")
            ),
            Load::VariableTorque { name, body, torque } => {
                format!("{name}: torque on {}, {}", bodies[*body], torque.explanation(bodies, "N m"))
            }
            Load::Motor { name, body, stall_torque, no_load_speed } => format!(
                "{name}: motor on {}, {stall_torque} N m at rest, none at {:.1} r/min",
                bodies[*body],
                no_load_speed * 30.0 / std::f64::consts::PI
            ),
            Load::Drag { name, at, direction: [x, y], linear, quadratic, flow, factor } => format!(
                "{name}: drag of {linear} N s/m and {quadratic} N s^2/m^2 on {} along ({x}, {y}) in a flow of {flow} m/s{}",
                bodies[at.body],
                factor_explanation(factor.as_ref(), bodies)
            ),
            Load::RotationalDrag { name, body, linear, quadratic, factor } => format!(
                "{name}: drag of {linear} N m s/rad and {quadratic} N m s^2/rad^2 on {}{}",
                bodies[*body],
                factor_explanation(factor.as_ref(), bodies)
            ),
        }
    }
}

/// The factor of a drag for [`Load::explanation`].
fn factor_explanation(factor: Option<&Curve>, bodies: &[&str]) -> String {
    factor.map_or_else(String::new, |factor| format!(", times {}", factor.explanation(bodies, "")))
}
