//! The mechanism as checked: bodies, joints, drives, loads, random variables and limit states, all in SI.
//!
//! A [`Scene`] only comes out of validation ([`SceneSource`]), so the simulation need not check again what it
//! reads here.

mod attachment;
mod bodies;
mod body_row;
mod builtin;
mod clearance;
mod correlations;
mod drive;
pub mod expression;
pub mod faults;
mod fits;
mod joint;
mod joints;
mod life;
mod limits;
mod load;
mod loads;
mod merge;
pub mod model;
mod output;
mod outputs;
mod parameters;
pub mod quantity;
mod read;
mod resolve;
mod section;
mod simulator;
pub mod source;
mod tables;
mod variable_law;
mod variables;

pub use attachment::Attachment;
pub use drive::*;
pub use faults::{Fault, FaultKind, Faults};
pub use joint::*;
pub use load::*;
pub use model::*;
pub use output::*;
pub use source::SceneSource;
