//! From what was learned to what is reported.

use super::responses::Responses;
use super::rows::{failures, first_failure, sobol};
use super::so_far::SoFar;
use super::{Learned, LookedAt, Settings, Stop, Surrogate};
use crate::results::output_unit::OutputUnit;
use crate::results::summary::{
    ConditionRow, Convergence, EvaluationCounts, Failures, MomentsRow, NumericalRange, SensitivityError,
    SensitivityRow, StudySummary, SurrogateRow, Timing,
};
use crate::statistics::learning::Rule;
use crate::statistics::reliability::{
    NumericalBand, OutputDistribution, killers, predict_distributions, shift_population,
};
use crate::statistics::sensitivity::{Sampled, Sensitivity, sensitivities};
use crate::statistics::surrogate::{Correlation, LeaveOneOut, Sharing, Trend};
use common::scene::Scene;
use std::collections::BTreeMap;

/// Everything a study found.
#[derive(Debug, Clone, PartialEq)]
pub struct StudyResult {
    /// As written to `summary.json`.
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

/// One limit state's surrogate.
#[derive(Debug, Clone, PartialEq)]
pub struct SurrogateReport {
    /// Name of the limit state.
    pub limit_state: String,
    /// Its correlation.
    pub correlation: Correlation,
    /// Its trend.
    pub trend: Trend,
    /// Whether checkpoints are as well served by one correlation as by separate ones, where that was compared.
    pub sharing: Option<Sharing>,
    /// Checkpoints whose likelihood set the lengths [cycles].
    pub cycles: Vec<u32>,
    /// Leave-one-out figures at those.
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
            separate_would_gain: self.sharing.map(|sharing| sharing.separate_would_gain),
            share_of_stated_error: surrogate.share_of_stated,
            noise_share: Some(surrogate.noise_share),
        }
    }
}

/// Failure shares, how far they can be trusted, and what they are under numerical errors.
pub(super) struct Curves<'a> {
    pub so_far: SoFar,
    /// The failure shares under numerical errors.
    pub numerical: &'a NumericalBand,
}

/// Names of the curves: the limit states, in the scene's order, and the system.
pub(super) fn curve_names(scene: &Scene) -> Vec<String> {
    let limits = scene.limit_states.iter().map(|limit| limit.name.clone());
    limits.chain(["total".to_owned()]).collect()
}

/// The summary of a study that has found nothing yet.
pub fn blank(scene: &Scene, settings: &Settings) -> StudySummary {
    let mechanism = scene.simulator.is_none();
    StudySummary {
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
        limit_states: scene.limit_states.iter().map(|limit| limit.name.clone()).collect(),
        reliability: Vec::new(),
        first_failure: Vec::new(),
        failures: Failures::default(),
        conditional: None,
        sobol: Vec::new(),
        moments: Vec::new(),
        sensitivity: Vec::new(),
        convergence: Convergence::default(),
        surrogates: Vec::new(),
        timing_s: Timing::default(),
        workers: Vec::new(),
    }
}

