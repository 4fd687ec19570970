//! Rounds of simulations and fits.

use super::least_squares::{Problem, covariance};
use super::report::{Outcome, outcome};
use super::responses::{Responses, Simulated};
use super::space::Space;
use super::targets::Targets;
use super::{CalibrationError, Free};
use crate::farm::evaluate::{EvaluateError, Evaluator, Finished, Request};
use crate::statistics::design::{InputModel, Population};
use common::accuracy::Accuracy;
use common::random::{Distribution, GaussianCopula};

/// How a calibration is done.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Calibration {
    /// Simulations of the first round; 0: four for each variable and parameter, 40 at least.
    pub simulations: usize,
    /// Rounds around the optimum, each a third of that.
    pub rounds: usize,
    /// Seed.
    pub seed: u64,
    /// Setting of the simulations.
    pub accuracy: Accuracy,
}

/// A simulation ended.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Progress {
    /// Round, from 0.
    pub round: usize,
    /// Done in this round.
    pub done: usize,
    /// All of this round.
    pub all: usize,
}

/// Half-width of the next round's points around the optimum, in standard uncertainties and, at least, as a share of the
/// distance between the bounds.
const AROUND: (f64, f64) = (2.0, 0.05);

/// Fits the free parameters of a scene to targets.
///
/// # Errors
/// [`CalibrationError`].
pub fn calibrate(
    Targets { free, targets }: &Targets,
    plan: &Calibration,
    evaluator: &mut dyn Evaluator,
    space: &Space,
    progress: &mut dyn FnMut(Progress),
) -> Result<Outcome, CalibrationError> {
    let dimension = space.dimension();
    let first = if plan.simulations == 0 { (4 * dimension).max(40) } else { plan.simulations };
    let mut simulated: Vec<Simulated> = Vec::new();
    let mut asked = 0;
    let mut window: Vec<(f64, f64)> = vec![(0.0, 1.0); free.len()];
    let mut found = None;
    for round in 0..=plan.rounds {
        let count = if round == 0 { first } else { first.div_ceil(3) };
        let points = design(space, &window, count, plan.seed.wrapping_add(round as u64));
        asked += points.len();
        let first_id = (asked - points.len()) as u64;
        simulate(evaluator, (first_id, points), plan.accuracy, &mut simulated, &mut |done, all| {
            progress(Progress { round, done, all });
        })?;
        let least = dimension / 2 + 10;
        if simulated.len() < least {
            let succeeded = simulated.len();
            return Err(CalibrationError::TooFew { succeeded, all: asked, least, dimension });
        }
        let responses = Responses::fit(space, targets, &simulated, plan.seed)?;
        let residuals = |places: &[f64]| -> Vec<f64> {
            let values = responses.at(&parameters(&space.free, places));
            targets
                .iter()
                .zip(values)
                .map(|(target, value)| (value - target.value) / target.tolerance)
                .collect()
        };
        let problem = Problem { residuals, weights: vec![1.0; targets.len()] };
        let middle =
            space.free.iter().zip(space.middle()).map(|(f, x)| (x - f.lower) / (f.upper - f.lower)).collect();
        let corners = [0.25, 0.75].map(|place| vec![place; free.len()]);
        let mut starts = vec![middle];
        starts.extend(corners);
        let best = problem.minimise(&starts);
        let spread = covariance(&problem.jacobian(&best));
        window = (0..free.len())
            .map(|k| {
                let half = (AROUND.0 * spread[(k, k)].sqrt()).max(AROUND.1);
                ((best[k] - half).max(0.0), (best[k] + half).min(1.0))
            })
            .collect();
        if round == plan.rounds {
            let failed = asked - simulated.len();
            found = Some(outcome(space, targets, &responses, &problem, &best, &spread, (asked, failed)));
        }
    }
    Ok(found.expect("the last round has an outcome"))
}

/// Parameters `(p,)` of their places between the bounds.
pub(super) fn parameters(free: &[Free], places: &[f64]) -> Vec<f64> {
    free.iter().zip(places).map(|(free, place)| free.lower + (free.upper - free.lower) * place).collect()
}

/// Samples over the window of the parameters and the random variables together, by a Latin hypercube; the widest spread that
/// is allowed, so that every narrower one is interpolated.
fn design(space: &Space, window: &[(f64, f64)], count: usize, seed: u64) -> Vec<Vec<f64>> {
    let d = space.inputs.dimension();
    let mut laws = space.inputs.variables().to_vec();
    for (low, high) in window {
        let high = high.max(low + 1e-6);
        laws.push(Distribution::uniform(*low, high).expect("a window that is open"));
    }
    let independent = GaussianCopula::new(laws.len(), &[]).expect("no correlations");
    let all = Population::latin_hypercube(&InputModel::new(laws, independent), count, seed);
    let sample = |j: usize| {
        let x = all.physical(j);
        let z = space.inputs.standardise(&x[..d]);
        let mut values = parameters(&space.free, &x[d..]);
        for (value, free) in values.iter_mut().zip(&space.free) {
            if matches!(free.moves, super::space::Moves::Spread(_)) {
                *value = free.upper;
            }
        }
        space.sample(&z, &values)
    };
    (0..count).map(sample).collect()
}

/// Simulates the samples, numbered from the first id on; those that fail are left out.
fn simulate(
    evaluator: &mut dyn Evaluator,
    (first_id, samples): (u64, Vec<Vec<f64>>),
    accuracy: Accuracy,
    simulated: &mut Vec<Simulated>,
    progress: &mut dyn FnMut(usize, usize),
) -> Result<(), EvaluateError> {
    let request = |(id, sample): (usize, &Vec<f64>)| Request {
        id: first_id + id as u64,
        sample: sample.clone(),
        with_first_cycle: false,
        accuracy: Some(accuracy),
    };
    let requests: Vec<Request> = samples.iter().enumerate().map(request).collect();
    let mut outcomes = vec![None; requests.len()];
    let mut done = 0;
    evaluator.evaluate(&requests, &mut |finished: Finished| {
        let Some(place) = usize::try_from(finished.id.wrapping_sub(first_id))
            .ok()
            .and_then(|place| outcomes.get_mut(place))
        else {
            return Err(EvaluateError::UnrequestedOutcome { id: finished.id });
        };
        *place = finished.outcome.ok();
        done += 1;
        progress(done, requests.len());
        Ok(())
    })?;
    let pairs = samples.into_iter().zip(outcomes);
    simulated.extend(pairs.filter_map(|(sample, outcome)| Some(Simulated { sample, evaluation: outcome? })));
    Ok(())
}
