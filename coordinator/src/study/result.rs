//! The result of a study, from the findings of active learning or direct simulation.

use super::interim::InterimResult;
use super::lives::{add_lives, learned_lives};
use super::plan::ResponseLayout;
use super::stopped::{stop_in_words, targets_met};
use super::summary_rows::{failure_points, predictions, simulations_beyond_a_limit, sobol};
use super::{
    CampaignResult, ClassifiedPopulation, ExplicitModel, Failed, Outlier, Settings, StopReason, Surrogate,
};
use crate::results::scene_summary::{limit_rows, unit_rows, variable_rows};
use crate::results::summary::{
    AROUND_CYCLES, ConditionRow, Convergence, EvaluationCounts, FailureRow, Failures, FirstFailureRow,
    MomentsRow, ReliabilityRange, ReliabilityRow, SCHEMA, SensitivityError, SensitivityRow, StudySummary,
    SurrogateRow, Timing, WorkerShare,
};
use crate::statistics::design::InputModel;
use crate::statistics::reliability::{LifeCounts, OutputDistribution, predict_distributions};
use crate::statistics::sensitivity::{Sampled, Sensitivity, sensitivities};
use crate::statistics::surrogate::ResponseScale;
use common::scene::{LimitState, Scene};
use std::collections::BTreeMap;

/// Result of a study.
#[derive(Debug, Clone, PartialEq)]
pub struct StudyResult {
    /// The summary, as written to `summary.json`.
    pub summary: StudySummary,
    /// Distributions over the population (from simulations alone with the Monte Carlo method), per output of the
    /// scene, in its order, and checkpoint `(outputs)(m,)`, in the output's SI unit; empty if they are not computed.
    pub distributions: Vec<Vec<OutputDistribution>>,
    /// The surrogates as plain numbers; `None` without any.
    pub explicit: Option<ExplicitModel>,
}

/// Findings of a study, from which [`Findings::result`] makes its result.
pub(super) struct Findings {
    /// Failure shares and their errors.
    pub shares: InterimResult,
    /// Lives of the population.
    pub lives: LifeCounts,
    /// Distributions of the outputs at every checkpoint `(outputs)(m,)`; empty if they are not computed.
    pub distributions: Vec<Vec<OutputDistribution>>,
    /// Derivatives of the failure probabilities.
    pub derivatives: Vec<Sensitivity>,
    /// The surrogates as plain numbers.
    pub explicit: Option<ExplicitModel>,
    /// What needs none of these: most probable failures, simulations without a result, counts, convergence, and what only
    /// active learning has.
    pub summary: StudySummary,
}

/// Names of the curves: the limit states, in the scene's order, and the system.
pub(super) fn curve_names(scene: &Scene) -> Vec<String> {
    scene.limit_states.iter().map(|limit| limit.name.clone()).chain(["total".to_owned()]).collect()
}

/// The summary of a study without results: what scene and settings determine.
pub fn blank(scene: &Scene, settings: &Settings) -> StudySummary {
    let mechanism = scene.simulator.is_none();
    StudySummary {
        schema: SCHEMA,
        scene: scene.name.clone(),
        version: concat!(env!("CARGO_PKG_VERSION"), env!("HINGEWISE_COMMIT")).to_owned(),
        seed: settings.seed,
        method: settings.method.name().to_owned(),
        accuracy: match &scene.simulator {
            None => settings.accuracy.setting.name.clone(),
            Some(simulator) if simulator.cycles.is_some() => scene.accuracy.name.clone() + AROUND_CYCLES,
            Some(_) => "the simulator's own".to_owned(),
        },
        accuracy_settings: mechanism.then_some(settings.accuracy.setting.accuracy),
        max_error: settings.accuracy.max_error,
        limit_states: scene.limit_states.iter().map(|limit| limit.name.clone()).collect(),
        limits: limit_rows(scene),
        variables: variable_rows(scene),
        units: unit_rows(scene),
        ..StudySummary::default()
    }
}