/// The result of active learning.
pub(super) fn from_learning(scene: &Scene, settings: &Settings, learned: &Learned) -> StudyResult {
    let assessment = &learned.assessment;
    let LookedAt { population, condition, .. } = &learned.looked_at;
    let m = scene.life.checkpoints().len();
    let numerical = numerical_band(scene, learned);
    let so_far = SoFar {
        failed: assessment.curves.clone(),
        points: population.len(),
        surrogate: assessment.combined_errors(),
        condition: *condition,
    };
    let curves = Curves { so_far, numerical: &numerical };

    // Derivatives of the modes and of the system, whose first failure is the earliest of the modes'.
    let mut first_failures: Vec<Vec<u32>> =
        assessment.modes.iter().map(|mode| mode.first_failure.clone()).collect();
    let earliest = |j: usize| first_failures.iter().map(|first| first[j]).min().unwrap_or(m as u32);
    let system = (0..population.len()).map(earliest).collect();
    first_failures.push(system);
    let points: Vec<usize> = (0..population.len()).collect();
    let sampled = Sampled { population, points: &points, probability: condition.probability };
    let rows = sensitivities(&sampled, &first_failures, &assessment.grid, m);

    let counts = EvaluationCounts {
        total: learned.evaluations,
        initial: settings.initial.min(learned.evaluations),
        added: learned.evaluations.saturating_sub(settings.initial),
        failed: learned.failed.len(),
    };
    let convergence = Convergence {
        stopped_because: stop_in_words(learned, settings),
        targets_met: targets_met(learned, settings),
        rounds: learned.rounds.clone(),
    };
    let distributions = output_distributions(scene, learned);
    let modes: Vec<&[u32]> = first_failures[..scene.limit_states.len()].iter().map(Vec::as_slice).collect();
    let shares = killers(&modes, m);
    let mut result = assemble(scene, settings, curves, distributions, &rows, &shares, counts, convergence);
    result.summary.failures = failures(scene, learned);
    result.summary.population = population.len();
    result.summary.conditional = (condition.levels > 0).then_some(ConditionRow {
        probability: condition.probability,
        coefficient_of_variation: condition.cov,
        levels: condition.levels,
    });
    result.summary.sobol = sobol(scene, learned);
    let cycles = scene.life.checkpoints();
    result.surrogates = scene
        .limit_states
        .iter()
        .zip(&assessment.surrogates)
        .map(|(limit, surrogate)| SurrogateReport {
            limit_state: limit.name.clone(),
            correlation: surrogate.model.correlation().clone(),
            trend: surrogate.model.trend(),
            sharing: surrogate.sharing,
            cycles: surrogate.fitted_on.iter().map(|n| cycles[*n]).collect(),
            leave_one_out: surrogate.leave_one_out.clone(),
        })
        .collect();
    result.summary.surrogates = result
        .surrogates
        .iter()
        .zip(&assessment.surrogates)
        .map(|(report, surrogate)| report.row(surrogate))
        .collect();
    result
}

/// The failure shares with the population's responses moved by the stated errors.
fn numerical_band(scene: &Scene, learned: &Learned) -> NumericalBand {
    let shifted: Vec<_> = Responses::of(scene)
        .modes
        .iter()
        .zip(&learned.assessment.surrogates)
        .map(|(mode, surrogate)| {
            let values = learned.observations.running_maxima(mode.output);
            let errors = learned.observations.errors_of_running_maxima(mode.output);
            let (values, errors) = (values.as_ref(), errors.as_ref());
            shift_population(&surrogate.model, &learned.looked_at.population, values, errors, mode.threshold)
        })
        .collect();
    NumericalBand::count(&shifted, scene.life.checkpoints().len())
}

/// Distributions of the outputs themselves (not their running maxima), with the lengths of the first limit state that
/// watches each; an output no limit state watches uses those of the first limit state.
fn output_distributions(scene: &Scene, learned: &Learned) -> Vec<Vec<OutputDistribution>> {
    (0..scene.outputs.len())
        .map(|output| {
            let mode = scene.limit_states.iter().position(|limit| limit.output == output).unwrap_or(0);
            let mut model = learned.assessment.surrogates[mode].model.clone();
            model.set_values(learned.observations.values(output).as_ref());
            predict_distributions(&model, learned.looked_at.unconditional())
        })
        .collect()
}

/// Whether learning ended by a rule and with failures enough for the coefficient of variation asked for.
fn targets_met(learned: &Learned, settings: &Settings) -> bool {
    let enough = learned.rounds.last().is_some_and(|round| round.cov_pf <= settings.targets().cov);
    enough && matches!(learned.stop, Stop::Rule(_))
}

