//! The result of a study, as written to `summary.json` and shown by the report. The field names are the keys of the file: they may
//! be added to, but not changed. Keys of outputs are their name and unit, e.g. `max_wear_depth_m`.

use super::life_summary::{LifeCurveRow, LifeRow, UnresolvedFall};
pub use super::reliability_summary::{PerLimitState, ReliabilityRange, ReliabilityRow};
use super::scene_summary::{LimitRow, UnitRow, VariableRow, limit_rows, sha256, unit_rows, variable_rows};
use super::summary_rows::{ControlPointsRow, FailurePointRow, LevelsRow, OutlierRow, PredictionRow};
pub use super::summary_rows::{SurrogateRow, UntestedRow, VariantRow};
pub use super::timing::{ScaleRow, Timing, WorkerShare};
use common::accuracy::Accuracy;
use common::scene::Scene;
use serde::{Deserialize, Serialize};
use std::{collections::BTreeMap, path::Path};

/// Version of the form of `summary.json`: a reader of this one reads later ones, which only add keys.
pub const SCHEMA: u32 = 1;

/// End of the name of the accuracy where a program gives cycles: the name before it is that of the wear.
pub const AROUND_CYCLES: &str = " around cycles of a program";

/// Result of a study.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct StudySummary {
    /// Version of the form of the file; 0 in studies by earlier versions.
    pub schema: u32,
    /// Date and time of the start of the study, UTC, as `2026-01-31T12:00:00.000Z`; empty in studies by earlier versions.
    pub created: String,
    /// SHA-256 of the text of the scene, as in `scene.toml`, in hexadecimal digits; empty in studies by earlier versions.
    pub scene_sha256: String,
    /// Name of the scene.
    pub scene: String,
    /// Version of the program.
    pub version: String,
    /// Seed of every random draw.
    pub seed: u64,
    /// Name of the method: `ak`, `monte-carlo` or `latin-hypercube`.
    pub method: String,
    /// Name of the accuracy: a preset, or a preset with changed parameters.
    pub accuracy: String,
    /// All parameters of the accuracy; absent for an external simulator.
    pub accuracy_settings: Option<Accuracy>,
    /// Error budget of the accuracy as a share of the limits [1]; absent if the accuracy was given by name.
    pub max_error: Option<f64>,
    /// Finer levels of accuracy and the differences that pairs of simulations showed; absent without any, and in studies by earlier versions.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub levels: Option<LevelsRow>,
    /// Variants of the model; empty without any.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub variants: Vec<VariantRow>,
    /// Size of the final Monte Carlo population.
    pub population: usize,
    /// Condition of that population, if failures were too rare for an unconditional one.
    pub conditional: Option<ConditionRow>,
    /// Numbers of evaluations.
    pub evaluations: EvaluationCounts,
    /// Keys of the design variables: the curves are then those over their ranges and the random variables together. Empty for
    /// a study of one design.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub designs: Vec<String>,
    /// Names of the limit states, in the scene's order.
    pub limit_states: Vec<String>,
    /// Limit states with their thresholds, in the same order; empty in studies by earlier versions.
    pub limits: Vec<LimitRow>,
    /// Random variables, in the scene's order; empty in studies by earlier versions.
    pub variables: Vec<VariableRow>,
    /// Units of the random variables and outputs; empty in studies by earlier versions.
    pub units: Vec<UnitRow>,
    /// Reliabilities, one row per checkpoint.
    pub reliability: Vec<ReliabilityRow>,
    /// Lives at the usual levels of reliability, per limit state and in total; empty with a single checkpoint and in studies by
    /// earlier versions.
    pub lives: Vec<LifeRow>,
    /// Reliability between the checkpoints, per limit state and in total, from which the lives are read; empty where `lives` is.
    pub curves: Vec<LifeCurveRow>,
    /// The interval that contains too much of the fall of R for its checkpoints, if there is one.
    pub unresolved_fall: Option<UnresolvedFall>,
    /// Outputs of the motion of the nominal mechanism with more control points; empty where that was not compared.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub control_points: Vec<ControlPointsRow>,
    /// First failures, one row per checkpoint; empty in studies by earlier versions.
    pub first_failure: Vec<FirstFailureRow>,
    /// Simulations without a result.
    pub failures: Failures,
    /// Simulations that exceeded a limit within the life studied, of those that the surrogates use; absent with direct simulation
    /// and in studies by earlier versions.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub simulations_beyond_a_limit: Option<usize>,
    /// Outliers whose samples were evaluated again; absent without any.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub outliers: Vec<OutlierRow>,
    /// Failure probabilities that no simulation has tested.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub untested: Option<UntestedRow>,
    /// Share of the population in the largest ball around one of its points without a simulation [1], where a region of failures apart from
    /// all others could lie unseen; absent with direct simulation and in studies by earlier versions.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub largest_gap: Option<f64>,
    /// Moments of the outputs, one row per checkpoint.
    pub moments: Vec<MomentsRow>,
    /// Derivatives of the failure probabilities.
    pub sensitivity: Vec<SensitivityRow>,
    /// Sobol indices of the limit states' outputs; none with direct simulation.
    pub sobol: Vec<SobolRow>,
    /// Most probable failures, one row per limit state with failures; empty in studies by earlier versions.
    pub failure_points: Vec<FailurePointRow>,
    /// Rounds of learning and the reason of the stop.
    pub convergence: Convergence,
    /// Surrogates at the end; empty with direct simulation.
    pub surrogates: Vec<SurrogateRow>,
    /// Predictions of the surrogates for their own simulations, one row per limit state; empty with direct simulation and in
    /// studies by earlier versions.
    pub predictions: Vec<PredictionRow>,
    /// Times of the study, over all its runs.
    pub timing_s: Timing,
    /// Contributions of the workers.
    pub workers: Vec<WorkerShare>,
    /// Jobs of a batch system; absent where the last run asked for none.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub scale: Option<ScaleRow>,
}