/// The findings of active learning as far as reliability, lives and first failures need them.
pub(super) fn curves_from_learning(scene: &Scene, settings: &Settings, learned: &CampaignResult) -> Findings {
    let inputs = &learned.classified.population.inputs;
    let surrogates = scene.limit_states.iter().zip(&learned.assessment.surrogates);
    let outlier = |outlier: &Outlier| outlier.row(scene, scene.simulator.is_none());
    let summary = StudySummary {
        failures: failures(scene, inputs, &learned.failed, learned.shares.missing),
        evaluations: EvaluationCounts {
            total: learned.evaluations,
            initial: settings.initial.min(learned.evaluations),
            added: learned.evaluations.saturating_sub(settings.initial),
            failed: learned.failed.len(),
        },
        convergence: Convergence {
            stopped_because: stop_in_words(scene, learned, settings),
            targets_met: targets_met(learned, settings),
            larger_budget: matches!(learned.stop, StopReason::Budget).then_some(2 * settings.max_evaluations),
            rounds: learned.rounds.clone(),
        },
        simulations_beyond_a_limit: Some(simulations_beyond_a_limit(scene, learned)),
        surrogates: surrogates.map(surrogate_row).collect(),
        outliers: learned.outliers.iter().map(outlier).collect(),
        ..blank(scene, settings)
    };
    Findings {
        shares: learned.shares.clone(),
        lives: learned_lives(&ResponseLayout::from_scene(scene).modes, &scene.life.checkpoints(), learned),
        distributions: vec![],
        derivatives: vec![],
        explicit: None,
        summary,
    }
}

/// The findings of active learning, everything that a summary contains.
pub(super) fn from_learning(scene: &Scene, settings: &Settings, learned: &CampaignResult) -> Findings {
    let curves = curves_from_learning(scene, settings, learned);
    let assessment = &learned.assessment;
    let ClassifiedPopulation { population, condition, .. } = &learned.classified;
    let first_failures = assessment.first_failures();
    let points: Vec<usize> = (0..population.len()).collect();
    let sampled = Sampled { population, points: &points, probability: condition.probability };
    let m = scene.life.checkpoints().len();
    Findings {
        distributions: output_distributions(scene, learned),
        derivatives: sensitivities(&sampled, &first_failures, &assessment.grid, m),
        explicit: Some(ExplicitModel::new(scene, learned)),
        summary: StudySummary {
            failure_points: failure_points(scene, &sampled, &first_failures[..scene.limit_states.len()]),
            sobol: sobol(scene, learned),
            largest_gap: Some(learned.largest_gap()),
            predictions: predictions(scene, learned),
            ..curves.summary
        },
        ..curves
    }
}

fn surrogate_row((limit, surrogate): (&LimitState, &Surrogate)) -> SurrogateRow {
    let correlation = &surrogate.model.correlation;
    SurrogateRow {
        limit_state: limit.name.clone(),
        q2: surrogate.leave_one_out.iter().map(|l| l.q2).fold(1.0, f64::min),
        q2_cross_validated: surrogate.cross_validation.as_ref().map(|crossed| crossed.q2),
        variance_factor: Some(surrogate.inflation()),
        nugget: correlation.nugget,
        stated_noise: correlation.stated,
        kernel: correlation.kernel.name().to_owned(),
        trend: surrogate.model.trend().name().to_owned(),
        different_values: surrogate.threshold.coarse,
        separate_would_gain: surrogate.separate_would_gain,
        share_of_stated_error: surrogate.share_of_stated,
        noise_share: Some(surrogate.noise_share),
        outlier: surrogate.outlier(),
        logarithms: surrogate.scale == ResponseScale::Logarithms,
    }
}

/// Distributions of the outputs themselves (not their running maxima), with the lengths of the first limit state that
/// watches each; an output no limit state watches uses those of the first limit state.
fn output_distributions(scene: &Scene, learned: &CampaignResult) -> Vec<Vec<OutputDistribution>> {
    let of_output = |output: usize| {
        let mode = scene.limit_states.iter().position(|limit| limit.output == output).unwrap_or(0);
        let surrogate = &learned.assessment.surrogates[mode];
        let values = learned.observations.design_of(mode).values(output);
        let (mut model, scale) = (surrogate.model.clone(), surrogate.scale_of(&values));
        model.set_values(scale.learned_values(&values).as_ref());
        predict_distributions(&model, scale, learned.classified.unconditional())
    };
    (0..scene.outputs.len()).map(of_output).collect()
}

