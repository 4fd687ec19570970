//! From the recorded motion of a cycle to the outputs of a scene.
//!
//! `motion_output.rs` lists the outputs that follow from the motion: what each needs recorded, its value, and how it reads values
//! between two time steps.
//!
//! | file | contents |
//! |---|---|
//! | `motion_output.rs` | the outputs |
//! | `angle_difference.rs`, `deviation.rs`, `backlash.rs` | values of single outputs, and wanted functions of time or of an angle |
//! | `recorder.rs`, `peaks.rs` | what to record of an island, and the recording |
//! | `contact_lanes.rs`, `motion_rows.rs` | contacts and motion of islands in lanes |
//! | `recorded_cycle.rs` | the recordings of all islands of a cycle, as outputs read them |
//! | `trace.rs` | angle of a body, force of a joint, path of a point and moment on a body over time |
//! | `displayed_motion.rs` | everything of a cycle that is displayed |

mod angle_difference;
mod backlash;
mod contact_lanes;
mod deviation;
mod displayed_motion;
mod driving_torque;
mod motion_output;
mod motion_rows;
mod peaks;
mod recorded_cycle;
mod recorder;
#[cfg(test)]
mod recorder_tests;
mod trace;

pub(crate) use contact_lanes::ContactLanes;
pub(crate) use displayed_motion::{FullRecording, sum_of_islands};
pub(crate) use driving_torque::own_torque;
pub(crate) use motion_output::{is_extreme, missed_peak, motion_value, recording_request};
pub(crate) use motion_rows::MotionRows;
pub(crate) use peaks::RecordingRequest;
pub(crate) use recorded_cycle::{IdealTracks, RecordedCycle, sample_times};
pub(crate) use recorder::Recorder;
pub(crate) use trace::{BodyTrack, ForceTrack, MomentTrack, PointTrack};
