//! Ask and tell: which points to simulate next, and what is known once they are. No scene, no evaluator, no clock.

use super::observations::{Observations, Observed};
use super::round::{Assessment, assess};
use crate::design::{InputModel, Population, choose_by_latin_hypercube};
use crate::learning::{Mode, Rule, Stopping, Targets, select_batch};
use crate::reliability::coefficient_of_variation;
use crate::summary::Round;
use crate::surrogate::{Correlation, Effort, StatedErrors, SurrogateError};
use common::failure::SimulationFailure;
use std::mem::discriminant;
use thiserror::Error;

/// What is to be learned.
#[derive(Debug, Clone, PartialEq)]
pub struct Problem {
    /// The d random variables and how they depend on each other.
    pub inputs: InputModel,
    /// Number of outputs of an evaluation.
    pub outputs: usize,
    /// Limit states.
    pub modes: Vec<Mode>,
    /// Checkpoints of life [cycles] `(m,)`; a static problem has one.
    pub checkpoints: Vec<u32>,
}

/// How it is to be learned.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Plan {
    /// Monte Carlo population to begin with.
    pub population: usize,
    /// Size to which the population may grow for the coefficient of variation.
    pub largest_population: usize,
    /// Initial design, the nominal point included.
    pub initial: usize,
    /// Points per round.
    pub batch: usize,
    /// Budget of evaluations, failed ones included.
    pub max_evaluations: usize,
    /// Seed of every draw.
    pub seed: u64,
    /// Stopping rules.
    pub targets: Targets,
    /// What the surrogates make of the numerical errors that simulations state.
    pub stated_errors: StatedErrors,
}

/// What the campaign wants next.
#[derive(Debug, Clone, PartialEq)]
pub enum Step {
    /// Simulate these samples `(count)(d,)` [SI] and [`Campaign::tell`] the outcomes in the same order.
    Evaluate(Vec<Vec<f64>>),
    /// Nothing: learning has ended.
    Done,
}

/// Why learning ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Stop {
    /// A stopping rule held.
    Rule(Rule),
    /// The budget of evaluations is spent.
    Budget,
}

/// Why a campaign cannot go on.
#[derive(Debug, Error)]
pub enum CampaignError {
    /// More than a fifth of the simulations failed.
    #[error("{failed} of {total} simulations failed, {count} of them like this: {cause}")]
    TooManyFailures {
        /// Failed.
        failed: usize,
        /// Simulated.
        total: usize,
        /// Failures of the commonest kind.
        count: usize,
        /// The first of them.
        cause: SimulationFailure,
    },
    /// A surrogate could not be made.
    #[error("surrogate of limit state {mode}: {source}")]
    Surrogate {
        /// Index of the limit state, from 0.
        mode: usize,
        /// Why.
        source: SurrogateError,
    },
}

/// Share of failed simulations that ends a campaign, and the least number simulated before it can.
const FAILED_SHARE: f64 = 0.2;
const FAILED_AFTER: usize = 10;
/// A fresh fit from several starts every so many rounds, against a lasting local optimum.
const FRESH_FIT_EVERY: usize = 4;
/// The pool holds at least this many points per point of a batch.
const POOL_PER_BATCH: usize = 8;

/// A campaign of active learning.
#[derive(Debug)]
pub struct Campaign {
    problem: Problem,
    plan: Plan,
    population: Population,
    /// Points of the population that were asked for `(N,)`.
    evaluated: Vec<bool>,
    observations: Observations,
    failures: Vec<SimulationFailure>,
    /// Standardised points asked for and not yet told.
    asked: Vec<Vec<f64>>,
    total: usize,
    correlations: Vec<Option<Correlation>>,
    /// Curves of the round before, over the present population.
    previous: Option<Vec<Vec<f64>>>,
    stopping: Stopping,
    rounds: Vec<Round>,
    assessment: Option<Assessment>,
    stop: Option<Stop>,
}