impl Findings {
    /// The result of the study; `timing` and `workers` are what it cost.
    pub fn result(self, scene: &Scene, timing: Timing, workers: Vec<WorkerShare>) -> StudyResult {
        let cycles = scene.life.checkpoints();
        let names = curve_names(scene);
        let limits = &names[..scene.limit_states.len()];
        let condition = &self.shares.condition;
        let first_failures = self.lives.first_failure_shares();
        let first_failure = |(n, cycles): (usize, &u32)| {
            let share = |curve: &Vec<f64>| condition.probability * curve[n];
            let first = limits.iter().cloned().zip(first_failures.iter().map(share)).collect();
            FirstFailureRow { cycles: *cycles, together: share(&first_failures[limits.len()]), first }
        };
        let has_moments = !self.distributions.is_empty();
        let moments = |(n, cycles): (usize, &u32)| moments(scene, &self.distributions, *cycles, n);
        let derivatives = self.derivatives.iter();
        let mut summary = StudySummary {
            population: self.shares.points,
            conditional: (condition.levels > 0).then_some(ConditionRow {
                probability: condition.probability,
                coefficient_of_variation: condition.cov,
                levels: condition.levels,
            }),
            reliability: self.reliability(&names, &cycles),
            first_failure: cycles.iter().enumerate().map(first_failure).collect(),
            untested: self.shares.untested_row(&names),
            moments: cycles.iter().enumerate().filter(|_| has_moments).map(moments).collect(),
            sensitivity: derivatives.map(|row| sensitivity_row(scene, &names, &cycles, row)).collect(),
            timing_s: timing,
            workers,
            ..self.summary
        };
        add_lives(&mut summary, &self.lives, &self.shares, &names, &cycles);
        StudyResult { summary, distributions: self.distributions, explicit: self.explicit }
    }

    /// R(n) of every curve with its interval, the numerical error included.
    fn reliability(&self, names: &[String], cycles: &[u32]) -> Vec<ReliabilityRow> {
        let (mut rows, [least, most]) = (self.shares.rows(names, cycles), self.lives.numerical_band());
        let probability = self.shares.condition.probability;
        for (n, row) in rows.iter_mut().enumerate() {
            for (c, name) in names.iter().enumerate() {
                let [lower, upper] = [&most, &least].map(|all| 1.0 - probability * all[c][n]);
                row.add_numerical(name, ReliabilityRange { lower, upper });
            }
        }
        rows
    }
}

/// The failed simulations with their causes and samples, and the share of the population they represent.
pub(super) fn failures(scene: &Scene, inputs: &InputModel, failed: &[Failed], barred_share: f64) -> Failures {
    let sample = |z: &[f64]| -> BTreeMap<String, f64> {
        let values = inputs.to_physical(z);
        scene.variables.iter().zip(values).map(|(variable, x)| (variable.name.clone(), x)).collect()
    };
    let row = |failed: &Failed| FailureRow { cause: failed.cause.to_string(), sample: sample(&failed.z) };
    Failures { barred_share, simulations: failed.iter().map(row).collect() }
}

/// Moments at one checkpoint: `{limit state}_mean_m` and `_std_m`, or `_rpm` for angular velocities; one that is too large for a
/// number is left out.
fn moments(scene: &Scene, distributions: &[Vec<OutputDistribution>], cycles: u32, n: usize) -> MomentsRow {
    let mut row = BTreeMap::new();
    for limit in &scene.limit_states {
        let unit = scene.outputs[limit.output].kind.unit();
        let at = &distributions[limit.output][n];
        for (name, value) in [("mean", at.mean), ("std", at.std)] {
            let value = unit.to_file(value);
            if value.is_finite() {
                row.insert(unit.key(&format!("{}_{name}", limit.name)), value);
            }
        }
    }
    MomentsRow { cycles, moments: row }
}

/// A derivative in the names of the scene.
fn sensitivity_row(scene: &Scene, curves: &[String], cycles: &[u32], row: &Sensitivity) -> SensitivityRow {
    let variable = &scene.variables[row.variable];
    let std = variable.distribution.parent_std();
    SensitivityRow {
        cycles: cycles[row.checkpoint],
        limit_state: curves[row.curve].clone(),
        variable: variable.name.clone(),
        d_pf_d_mean: row.to_mean.value,
        d_pf_d_std: row.to_std.value,
        standard_error: SensitivityError {
            d_pf_d_mean: row.to_mean.standard_error,
            d_pf_d_std: row.to_std.standard_error,
        },
        scaled: SensitivityError { d_pf_d_mean: row.to_mean.value * std, d_pf_d_std: row.to_std.value * std },
    }
}
