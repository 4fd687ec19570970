//! The mechanism a scene describes, assembled: who is connected to whom, which bodies cost unknowns, where it
//! stands with ideal joints, and the forces of each island.

mod assembly;
#[cfg(test)]
mod derivative_tests;
mod frame;
mod island;
mod joint;
mod prescribed;
mod table;

pub use assembly::{Pose, ideal_accelerations, ideal_cycle};
pub use frame::Frame;
pub use island::{Island, WearingJoint, islands};
pub use prescribed::Prescribed;
