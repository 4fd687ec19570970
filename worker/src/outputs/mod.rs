//! From the motion of a cycle to the quantities a scene asks for.

mod difference;
mod recorder;
mod trace;

pub use difference::largest_difference;
pub use recorder::Recorder;
pub use trace::{BodyTrack, ForceTrack};
