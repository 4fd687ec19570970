//! From the motion of a cycle to the quantities a scene asks for.

mod difference;
mod point;
mod recorder;
mod torque;
mod trace;

pub use difference::{Compared, largest_difference};
pub use point::PointTrack;
pub use recorder::Recorder;
pub use torque::{MomentTrack, largest_torque};
pub use trace::{BodyTrack, ForceTrack};
