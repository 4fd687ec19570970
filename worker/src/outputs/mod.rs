//! From the recorded motion of a cycle to the outputs of a scene.
//!
//! An output that follows from the motion is a [`MotionOutput`] in its own file: what it needs recorded, its value, and how
//! it reads values between two time steps. [`motion_output`] lists them all.
//!
//! | file | contents |
//! |---|---|
//! | `motion_output.rs` | the trait of the outputs |
//! | `angle_difference.rs`, `peak_joint_force.rs`, `position_error.rs`, `angle_error.rs`, `acceleration.rs`, `impacts.rs`, `driving_torque.rs`, `backlash.rs`, `sought_backlash.rs` | the outputs |
//! | `deviation.rs`, `wanted.rs` | size of a deviation over a cycle; wanted functions of time or of an angle |
//! | `recording_request.rs`, `recorder.rs`, `peaks.rs` | what to record of an island, and the recording |
//! | `contact_lanes.rs`, `motion_rows.rs` | contacts and motion of islands in lanes |
//! | `recorded_cycle.rs` | the recordings of all islands of a cycle, as outputs read them |
//! | `trace.rs`, `point_track.rs`, `moment_track.rs` | angle of a body, force of a joint, path of a point and moment on a body over time |
//! | `full_recording.rs`, `displayed_motion.rs`, `energy.rs` | everything of a cycle that is displayed |

mod acceleration;
mod angle_difference;
mod angle_error;
mod backlash;
mod contact_lanes;
mod deviation;
mod displayed_motion;
mod driving_torque;
mod energy;
mod full_recording;
mod impact_count;
mod impacts;
mod moment_track;
mod motion_output;
mod motion_rows;
mod peak_joint_force;
mod peaks;
mod point_track;
mod position_error;
mod recorded_cycle;
mod recorder;
#[cfg(test)]
mod recorder_tests;
mod recording_request;
mod sought_backlash;
mod trace;
mod wanted;

pub(crate) use contact_lanes::ContactLanes;
pub(crate) use energy::sum_of_islands;
pub(crate) use full_recording::FullRecording;
pub(crate) use motion_output::{MotionOutput, Sampling};
pub(crate) use motion_rows::{LaneRows, MotionRows};
pub(crate) use point_track::PointTrack;
pub(crate) use recorded_cycle::{IdealTracks, RecordedCycle, sample_times};
pub(crate) use recorder::Recorder;
pub(crate) use recording_request::RecordingRequest;
pub(crate) use sought_backlash::SoughtBacklash;
pub(crate) use trace::{BodyTrack, ForceTrack};

use acceleration::{Acceleration, AngularAcceleration};
use angle_difference::AngleDifference;
use angle_error::AngleError;
use backlash::Backlash;
use common::scene::{Output, OutputKind};
use driving_torque::DrivingTorque;
use impacts::{ImpactEnergy, Impacts};
use peak_joint_force::PeakJointForce;
use position_error::PositionError;

/// The output of this kind, if it follows from the motion of a cycle; `None` for the wear and for external simulators.
pub(crate) fn motion_output(kind: &OutputKind) -> Option<Box<dyn MotionOutput + '_>> {
    match kind {
        OutputKind::LargestWear { .. } | OutputKind::Wear { .. } | OutputKind::External { .. } => None,
        OutputKind::AngularVelocityDifference { a, b } => Some(Box::new(AngleDifference::of_speeds(a, b))),
        OutputKind::AngleDifference { a, b } => Some(Box::new(AngleDifference::of_angles(a, b))),
        OutputKind::PeakJointForce { joints } => Some(Box::new(PeakJointForce { joints })),
        OutputKind::PositionError { at, wanted, measure } => {
            Some(Box::new(PositionError { at, wanted, measure: *measure }))
        }
        OutputKind::AngleError { body, wanted, measure } => {
            Some(Box::new(AngleError { body: *body, wanted: wanted.as_ref(), measure: *measure }))
        }
        OutputKind::Acceleration { at } => Some(Box::new(Acceleration { at })),
        OutputKind::AngularAcceleration { body } => Some(Box::new(AngularAcceleration { body: *body })),
        OutputKind::Impacts { joints } => Some(Box::new(Impacts { joints })),
        OutputKind::ImpactEnergy { joints, measure } => {
            Some(Box::new(ImpactEnergy { joints, measure: *measure }))
        }
        OutputKind::DrivingTorque { body } => Some(Box::new(DrivingTorque { body: *body })),
        OutputKind::Backlash { body, held } => Some(Box::new(Backlash::of_angle(*body, *held))),
        OutputKind::PositionBacklash { at, direction, held } => {
            Some(Box::new(Backlash::of_place(*at, *direction, *held)))
        }
    }
}

/// What these outputs need recorded of the motion.
pub(crate) fn recording_request(outputs: &[Output]) -> RecordingRequest {
    let mut request = RecordingRequest::default();
    for output in outputs.iter().filter_map(|output| motion_output(&output.kind)) {
        output.request(&mut request);
    }
    request
}
