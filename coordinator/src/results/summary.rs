//! The result of a study, as written to `summary.json` and shown by the report.
//!
//! Fields named `..._m` and `..._rpm` follow the contract; general outputs stand under their own name.

use common::accuracy::Accuracy;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// A value for each limit state of the scene, by name, in the scene's order is kept by `limit_states`.
pub type PerLimitState = BTreeMap<String, f64>;

/// A whole study.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct StudySummary {
    /// Scene name.
    pub scene: String,
    /// Version of the program.
    pub version: String,
    /// Seed.
    pub seed: u64,
    /// `ak` or `monte-carlo`.
    pub method: String,
    /// Accuracy of the evaluations: a preset, or one with knobs turned.
    pub accuracy: String,
    /// All its knobs; none of an external simulator, whose accuracy is its own affair.
    pub accuracy_settings: Option<Accuracy>,
    /// Error budget that the accuracy was found for, if it was, as a share of the limits [1].
    pub max_error: Option<f64>,
    /// Size of the Monte Carlo population at the end.
    pub population: usize,
    /// What that population is conditional on, where failures were too rare for any without condition.
    #[serde(default)]
    pub conditional: Option<ConditionRow>,
    /// Counts of evaluations.
    pub evaluations: EvaluationCounts,
    /// Names of the limit states, in the scene's order.
    pub limit_states: Vec<String>,
    /// One row per checkpoint.
    pub reliability: Vec<ReliabilityRow>,
    /// What failed first, one row per checkpoint; empty in studies made before it was counted.
    #[serde(default)]
    pub first_failure: Vec<FirstFailureRow>,
    /// Simulations without a result.
    #[serde(default)]
    pub failures: Failures,
    /// One row per checkpoint: `cycles` and, per output, mean and standard deviation over the population.
    pub moments: Vec<MomentsRow>,
    /// Derivatives of the failure probabilities.
    pub sensitivity: Vec<SensitivityRow>,
    /// Sobol indices of the limit states' outputs; none with direct simulation.
    #[serde(default)]
    pub sobol: Vec<SobolRow>,
    /// How learning went and why it stopped.
    pub convergence: Convergence,
    /// The surrogates at the end; none with the Monte Carlo method.
    #[serde(default)]
    pub surrogates: Vec<SurrogateRow>,
    /// Where the time went.
    pub timing_s: Timing,
    /// Who worked.
    pub workers: Vec<WorkerShare>,
}

impl StudySummary {
    /// Whether a mechanism was simulated, and not by a simulator that the scene names.
    pub fn of_mechanism(&self) -> bool {
        self.accuracy_settings.is_some()
    }

    /// What is studied, in the singular.
    pub fn subject(&self) -> &'static str {
        if self.of_mechanism() { "mechanism" } else { "system" }
    }

    /// Whether there is no life to follow: everything is told at a single checkpoint.
    pub fn is_static(&self) -> bool {
        self.reliability.len() == 1
    }
}

/// The intermediate event of a subset simulation.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct ConditionRow {
    /// Its probability [1].
    pub probability: f64,
    /// Coefficient of variation of that [1].
    pub coefficient_of_variation: f64,
    /// Levels on the way there.
    pub levels: usize,
}

/// Sobol indices of one limit state's output for one variable.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct SobolRow {
    /// Life [cycles].
    pub cycles: u32,
    /// Limit state.
    pub limit_state: String,
    /// Variable.
    pub variable: String,
    /// Share of the output's variance that knowing the variable would remove [1].
    pub first_order: f64,
    /// Share that would be left if all others were known [1].
    pub total: f64,
    /// Standard errors of the two.
    pub standard_error: SobolError,
}

/// A pair for the two indices.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct SobolError {
    /// Of first order.
    pub first_order: f64,
    /// Total.
    pub total: f64,
}

/// What failed first of the samples that have failed by one checkpoint, as shares of all samples: they add up to the failure
/// probability of the system.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct FirstFailureRow {
    /// Life [cycles].
    pub cycles: u32,
    /// Share of the samples in which several limit states were reached at the same checkpoint [1].
    pub together: f64,
    /// Share in which each limit state was reached first [1].
    pub first: PerLimitState,
}

/// Simulations that gave no result, at a stricter setting neither.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Failures {
    /// Share of the population where a simulation is more likely to fail than not, by an estimate from those that
    /// did [1].
    pub barred_share: f64,
    /// Each of them.
    pub simulations: Vec<FailureRow>,
}

/// A simulation that failed.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct FailureRow {
    /// Why.
    pub cause: String,
    /// Values of the random variables [SI].
    pub sample: BTreeMap<String, f64>,
}

/// Moments at one checkpoint.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct MomentsRow {
    /// Life [cycles].
    pub cycles: u32,
    /// Mean and standard deviation of each limit state's output over the population, e.g. `wear_mean_m`.
    #[serde(flatten)]
    pub moments: BTreeMap<String, f64>,
}

/// Counts of evaluations.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct EvaluationCounts {
    /// All.
    pub total: usize,
    /// Of the initial design.
    pub initial: usize,
    /// Added by learning.
    pub added: usize,
    /// Without a result.
    pub failed: usize,
}

/// Reliability at one checkpoint.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ReliabilityRow {
    /// Life [cycles].
    pub cycles: u32,
    /// R per limit state, and `total` for the series system; absorbing.
    #[serde(flatten)]
    pub reliability: PerLimitState,
    /// Standard error of each: root of the sum of squares of sampling error, estimated surrogate error and the shift by
    /// the simulator's numerical noise.
    pub standard_error: PerLimitState,
    /// R of each with all responses moved by the numerical errors that the simulations state, in the worst and in the
    /// best direction. Not part of the standard error; empty in studies made before there was one.
    #[serde(default)]
    pub numerical: BTreeMap<String, NumericalRange>,
}

