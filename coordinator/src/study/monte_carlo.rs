//! Direct simulation of the first points of a Monte Carlo population, or of a Latin hypercube, without
//! surrogates.
//!
//! R(n) = 1 - N_f(n) / N, with N_f(n) the number of the N samples that have failed by checkpoint n; failed
//! simulations are left out of N, and the standard error of R contains what they may have been
//! ([`CurvePoint::with_missing`](crate::statistics::reliability::CurvePoint::with_missing)).

use super::failures::{Failed, check_failures};
use super::interim::{InterimResult, Untested};
use super::learner::Learner;
use super::lives::add_simulated;
use super::observations::ObservedOutcome;
use super::result::{Findings, blank, failures};
use super::round::largest_change;
use super::summary_rows::failure_points;

use super::{CampaignError, Method, Problem, SampleRequest, SettingError, Settings, Step, StudyError};
use crate::results::summary::{Convergence, EvaluationCounts, Round, StudySummary};
use crate::statistics::design::Population;
use crate::statistics::learning::curves;
use crate::statistics::reliability::{
    Condition, LifeCounts, coefficient_of_variation, distributions_from_samples, governing_checkpoint,
};
use crate::statistics::sensitivity::{Sampled, sensitivities};
use common::scene::Scene;
use std::collections::VecDeque;
use std::ops::Range;

/// Number of samples between two updates of the curves.
const CHUNK: usize = 64;
/// Number of chunks under way at once, besides the one requested.
const AHEAD: usize = 2;

/// Direct simulation as a [`Learner`] whose samples do not depend on outcomes.
pub(super) struct DirectSimulation<'a> {
    problem: &'a Problem,
    population: Population,
    /// Share of failed simulations that ends the study [1].
    failed_share: f64,
    /// Number of samples requested.
    requested: usize,
    /// Number of chunks recorded, the first of which is the nominal point.
    recorded: usize,
    /// Chunks under way, the oldest first; the nominal point is an empty range.
    chunks: VecDeque<Range<usize>>,
    /// Indices of the samples with a result.
    points: Vec<usize>,
    /// Histories of those samples `(outputs)(points)(m,)`.
    histories: Vec<Vec<Vec<f64>>>,
    /// Index of their first failure `(modes + 1)(points,)`, the system last.
    first_failures: Vec<Vec<u32>>,
    /// Counts of their lives by limit state.
    lives: LifeCounts,
    failures: Vec<Failed>,
    rounds: Vec<Round>,
    /// Failure shares of the last round `(modes + 1, m)`.
    curves: Option<Vec<Vec<f64>>>,
}

impl<'a> DirectSimulation<'a> {
    /// Simulates the first `settings.samples` points of the Monte Carlo population, or a Latin hypercube of
    /// as many points.
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
            requested: 0,
            recorded: 0,
            chunks: VecDeque::new(),
            points: Vec::new(),
            histories: vec![Vec::new(); problem.outputs],
            first_failures: vec![Vec::new(); problem.modes.len() + 1],
            lives: LifeCounts::new(problem.modes.len(), problem.checkpoints.len()),
            failures: Vec::new(),
            rounds: Vec::new(),
            curves: None,
        }
    }

    /// Share of the samples requested so far whose simulation failed [1].
    fn missing(&self) -> f64 {
        let recorded = self.requested - self.chunks.iter().map(Range::len).sum::<usize>();
        1.0 - self.points.len() as f64 / recorded.max(1) as f64
    }

    /// Counts the failure shares anew, after this number of evaluations.
    fn add_round(&mut self, evaluations: usize) {
        let (modes, points) = (self.problem.modes.len(), self.points.len());
        let now = curves(&self.first_failures, self.problem.checkpoints.len());
        let system = &now[modes];
        let governing = governing_checkpoint(system);
        let failed = system[governing];
        let smaller = failed.min(1.0 - failed).max(1.0 / points as f64);
        self.rounds.push(Round {
            round: self.rounds.len(),
            evaluations,
            change_of_r: self.curves.as_ref().map(|before| largest_change(before, &now) / smaller),
            cov_pf: coefficient_of_variation(failed, points),
            cycles: self.problem.checkpoints[governing],
            reliability_total: 1.0 - failed,
            ..Round::default()
        });
        self.curves = Some(now);
    }

    /// The findings, after the outcomes of all samples.
    ///
    /// # Errors
    /// [`StudyError::Setting`] if no sample gave a result.
    pub fn findings(self, scene: &Scene, settings: &Settings) -> Result<Findings, StudyError> {
        let samples = self.population.len();
        let Some(shares) = self.interim() else {
            let (value, allowed) =
                (samples.to_string(), "none of these simulations gave a result".to_owned());
            return Err(SettingError { key: "samples", value, allowed }.into());
        };
        let m = self.problem.checkpoints.len();
        let grid: Vec<usize> = undecided(&shares.failed);
        let sampled = Sampled { population: &self.population, points: &self.points, probability: 1.0 };
        let modes = self.problem.modes.len();
        Ok(Findings {
            summary: StudySummary {
                failures: failures(scene, &self.problem.inputs, &self.failures, shares.missing),
                failure_points: failure_points(scene, &sampled, &self.first_failures[..modes]),
                evaluations: EvaluationCounts {
                    total: samples + 1,
                    initial: 1,
                    added: samples,
                    failed: self.failures.len(),
                },
                convergence: Convergence {
                    stopped_because: format!("all {samples} samples were simulated"),
                    targets_met: true,
                    larger_budget: None,
                    rounds: self.rounds,
                },
                ..blank(scene, settings)
            },
            shares,
            lives: self.lives,
            distributions: self.histories.iter().map(|all| distributions_from_samples(all)).collect(),
            derivatives: sensitivities(&sampled, &self.first_failures, &grid, m),
            explicit: None,
        })
    }
}

