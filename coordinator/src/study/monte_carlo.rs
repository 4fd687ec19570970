//! Direct simulation of a Monte Carlo population's first points or of a Latin hypercube: no surrogates, curves from counts.

use super::dispatching::Outcome;
use super::failures::check_failures;
use super::result::{Findings, LearnerFindings};
use super::so_far::SoFar;
use super::thinking::Learner;
use super::{Ask, CampaignError, Method, Observed, Problem, SettingError, Settings, Step, StudyError};
use crate::results::summary::{Convergence, EvaluationCounts, Round};
use crate::statistics::design::Population;
use crate::statistics::learning::{curves, running_maximum};
use crate::statistics::reliability::{
    Condition, NumericalBand, Shifted, coefficient_of_variation, distributions_from_samples,
    first_failure_with, governing_checkpoint, killers,
};
use crate::statistics::sensitivity::{Sampled, sensitivities};
use common::failure::SimulationFailure;
use std::collections::VecDeque;
use std::ops::Range;

/// Samples between two looks at the curves.
const CHUNK: usize = 64;
/// Chunks under way at once.
const AHEAD: usize = 2;

/// Direct simulation as a [`Learner`]: it learns nothing, so it only has to keep the workers busy.
pub(super) struct DirectSimulation<'a> {
    problem: &'a Problem,
    population: Population,
    failed_share: f64,
    /// Samples asked for, and chunks told, the nominal point being the first.
    asked: usize,
    told: usize,
    chunks: VecDeque<Range<usize>>,
    points: Vec<usize>,
    histories: Vec<Vec<Vec<f64>>>,
    first_failures: Vec<Vec<u32>>,
    shifted: Vec<Shifted>,
    failures: Vec<SimulationFailure>,
    rounds: Vec<Round>,
    curves: Option<Vec<Vec<f64>>>,
}

impl<'a> DirectSimulation<'a> {
    /// Of the first points of the Monte Carlo population, or of a Latin hypercube of as many.
    pub fn new(problem: &'a Problem, settings: &Settings) -> Self {
        let (samples, seed) = (settings.samples, settings.seed);
        let population = match settings.method {
            Method::LatinHypercube => Population::latin_hypercube(&problem.inputs, samples, seed),
            _ => Population::draw(&problem.inputs, samples, seed),
        };
        Self {
            problem,
            population,
            failed_share: settings.max_failed,
            asked: 0,
            told: 0,
            chunks: VecDeque::new(),
            points: Vec::new(),
            histories: vec![Vec::new(); problem.outputs],
            first_failures: vec![Vec::new(); problem.modes.len() + 1],
            shifted: vec![Shifted { larger: vec![], smaller: vec![] }; problem.modes.len()],
            failures: Vec::new(),
            rounds: Vec::new(),
            curves: None,
        }
    }

    /// The findings, after the outcomes of all samples.
    ///
    /// # Errors
    /// [`StudyError::Setting`] if no sample gave a result.
    pub fn findings(self) -> Result<Findings, StudyError> {
        let samples = self.population.len();
        let Some(failed) = self.curves else {
            let error = SettingError {
                key: "samples",
                value: samples.to_string(),
                allowed: "none of these simulations gave a result".to_owned(),
            };
            return Err(error.into());
        };
        let m = self.problem.checkpoints.len();
        let grid: Vec<usize> = undecided(&failed);
        let sampled = Sampled { population: &self.population, points: &self.points, probability: 1.0 };
        let modes: Vec<&[u32]> =
            self.first_failures[..self.problem.modes.len()].iter().map(Vec::as_slice).collect();
        Ok(Findings {
            shares: SoFar {
                failed,
                points: self.points.len(),
                surrogate: vec![],
                condition: Condition::NONE,
            },
            numerical: NumericalBand::count(&self.shifted, m),
            distributions: self
                .histories
                .iter()
                .map(|all| distributions_from_samples(&all.iter().map(Vec::as_slice).collect::<Vec<_>>()))
                .collect(),
            derivatives: sensitivities(&sampled, &self.first_failures, &grid, m),
            first_failures: killers(&modes, m),
            evaluations: EvaluationCounts {
                total: samples + 1,
                initial: 1,
                added: samples,
                failed: self.failures.len(),
            },
            convergence: Convergence {
                stopped_because: format!("all {samples} samples were simulated"),
                targets_met: true,
                rounds: self.rounds,
            },
            learner: LearnerFindings::default(),
        })
    }
}

impl Learner for DirectSimulation<'_> {
    fn next_step(&mut self) -> Result<Step, CampaignError> {
        if self.told == 0 && self.chunks.is_empty() {
            // The nominal point is no draw of the population: simulated for its first cycle, not counted.
            self.chunks.push_back(0..0);
            let sample = self.problem.inputs.means();
            return Ok(Step::Evaluate(vec![Ask { sample, stricter: false }]));
        }
        let range = self.asked..self.population.len().min(self.asked + CHUNK);
        if range.is_empty() && self.chunks.is_empty() {
            return Ok(Step::Done);
        }
        if range.is_empty() || self.chunks.len() > AHEAD {
            return Ok(Step::Wait);
        }
        self.asked = range.end;
        self.chunks.push_back(range.clone());
        let ask = |j| Ask { sample: self.population.physical(j), stricter: false };
        Ok(Step::Evaluate(range.map(ask).collect()))
    }

    fn tell(&mut self, outcomes: Vec<Outcome>) -> Result<(), CampaignError> {
        let range = self.chunks.pop_front().expect("outcomes are told of what was asked for");
        self.told += 1;
        if range.is_empty() {
            self.failures.extend(outcomes.into_iter().filter_map(Result::err));
            return Ok(());
        }
        for (j, outcome) in range.clone().zip(outcomes) {
            match outcome {
                Ok(observed) => {
                    self.points.push(j);
                    note_first_failures(self.problem, &observed.histories, &mut self.first_failures);
                    note_shifted(self.problem, &observed, &mut self.shifted);
                    let all = self.histories.iter_mut();
                    all.zip(observed.histories).for_each(|(all, history)| all.push(history));
                }
                Err(failure) => self.failures.push(failure),
            }
        }
        check_failures(self.failures.iter(), range.end + 1, self.failed_share)?;
        if !self.points.is_empty() {
            let now = curves_of(self.problem, &self.first_failures);
            let previous = self.curves.as_deref();
            let (points, round) = (self.points.len(), self.rounds.len());
            self.rounds.push(round_of(self.problem, &now, previous, points, range.end + 1, round));
            self.curves = Some(now);
        }
        Ok(())
    }

    fn rounds(&self) -> &[Round] {
        &self.rounds
    }

    fn purpose(&self) -> String {
        if self.asked == 0 { "nominal point".to_owned() } else { format!("samples to {}", self.asked) }
    }

    fn so_far(&self) -> Option<SoFar> {
        let failed = self.curves.clone()?;
        Some(SoFar { failed, points: self.points.len(), surrogate: vec![], condition: Condition::NONE })
    }
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
