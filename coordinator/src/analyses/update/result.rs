//! The state of units after their observations, as printed by `coordinator update --json`.

use super::observation::Observation;
use crate::results::life_summary::LifeRow;
use crate::results::summary::ReliabilityRow;
use serde::Serialize;

/// All units of a file.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct FleetReport {
    /// Name of the scene.
    pub scene: String,
    /// Simulations that were made.
    pub evaluations: usize,
    /// Reliability of a unit of which nothing is known: that of the study.
    pub reliability: Vec<ReliabilityRow>,
    /// Lives of such a unit.
    pub lives: Vec<LifeRow>,
    /// What the study's simulations do not support, in words.
    pub caution: Option<String>,
    /// Last checkpoint [cycles].
    pub end: f64,
    /// Number of points whose weights are changed.
    pub population: usize,
    /// The units, in the order of the file.
    pub units: Vec<UnitReport>,
}

/// One unit after its observations.
#[derive(Debug, Clone, PartialEq, Default, Serialize)]
pub struct UnitReport {
    /// Name of the unit.
    pub unit: String,
    /// Life up to which it was observed [cycles].
    pub observed_until: f64,
    /// Life by which it had failed [cycles].
    pub failed_by: Option<f64>,
    /// R(n | observations) at the life up to which it was observed, and at later checkpoints; the standard errors are those of
    /// the number of points.
    pub reliability: Vec<ReliabilityRow>,
    /// Lives at which R(n | observations) falls to 0.99, 0.9 and 0.5.
    pub lives: Vec<LifeRow>,
    /// Remaining life after the last observation.
    pub remaining: RemainingLife,
    /// Random variables of the unit.
    pub variables: Vec<UpdatedVariable>,
    /// Observations with their probabilities.
    pub observations: Vec<ObservationRow>,
    /// True if the effective sample size is large enough for quantiles; else none is stated, only their intervals.
    pub resolved: bool,
    /// Effective sample size: the number of equally weighted points with the same error.
    pub effective_size: f64,
    /// Stages of sequential Monte Carlo; 0 where weights over the population sufficed.
    pub stages: usize,
    /// Share of its moves that were accepted [1]; `null` without any.
    pub acceptance: Option<f64>,
    /// What is to be checked, in words; `null` if nothing is.
    pub warning: Option<String>,
}

/// Remaining life after the last observation [cycles].
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize)]
pub struct RemainingLife {
    /// Remaining life that 5 % of such units do not reach; 0 if the unit may have failed already, `null` beyond the study.
    pub p5: Option<f64>,
    /// Median of the remaining life.
    pub p50: Option<f64>,
    /// Remaining life that 95 % do not reach.
    pub p95: Option<f64>,
    /// 95 % interval of each by the number of points: `[lower, upper]`, `null` beyond the study.
    pub sampling: [[Option<f64>; 2]; 3],
}

/// A random variable after the observations.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct UpdatedVariable {
    /// Name of the variable.
    pub name: String,
    /// Unit in which it is read.
    pub unit: String,
    /// Posterior mean [SI].
    pub mean: f64,
    /// Posterior standard deviation [SI].
    pub std: f64,
    /// Mean in the study [SI].
    pub prior_mean: f64,
    /// Standard deviation in the study [SI].
    pub prior_std: f64,
}

impl ObservationRow {
    /// An observation with its probability [1], and the one that is resolved.
    pub(in crate::analyses) fn new(of: &Observation, probability: f64, resolution: f64) -> Self {
        let Observation { line, cycles, name, .. } = of;
        Self { line: *line, cycles: *cycles, quantity: name.clone(), probability, resolution }
    }
}

/// One observation of a unit.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ObservationRow {
    /// Line of the file.
    pub line: u64,
    /// Life of the unit then [cycles].
    pub cycles: f64,
    /// Quantity as written.
    pub quantity: String,
    /// Probability, under the model and the earlier observations of the unit, of a value at least as far off [1]; of survival or
    /// failure the probability that it happens.
    pub probability: f64,
    /// Probability below which the number of points says nothing, 3 over their effective size [1].
    pub resolution: f64,
}
