//! One problem, studied and optimised once.

use super::problems::Known;
use common::random::standard_normal_quantile;
use coordinator::analyses::error::AnalysisError;
use coordinator::analyses::optimise::{StudyBasis, answer, optimise};
use coordinator::statistics::design::InputModel;
use coordinator::statistics::learning::Mode;
use coordinator::statistics::reliability::LineSampling;
use coordinator::study::{Campaign, Observed, ObservedOutcome, Plan, Problem, SampleRequest, Settings};
use faer::{Mat, MatRef};
use std::error::Error;
use std::fmt;
use std::time::Instant;

/// Lines by which the true reliability at the optimum is computed.
const LINES: usize = 4000;

/// Result of one run.
pub struct Outcome {
    /// Simulations in all.
    pub calls: usize,
    /// True if the optimum was confirmed.
    pub confirmed: bool,
    /// Relative error of the cost.
    pub error: f64,
    /// True if the true cost lies within the stated 95 % interval.
    pub within: bool,
    /// Largest difference of the true reliability index at the optimum from that of an active target.
    pub beta_error: f64,
    /// The design found.
    pub values: Vec<f64>,
    /// Wall time [s].
    pub seconds: f64,
}

impl fmt::Display for Outcome {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "{} calls, cost off by {:+.3} %, {} the stated interval, true beta off by {:.4}, {}, {:.3?}, {:.1} s",
            self.calls,
            100.0 * self.error,
            if self.within { "within" } else { "outside" },
            self.beta_error,
            if self.confirmed { "confirmed" } else { "not confirmed" },
            self.values,
            self.seconds
        )
    }
}

/// Studies and optimises a problem with at most `budget` simulations in all.
///
/// # Errors
/// Those of the study and of the optimisation.
pub fn solve(known: &Known, seed: u64, budget: usize, report: bool) -> Result<Outcome, Box<dyn Error>> {
    let started = Instant::now();
    let study = study(known, seed)?;
    let mut simulate = |requests: &[SampleRequest]| -> Result<Vec<ObservedOutcome>, AnalysisError> {
        Ok(requests.iter().map(|request| observed(known, &request.sample)).collect())
    };
    let left = budget - study.outcomes.len();
    let mut progress = |text| {
        if report {
            eprintln!("{text}, {:.1} s", started.elapsed().as_secs_f64());
        }
    };
    let found = optimise(&study, &known.problem, left, &mut simulate, &mut progress)?;
    if report {
        eprintln!("{}", answer(&found, "", vec![]).markdown());
    }
    let inputs = known.problem.inputs(&study.problem.inputs, &found.values)?;
    let active = found.targets.iter().zip(&known.problem.targets).filter(|(target, _)| target.active);
    let beta_error = active
        .map(|(_, target)| {
            let margins = |v: MatRef<'_, f64>| -> Mat<f64> {
                let values: Vec<Vec<f64>> = (0..v.ncols())
                    .map(|j| {
                        let point: Vec<f64> = (0..v.nrows()).map(|k| v[(k, j)]).collect();
                        (known.margins)(&inputs.from_independent_normals(&point))
                    })
                    .collect();
                let of = |i: usize| target.limit_state.unwrap_or(i);
                let modes = if target.limit_state.is_some() { 1 } else { known.modes };
                Mat::from_fn(modes, values.len(), |i, j| values[j][of(i)])
            };
            let lines = LineSampling::new(inputs.dimension(), LINES, 1);
            let modes = if target.limit_state.is_some() { 1 } else { known.modes };
            let exact = lines.estimate(&lines.directions(modes, &margins), &margins).probability;
            let wanted = -standard_normal_quantile(1.0 - target.reliability);
            (-standard_normal_quantile(exact) - wanted).abs()
        })
        .fold(0.0, f64::max);
    Ok(Outcome {
        calls: found.evaluations.study + found.evaluations.added,
        confirmed: found.confirmed,
        error: found.cost / known.optimum - 1.0,
        within: (found.cost - known.optimum).abs() <= 1.96 * found.cost_standard_error + 1e-4 * known.optimum,
        beta_error,
        values: found.values,
        seconds: started.elapsed().as_secs_f64(),
    })
}

fn observed(known: &Known, sample: &[f64]) -> ObservedOutcome {
    Ok(Observed::exact((known.margins)(sample).into_iter().map(|y| vec![y]).collect()))
}

/// The first study: a few simulations at the study's design.
fn study(known: &Known, seed: u64) -> Result<StudyBasis, Box<dyn Error>> {
    let settings = Settings {
        samples: 100_000,
        initial: known.initial,
        max_evaluations: known.initial,
        batch: 1,
        seed,
        ..Settings::default()
    };
    let problem = Problem {
        inputs: InputModel::from(&known.variables),
        outputs: known.modes,
        modes: (0..known.modes).map(|output| Mode { output, threshold: 0.0 }).collect(),
        checkpoints: vec![1],
    };
    let plan = Plan {
        targets: settings.targets(),
        largest_population: settings.samples,
        retry: false,
        is_exact: true,
        settings: settings.clone(),
    };
    let mut outcomes = Vec::new();
    let simulate = |sample: &[f64]| {
        let outcome = observed(known, sample);
        outcomes.push((sample.to_vec(), outcome.clone()));
        outcome
    };
    Campaign::new(problem.clone(), plan).learn_from(simulate, |_| {})?;
    Ok(StudyBasis { problem, settings, outcomes })
}
