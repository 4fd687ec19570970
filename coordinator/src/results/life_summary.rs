//! Lives and reliability between the checkpoints, as written to `summary.json`.

use serde::{Deserialize, Serialize};

/// Life at which a reliability falls to a level.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct LifeRow {
    /// Name of the limit state, or `total`.
    pub limit_state: String,
    /// Level of the reliability [1].
    pub reliability: f64,
    /// Life [cycles]; absent if it lies beyond the life studied, or if the checkpoints only bound it.
    pub cycles: Option<f64>,
    /// Its 95 % interval: sampling, surrogate and interpolation between the checkpoints.
    pub interval: CyclesRange,
    /// The 95 % interval with the numerical error of the simulations; absent if they state none.
    pub with_numerical_error: Option<CyclesRange>,
}

impl LifeRow {
    /// The interval with every error that is known.
    pub fn whole_interval(&self) -> CyclesRange {
        self.with_numerical_error.unwrap_or(self.interval)
    }
}

/// Interval of a life.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct CyclesRange {
    /// Lower limit [cycles].
    pub lower: f64,
    /// Upper limit [cycles]; absent beyond the life studied.
    pub upper: Option<f64>,
}

/// Reliability over life, from which lives are read: straight lines between these points are the curve.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct LifeCurveRow {
    /// Name of the limit state, or `total`.
    pub limit_state: String,
    /// Times, increasing from 0 `(g,)` [cycles].
    pub cycles: Vec<f64>,
    /// R `(g,)` [1].
    pub reliability: Vec<f64>,
    /// Lower limit of its 95 % interval `(g,)` [1].
    pub lower: Vec<f64>,
    /// Upper limit `(g,)` [1].
    pub upper: Vec<f64>,
    /// Lower limit with the numerical error of the simulations `(g,)` [1]; empty if they state none.
    pub numerical_lower: Vec<f64>,
    /// Upper limit with it `(g,)` [1].
    pub numerical_upper: Vec<f64>,
}

/// An interval between two checkpoints that contains too much of the system's failures to be read.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub struct UnresolvedFall {
    /// Beginning of the interval, 0 for the start of life [cycles].
    pub from: u32,
    /// Its end, a checkpoint [cycles].
    pub to: u32,
    /// Distance of the checkpoints that would resolve the fall [cycles].
    pub checkpoint_every: u32,
}
