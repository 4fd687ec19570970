//! Quantities that an evaluation returns.

use super::attachment::Attachment;
use super::drive::Curve;
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
        /// What is read from their depths.
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
    /// Distance over a cycle of a point from where the mechanism with ideal joints has it, or from wanted coordinates [m].
    PositionError {
        /// Place on a free body.
        at: Attachment,
        /// Wanted coordinates x, y [m]; with one of them the error is that of this coordinate, without any the ideal mechanism is the
        /// reference.
        wanted: [Option<Curve>; 2],
        /// Measure of the error over the cycle.
        measure: ErrorMeasure,
    },
    /// Difference over a cycle of the angle of a body from that of the mechanism with ideal joints, or from a wanted angle [rad].
    AngleError {
        /// Index of a free body.
        body: usize,
        /// Wanted angle [rad]; without it the ideal mechanism is the reference.
        wanted: Option<Curve>,
        /// Measure of the error over the cycle.
        measure: ErrorMeasure,
    },
    /// Largest size over a cycle of the acceleration of a point [m/s^2].
    Acceleration {
        /// Place on a free body.
        at: Attachment,
    },
    /// Largest size over a cycle of the angular acceleration of a body [rad/s^2].
    AngularAcceleration {
        /// Index of a free body.
        body: usize,
    },
    /// Number of impacts in these joints and guides with clearance over a cycle [1].
    Impacts {
        /// Indices into [`super::Scene::joints`].
        joints: Vec<usize>,
    },
    /// Energy of these impacts over a cycle [J].
    ImpactEnergy {
        /// Indices into [`super::Scene::joints`].
        joints: Vec<usize>,
        /// All impacts of the cycle, or the hardest one.
        measure: ImpactMeasure,
    },
    /// Largest size over a cycle of the torque that drives a body [N m].
    DrivingTorque {
        /// Index of the driven body.
        body: usize,
    },
    /// Backlash of the angle of a body: how far it can be turned while the drives are held, all journals within their worn bores [rad].
    Backlash {
        /// Index of a free body.
        body: usize,
        /// Where the drives are held; without it the largest backlash over a cycle.
        held: Option<HeldInput>,
    },
    /// Backlash of a point: how far it can be moved along a direction of the frame while the drives are held [m].
    PositionBacklash {
        /// Place on a free body.
        at: Attachment,
        /// Angle of the direction from the x axis of the frame [rad].
        direction: f64,
        /// Where the drives are held; without it the largest backlash over a cycle.
        held: Option<HeldInput>,
    },
    /// Value that an external simulator returns under the output's name.
    External {
        /// Its unit, as it is displayed; values are not converted.
        unit: String,
        /// True if it has a single value, which holds for the whole life.
        single: bool,
    },
}

/// Position in which the drives of a mechanism are held.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct HeldInput {
    /// Index of a driven body.
    pub body: usize,
    /// Its angle, whole turns not counted [rad].
    pub angle: f64,
}

/// Measure of an error over a cycle.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum ErrorMeasure {
    /// Largest size of the error.
    #[default]
    Largest,
    /// Root of the mean over time of its square.
    RootMeanSquare,
}

/// Measure of the energies of the impacts of a cycle.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum ImpactMeasure {
    /// Sum over all impacts.
    #[default]
    Total,
    /// Energy of the hardest impact.
    Largest,
}

