//! Quantities that an evaluation returns.

use super::attachment::Attachment;
use super::output_unit::OutputUnit;
use super::wear_output::WearQuantity;
use serde::{Deserialize, Serialize};

/// A quantity returned at every checkpoint of life.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Output {
    /// Name, unique in its scene, e.g. `max_wear_depth`.
    pub name: String,
    /// Quantity that is returned.
    pub kind: OutputKind,
}

/// Kinds of output.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub enum OutputKind {
    /// Largest wear depth over the control points of these joints, of the bushing or the journal, delta_0 [m].
    LargestWear {
        /// Indices into [`super::Scene::joints`].
        joints: Vec<usize>,
    },
    /// Another quantity of the wear of these joints [m or m^3].
    Wear {
        /// The quantity.
        quantity: WearQuantity,
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
    /// Value that an external simulator returns under the output's name.
    External {
        /// Its unit, as it is displayed; values are not converted.
        unit: String,
        /// True if it has a single value, which holds for the whole life.
        single: bool,
    },
}

impl OutputKind {
    /// Unit of the values.
    pub fn unit(&self) -> OutputUnit {
        match self {
            OutputKind::LargestWear { .. } | OutputKind::PositionError { .. } => OutputUnit::Length,
            OutputKind::Wear { quantity, .. } => quantity.unit(),
            OutputKind::AngularVelocityDifference { .. } => OutputUnit::AngularVelocity,
            OutputKind::AngleDifference { .. } => OutputUnit::Angle,
            OutputKind::PeakJointForce { .. } => OutputUnit::Force,
            OutputKind::DrivingTorque { .. } => OutputUnit::Torque,
            OutputKind::External { unit, .. } => OutputUnit::External(unit.clone()),
        }
    }

    /// Description in words; `body` and `joint` return the names of the scene's bodies and joints by index.
    pub fn description<'a>(
        &self,
        body: impl Fn(usize) -> &'a str,
        joint: impl Fn(usize) -> &'a str,
    ) -> String {
        let joints = |joints: &[usize]| match joints {
            [one] => format!("joint {}", joint(*one)),
            many => format!("{} joints", many.len()),
        };
        match self {
            OutputKind::LargestWear { joints: worn } => format!("largest wear depth of {}", joints(worn)),
            OutputKind::Wear { quantity, joints: worn } => {
                format!("{} of {}", quantity.description(), joints(worn))
            }
            OutputKind::AngularVelocityDifference { a, b } => {
                format!("largest difference of angular velocity, {} against {}", a.label, b.label)
            }
            OutputKind::AngleDifference { a, b } => {
                format!("largest difference of angle, {} against {}", a.label, b.label)
            }
            OutputKind::PeakJointForce { joints: loaded } => format!("largest force in {}", joints(loaded)),
            OutputKind::PositionError { at } => {
                format!(
                    "largest distance of a point of {} from its position with ideal joints",
                    body(at.body)
                )
            }
            OutputKind::DrivingTorque { body: driven } => {
                format!("largest torque that drives {}", body(*driven))
            }
            OutputKind::External { .. } => "value returned by the simulator".to_owned(),
        }
    }

    /// The quantity of the wear and the indices of its joints, if the output is one.
    pub fn wear(&self) -> Option<(WearQuantity, &[usize])> {
        match self {
            OutputKind::LargestWear { joints } => Some((WearQuantity::LargestDepth, joints)),
            OutputKind::Wear { quantity, joints } => Some((*quantity, joints)),
            _ => None,
        }
    }

    /// The two bodies whose angles or angular velocities are compared, if the output compares two.
    pub fn compared_bodies(&self) -> Option<[&SignedBody; 2]> {
        match self {
            OutputKind::AngularVelocityDifference { a, b } | OutputKind::AngleDifference { a, b } => {
                Some([a, b])
            }
            _ => None,
        }
    }
}

/// A body with the sense in which its angle is reported.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct SignedBody {
    /// Index into [`super::Scene::bodies`].
    pub body: usize,
    /// +1 or -1.
    pub sign: f64,
    /// Name in texts, e.g. `right`.
    pub label: String,
}
