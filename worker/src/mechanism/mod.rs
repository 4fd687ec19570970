//! The mechanism of a scene: islands of bodies that influence each other, their ideal start and motion, and
//! the generalised forces of each island.

// In lanes, closures of iterators are not compiled for the instruction set of the loop around them.
#![allow(clippy::needless_range_loop)]

mod assembly;
mod closing;
mod closure;
mod constraint;
mod coupling;
mod dependence;
mod effective_mass;
mod elimination;
mod envelope_qr;
mod extent;
mod forces;
mod frame;
mod friction_balance;
mod guide;
mod influence;
mod island;
mod island_frames;
mod island_steps;
mod joint;
mod joint_friction;
mod lanes;
mod load;
mod orthonormal;
mod passage;
mod piecewise_cubic;
mod prescribed;
mod separate;
mod sliding;
mod sparse_elimination;
mod start_velocity;
#[cfg(test)]
mod tests;
mod topology;
mod turns;
mod wearing_guide;
mod wearing_joint;
mod worn_guide;

pub(crate) use assembly::ideal_accelerations;
pub use assembly::{Pose, ideal_cycle};
pub use constraint::Constraint;
pub use extent::local_origin;
pub(crate) use extent::moved_to_origin;
pub use frame::{End, Frame, TimedState};
pub use guide::Guide;
pub(crate) use influence::{Influence, held_poses, influences, places_in_guide};
pub use island::Island;
pub(crate) use lanes::{IslandLanes, same_topology};
pub(crate) use load::external_moment;
pub(crate) use piecewise_cubic::PiecewiseCubic;
pub use prescribed::Prescribed;
pub use topology::{island_of_program, islands};
pub use turns::turns_per_cycle;
pub use wearing_guide::WearingGuide;
pub use wearing_joint::WearingJoint;
pub(crate) use wearing_joint::WearingPair;
