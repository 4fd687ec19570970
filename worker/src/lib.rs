//! The worker: one evaluation of a mechanism's life, and the service that offers it to a coordinator.
//!
//! `simulate` is the evaluation as one page; below it: `mechanism` (who moves how), `contact` (forces in a
//! joint), `integrate` (time), `quasi_static` (the same without vibrations), `wear` (the bore), `outputs` (what was
//! asked for).

pub mod bore;
pub mod contact;
pub mod extremes;
mod extremum;
pub mod integrate;
mod interpolate;
pub mod lanes;
pub mod life;
pub mod log;
pub mod mechanism;
pub mod outputs;
mod plane;
pub mod quasi_static;
pub mod service;
pub mod simulate;
pub mod simulator;
pub mod umbridge;
pub mod wear;
