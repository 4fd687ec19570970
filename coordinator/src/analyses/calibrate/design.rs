//! Rounds of simulations and fits.

use super::least_squares::LeastSquares;
use super::report::{CalibrationResult, result};
use super::responses::{POPULATION, ResponseSurrogates};
use super::space::{ParameterKind, Space};
use super::target_file::CalibrationTargets;
use crate::analyses::error::AnalysisError;
use crate::farm::evaluate::{EvaluateError, Evaluator, Request};
use crate::statistics::design::{InputModel, Population};
use common::accuracy::Accuracy;
use common::outputs::Evaluation;
use common::random::Distribution;

/// Settings of a calibration.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CalibrationSettings {
    /// Simulations of the first round; 0: four for each variable and parameter, 40 at least.
    pub simulations: usize,
    /// Rounds around the optimum, each with a third of the simulations of the first.
    pub rounds: usize,
    /// Seed of every random draw.
    pub seed: u64,
    /// Accuracy of the simulations.
    pub accuracy: Accuracy,
}

/// Half-width of the next round's points around the optimum [standard uncertainties].
const WINDOW: f64 = 2.0;

/// Smallest half-width, as a share of the distance between the bounds.
const SMALLEST_WINDOW: f64 = 0.05;

/// Fits the free parameters of a scene to targets.
///
/// # Errors
/// [`AnalysisError`].
pub fn calibrate(
    targets: &CalibrationTargets,
    settings: &CalibrationSettings,
    evaluator: &mut dyn Evaluator,
    space: &Space,
    progress: &mut dyn FnMut(String),
) -> Result<CalibrationResult, AnalysisError> {
    let targets = targets.targets.iter().map(|target| target.clone().counted_over(POPULATION));
    let targets = &targets.collect::<Vec<_>>()[..];
    let dimension = space.dimension();
    let first = if settings.simulations == 0 { (4 * dimension).max(40) } else { settings.simulations };
    let least = dimension / 2 + 10;
    let mut simulated: Vec<(Vec<f64>, Evaluation)> = Vec::new();
    let mut requested = 0;
    // Bounds of the round's points `(p,)`, as shares of the distance between the bounds of the parameters.
    let mut window: Vec<(f64, f64)> = vec![(0.0, 1.0); space.free.len()];
    let mut round = 0;
    loop {
        let count = if round == 0 { first } else { first.div_ceil(3) };
        let points = design(space, &window, count, settings.seed.wrapping_add(round as u64));
        let first_id = requested as u64;
        requested += points.len();
        simulated.extend(simulate(evaluator, points, first_id, settings.accuracy, &mut |done, all| {
            if done == all || done % 10 == 0 {
                progress(format!("round {round}: {done}/{all} simulations"));
            }
        })?);
        if simulated.len() < least {
            return Err(AnalysisError::TooFew(format!(
                "{} of {requested} simulations gave a result, fewer than the {least} that {dimension} variables and \
                 parameters need",
                simulated.len()
            )));
        }
        let responses = ResponseSurrogates::fit(space, targets, &simulated, settings.seed)?;
        let residuals = |places: &[f64]| -> Vec<f64> {
            let values = responses.target_values(&space.parameters(places)).into_iter().zip(targets);
            values.map(|(value, target)| (value - target.value) / target.tolerance).collect()
        };
        let problem = LeastSquares { residuals, weights: vec![1.0; targets.len()] };
        let fit = problem.fit(&starts(space));
        if round == settings.rounds {
            let counts = (requested, requested - simulated.len());
            return Ok(result(&responses, &problem, &fit, counts));
        }
        let around = |(k, best): (usize, &f64)| {
            let half = (WINDOW * fit.uncertainty(k)).max(SMALLEST_WINDOW);
            ((best - half).max(0.0), (best + half).min(1.0))
        };
        window = fit.best.iter().enumerate().map(around).collect();
        round += 1;
    }
}

/// Starts of the minimisation `(3)(p,)`: the nominal parameters and two points on the diagonal of the bounds.
fn starts(space: &Space) -> Vec<Vec<f64>> {
    let nominal = space.free.iter().zip(space.middle());
    let nominal = nominal.map(|(free, x)| (x - free.lower) / (free.upper - free.lower)).collect();
    let corners = [0.25, 0.75].map(|place| vec![place; space.free.len()]);
    std::iter::once(nominal).chain(corners).collect()
}

/// Points over the window of the parameters and the random variables together, by a Latin hypercube: the sample to be simulated
/// `(d + keyed,)` [SI] and its coordinates for the surrogates `(d + keyed,)` [1]. Factors of the spread are at their upper bound, so that
/// every narrower spread is interpolated.
fn design(space: &Space, window: &[(f64, f64)], count: usize, seed: u64) -> Vec<(Vec<f64>, Vec<f64>)> {
    let d = space.inputs.dimension();
    let uniform = |(low, high): &(f64, f64)| {
        Distribution::uniform(*low, high.max(low + 1e-6)).expect("the bounds of a window differ")
    };
    let laws: Vec<_> = space.inputs.variables().iter().cloned().chain(window.iter().map(uniform)).collect();
    let all = Population::latin_hypercube(&InputModel::from(&laws[..]), count, seed);
    let point = |j: usize| {
        let x = all.physical(j);
        let z = space.inputs.standardise(&x[..d]);
        let mut values = space.parameters(&x[d..]);
        for (value, free) in values.iter_mut().zip(&space.free) {
            if matches!(free.kind, ParameterKind::Spread(_)) {
                *value = free.upper;
            }
        }
        let placed = space.placed(&values);
        let sample = placed.sample(&z);
        let features = placed.features(&sample);
        (sample, features)
    };
    (0..count).map(point).collect()
}

/// Simulates points, numbered from `first_id`: their coordinates and results; failed simulations are left out.
fn simulate(
    evaluator: &mut dyn Evaluator,
    points: Vec<(Vec<f64>, Vec<f64>)>,
    first_id: u64,
    accuracy: Accuracy,
    progress: &mut dyn FnMut(usize, usize),
) -> Result<Vec<(Vec<f64>, Evaluation)>, EvaluateError> {
    let all = (first_id..).zip(&points);
    let requests: Vec<_> = all.map(|(id, (x, _))| Request::at(id, x.clone(), accuracy)).collect();
    let mut done = 0;
    let (outcomes, end) = evaluator.outcomes(&requests, &mut |_| {
        done += 1;
        progress(done, requests.len());
    });
    end?;
    let simulated = points.into_iter().zip(outcomes);
    Ok(simulated.filter_map(|((_, features), found)| Some((features, found?.outcome.ok()?))).collect())
}