impl StudySummary {
    /// Sets what identifies the study: its scene, the text of the scene, and the time when the study began.
    pub fn identify(&mut self, scene: &Scene, source: &str, created: &str) {
        self.schema = SCHEMA;
        created.clone_into(&mut self.created);
        self.scene_sha256 = sha256(source);
        self.limits = limit_rows(scene);
        self.variables = variable_rows(scene);
        self.units = unit_rows(scene);
    }

    /// Points of an unconditional population that counts rare failures as finely.
    pub fn unconditional_points(&self) -> usize {
        let share = self.conditional.as_ref().map_or(1.0, |condition| condition.probability);
        (self.population as f64 / share) as usize
    }

    /// True for a mechanism, false for a scene that names its own simulator.
    pub fn of_mechanism(&self) -> bool {
        self.accuracy_settings.is_some()
    }

    /// True for cycles of a program, around which the study computes the wear.
    pub fn of_cycles(&self) -> bool {
        self.accuracy.ends_with(AROUND_CYCLES)
    }

    /// Noun for one sample of the study.
    pub fn subject(&self) -> &'static str {
        if self.of_mechanism() { "mechanism" } else { "system" }
    }

    /// Names of the curves that differ: the limit states in their order, then the system if there are several.
    pub fn curve_names(&self) -> impl Iterator<Item = &str> {
        let total = (self.limit_states.len() != 1).then_some("total");
        self.limit_states.iter().map(String::as_str).chain(total)
    }

    /// True if every sample was simulated, without surrogates.
    pub fn is_direct(&self) -> bool {
        matches!(self.method.as_str(), "monte-carlo" | "latin-hypercube")
    }

    /// True if the study has a single checkpoint.
    pub fn is_static(&self) -> bool {
        self.reliability.len() == 1
    }
}

/// Intermediate event of a subset simulation.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct ConditionRow {
    /// Probability of the condition [1].
    pub probability: f64,
    /// Coefficient of variation of `probability` [1].
    pub coefficient_of_variation: f64,
    /// Number of levels of the subset simulation.
    pub levels: usize,
}

/// Sobol indices of one limit state's output for one variable.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct SobolRow {
    /// Checkpoint of life [cycles].
    pub cycles: u32,
    /// Name of the limit state.
    pub limit_state: String,
    /// Name of the variable.
    pub variable: String,
    /// Share of the variance that knowledge of this variable would remove [1].
    pub first_order: f64,
    /// Share of the variance that would remain if all other variables were known [1].
    pub total: f64,
    /// Standard errors of the two indices.
    pub standard_error: SobolError,
}

/// Standard errors of the two Sobol indices.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct SobolError {
    /// Standard error of `first_order` [1].
    pub first_order: f64,
    /// Standard error of `total` [1].
    pub total: f64,
}

/// First failures by one checkpoint, as shares of all samples; they add up to the failure probability of the system.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct FirstFailureRow {
    /// Checkpoint of life [cycles].
    pub cycles: u32,
    /// Share in which several limit states were reached at the same life, interpolated between checkpoints [1].
    pub together: f64,
    /// Share in which each limit state was reached first [1].
    pub first: PerLimitState,
}

/// Simulations without a result, also when repeated at a stricter accuracy.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Failures {
    /// Estimated share of the population where a simulation is more likely to fail than not [1]; with direct
    /// simulation the share of the samples without a result.
    pub barred_share: f64,
    /// The failed simulations.
    pub simulations: Vec<FailureRow>,
}