impl Learner for DirectSimulation<'_> {
    fn next_step(&mut self) -> Result<Step, CampaignError> {
        if self.recorded == 0 && self.chunks.is_empty() {
            // The nominal point is simulated for its first cycle; it is no sample of the population and is
            // not counted.
            self.chunks.push_back(0..0);
            return Ok(Step::Evaluate(vec![SampleRequest::new(self.problem.inputs.means())]));
        }
        if self.recorded == 0 {
            return Ok(Step::Wait);
        }
        let range = self.requested..self.population.len().min(self.requested + CHUNK);
        if range.is_empty() && self.chunks.is_empty() {
            return Ok(Step::Done);
        }
        if range.is_empty() || self.chunks.len() > AHEAD {
            return Ok(Step::Wait);
        }
        self.requested = range.end;
        self.chunks.push_back(range.clone());
        let request = |j| SampleRequest::new(self.population.physical(j));
        Ok(Step::Evaluate(range.map(request).collect()))
    }

    fn record(&mut self, outcomes: Vec<ObservedOutcome>) -> Result<(), CampaignError> {
        let range = self.chunks.pop_front().expect("outcomes belong to a chunk under way");
        self.recorded += 1;
        if range.is_empty() {
            let failure = outcomes.into_iter().find_map(Result::err);
            return failure.map_or(Ok(()), |cause| Err(CampaignError::Nominal { cause }));
        }
        for (j, outcome) in range.clone().zip(outcomes) {
            match outcome {
                Ok(observed) => {
                    self.points.push(j);
                    add_simulated(self.problem, &observed, &mut self.lives, &mut self.first_failures);
                    let all = self.histories.iter_mut();
                    all.zip(observed.histories).for_each(|(all, history)| all.push(history));
                }
                Err(cause) => {
                    let z = self.population.standardised(j).to_vec();
                    self.failures.push(Failed { z, cause, expected: false });
                }
            }
        }
        check_failures(self.failures.iter().map(|failed| &failed.cause), range.end + 1, self.failed_share)?;
        if !self.points.is_empty() {
            self.add_round(range.end + 1);
        }
        Ok(())
    }

    fn rounds(&self) -> &[Round] {
        &self.rounds
    }

    fn purpose(&self) -> String {
        if self.requested == 0 {
            "nominal point".to_owned()
        } else {
            format!("samples to {}", self.requested)
        }
    }

    fn interim(&self) -> Option<InterimResult> {
        let failed = self.curves.clone()?;
        let (points, missing, untested) = (self.points.len(), self.missing(), Untested::default());
        let (surrogate, condition) = (vec![], Condition::NONE);
        Some(InterimResult { failed, points, missing, surrogate, condition, untested })
    }
}

/// Indices of the checkpoints where any curve is neither 0 nor 1; the last checkpoint if there is none.
fn undecided(failed: &[Vec<f64>]) -> Vec<usize> {
    let m = failed[0].len();
    let open = |n: &usize| failed.iter().any(|curve| curve[*n] > 0.0 && curve[*n] < 1.0);
    let found: Vec<usize> = (0..m).filter(open).collect();
    if found.is_empty() { vec![m - 1] } else { found }
}