impl Campaign {
    /// Draws the population. The plan must have `initial` >= 3 and `batch` >= 1; one mode at least.
    pub fn new(problem: Problem, plan: Plan) -> Self {
        let population = Population::draw(&problem.inputs, plan.population, plan.seed);
        Self {
            evaluated: vec![false; population.len()],
            observations: Observations::new(problem.inputs.dimension(), problem.outputs),
            failures: Vec::new(),
            asked: Vec::new(),
            total: 0,
            correlations: vec![None; problem.modes.len()],
            previous: None,
            stopping: Stopping::default(),
            rounds: Vec::new(),
            assessment: None,
            stop: None,
            population,
            problem,
            plan,
        }
    }

    /// What to do next. Fits and classifies when the last batch has been told.
    ///
    /// # Errors
    /// [`CampaignError::Surrogate`].
    pub fn next_step(&mut self) -> Result<Step, CampaignError> {
        if self.total == 0 {
            return Ok(self.ask_initial_design());
        }
        if self.stop.is_some() {
            return Ok(Step::Done);
        }
        loop {
            let (assessment, met) = self.assess_until_fresh()?;
            let cov = coefficient_of_variation(assessment.governing_failed(), self.population.len());
            self.note(&assessment, cov);
            self.previous = Some(assessment.curves.clone());
            let spent = self.total >= self.plan.max_evaluations;
            if self.stopping.note(met, &self.plan.targets) {
                if cov > self.plan.targets.cov && self.population.len() < self.plan.largest_population {
                    self.enlarge(assessment.governing_failed());
                    continue;
                }
                self.stop = met.map(Stop::Rule);
            } else if spent {
                self.stop = Some(Stop::Budget);
            }
            if self.stop.is_some() {
                self.assessment = Some(assessment);
                return Ok(Step::Done);
            }
            return Ok(self.ask_batch(assessment));
        }
    }

    /// Takes the outcomes of the batch asked for, in its order.
    ///
    /// # Errors
    /// [`CampaignError::TooManyFailures`].
    pub fn tell(&mut self, outcomes: Vec<Result<Observed, SimulationFailure>>) -> Result<(), CampaignError> {
        let asked = std::mem::take(&mut self.asked);
        assert_eq!(asked.len(), outcomes.len(), "every sample asked for has one outcome");
        let initial = self.total == 0;
        self.total += asked.len();
        for (z, outcome) in asked.into_iter().zip(outcomes) {
            match outcome {
                Ok(observed) => self.observations.add(&z, observed),
                Err(failure) => self.failures.push(failure),
            }
        }
        if initial {
            self.observations.close_design();
        }
        check_failures(&self.failures, self.total)
    }

    /// The nominal point first, then the population's points nearest a Latin hypercube.
    fn ask_initial_design(&mut self) -> Step {
        let count = self.plan.initial.min(self.plan.max_evaluations);
        let chosen = choose_by_latin_hypercube(&self.population, count.saturating_sub(1), self.plan.seed);
        let means = self.problem.inputs.means();
        self.asked = vec![self.problem.inputs.standardise(&means)];
        let mut samples = vec![means];
        for j in chosen {
            samples.push(self.take(j));
        }
        Step::Evaluate(samples)
    }

    fn ask_batch(&mut self, assessment: Assessment) -> Step {
        let batch = self.plan.batch.min(self.plan.max_evaluations - self.total);
        let governing = assessment.governing_on_grid();
        let Assessment { modes, pool, posteriors, .. } = assessment;
        let chosen = select_batch(&modes, &pool, posteriors, governing, batch);
        if chosen.is_empty() {
            // Every point of the population was simulated.
            self.stop = Some(Stop::Rule(Rule::Learning));
            return Step::Done;
        }
        Step::Evaluate(chosen.into_iter().map(|j| self.take(j)).collect())
    }

    /// Marks point `j` as asked for; its sample in SI.
    fn take(&mut self, j: usize) -> Vec<f64> {
        self.evaluated[j] = true;
        self.asked.push(self.population.standardised(j).to_vec());
        self.population.physical(j)
    }

