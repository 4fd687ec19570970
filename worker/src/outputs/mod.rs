//! From the motion of a cycle to the quantities a scene asks for.

mod difference;
mod energy;
mod point;
mod recorder;
mod shown;
mod torque;
mod trace;
mod wanted;

pub use difference::{Compared, largest_difference};
pub use energy::together;
pub use point::PointTrack;
pub use recorder::Recorder;
pub use shown::Shown;
pub use torque::{MomentTrack, largest_torque};
pub use trace::{BodyTrack, ForceTrack};
pub use wanted::Wanted;
