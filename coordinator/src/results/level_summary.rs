//! Levels of accuracy of a study and their differences, as written to `summary.json`.

use serde::{Deserialize, Serialize};

/// Levels of accuracy and what pairs of simulations at the same points showed.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct LevelsRow {
    /// Names of the levels, the working accuracy first.
    pub names: Vec<String>,
    /// Pairs at the second level, and points at the third one.
    pub pairs: [usize; 2],
    /// Simulations at finer levels, failed ones included.
    pub evaluations: usize,
    /// Simulations at finer levels without a result.
    pub failed: usize,
    /// Differences, one row per limit state.
    pub differences: Vec<DifferenceRow>,
}

/// Correction of the output of one limit state at its limit, at the checkpoint where R of the system is nearest 1/2.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct DifferenceRow {
    /// Name of the limit state.
    pub limit_state: String,
    /// Checkpoint of the correction [cycles].
    pub cycles: u32,
    /// `constant`, `line` over the value, or `kriging` over the variables.
    pub form: String,
    /// What is added to a result, over the limit [1]; where the limit is 0 in its own unit.
    pub correction: f64,
    /// Half width of the 95 % interval of the correction, over the limit [1].
    pub error: f64,
    /// Spread of the pairs from point to point, over the limit [1].
    pub rough: f64,
    /// Observed order of convergence under halving; absent without convergence.
    pub order: Option<f64>,
}
