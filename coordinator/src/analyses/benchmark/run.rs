//! One published problem learned once.

use super::PublishedProblem;
use crate::statistics::design::InputModel;
use crate::statistics::learning::{LearningFunction, Mode, Targets};
use crate::statistics::reliability::reliability_curve;
use crate::statistics::surrogate::{FormSettings, StatedErrors};
use crate::study::{Campaign, CampaignError, FAILED_SHARE, Learned, LookedAt, Observed, Plan, Problem, Stop};
use std::time::Instant;

/// What one run found.
#[derive(Debug, Clone, PartialEq)]
pub struct Run {
    /// Seed.
    pub seed: u64,
    /// Evaluations spent.
    pub calls: usize,
    /// Failure probability of the system at the last checkpoint, and its stated standard error.
    pub pf: f64,
    /// Standard error of it.
    pub standard_error: f64,
    /// Points of the population, and how many of them are on the wrong side of the limit at the last checkpoint.
    pub population: usize,
    /// Misclassified points.
    pub misclassified: usize,
    /// Why it stopped.
    pub stop: Stop,
    /// Time [s].
    pub seconds: f64,
}

/// Learns a problem with a population of `population` points to begin with, `batch` points under way at once.
///
/// # Errors
/// [`CampaignError`].
pub fn run(
    problem: &PublishedProblem,
    (population, batch): (usize, usize),
    (learning, targets): (LearningFunction, Targets),
    seed: u64,
) -> Result<Run, CampaignError> {
    let started = Instant::now();
    let (modes, m) = problem.shape;
    let plan = Plan {
        population,
        largest_population: population.max(2_000_000),
        initial: problem.initial,
        batch,
        max_evaluations: problem.max_evaluations,
        seed,
        learning,
        targets,
        forms: FormSettings::default(),
        stated_errors: StatedErrors::Ignored,
        retry: false,
        failed_share: FAILED_SHARE,
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
    Ok(found(problem, &learned, seed, seconds))
}

fn found(problem: &PublishedProblem, learned: &Learned, seed: u64, seconds: f64) -> Run {
    let assessment = &learned.assessment;
    let system = assessment.curves.len() - 1;
    let m = problem.shape.1;
    let errors = assessment.errors.by_curve[system].iter().zip(&assessment.noise_shift[system]);
    let on_grid: Vec<(usize, f64)> =
        assessment.grid.iter().copied().zip(errors.map(|(error, noise)| error.hypot(*noise))).collect();
    let LookedAt { population, condition, .. } = &learned.looked_at;
    let curve = reliability_curve(&assessment.curves[system], population.len(), &on_grid, condition);
    let wrong = |j: &usize| {
        let truly = (problem.evaluate)(&population.physical(*j)).iter().flatten().any(|y| *y >= 0.0);
        let predicted = assessment.modes.iter().any(|mode| (mode.first_failure[*j] as usize) < m);
        truly != predicted
    };
    Run {
        seed,
        calls: learned.evaluations,
        pf: 1.0 - curve[m - 1].reliability,
        standard_error: curve[m - 1].standard_error,
        population: population.len(),
        misclassified: (0..population.len()).filter(wrong).count(),
        stop: learned.stop,
        seconds,
    }
}
