//! The outputs that follow from the motion of a cycle: what each needs recorded, its value, and how it reads values between two time steps.

use super::angle_difference::largest_difference;
use super::backlash::backlash;
use super::deviation::{angle_error, argument_body, position_error};
use super::driving_torque::driving_torque;
use super::{BodyTrack, RecordedCycle, RecordingRequest};
use common::scene::{ErrorMeasure, ImpactMeasure, Output, OutputKind, SignedBody};

/// Largest share of the amplitude of a vibration by which an output of this kind can miss its peak between two time steps [1], where `phase`
/// x is the angle of the vibration per time step [rad]: x^4 / 384 on the cubic through values and rates at both ends of the step, x^2 / 8
/// at the ends of the steps alone, nothing by events, which the steps do not pass over. What another program measures has no peaks between the
/// steps of this one. Valid for x below about 1.
///
/// # Source
/// Error of piecewise Hermite and linear interpolation: de Boor, A Practical Guide to Splines (1978).
pub(crate) fn missed_peak(kind: &OutputKind, phase: f64) -> f64 {
    match kind {
        OutputKind::AngularVelocityDifference { .. }
        | OutputKind::AngleDifference { .. }
        | OutputKind::PositionError { .. }
        | OutputKind::AngleError { .. } => phase * phase * phase * phase / 384.0,
        OutputKind::PeakJointForce { .. }
        | OutputKind::Acceleration { .. }
        | OutputKind::AngularAcceleration { .. }
        | OutputKind::DrivingTorque { .. } => phase * phase / 8.0,
        OutputKind::Impacts { .. }
        | OutputKind::ImpactEnergy { .. }
        | OutputKind::Backlash { .. }
        | OutputKind::PositionBacklash { .. }
        | OutputKind::LargestWear { .. }
        | OutputKind::Wear { .. }
        | OutputKind::External { .. } => 0.0,
    }
}

/// True if the value of an output of the motion is that of an instant or of single events, and not a mean over the cycle.
pub(crate) fn is_extreme(kind: &OutputKind) -> bool {
    match kind {
        OutputKind::LargestWear { .. } | OutputKind::Wear { .. } | OutputKind::External { .. } => false,
        OutputKind::PositionError { measure, .. } | OutputKind::AngleError { measure, .. } => {
            *measure == ErrorMeasure::Largest
        }
        _ => true,
    }
}

/// What these outputs need recorded of the motion.
pub(crate) fn recording_request(outputs: &[Output]) -> RecordingRequest {
    let mut request = RecordingRequest::default();
    for output in outputs {
        match &output.kind {
            OutputKind::LargestWear { .. } | OutputKind::Wear { .. } | OutputKind::External { .. } => {}
            OutputKind::AngularVelocityDifference { a, b } | OutputKind::AngleDifference { a, b } => {
                request.bodies.extend([a.body, b.body]);
            }
            OutputKind::PeakJointForce { .. } => request.peak_forces = true,
            OutputKind::PositionError { at, wanted, .. } => {
                request.points.push(*at);
                if wanted.iter().all(Option::is_none) {
                    request.ideal_points.push(*at);
                }
                request.bodies.extend(wanted.iter().flatten().filter_map(argument_body));
            }
            OutputKind::AngleError { body, wanted, .. } => {
                request.bodies.push(*body);
                match wanted {
                    None => request.ideal_bodies.push(*body),
                    Some(curve) => request.bodies.extend(argument_body(curve)),
                }
            }
            OutputKind::Acceleration { at } => request.accelerations.push(*at),
            OutputKind::AngularAcceleration { body } => request.angular_accelerations.push(*body),
            OutputKind::Impacts { .. } | OutputKind::ImpactEnergy { .. } => request.impacts = true,
            OutputKind::DrivingTorque { body } => request.driven.push(*body),
            OutputKind::Backlash { .. } | OutputKind::PositionBacklash { .. } => {
                request.backlashes.push(output.kind.clone());
            }
        }
    }
    request
}

/// Value of an output over the recorded cycle, in its SI unit; zero if it does not follow from the motion.
pub(crate) fn motion_value(kind: &OutputKind, cycle: &RecordedCycle) -> f64 {
    let difference =
        |largest: fn((&BodyTrack, f64), (&BodyTrack, f64)) -> f64, a: &SignedBody, b: &SignedBody| {
            largest((&cycle.body(a.body), a.sign), (&cycle.body(b.body), b.sign))
        };
    match kind {
        OutputKind::LargestWear { .. } | OutputKind::Wear { .. } | OutputKind::External { .. } => 0.0,
        OutputKind::AngularVelocityDifference { a, b } => difference(largest_difference::<true>, a, b),
        OutputKind::AngleDifference { a, b } => difference(largest_difference::<false>, a, b),
        OutputKind::PeakJointForce { joints } => {
            joints.iter().filter_map(|&joint| cycle.peak_force(joint)).fold(0.0, f64::max)
        }
        OutputKind::PositionError { at, wanted, measure } => {
            position_error(at, wanted, cycle).measure(*measure)
        }
        OutputKind::AngleError { body, wanted, measure } => {
            angle_error(*body, wanted.as_ref(), cycle).measure(*measure)
        }
        OutputKind::Acceleration { at } => cycle.peak(|peaks| peaks.acceleration(at)),
        OutputKind::AngularAcceleration { body } => cycle.peak(|peaks| peaks.angular_acceleration(*body)),
        OutputKind::Impacts { joints } => cycle.impacts(joints).map(|count| f64::from(count.number)).sum(),
        OutputKind::ImpactEnergy { joints, measure: ImpactMeasure::Total } => {
            cycle.impacts(joints).map(|count| count.energy).sum()
        }
        OutputKind::ImpactEnergy { joints, measure: ImpactMeasure::Largest } => {
            cycle.impacts(joints).map(|count| count.hardest).fold(0.0, f64::max)
        }
        OutputKind::DrivingTorque { body } => driving_torque(*body, cycle),
        OutputKind::Backlash { .. } | OutputKind::PositionBacklash { .. } => backlash(kind, cycle),
    }
}
