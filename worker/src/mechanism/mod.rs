//! The mechanism a scene describes, assembled: who is connected to whom, which bodies cost unknowns, where it
//! stands with ideal joints, and the forces of each island.

#[cfg(test)]
mod acceleration_tests;
mod assembly;
mod closure;
mod constraint;
#[cfg(test)]
mod derivative_tests;
mod elimination;
mod forces;
mod frame;
mod island;
mod joint;
mod load;
#[cfg(test)]
mod order_tests;
mod outer;
mod pack;
mod packed_load;
mod prescribed;
mod table;
mod topology;

pub use assembly::{Pose, ideal_accelerations, ideal_cycle};
pub use constraint::Constraint;
pub use forces::LoadPower;
pub use frame::{End, Frame};
pub use island::{Island, WearingJoint};
pub use outer::OuterLoads;
pub use pack::{Pack, packs, same_make};
pub use prescribed::Prescribed;
pub use topology::islands;
