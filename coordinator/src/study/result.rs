//! The result of a study, from the findings of active learning or direct simulation.

use super::failure_points::failure_points;
use super::interim::InterimResult;
use super::lives::{learned_lives, life_findings};
use super::predictions::{predictions, simulations_beyond_a_limit};
use super::rows::{failures, first_failure, moments, sensitivity_row};
use super::sobol::sobol;
use super::stopped::{stop_in_words, targets_met};
use super::{CampaignResult, ClassifiedPopulation, Settings, StopReason, Surrogate};
use crate::results::point_summary::{FailurePointRow, PredictionRow};
use crate::results::scene_summary::{limit_rows, variable_rows};
use crate::results::summary::{
    ConditionRow, Convergence, EvaluationCounts, Failures, ReliabilityRange, ReliabilityRow, SCHEMA,
    SobolRow, StudySummary, SurrogateRow, Timing, WorkerShare,
};
use crate::statistics::reliability::{LifeCounts, NumericalBand, OutputDistribution, predict_distributions};
use crate::statistics::sensitivity::{Sampled, Sensitivity, sensitivities};
use crate::statistics::surrogate::{Correlation, LeaveOneOut, Sharing, Trend};
use common::scene::{LimitState, Output, Scene};

/// Result of a study.
#[derive(Debug, Clone, PartialEq)]
pub struct StudyResult {
    /// The summary, as written to `summary.json`.
    pub summary: StudySummary,
    /// Distributions over the population (from simulations alone with the Monte Carlo method), per output of the
    /// scene, in its order.
    pub distributions: Vec<OutputHistory>,
    /// The surrogates at the end, per limit state; empty with the Monte Carlo method.
    pub surrogates: Vec<SurrogateReport>,
}

/// Distribution of one output at every checkpoint.
#[derive(Debug, Clone, PartialEq)]
pub struct OutputHistory {
    /// Name of the output.
    pub output: String,
    /// Checkpoints `(m,)` [cycles].
    pub cycles: Vec<u32>,
    /// Distributions `(m,)`, in the output's SI unit.
    pub at: Vec<OutputDistribution>,
}

/// Surrogate of one limit state.
#[derive(Debug, Clone, PartialEq)]
pub struct SurrogateReport {
    /// Name of the limit state.
    pub limit_state: String,
    /// Correlation of the surrogate.
    pub correlation: Correlation,
    /// Trend of the surrogate.
    pub trend: Trend,
    /// Comparison of one correlation for all checkpoints with separate ones, if it was made.
    pub sharing: Option<Sharing>,
    /// Checkpoints whose likelihood determined the correlation lengths [cycles].
    pub cycles: Vec<u32>,
    /// Leave-one-out errors at these checkpoints.
    pub leave_one_out: Vec<LeaveOneOut>,
}

impl SurrogateReport {
    fn row(&self, surrogate: &Surrogate) -> SurrogateRow {
        SurrogateRow {
            limit_state: self.limit_state.clone(),
            q2: self.leave_one_out.iter().map(|l| l.q2).fold(1.0, f64::min),
            q2_cross_validated: surrogate.cross_validation.as_ref().map(|crossed| crossed.q2),
            variance_factor: Some(surrogate.inflation()),
            nugget: self.correlation.nugget,
            stated_noise: self.correlation.stated,
            kernel: self.correlation.kernel.name().to_owned(),
            trend: self.trend.name().to_owned(),
            different_values: surrogate.threshold.coarse,
            separate_would_gain: self.sharing.map(|sharing| sharing.separate_would_gain),
            share_of_stated_error: surrogate.share_of_stated,
            noise_share: Some(surrogate.noise_share),
            outlier: surrogate.outlier,
        }
    }
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
    /// Most probable failures per limit state.
    pub failure_points: Vec<FailurePointRow>,
    /// Simulations without a result.
    pub failures: Failures,
    /// Counts of evaluations.
    pub evaluations: EvaluationCounts,
    /// Rounds and the reason of the stop.
    pub convergence: Convergence,
    /// Findings of the learner; empty with direct simulation.
    pub learner: LearnerFindings,
}

