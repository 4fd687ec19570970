//! What one evaluation returns, in SI.

use serde::{Deserialize, Serialize};

/// Result of one evaluation: the whole life of one sample.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Evaluation {
    /// Checkpoints `(m,)` [cycles]; each value below belongs to the profile worn to that many cycles.
    pub cycles: Vec<u32>,
    /// One history per output of the scene `(outputs, m)`, in the output's SI unit.
    pub histories: Vec<Vec<f64>>,
    /// Per joint with clearance: state at the end of life and force peak of the first cycle.
    pub joints: Vec<JointSummary>,
    /// The settled first cycle of the unworn mechanism, when asked for.
    pub first_cycle: Option<FirstCycle>,
    /// What the numerics had to do.
    pub diagnostics: Diagnostics,
}

/// One joint with clearance.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct JointSummary {
    /// Name of the joint.
    pub name: String,
    /// Largest contact force magnitude of the settled first cycle [N].
    pub peak_force: f64,
    /// Wear depth at each control point at the end of life `(control_points,)` [m].
    pub wear_depth: Vec<f64>,
}

/// Time histories of one cycle on a common time grid.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct FirstCycle {
    /// Time from the start of the cycle `(n,)` [s].
    pub time: Vec<f64>,
    /// Bodies reported, by label, e.g. `right`, `left`.
    pub bodies: Vec<BodyTrace>,
    /// Contact force magnitude per joint with clearance, `(n,)` each [N].
    pub joint_force: Vec<(String, Vec<f64>)>,
}

/// Motion of one body over a cycle.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct BodyTrace {
    /// Label, e.g. `right`.
    pub label: String,
    /// Signed angle `(n,)` [rad].
    pub angle: Vec<f64>,
    /// Signed angular velocity `(n,)` [rad/s].
    pub speed: Vec<f64>,
}

/// Work and repairs of one evaluation.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Diagnostics {
    /// Accepted time steps.
    pub steps: u64,
    /// Steps refused and repeated with a smaller one.
    pub rejected_steps: u64,
    /// Newton iterations (position analysis and contact equilibrium; the linearly implicit step needs none).
    pub newton_iterations: u64,
    /// Evaluations of the force vector.
    pub force_evaluations: u64,
    /// Cycles simulated.
    pub simulated_cycles: u64,
    /// Stages of the wear step.
    pub wear_stages: u64,
    /// Wear steps refused and repeated over a smaller block.
    pub rejected_wear_steps: u64,
    /// Share of the first cycle in free flight, per joint with clearance.
    pub free_flight_fraction: Vec<(String, f64)>,
}