fn stop_in_words(learned: &Learned, settings: &Settings) -> String {
    let targets = settings.targets();
    let figures = &learned.assessment.figures;
    let reason = match learned.stop {
        Stop::Rule(Rule::Learning) => format!(
            "every U_c >= {} and no curve changed by more than {} of the smaller of R and P_f, {} rounds and {} points running, after a fresh fit",
            targets.min_u, targets.relative_change, targets.hold, targets.hold_points
        ),
        Stop::Rule(Rule::Error) => format!(
            "the estimated surrogate error of every curve is below {} and no curve changed by more than {}, {} rounds and {} points running, after a fresh fit",
            targets.error, targets.change, targets.hold, targets.hold_points
        ),
        Stop::Budget => format!(
            "the budget of {} evaluations is spent; the estimated surrogate error is {:.2e} (target {})",
            settings.max_evaluations, figures.error, targets.error
        ),
    };
    let system = &learned.assessment.curves[learned.assessment.curves.len() - 1];
    let cov = learned.rounds.last().map_or(f64::INFINITY, |round| round.cov_pf);
    if system.iter().all(|failed| *failed == 0.0) {
        let points = learned.looked_at.population.len();
        format!("{reason}; no failure was found among {points} points of the population")
    } else if cov > targets.cov {
        format!("{reason}; the coefficient of variation of P_f is still {cov:.3} (target {})", targets.cov)
    } else {
        reason
    }
}

/// Puts the parts of a result together; time and workers are the caller's.
#[allow(clippy::too_many_arguments)] // the parts of one result
pub(super) fn assemble(
    scene: &Scene,
    settings: &Settings,
    curves: Curves<'_>,
    distributions: Vec<Vec<OutputDistribution>>,
    rows: &[Sensitivity],
    killers: &[Vec<f64>],
    evaluations: EvaluationCounts,
    convergence: Convergence,
) -> StudyResult {
    let cycles = scene.life.checkpoints();
    let names = curve_names(scene);
    let Curves { so_far, numerical } = curves;
    let mut reliability = so_far.rows(&names, &cycles);
    // A simulator that states no errors leaves nothing to say of them.
    if scene.simulator.is_none() || numerical.most != numerical.least {
        let probability = so_far.condition.probability;
        for (n, row) in reliability.iter_mut().enumerate() {
            let range = |c: usize| NumericalRange {
                lower: 1.0 - probability * numerical.most[c][n],
                upper: 1.0 - probability * numerical.least[c][n],
            };
            row.numerical = names.iter().enumerate().map(|(c, name)| (name.clone(), range(c))).collect();
        }
    }
    let limits = &names[..scene.limit_states.len()];
    let summary = StudySummary {
        population: so_far.points,
        evaluations,
        reliability,
        first_failure: (0..cycles.len())
            .map(|n| first_failure(limits, killers, &so_far.condition, cycles[n], n))
            .collect(),
        moments: (0..cycles.len()).map(|n| moments(scene, &distributions, cycles[n], n)).collect(),
        sensitivity: rows.iter().map(|row| sensitivity_row(scene, &names, &cycles, row)).collect(),
        convergence,
        ..blank(scene, settings)
    };
    let history = |(output, at): (&common::scene::Output, Vec<OutputDistribution>)| OutputHistory {
        output: output.name.clone(),
        cycles: cycles.clone(),
        at,
    };
    StudyResult {
        summary,
        distributions: scene.outputs.iter().zip(distributions).map(history).collect(),
        surrogates: Vec::new(),
    }
}

/// Moments at one checkpoint: `{limit state}_mean_m` and `_std_m`, or `_rpm` for angular velocities.
fn moments(scene: &Scene, distributions: &[Vec<OutputDistribution>], cycles: u32, n: usize) -> MomentsRow {
    let mut row = BTreeMap::new();
    for limit in &scene.limit_states {
        let unit = OutputUnit::of(&scene.outputs[limit.output].kind);
        let at = &distributions[limit.output][n];
        row.insert(unit.key(&format!("{}_mean", limit.name)), unit.to_file(at.mean));
        row.insert(unit.key(&format!("{}_std", limit.name)), unit.to_file(at.std));
    }
    MomentsRow { cycles, moments: row }
}

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