/// Findings that only active learning has.
#[derive(Default)]
pub(super) struct LearnerFindings {
    /// Simulations that exceeded a limit.
    exceeding: Option<usize>,
    sobol: Vec<SobolRow>,
    predictions: Vec<PredictionRow>,
    surrogates: Vec<SurrogateReport>,
    /// Rows of the summary, in the order of `surrogates`.
    rows: Vec<SurrogateRow>,
}

/// Names of the curves: the limit states, in the scene's order, and the system.
pub(super) fn curve_names(scene: &Scene) -> Vec<String> {
    let limits = scene.limit_states.iter().map(|limit| limit.name.clone());
    limits.chain(["total".to_owned()]).collect()
}

/// The summary of a study without results: what scene and settings determine.
pub fn blank(scene: &Scene, settings: &Settings) -> StudySummary {
    let mechanism = scene.simulator.is_none();
    StudySummary {
        schema: SCHEMA,
        created: String::new(),
        scene_sha256: String::new(),
        scene: scene.name.clone(),
        version: env!("CARGO_PKG_VERSION").to_owned(),
        seed: settings.seed,
        method: settings.method.name().to_owned(),
        accuracy: if mechanism {
            settings.accuracy.setting.name.clone()
        } else {
            "the simulator's own".to_owned()
        },
        accuracy_settings: mechanism.then_some(settings.accuracy.setting.accuracy),
        max_error: settings.accuracy.max_error,
        population: 0,
        evaluations: EvaluationCounts::default(),
        designs: Vec::new(),
        limit_states: scene.limit_states.iter().map(|limit| limit.name.clone()).collect(),
        limits: limit_rows(scene),
        variables: variable_rows(scene),
        reliability: Vec::new(),
        lives: Vec::new(),
        curves: Vec::new(),
        unresolved_fall: None,
        control_points: Vec::new(),
        first_failure: Vec::new(),
        failures: Failures::default(),
        simulations_beyond_a_limit: None,
        untested: None,
        conditional: None,
        sobol: Vec::new(),
        moments: Vec::new(),
        sensitivity: Vec::new(),
        failure_points: Vec::new(),
        predictions: Vec::new(),
        convergence: Convergence::default(),
        surrogates: Vec::new(),
        timing_s: Timing::default(),
        workers: Vec::new(),
    }
}

/// What is computed from a campaign.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Computed {
    /// Everything that a summary contains.
    Whole,
    /// Reliability, lives and first failures.
    Curves,
}

/// The findings of active learning.
pub(super) fn from_learning(
    scene: &Scene,
    settings: &Settings,
    learned: &CampaignResult,
    extent: Computed,
) -> Findings {
    let is_whole = extent == Computed::Whole;
    let assessment = &learned.assessment;
    let ClassifiedPopulation { population, condition, .. } = &learned.classified;
    let m = scene.life.checkpoints().len();
    let first_failures = assessment.first_failures();
    let points: Vec<usize> = (0..population.len()).collect();
    let sampled = Sampled { population, points: &points, probability: condition.probability };
    Findings {
        shares: learned.shares(),
        lives: learned_lives(scene, learned),
        distributions: if is_whole { output_distributions(scene, learned) } else { vec![] },
        derivatives: if is_whole {
            sensitivities(&sampled, &first_failures, &assessment.grid, m)
        } else {
            vec![]
        },
        failure_points: if is_whole {
            failure_points(scene, &sampled, &first_failures[..scene.limit_states.len()])
        } else {
            vec![]
        },
        failures: failures(scene, learned),
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
        learner: learner_findings(scene, learned, extent),
    }
}

fn learner_findings(scene: &Scene, learned: &CampaignResult, extent: Computed) -> LearnerFindings {
    let cycles = scene.life.checkpoints();
    let fitted = &learned.assessment.surrogates;
    let report = |(limit, surrogate): (&LimitState, &Surrogate)| SurrogateReport {
        limit_state: limit.name.clone(),
        correlation: surrogate.model.correlation().clone(),
        trend: surrogate.model.trend(),
        sharing: surrogate.sharing,
        cycles: surrogate.fitted_on.iter().map(|n| cycles[*n]).collect(),
        leave_one_out: surrogate.leave_one_out.clone(),
    };
    let surrogates: Vec<SurrogateReport> = scene.limit_states.iter().zip(fitted).map(report).collect();
    LearnerFindings {
        exceeding: Some(simulations_beyond_a_limit(scene, learned)),
        sobol: if extent == Computed::Whole { sobol(scene, learned) } else { vec![] },
        predictions: if extent == Computed::Whole { predictions(scene, learned) } else { vec![] },
        rows: surrogates.iter().zip(fitted).map(|(report, surrogate)| report.row(surrogate)).collect(),
        surrogates,
    }
}