/// A simulation that failed.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct FailureRow {
    /// Reason of the failure.
    pub cause: String,
    /// Values of the random variables, in SI units.
    pub sample: BTreeMap<String, f64>,
}

/// Mean and standard deviation of the outputs at one checkpoint.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct MomentsRow {
    /// Checkpoint of life [cycles].
    pub cycles: u32,
    /// Mean and standard deviation of each limit state's output over the population, e.g. `wear_mean_m`.
    #[serde(flatten)]
    pub moments: BTreeMap<String, f64>,
}

/// Numbers of evaluations of a study.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct EvaluationCounts {
    /// Number of all evaluations.
    pub total: usize,
    /// Evaluations of the initial design.
    pub initial: usize,
    /// Evaluations added by learning; with direct simulation the samples.
    pub added: usize,
    /// Evaluations without a result.
    pub failed: usize,
}

/// Derivative of the probability of failure of one limit state with respect to one variable's parameters.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct SensitivityRow {
    /// Checkpoint of life [cycles].
    pub cycles: u32,
    /// Name of the limit state, or `total`.
    pub limit_state: String,
    /// Name of the variable.
    pub variable: String,
    /// dPf / dmean [1/unit of the variable, SI].
    pub d_pf_d_mean: f64,
    /// dPf / dstd [1/unit of the variable, SI].
    pub d_pf_d_std: f64,
    /// Standard errors of the two derivatives.
    pub standard_error: SensitivityError,
    /// Derivatives times the standard deviation of the variable, comparable between variables [1].
    pub scaled: SensitivityError,
}

impl SensitivityRow {
    /// False where the failure probability is 0 or 1: no derivative is known there.
    pub fn is_known(&self) -> bool {
        self.d_pf_d_mean != 0.0 || self.d_pf_d_std != 0.0
    }

    /// Magnitude of the larger scaled derivative [1].
    pub fn strength(&self) -> f64 {
        self.scaled.d_pf_d_mean.abs().max(self.scaled.d_pf_d_std.abs())
    }

    /// Standard errors of the scaled derivatives to the mean and to the standard deviation [1]; zero for a derivative of zero.
    pub fn scaled_errors(&self) -> [f64; 2] {
        let scaled = |derivative: f64, scaled: f64, error: f64| {
            if derivative == 0.0 { 0.0 } else { (scaled / derivative * error).abs() }
        };
        [
            scaled(self.d_pf_d_mean, self.scaled.d_pf_d_mean, self.standard_error.d_pf_d_mean),
            scaled(self.d_pf_d_std, self.scaled.d_pf_d_std, self.standard_error.d_pf_d_std),
        ]
    }
}

/// Values for the derivatives to the mean and to the standard deviation.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct SensitivityError {
    /// Value for the derivative to the mean.
    pub d_pf_d_mean: f64,
    /// Value for the derivative to the standard deviation.
    pub d_pf_d_std: f64,
}

/// Rounds of learning and the reason of the stop.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Convergence {
    /// The rule that ended learning, in words.
    pub stopped_because: String,
    /// True if the targets were met; false if the budget was spent first, or too few failures were found.
    pub targets_met: bool,
    /// Budget for `resume --max-evaluations`, if the budget ended learning before its targets were met; absent otherwise,
    /// and in studies by earlier versions.
    pub larger_budget: Option<usize>,
    /// Rounds of learning, in their order.
    pub rounds: Vec<Round>,
}

/// One round of learning.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Round {
    /// Round, from 0 (after the initial design).
    pub round: usize,
    /// Number of evaluations so far.
    pub evaluations: usize,
    /// Smallest coupled learning function U_c over the population; 100 stands for 100 or more.
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

impl Convergence {
    /// The command that goes on with the study in the folder `dir`, if a larger budget would help.
    pub fn command_to_go_on(&self, dir: &Path) -> Option<String> {
        let budget = self.larger_budget?;
        Some(format!(
            "coordinator resume {} --max-evaluations {budget}",
            shell_word(&dir.display().to_string())
        ))
    }
}

/// A word as a shell takes it: in quotes if it has other characters than those of plain file names.
fn shell_word(word: &str) -> String {
    let plain = |c: char| c.is_alphanumeric() || "/._-+:@".contains(c);
    if !word.is_empty() && word.chars().all(plain) {
        return word.to_owned();
    }
    format!("'{}'", word.replace('\'', "'\\''"))
}

impl Round {
    /// Standard error of [`Round::reliability_total`]: of the surrogates (at most) and of counting.
    pub fn standard_error(&self) -> f64 {
        self.surrogate_error.hypot(self.cov_pf * (1.0 - self.reliability_total))
    }
}
