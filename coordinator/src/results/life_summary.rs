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
    /// Its 95 % interval: sampling, surrogate, interpolation between the checkpoints, and numerical error of the simulations.
    pub interval: CyclesRange,
    /// In studies by earlier versions, whose `interval` leaves it out, the interval with the numerical error of the simulations.
    #[serde(default, skip_serializing_if = "Option::is_none")]
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
    /// In studies by earlier versions, whose interval leaves it out, the lower limit with the numerical error of the simulations
    /// `(g,)` [1].
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub numerical_lower: Vec<f64>,
    /// In the same studies the upper limit with it `(g,)` [1].
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub numerical_upper: Vec<f64>,
}

impl LifeCurveRow {
    /// Lower and upper limits of the whole 95 % interval `(g,)` [1].
    pub fn limits(&self) -> [&[f64]; 2] {
        if self.numerical_lower.is_empty() {
            [&self.lower, &self.upper]
        } else {
            [&self.numerical_lower, &self.numerical_upper]
        }
    }
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
