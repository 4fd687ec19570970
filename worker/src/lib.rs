//! The worker: simulates worn mechanisms.

pub mod service;
pub mod simulator;