/// Range of a reliability under numerical errors.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct NumericalRange {
    /// R with every response larger by its stated error.
    pub lower: f64,
    /// R with every response smaller by its stated error.
    pub upper: f64,
}

/// Derivative of the probability of failure of one limit state with respect to one variable's parameters.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct SensitivityRow {
    /// Life [cycles].
    pub cycles: u32,
    /// Limit state, or `total`.
    pub limit_state: String,
    /// Variable.
    pub variable: String,
    /// dPf / dmean [1/unit of the variable, SI].
    pub d_pf_d_mean: f64,
    /// dPf / dstd [1/unit of the variable, SI].
    pub d_pf_d_std: f64,
    /// Standard errors of the two.
    pub standard_error: SensitivityError,
    /// The two made comparable between variables: derivative times standard deviation [1].
    pub scaled: SensitivityError,
}

/// A pair for mean and standard deviation.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct SensitivityError {
    /// For the derivative to the mean.
    pub d_pf_d_mean: f64,
    /// For the derivative to the standard deviation.
    pub d_pf_d_std: f64,
}

/// How learning went.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Convergence {
    /// The rule that ended it, in words.
    pub stopped_because: String,
    /// Whether that rule is a met target; false when the budget was spent first, or too few failures were found.
    pub targets_met: bool,
    /// One row per round of learning.
    pub rounds: Vec<Round>,
}

/// One round of learning.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Round {
    /// Round, from 0 (after the initial design).
    pub round: usize,
    /// Evaluations so far.
    pub evaluations: usize,
    /// Smallest coupled learning function over the population; 100 stands for 100 or more.
    pub min_u: f64,
    /// Share of the population with U_c < 2.
    pub share_uncertain: f64,
    /// Largest change of any R(n) since the round before, relative to the smaller of R and P_f of the system at the
    /// governing checkpoint; absent in round 0 and after the population grew.
    pub change_of_r: Option<f64>,
    /// Largest estimated surrogate error of any R(n).
    pub surrogate_error: f64,
    /// Coefficient of variation of the system's failure probability at the governing checkpoint; about 1 while no
    /// failure is found.
    pub cov_pf: f64,
    /// Dominance weight k, where defined.
    pub dominance: Option<f64>,
    /// Governing checkpoint [cycles]: where the system's R is nearest 1/2.
    pub cycles: u32,
    /// R of the system there.
    pub reliability_total: f64,
    /// Repairs of the surrogates this round (nugget raised, likelihood start failed).
    pub repairs: usize,
}

impl Round {
    /// Standard error of [`Round::reliability_total`]: of the surrogates (at most) and of counting.
    pub fn standard_error(&self) -> f64 {
        self.surrogate_error.hypot(self.cov_pf * (1.0 - self.reliability_total))
    }
}

/// The surrogate of one limit state at the end of a study.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct SurrogateRow {
    /// Limit state.
    pub limit_state: String,
    /// Least leave-one-out Q2 over the checkpoints that matter [1].
    pub q2: f64,
    /// Least Q2 of cross-validation with the lengths found anew [1]; absent with fewer than ten results, and in studies made
    /// before it was told.
    #[serde(default)]
    pub q2_cross_validated: Option<f64>,
    /// Factor by which the predicted variances were multiplied, since cross-validation or leaving one out showed them too
    /// small [1]; likewise.
    #[serde(default)]
    pub variance_factor: Option<f64>,
    /// Variance of the noise that is the same at every point over the process variance [1].
    pub nugget: f64,
    /// Mean variance of the noise that goes with the stated errors over the process variance [1].
    pub stated_noise: f64,
    /// Variance of both over that of the simulated values, largest over the checkpoints that matter [1]; absent in studies
    /// made before it was told.
    #[serde(default)]
    pub noise_share: Option<f64>,
    /// Kernel of the correlation; empty in studies made before there was a choice.
    #[serde(default)]
    pub kernel: String,
    /// Trend, likewise.
    #[serde(default)]
    pub trend: String,
    /// Whether a correlation for the early and one for the late checkpoints would clearly predict better than the one for all;
    /// absent with one checkpoint.
    #[serde(default)]
    pub separate_would_gain: Option<bool>,
    /// Standard deviation of that noise over the stated errors themselves [1]; absent without stated errors.
    pub share_of_stated_error: Option<f64>,
}

/// Share of the variance from which the noise of the simulations costs more of them than a finer accuracy would.
const MUCH_NOISE: f64 = 0.02;

impl SurrogateRow {
    /// The share of noise in the simulations, if it is what limits learning.
    pub fn much_noise(&self) -> Option<f64> {
        self.noise_share.filter(|share| *share > MUCH_NOISE)
    }
}

/// Wall-clock time, coordinator's view [s].
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct Timing {
    /// All.
    pub total: f64,
    /// Sum over evaluations of the simulations' own times.
    pub simulation: f64,
    /// Fitting, prediction, selection.
    pub surrogate: f64,
    /// Time in which nothing was under way, so that all slots waited.
    pub idle: f64,
}

/// What one worker contributed.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct WorkerShare {
    /// Name.
    pub name: String,
    /// Evaluations.
    pub evaluations: usize,
    /// Sum of its simulation times [s].
    pub simulation_s: f64,
}