/// Distributions of the outputs themselves (not their running maxima), with the lengths of the first limit state that
/// watches each; an output no limit state watches uses those of the first limit state.
fn output_distributions(scene: &Scene, learned: &CampaignResult) -> Vec<Vec<OutputDistribution>> {
    (0..scene.outputs.len())
        .map(|output| {
            let mode = scene.limit_states.iter().position(|limit| limit.output == output).unwrap_or(0);
            let mut model = learned.assessment.surrogates[mode].model.clone();
            model.set_values(learned.observations.values(output).as_ref());
            predict_distributions(&model, learned.classified.unconditional())
        })
        .collect()
}

impl Findings {
    /// The result of the study; `timing` and `workers` are what it cost.
    pub fn result(
        self,
        scene: &Scene,
        settings: &Settings,
        timing: Timing,
        workers: Vec<WorkerShare>,
    ) -> StudyResult {
        let cycles = scene.life.checkpoints();
        let names = curve_names(scene);
        let limits = &names[..scene.limit_states.len()];
        let condition = &self.shares.condition;
        let first_failures = self.lives.first_failure_shares();
        let first_failure =
            |(n, cycles): (usize, &u32)| first_failure(limits, &first_failures, condition, *cycles, n);
        let numerical = self.lives.numerical_band();
        let states_errors = scene.simulator.is_none() || numerical.most != numerical.least;
        let life = life_findings(&self.lives, &self.shares, &names, &cycles, states_errors);
        let has_moments = !self.distributions.is_empty();
        let moments = |(n, cycles): (usize, &u32)| moments(scene, &self.distributions, *cycles, n);
        let summary = StudySummary {
            population: self.shares.points,
            conditional: (condition.levels > 0).then_some(ConditionRow {
                probability: condition.probability,
                coefficient_of_variation: condition.cov,
                levels: condition.levels,
            }),
            evaluations: self.evaluations,
            reliability: self.reliability(states_errors.then_some(&numerical), &names, &cycles),
            lives: life.lives,
            curves: life.curves,
            unresolved_fall: life.unresolved,
            first_failure: cycles.iter().enumerate().map(first_failure).collect(),
            failures: self.failures,
            simulations_beyond_a_limit: self.learner.exceeding,
            untested: self.shares.untested_row(&names),
            moments: cycles.iter().enumerate().filter(|_| has_moments).map(moments).collect(),
            sensitivity: self
                .derivatives
                .iter()
                .map(|row| sensitivity_row(scene, &names, &cycles, row))
                .collect(),
            sobol: self.learner.sobol,
            failure_points: self.failure_points,
            predictions: self.learner.predictions,
            convergence: self.convergence,
            surrogates: self.learner.rows,
            timing_s: timing,
            workers,
            ..blank(scene, settings)
        };
        let history = |(output, at): (&Output, Vec<OutputDistribution>)| OutputHistory {
            output: output.name.clone(),
            cycles: cycles.clone(),
            at,
        };
        StudyResult {
            summary,
            distributions: scene.outputs.iter().zip(self.distributions).map(history).collect(),
            surrogates: self.learner.surrogates,
        }
    }

    /// R(n) of every curve, with its range under numerical errors unless the simulator states none.
    fn reliability(
        &self,
        numerical: Option<&NumericalBand>,
        names: &[String],
        cycles: &[u32],
    ) -> Vec<ReliabilityRow> {
        let mut rows = self.shares.rows(names, cycles);
        if let Some(numerical) = numerical {
            let probability = self.shares.condition.probability;
            for (n, row) in rows.iter_mut().enumerate() {
                let range = |c: usize| ReliabilityRange {
                    lower: 1.0 - probability * numerical.most[c][n],
                    upper: 1.0 - probability * numerical.least[c][n],
                };
                row.numerical = names.iter().enumerate().map(|(c, name)| (name.clone(), range(c))).collect();
            }
        }
        rows
    }
}
