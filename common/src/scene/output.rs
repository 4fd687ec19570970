//! Quantities that an evaluation returns, and limit states: thresholds of them, and the sides of these that mean failure.

use super::context::Range;
use super::key_table::{ElementKind, Form, Key, Value, elements};
use super::output_unit::OutputUnit;
use super::quantity::ANGLE;
use super::values::{Attachment, Curve, ErrorMeasure, HeldInput, ImpactMeasure, SignedBody, WearQuantity};
use serde::{Deserialize, Serialize};

/// A quantity returned at every checkpoint of life.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Output {
    /// Name, unique in its scene, e.g. `max_wear_depth`.
    pub name: String,
    /// Quantity that is returned.
    pub kind: OutputKind,
}

elements! {
    /// Kinds of output; bodies and joints are indices into those of the scene.
    pub enum OutputKind by OutputUnit;

    /// Largest wear depth over the control points of these joints, of the bushing or the journal, delta_0 [m].
    "largest-wear" (OutputUnit::Length) => LargestWear {
        /// Joints that wear.
        joints: Vec<usize> = Form::WornJoints,
    }
    "largest wear depth of {joints}"

    /// Another quantity of the wear of these joints [m or m^3].
    "bushing-wear" (OutputUnit::Length),
    "journal-wear" (OutputUnit::Length),
    "clearance-growth" (OutputUnit::Length),
    "worn-volume" (OutputUnit::Volume) => Wear {
        /// What is read from their depths.
        quantity: WearQuantity = Form::WearQuantity,
        /// Joints that wear.
        joints: Vec<usize> = Form::WornJoints,
    }
    "{quantity} of {joints}"

    /// Largest force in these joints over a cycle [N].
    "peak-joint-force" (OutputUnit::Force) => PeakJointForce {
        /// Joints of any type.
        joints: Vec<usize> = Form::Joints,
    }
    "largest force in {joints}"

    /// Largest over a cycle of |s_a omega_a - s_b omega_b|, gamma_max [rad/s].
    "angular-velocity-difference" (OutputUnit::AngularVelocity) => AngularVelocityDifference {
        /// First body and sign of its angle.
        a: SignedBody = Form::SignedBody,
        /// Second body and sign of its angle.
        b: SignedBody = Form::SignedBody,
    }
    "largest difference of angular velocity, {a} against {b}"

    /// Largest over a cycle of |s_a theta_a - s_b theta_b|, angles of the bodies' frames [rad].
    "angle-difference" (OutputUnit::Angle) => AngleDifference {
        /// First body and sign of its angle.
        a: SignedBody = Form::SignedBody,
        /// Second body and sign of its angle.
        b: SignedBody = Form::SignedBody,
    }
    "largest difference of angle, {a} against {b}"

    /// Distance over a cycle of a point from where the mechanism with ideal joints has it, or from wanted coordinates [m].
    "position-error" (OutputUnit::Length) => PositionError {
        /// Point whose position is compared.
        at: Attachment = Form::FreePlace,
        /// Wanted coordinates x, y [m]; with one of them the error is that of this coordinate, without any the ideal mechanism is the
        /// reference.
        wanted: [Option<Curve>; 2] = Form::WantedPoint,
        /// Measure of the error over the cycle.
        measure: ErrorMeasure = Form::ErrorMeasure,
    }
    "{measure} distance of a point of {at} from its position with ideal joints"

    /// Difference over a cycle of the angle of a body from that of the mechanism with ideal joints, or from a wanted angle [rad].
    "angle-error" (OutputUnit::Angle) => AngleError {
        /// Body whose angle is compared.
        body: usize = Form::FreeBody,
        /// Wanted angle [rad]; without it the ideal mechanism is the reference.
        wanted: Option<Curve> = Form::Wanted(ANGLE),
        /// Measure of the error over the cycle.
        measure: ErrorMeasure = Form::ErrorMeasure,
    }
    "{measure} difference of the angle of {body} from {wanted}"

    /// Largest size over a cycle of the acceleration of a point [m/s^2].
    "acceleration" (OutputUnit::Acceleration) => Acceleration {
        /// Point that is accelerated.
        at: Attachment = Form::FreePlace,
    }
    "largest acceleration of a point of {at}"

    /// Largest size over a cycle of the angular acceleration of a body [rad/s^2].
    "angular-acceleration" (OutputUnit::AngularAcceleration) => AngularAcceleration {
        /// Body that is accelerated.
        body: usize = Form::FreeBody,
    }
    "largest angular acceleration of {body}"

    /// Number of impacts in these joints and guides with clearance over a cycle [1].
    "impacts" (OutputUnit::Number) => Impacts {
        /// Joints and guides with clearance.
        joints: Vec<usize> = Form::StruckJoints,
    }
    "number of impacts per cycle in {joints}"

    /// Energy of these impacts over a cycle [J].
    "impact-energy" (OutputUnit::Energy) => ImpactEnergy {
        /// Joints and guides with clearance.
        joints: Vec<usize> = Form::StruckJoints,
        /// All impacts of the cycle, or the hardest one.
        measure: ImpactMeasure = Form::ImpactMeasure,
    }
    "energy of the {measure} in {joints}"

    /// Largest size over a cycle of the torque that drives a body [N m].
    "driving-torque" (OutputUnit::Torque) => DrivingTorque {
        /// Body that is driven.
        body: usize = Form::DrivenBody,
    }
    "largest torque that drives {body}"

    /// Backlash of the angle of a body: how far it can be turned while the drives are held, all journals within their worn bores [rad].
    "backlash" (OutputUnit::Angle) => Backlash {
        /// Body that can be turned.
        body: usize = Form::FreeBody,
        /// Where the drives are held; without it the largest backlash over a cycle.
        held: Option<HeldInput> = Form::Held,
    }
    "backlash of the angle of {body}{held}"

    /// Backlash of a point: how far it can be moved along a direction of the frame while the drives are held [m].
    "position-backlash" (OutputUnit::Length) => PositionBacklash {
        /// Point that can be moved.
        at: Attachment = Form::FreePlace,
        /// Angle of the direction from the x axis of the frame [rad].
        direction: f64 = Form::NumberOr(ANGLE, Range::Any, 0.0),
        /// Where the drives are held; without it the largest backlash over a cycle.
        held: Option<HeldInput> = Form::Held,
    }
    "backlash of a point of {at}{held}"

    /// Value that an external simulator returns under the output's name.
    => External {
        /// Its unit, as it is displayed; values are not converted.
        unit: String = Form::Elsewhere,
        /// True if it has a single value, which holds for the whole life.
        single: bool = Form::Elsewhere,
    }
    "value returned by the simulator"
}