    /// Assesses; where a stopping rule is met after a warm fit, again after a fresh one.
    fn assess_until_fresh(&mut self) -> Result<(Assessment, Option<Rule>), CampaignError> {
        let fresh = self.rounds.len().is_multiple_of(FRESH_FIT_EVERY);
        let mut effort = if fresh { Effort::MultiStart } else { Effort::Warm };
        let mut repairs = 0;
        loop {
            let least = POOL_PER_BATCH * self.plan.batch;
            let round = u32::try_from(self.rounds.len()).unwrap_or(u32::MAX);
            let mut assessment = assess(
                &self.problem,
                &self.population,
                &self.evaluated,
                &self.observations,
                &self.correlations,
                self.previous.as_deref(),
                (effort, self.plan.stated_errors),
                (least, self.plan.seed, round),
            )?;
            repairs += assessment.repairs;
            assessment.repairs = repairs;
            self.correlations =
                assessment.surrogates.iter().map(|s| Some(s.model.correlation().clone())).collect();
            let met = self.plan.targets.met(&assessment.figures);
            if met.is_none() || effort == Effort::MultiStart {
                return Ok((assessment, met));
            }
            effort = Effort::MultiStart;
        }
    }

    fn note(&mut self, assessment: &Assessment, cov: f64) {
        let figures = &assessment.figures;
        let governing = assessment.governing;
        let relative = |change: f64| change / figures.governing_share.max(1.0 / self.population.len() as f64);
        self.rounds.push(Round {
            round: self.rounds.len(),
            evaluations: self.total,
            // Beyond 100 the figure says nothing more, and JSON has no infinity.
            min_u: figures.min_u.min(100.0),
            share_uncertain: assessment.share_uncertain,
            change_of_r: figures.change.map(relative),
            surrogate_error: figures.error,
            cov_pf: cov,
            dominance: assessment.dominance,
            cycles: self.problem.checkpoints[governing],
            reliability_total: 1.0 - assessment.governing_failed(),
            repairs: assessment.repairs,
        });
    }

    /// Grows the population to what the coefficient of variation asks for, with a tenth in reserve (tenfold while
    /// nothing fails), never more than tenfold at once; learning then goes on.
    fn enlarge(&mut self, failed: f64) {
        let n = self.population.len();
        let pf = failed.max(1.0 / n as f64);
        let wanted = 1.1 * (1.0 - pf) / (pf * self.plan.targets.cov.powi(2));
        let wanted = (wanted.ceil() as usize).clamp(n + n / 10 + 1, 10 * n);
        self.population.grow_to(wanted.min(self.plan.largest_population));
        self.evaluated.resize(self.population.len(), false);
        self.previous = None;
        self.stopping.reset();
    }

    /// The rounds so far.
    pub fn rounds(&self) -> &[Round] {
        &self.rounds
    }

    /// Evaluations told so far, failed ones included.
    pub fn evaluations(&self) -> usize {
        self.total
    }

    /// Failed simulations so far.
    pub fn failed(&self) -> usize {
        self.failures.len()
    }

    /// What was learned, once [`Step::Done`] has been answered.
    pub fn finish(self) -> Option<Learned> {
        let stop = self.stop?;
        Some(Learned {
            population: self.population,
            observations: self.observations,
            assessment: self.assessment?,
            rounds: self.rounds,
            evaluations: self.total,
            failed: self.failures.len(),
            stop,
        })
    }
}

/// What a campaign learned.
#[derive(Debug)]
pub struct Learned {
    /// The population at the end.
    pub population: Population,
    /// All results.
    pub observations: Observations,
    /// The last round's surrogates and classification.
    pub assessment: Assessment,
    /// All rounds.
    pub rounds: Vec<Round>,
    /// Evaluations, failed ones included.
    pub evaluations: usize,
    /// Failed simulations.
    pub failed: usize,
    /// Why it ended.
    pub stop: Stop,
}

/// Refuses to go on when more than a fifth of at least ten simulations failed.
pub(super) fn check_failures(failures: &[SimulationFailure], total: usize) -> Result<(), CampaignError> {
    if total < FAILED_AFTER || failures.len() as f64 <= FAILED_SHARE * total as f64 {
        return Ok(());
    }
    let like = |a: &SimulationFailure| failures.iter().filter(|b| discriminant(a) == discriminant(b)).count();
    // The first of the commonest kind.
    let cause = failures.iter().rev().max_by_key(|a| like(a)).expect("more than a fifth failed");
    Err(CampaignError::TooManyFailures {
        failed: failures.len(),
        total,
        count: like(cause),
        cause: cause.clone(),
    })
}
