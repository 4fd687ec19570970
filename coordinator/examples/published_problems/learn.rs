//! One published problem, learned once.

use super::problems::PublishedProblem;
use coordinator::statistics::design::InputModel;
use coordinator::statistics::learning::{Mode, StoppingTargets};
use coordinator::statistics::surrogate::StatedErrors;
use coordinator::study::{
    Campaign, CampaignError, CampaignResult, ClassifiedPopulation, LARGEST_POPULATION, Method, Observed,
    Plan, Problem, Settings, StopReason,
};
use std::time::Instant;

/// Result of one run.
#[derive(Debug, Clone, PartialEq)]
pub struct Run {
    /// Evaluations spent.
    pub calls: usize,
    /// Failure probability of the system at the last checkpoint [1].
    pub pf: f64,
    /// Stated standard error of `pf` [1].
    pub standard_error: f64,
    /// Points of the population.
    pub population: usize,
    /// Points of the population that are misclassified at the last checkpoint.
    pub misclassified: usize,
    /// Reason of the stop.
    pub stop: StopReason,
    /// Wall time [s].
    pub seconds: f64,
}

/// Learns a problem; initial design and budget are those of the problem, or of the published method.
///
/// # Errors
/// [`CampaignError`].
pub fn learn(
    problem: &PublishedProblem,
    settings: Settings,
    targets: StoppingTargets,
) -> Result<Run, CampaignError> {
    let started = Instant::now();
    let (modes, m) = problem.shape;
    let (initial, max_evaluations) = match settings.method {
        Method::AkMcs => (settings.initial, settings.max_evaluations),
        _ => (problem.initial, problem.max_evaluations),
    };
    let settings = Settings { initial, max_evaluations, stated_errors: StatedErrors::Ignored, ..settings };
    let plan = Plan {
        targets,
        largest_population: settings.samples.max(LARGEST_POPULATION),
        retry: false,
        is_exact: true,
        settings,
    };
    let statistics = Problem {
        inputs: InputModel::from(&problem.variables[..]),
        outputs: modes,
        modes: (0..modes).map(|output| Mode { output, threshold: 0.0 }).collect(),
        checkpoints: (1..=m as u32).collect(),
    };
    let simulate = |sample: &[f64]| Ok(Observed::exact((problem.evaluate)(sample)));
    let learned = Campaign::new(statistics, plan).learn_from(simulate, |_| {})?;
    let seconds = started.elapsed().as_secs_f64();
    Ok(result(problem, &learned, seconds))
}

fn result(problem: &PublishedProblem, learned: &CampaignResult, seconds: f64) -> Run {
    let assessment = &learned.assessment;
    let system = assessment.curves.len() - 1;
    let m = problem.shape.1;
    let ClassifiedPopulation { population, .. } = &learned.classified;
    let stated = learned.reliability()[system][m - 1];
    let wrong = |j: &usize| {
        let truly = (problem.evaluate)(&population.physical(*j)).iter().flatten().any(|y| *y >= 0.0);
        let predicted = assessment.modes.iter().any(|mode| (mode.first_failure[*j] as usize) < m);
        truly != predicted
    };
    Run {
        calls: learned.evaluations,
        pf: 1.0 - stated.reliability,
        standard_error: stated.standard_error,
        population: population.len(),
        misclassified: (0..population.len()).filter(wrong).count(),
        stop: learned.stop,
        seconds,
    }
}