impl OutputKind {
    /// Unit of the values.
    pub fn unit(&self) -> OutputUnit {
        match self {
            OutputKind::Wear { quantity, .. } => quantity.unit(),
            OutputKind::External { unit, .. } => OutputUnit::External(unit.clone()),
            other => other.kind().words[0].1.clone(),
        }
    }

    /// The curves that state what is wanted, with their keys in a scene.
    pub fn curves(&self) -> Vec<(&'static str, Curve)> {
        let values = self.values();
        let curves = values.iter().flat_map(|(key, value)| value.curves(key.name));
        curves.map(|(key, curve)| (key, curve.clone())).collect()
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

/// A limit state of an output: the mechanism has failed where the output is at or beyond a threshold.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct LimitState {
    /// Unique name, e.g. `wear`.
    pub name: String,
    /// Index into [`super::Scene::outputs`].
    pub output: usize,
    /// Threshold in the unit of the output (SI); the upper one of two.
    pub threshold: f64,
    /// Side of the threshold on which the mechanism has failed.
    pub fails: Fails,
}

/// The side of a threshold that means failure; the threshold itself belongs to it.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize)]
pub enum Fails {
    /// Values at the threshold and above.
    #[default]
    Above,
    /// Values at the threshold and below.
    Below,
    /// Values at the threshold and above, and values at a lower threshold and below.
    Outside {
        /// The lower threshold in the unit of the output (SI).
        lower: f64,
    },
}

impl LimitState {
    /// Response r(y) of a value y of the output: failure means that it reaches [`Self::response_threshold`] from below. It is y
    /// where large values fail, -y where small ones do, and |y - c| where both do, c being the middle between the thresholds.
    pub fn response(&self, value: f64) -> f64 {
        match self.fails {
            Fails::Above => value,
            Fails::Below => -value,
            // About the middle, so that a value at a limit has the threshold of the response whatever rounding does.
            Fails::Outside { lower } => {
                self.response_threshold() + (value - self.threshold).max(lower - value)
            }
        }
    }

    /// Threshold of the response: the threshold, its negative, or half the distance between the two.
    pub fn response_threshold(&self) -> f64 {
        match self.fails {
            Fails::Above => self.threshold,
            Fails::Below => -self.threshold,
            Fails::Outside { lower } => 0.5 * (self.threshold - lower),
        }
    }

    /// True if a value of the output means failure; false for NaN.
    pub fn is_reached(&self, value: f64) -> bool {
        match self.fails {
            Fails::Above => value >= self.threshold,
            Fails::Below => value <= self.threshold,
            Fails::Outside { .. } => self.response(value) >= self.response_threshold(),
        }
    }

    /// Size by which errors of the output are measured: that of the threshold, or half the distance between the two.
    pub fn scale(&self) -> f64 {
        self.response_threshold().abs()
    }

    /// The thresholds of the output, ascending.
    pub fn thresholds(&self) -> Vec<f64> {
        let lower = if let Fails::Outside { lower } = self.fails { Some(lower) } else { None };
        lower.into_iter().chain([self.threshold]).collect()
    }

    /// The middle between two thresholds, if there are two.
    pub fn middle(&self) -> Option<f64> {
        let Fails::Outside { lower } = self.fails else { return None };
        Some(0.5 * (lower + self.threshold))
    }
}
