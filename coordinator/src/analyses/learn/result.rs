//! What a fleet says of its population, as printed by `coordinator learn --json`.

use crate::analyses::update::FleetSettings;
use crate::results::summary::ReliabilityRow;
use crate::statistics::updating::{ConfidentReliability, SequentialMonteCarlo};
use common::random::{Correlation, Distribution};
use common::scene::Scene;
use serde::Serialize;

/// Settings of the learning.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LearnSettings {
    /// Updating of the single units; its population is that of a pass.
    pub units: FleetSettings,
    /// Sets of parameters.
    pub sets: usize,
    /// Points of the population by which R is counted.
    pub points: usize,
    /// Confidence C in (0, 1) [1].
    pub confidence: f64,
    /// Whether the value of further data is computed.
    pub ranks: bool,
}

impl LearnSettings {
    /// Defaults for a study with this seed. With 400 particles a unit in a tail of the population, whose state two variables share,
    /// had a likelihood that changed with the parameters by chance: the lower bound of a life was up to a third of its interval too low.
    pub fn new(seed: u64) -> Self {
        let monte_carlo = SequentialMonteCarlo { particles: 2000, least: 150.0 };
        let units = FleetSettings { population: 15_000, monte_carlo, ..FleetSettings::new(seed) };
        Self { units, sets: 500, points: 16_000, confidence: 0.9, ranks: true }
    }
}

/// The answer of `coordinator learn`.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct LearnReport {
    /// Name of the scene.
    pub scene: String,
    /// Simulations that were made.
    pub evaluations: usize,
    /// Number of units.
    pub units: usize,
    /// Reliability and lives with their bounds.
    pub confident: ConfidentReliability,
    /// Reliability and lives before simulations were added.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub before: Option<ConfidentReliability>,
    /// Distributions of the variables of one more unit, with the moments that the sets give `(d,)`, and their correlations.
    #[serde(skip)]
    pub one_more: (Vec<Distribution>, Vec<Correlation>),
    /// Reliability of the study, before any unit was observed.
    pub study: Vec<ReliabilityRow>,
    /// What the study's simulations do not support, in words.
    pub caution: Option<String>,
    /// Last checkpoint [cycles].
    pub end: f64,
    /// True if the file names no unknown parameter.
    pub chosen_by_default: bool,
    /// The unknown parameters.
    pub parameters: Vec<LearnedParameter>,
    /// Units that the population which the others have does not explain well.
    pub checks: Vec<LearnedUnit>,
    /// Variables whose population leaves the simulated values.
    pub left: Vec<LeftVariable>,
    /// Further data, the one that narrows the bound most first; empty if that was not asked for.
    pub values: Vec<DataValue>,
    /// Effective number of sets of parameters [1].
    pub effective_size: f64,
    /// Stages of sequential Monte Carlo in the last pass.
    pub stages: usize,
    /// Share of its moves that were accepted [1]; `null` without any.
    pub acceptance: Option<f64>,
    /// Number of passes over the data.
    pub passes: u32,
}

impl LearnReport {
    /// The studied scene with the variables of one more unit, where simulations improve what was learned.
    pub fn scene_of_one_more(&self, studied: &Scene) -> Scene {
        let mut scene = studied.clone();
        let (laws, correlations) = &self.one_more;
        scene.correlations.clone_from(correlations);
        let laws = scene.variables.iter_mut().zip(laws);
        laws.for_each(|(variable, law)| variable.distribution = law.clone());
        scene
    }
}

/// A parameter of the population.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct LearnedParameter {
    /// `VARIABLE.mean`, `VARIABLE.std`, `correlation(A,B)`, or the name of a design variable.
    pub name: String,
    /// Unit in which it is read.
    pub unit: String,
    /// Posterior mean [SI].
    pub mean: f64,
    /// Posterior standard deviation [SI].
    pub std: f64,
    /// Posterior median [SI].
    pub median: f64,
    /// Interval with the confidence stated [SI].
    pub interval: [f64; 2],
    /// Value in the study [SI].
    pub study: f64,
    /// 5 and 95 % quantiles of the prior [SI].
    pub prior: [f64; 2],
    /// True for a flat prior.
    pub is_flat: bool,
}

/// A unit with an improbable observation.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct LearnedUnit {
    /// Name of the unit.
    pub unit: String,
    /// What is to be checked, in words.
    pub warning: String,
}

/// A variable whose population leaves the simulated values.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct LeftVariable {
    /// Name of the variable.
    pub name: String,
    /// Share of the units outside the simulated values [1].
    pub outside: f64,
    /// Share of the study's own population outside them [1].
    pub of_study: f64,
}

/// What further data are worth.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct DataValue {
    /// The data, in words.
    pub data: String,
    /// Expected narrowing of the interval of the life at R = 0.99, as a share of its width [1].
    pub narrowing: f64,
    /// Its standard error by the number of simulated data sets [1].
    pub standard_error: f64,
    /// What the data cost, if a price is given.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub cost: Option<f64>,
}
