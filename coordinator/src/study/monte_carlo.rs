//! Direct simulation: the population's first points, no surrogates; curves from counts.

use super::campaign::check_failures;
use super::dispatching::Dispatcher;
use super::result::{self, Curves};
use super::{Observed, Problem, Settings, StudyError, StudyResult};
use crate::design::Population;
use crate::learning::{curves, running_maximum};
use crate::reliability::{
    NumericalBand, Shifted, coefficient_of_variation, distributions_from_samples, first_failure_with,
    governing_checkpoint,
};
use crate::sensitivity::sensitivities;
use crate::summary::{Convergence, EvaluationCounts, Round};
use common::scene::Scene;

/// Samples between two looks at the curves.
const CHUNK: usize = 64;

pub(super) fn run(
    scene: &Scene,
    settings: &Settings,
    problem: &Problem,
    samples: usize,
    dispatcher: &mut Dispatcher<'_>,
) -> Result<StudyResult, StudyError> {
    let population = Population::draw(&problem.inputs, samples, settings.study.seed);
    let budget = samples + 1;
    // The nominal point is no draw of the population: simulated for its first cycle, not counted.
    let nominal = problem.inputs.means();
    let mut failures = Vec::new();
    let outcome = dispatcher.evaluate(vec![nominal], "nominal point", budget)?;
    failures.extend(outcome.into_iter().filter_map(Result::err));

    let mut points = Vec::new();
    let mut histories = vec![Vec::new(); problem.outputs];
    let mut first_failures = vec![Vec::new(); problem.modes.len() + 1];
    let mut shifted = vec![Shifted { larger: vec![], smaller: vec![] }; problem.modes.len()];
    let mut rounds: Vec<Round> = Vec::new();
    let mut previous: Option<Vec<Vec<f64>>> = None;
    for start in (0..samples).step_by(CHUNK) {
        let range = start..samples.min(start + CHUNK);
        let batch = range.clone().map(|j| population.physical(j)).collect();
        let outcomes = dispatcher.evaluate(batch, &format!("samples from {}", start + 1), budget)?;
        for (j, outcome) in range.clone().zip(outcomes) {
            match outcome {
                Ok(observed) => {
                    points.push(j);
                    note_first_failures(problem, &observed.histories, &mut first_failures);
                    note_shifted(problem, &observed, &mut shifted);
                    histories.iter_mut().zip(observed.histories).for_each(|(all, history)| all.push(history));
                }
                Err(failure) => failures.push(failure),
            }
        }
        check_failures(&failures, range.end + 1)?;
        if points.is_empty() {
            continue;
        }
        let now = curves_of(problem, &first_failures);
        let round = round_of(problem, &now, previous.as_deref(), points.len(), range.end + 1, rounds.len());
        dispatcher.note_round(&round)?;
        rounds.push(round);
        previous = Some(now);
    }
    let Some(failed) = previous else {
        return Err(StudyError::Setting {
            key: "samples",
            value: samples.to_string(),
            allowed: "none of these simulations gave a result".to_owned(),
        });
    };

    let grid: Vec<usize> = undecided(&failed);
    let rows = sensitivities(&population, &points, &first_failures, &grid, problem.checkpoints.len());
    let distributions = histories
        .iter()
        .map(|all| distributions_from_samples(&all.iter().map(Vec::as_slice).collect::<Vec<_>>()))
        .collect();
    let numerical = NumericalBand::count(&shifted, problem.checkpoints.len());
    let curves = Curves { failed: &failed, points: points.len(), surrogate: &[], numerical: &numerical };
    let counts = EvaluationCounts { total: samples + 1, initial: 1, added: samples, failed: failures.len() };
    let convergence = Convergence {
        stopped_because: format!("all {samples} samples were simulated"),
        targets_met: true,
        rounds,
    };
    Ok(result::assemble(scene, settings, curves, distributions, &rows, counts, convergence))
}

/// First failures of one evaluation by mode and, last, of the system.
fn note_first_failures(problem: &Problem, outputs: &[Vec<f64>], first_failures: &mut [Vec<u32>]) {
    let m = problem.checkpoints.len();
    let mut earliest = m as u32;
    for (mode, all) in problem.modes.iter().zip(first_failures.iter_mut()) {
        let history = running_maximum(&outputs[mode.output]);
        let first = history.iter().position(|y| *y >= mode.threshold).unwrap_or(m) as u32;
        earliest = earliest.min(first);
        all.push(first);
    }
    first_failures[problem.modes.len()].push(earliest);
}

/// First failures of one evaluation by mode, its values moved by the errors it states.
fn note_shifted(problem: &Problem, observed: &Observed, shifted: &mut [Shifted]) {
    for (mode, all) in problem.modes.iter().zip(shifted) {
        let (history, errors) = (&observed.histories[mode.output], &observed.errors[mode.output]);
        all.larger.push(first_failure_with(history, errors, 1.0, mode.threshold));
        all.smaller.push(first_failure_with(history, errors, -1.0, mode.threshold));
    }
}

fn curves_of(problem: &Problem, first_failures: &[Vec<u32>]) -> Vec<Vec<f64>> {
    let modes: Vec<&[u32]> = first_failures[..problem.modes.len()].iter().map(Vec::as_slice).collect();
    curves(&modes, problem.checkpoints.len())
}

fn round_of(
    problem: &Problem,
    now: &[Vec<f64>],
    previous: Option<&[Vec<f64>]>,
    points: usize,
    evaluations: usize,
    round: usize,
) -> Round {
    let system = &now[now.len() - 1];
    let governing = governing_checkpoint(system);
    let failed = system[governing];
    let change = previous.map(|previous| {
        let pairs = previous.iter().flatten().zip(now.iter().flatten());
        let largest = pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        largest / failed.min(1.0 - failed).max(1.0 / points as f64)
    });
    Round {
        round,
        evaluations,
        change_of_r: change,
        cov_pf: coefficient_of_variation(failed, points),
        cycles: problem.checkpoints[governing],
        reliability_total: 1.0 - failed,
        ..Round::default()
    }
}

/// Checkpoints where any curve is neither 0 nor 1; the last one if there is none.
fn undecided(failed: &[Vec<f64>]) -> Vec<usize> {
    let m = failed[0].len();
    let open = |n: &usize| failed.iter().any(|curve| curve[*n] > 0.0 && curve[*n] < 1.0);
    let found: Vec<usize> = (0..m).filter(open).collect();
    if found.is_empty() { vec![m - 1] } else { found }
}
