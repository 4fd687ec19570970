//! Every numerical knob of an evaluation, and the three named points among them.

use serde::{Deserialize, Serialize};

/// Numerical settings of one evaluation.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Accuracy {
    /// Tolerance of the local error of a time step, relative to the scales of the motion [1].
    pub step_tolerance: f64,
    /// Largest time step as a fraction of the cycle [1].
    pub largest_step: f64,
    /// Bound on time steps per cycle and island.
    pub steps_bound: u64,
    /// Samples of the contact history per cycle kept for the wear step.
    pub wear_samples: usize,
    /// Largest number of cycles one wear step jumps.
    pub cycle_jump: u32,
    /// Tolerance of the wear step, relative to the wear it adds [1].
    pub wear_tolerance: f64,
    /// Warm-up before a measured cycle, as a fraction of the cycle [1].
    pub warm_up: f64,
}
