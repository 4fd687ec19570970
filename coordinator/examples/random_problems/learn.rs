//! One random problem, learned once as `run` learns a scene without a section `[study]`.

use super::known_lives::LifeComparison;
use super::problem::{Class, RandomProblem};
use super::truth::Truth;
use coordinator::statistics::design::InputModel;
use coordinator::statistics::learning::{Mode, StoppingTargets};
use coordinator::study::{
    Campaign, CampaignError, CampaignResult, LARGEST_POPULATION, Plan, Problem, Settings, StopReason,
};
use std::time::Instant;

/// Half of the width of a 95 % interval in standard errors [1].
pub const INTERVAL: f64 = 1.96;

/// Stated and true failure probability at one checkpoint.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Comparison {
    /// Stated failure probability of the system [1].
    pub pf: f64,
    /// Its stated standard error [1].
    pub standard_error: f64,
    /// Its stated 95 % interval [1]: wider than the standard error where no simulation has tested it.
    pub interval: (f64, f64),
    /// True failure probability [1].
    pub truth: f64,
    /// Standard error of that [1].
    pub truth_error: f64,
}

impl Comparison {
    /// Distance of the stated value from the truth, in standard errors of the difference [1]; the stated one is that of the interval on
    /// the side of the truth, if it is larger.
    pub fn distance(&self) -> f64 {
        let (lower, upper) = self.interval;
        let half = if self.truth > self.pf { upper - self.pf } else { self.pf - lower };
        let standard_error = self.standard_error.max(half / INTERVAL);
        (self.pf - self.truth) / standard_error.hypot(self.truth_error)
    }
}

/// Result of one run.
#[derive(Debug, Clone, PartialEq)]
pub struct Run {
    /// Number of the problem in the family.
    pub index: u64,
    /// Its class.
    pub class: Class,
    /// Number of variables d, and of limit states.
    pub shape: (usize, usize),
    /// True failure probability at the end of life with its standard error [1].
    pub truth: (f64, f64),
    /// Comparison at every checkpoint `(m,)`; empty if too many simulations failed.
    pub checkpoints: Vec<Comparison>,
    /// Comparison of the lives that the checkpoints resolve; empty without wear.
    pub lives: Vec<LifeComparison>,
    /// Stated surrogate error at the end of life [1].
    pub surrogate_error: f64,
    /// Failure probability by the true responses over the population that the engine classified [1].
    pub on_population: f64,
    /// Evaluations spent.
    pub calls: usize,
    /// Points of the population.
    pub population: usize,
    /// Reason of the stop; `None` if too many simulations failed.
    pub stop: Option<StopReason>,
    /// Wall time [s].
    pub seconds: f64,
    /// Share of the population in the largest ball without a simulation [1].
    pub largest_gap: f64,
}

/// Learns a problem. A study that too many failed simulations ended is a result without a comparison. With `trace` every
/// simulation and round is written to standard error.
///
/// # Errors
/// [`CampaignError::Surrogate`].
pub fn learn(
    problem: &RandomProblem,
    truth: &Truth,
    (settings, targets): (Settings, StoppingTargets),
    trace: bool,
) -> Result<Run, CampaignError> {
    let started = Instant::now();
    let m = problem.checkpoints();
    let modes = problem.modes.len();
    let plan = Plan {
        targets,
        largest_population: settings.samples.max(LARGEST_POPULATION),
        retry: false,
        is_exact: true,
        settings,
    };
    let mode = |(output, unit): (usize, &f64)| Mode { output, threshold: unit * truth.limit };
    let statistics = Problem {
        inputs: InputModel::from(&problem.variables),
        outputs: modes,
        modes: problem.units.iter().enumerate().map(mode).collect(),
        checkpoints: (1..=m as u32).collect(),
    };
    let mut calls = 0;
    let simulate = |sample: &[f64]| {
        calls += 1;
        let outcome = problem.simulate(sample, truth.spread);
        if trace {
            let last = |history: &Vec<f64>| history.last().copied();
            let values: Result<Vec<_>, _> =
                outcome.as_ref().map(|observed| observed.histories.iter().filter_map(last).collect());
            eprintln!("{calls}: {:.2?} {values:.3?}", problem.in_standard_deviations(sample));
        }
        outcome
    };
    if trace {
        eprintln!(
            "{:?}, {:?}, failures are likely at {:.2?}",
            problem.noise, problem.failing, problem.centres
        );
    }
    let mut traced = 0;
    let write_rounds = |campaign: &Campaign| {
        for round in campaign.rounds.iter().skip(traced).filter(|_| trace) {
            eprintln!("{round:?}");
        }
        traced = campaign.rounds.len();
    };
    let learned = Campaign::new(statistics, plan).learn_from(simulate, write_rounds);
    let blank = Run {
        index: problem.index,
        class: problem.class,
        shape: (problem.dimension(), modes),
        truth: (truth.pf[m - 1], truth.standard_error[m - 1]),
        checkpoints: vec![],
        lives: vec![],
        surrogate_error: f64::NAN,
        on_population: f64::NAN,
        calls,
        population: 0,
        stop: None,
        seconds: started.elapsed().as_secs_f64(),
        largest_gap: f64::NAN,
    };
    match learned {
        Ok(learned) => Ok(compared(problem, truth, &learned, blank)),
        Err(CampaignError::TooManyFailures { .. } | CampaignError::TooFewResults { .. }) => Ok(blank),
        Err(error) => Err(error),
    }
}

/// The run with the comparison of its result with the truth.
fn compared(problem: &RandomProblem, truth: &Truth, learned: &CampaignResult, blank: Run) -> Run {
    let m = problem.checkpoints();
    let stated = learned.reliability();
    let system = &stated[stated.len() - 1];
    let intervals = learned.intervals();
    let checkpoint = |n: usize| Comparison {
        pf: 1.0 - system[n].reliability,
        standard_error: system[n].standard_error,
        interval: (1.0 - intervals[n].upper, 1.0 - intervals[n].lower),
        truth: truth.pf[n],
        truth_error: truth.standard_error[n],
    };
    let checkpoints: Vec<Comparison> = (0..m).map(checkpoint).collect();
    let population = &learned.classified.population;
    let of_system = learned.assessment.errors.last().and_then(|errors| errors.last());
    let mut history = vec![0.0; m];
    let mut fails = |j: &usize| {
        let z = problem.in_standard_deviations(&population.physical(*j));
        problem.running_maximum(&z, &mut history);
        history[m - 1] >= truth.limit
    };
    let failed = (0..population.len()).filter(|j| fails(j)).count();
    Run {
        lives: LifeComparison::all(problem, truth, &checkpoints),
        checkpoints,
        surrogate_error: learned.classified.condition.probability * of_system.copied().unwrap_or(f64::NAN),
        on_population: learned.classified.condition.probability * failed as f64 / population.len() as f64,
        population: population.len(),
        largest_gap: learned.largest_gap(),
        stop: Some(learned.stop),
        ..blank
    }
}
