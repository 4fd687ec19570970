//! The mechanism as checked: bodies, joints, drives, loads, random variables and limit states, all in SI.
//!
//! A [`Scene`] only comes out of validation, so the simulation need not check again what it reads here.

pub mod model;

pub use model::*;