impl OutputKind {
    /// Unit of the values.
    pub fn unit(&self) -> OutputUnit {
        match self {
            OutputKind::LargestWear { .. }
            | OutputKind::PositionError { .. }
            | OutputKind::PositionBacklash { .. } => OutputUnit::Length,
            OutputKind::Wear { quantity, .. } => quantity.unit(),
            OutputKind::AngularVelocityDifference { .. } => OutputUnit::AngularVelocity,
            OutputKind::AngleDifference { .. }
            | OutputKind::AngleError { .. }
            | OutputKind::Backlash { .. } => OutputUnit::Angle,
            OutputKind::Acceleration { .. } => OutputUnit::Acceleration,
            OutputKind::AngularAcceleration { .. } => OutputUnit::AngularAcceleration,
            OutputKind::Impacts { .. } => OutputUnit::Number,
            OutputKind::ImpactEnergy { .. } => OutputUnit::Energy,
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
            OutputKind::PositionError { at, wanted, measure } => {
                let point = format!("a point of {}", body(at.body));
                match wanted {
                    [None, None] => {
                        format!("{} distance of {point} from its position with ideal joints", measure.word())
                    }
                    [Some(_), Some(_)] => {
                        format!("{} distance of {point} from its wanted position", measure.word())
                    }
                    [Some(_), None] => format!("{} error of x of {point}", measure.word()),
                    [None, Some(_)] => format!("{} error of y of {point}", measure.word()),
                }
            }
            OutputKind::AngleError { body: turned, wanted, measure } => {
                let from = if wanted.is_some() { "the wanted one" } else { "that with ideal joints" };
                format!("{} difference of the angle of {} from {from}", measure.word(), body(*turned))
            }
            OutputKind::Acceleration { at } => {
                format!("largest acceleration of a point of {}", body(at.body))
            }
            OutputKind::AngularAcceleration { body: turned } => {
                format!("largest angular acceleration of {}", body(*turned))
            }
            OutputKind::Impacts { joints: struck } => {
                format!("number of impacts per cycle in {}", joints(struck))
            }
            OutputKind::ImpactEnergy { joints: struck, measure: ImpactMeasure::Total } => {
                format!("energy of the impacts per cycle in {}", joints(struck))
            }
            OutputKind::ImpactEnergy { joints: struck, measure: ImpactMeasure::Largest } => {
                format!("energy of the hardest impact in {}", joints(struck))
            }
            OutputKind::DrivingTorque { body: driven } => {
                format!("largest torque that drives {}", body(*driven))
            }
            OutputKind::Backlash { body: turned, held } => {
                format!("backlash of the angle of {}{}", body(*turned), held_at(held, &body))
            }
            OutputKind::PositionBacklash { at, held, .. } => {
                format!("backlash of a point of {}{}", body(at.body), held_at(held, &body))
            }
            OutputKind::External { .. } => "value returned by the simulator".to_owned(),
        }
    }

    /// The curves that state what is wanted, with their keys in a scene.
    pub fn curves(&self) -> Vec<(&'static str, &Curve)> {
        match self {
            OutputKind::PositionError { wanted: [x, y], .. } => {
                let keyed = [("wanted_x", x), ("wanted_y", y)].into_iter();
                keyed.filter_map(|(key, curve)| Some((key, curve.as_ref()?))).collect()
            }
            OutputKind::AngleError { wanted, .. } => wanted.iter().map(|curve| ("wanted", curve)).collect(),
            _ => vec![],
        }
    }

    /// The wanted curves, for values to be changed.
    pub fn curves_mut(&mut self) -> Vec<&mut Curve> {
        match self {
            OutputKind::PositionError { wanted, .. } => wanted.iter_mut().flatten().collect(),
            OutputKind::AngleError { wanted, .. } => wanted.iter_mut().collect(),
            _ => vec![],
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

/// Where the drives are held, in a description.
fn held_at<'a>(held: &Option<HeldInput>, body: impl Fn(usize) -> &'a str) -> String {
    match held {
        None => ", largest over the cycle".to_owned(),
        Some(held) => format!(" with {} held at {} deg", body(held.body), round_degrees(held.angle)),
    }
}

/// An angle [rad] in degrees, without digits that come from rounding.
fn round_degrees(angle: f64) -> f64 {
    (angle.to_degrees() * 1e9).round() / 1e9
}

impl ErrorMeasure {
    /// The measure in a description.
    fn word(self) -> &'static str {
        match self {
            ErrorMeasure::Largest => "largest",
            ErrorMeasure::RootMeanSquare => "r.m.s.",
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
