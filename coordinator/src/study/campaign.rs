//! A campaign of active learning as an ask-and-tell interface: [`Campaign::next_step`] names the samples to
//! simulate, [`Campaign::record`] takes their outcomes. It uses no scene, no evaluator and no clock.
//!
//! The loop is AK-MCS: initial design by Latin hypercube, Kriging of every limit state, classification of the
//! population, samples by a learning function, a stopping rule, and a larger (or conditional) population
//! where the coefficient of variation of the failure probability asks for one.
//!
//! # Source
//! Echard, Gayton, Lemaire (2011), AK-MCS: an active learning reliability method combining Kriging and Monte
//! Carlo simulation, Structural Safety 33(2).

use super::campaign_data::{CampaignData, judge, largest_prediction_error};
use super::failures::{check_failures, check_results};
use super::requests::{PendingSample, Requests};
use super::round::{Assessment, assess};
use super::surrogates::SurrogateState;
use super::{CampaignError, ClassifiedPopulation, ObservedOutcome, Plan, Problem, Step, StopReason};
use crate::results::summary::Round;
use crate::statistics::design::{Population, choose_by_latin_hypercube, latin_hypercube};
use crate::statistics::learning::{Rule, Stopping, UNCERTAIN};
use crate::statistics::surrogate::Effort;

/// Error in predicted standard deviations from which a result contradicts the surrogates while a stopping
/// rule holds: 6e-5 for a normal error.
const CONTRADICTION: f64 = 4.0;

/// A campaign of active learning.
///
/// [`Campaign::next_step`] may be called while outcomes are missing; it returns [`Step::Wait`] once as many
/// points are under way as the plan allows. Chunks are recorded in the order of their requests, so the points
/// depend on the outcomes and not on the time of their arrival.
#[derive(Debug)]
pub struct Campaign {
    pub(super) problem: Problem,
    pub(super) plan: Plan,
    pub(super) classified: ClassifiedPopulation,
    pub(super) requests: Requests,
    pub(super) data: CampaignData,
    pub(super) surrogates: SurrogateState,
    pub(super) stopping: Stopping,
    /// The rounds so far.
    pub rounds: Vec<Round>,
    /// Assessment of all outcomes received; absent until the newest have been assessed.
    pub assessment: Option<Assessment>,
    /// Why learning has ended; absent until it has.
    pub(super) stop: Option<StopReason>,
}

impl Campaign {
    /// Draws the population. The plan must have `initial` >= 3 and `batch` >= 1; the problem has at least one
    /// mode.
    pub fn new(problem: Problem, plan: Plan) -> Self {
        let population = Population::draw(&problem.inputs, plan.settings.samples, plan.settings.seed);
        Self {
            requests: Requests::new(population.len()),
            data: CampaignData::new(problem.inputs.dimension()),
            surrogates: SurrogateState::new(problem.modes.len()),
            stopping: Stopping::default(),
            rounds: Vec::new(),
            assessment: None,
            stop: None,
            classified: ClassifiedPopulation::new(population),
            problem,
            plan,
        }
    }

    /// Returns the next step. Fits and classifies if outcomes were recorded since the last call.
    ///
    /// # Errors
    /// [`CampaignError::Surrogate`], [`CampaignError::TooFewResults`].
    pub fn next_step(&mut self) -> Result<Step, CampaignError> {
        loop {
            let step = self.step_on_this_population()?;
            if step != Step::Done || !self.classified.grow_to_next(&self.plan.settings.larger_populations) {
                return Ok(step);
            }
            self.restart_on_new_population();
            (self.stop, self.assessment) = (None, None);
        }
    }

    fn step_on_this_population(&mut self) -> Result<Step, CampaignError> {
        if self.requests.total == 0 {
            // The nominal point, alone: a simulator that cannot answer is found out by one evaluation.
            return Ok(self.requests.begin(vec![PendingSample::nominal(&self.problem.inputs)]));
        }
        let waiting = self.requests.under_way();
        if self.stop.is_some() {
            return Ok(if waiting == 0 { Step::Done } else { Step::Wait });
        }
        if !self.requests.retries.is_empty() && self.budget_left() > 0 {
            return Ok(self.request_retries());
        }
        if self.rounds.is_empty() && waiting > 0 {
            return Ok(Step::Wait);
        }
        if !self.data.observations.has_design() {
            return Ok(self.request_initial_design());
        }
        while self.assessment.is_none() {
            if let Some(step) = self.repeat_outliers() {
                return Ok(step);
            }
            self.assess_and_decide()?;
        }
        // A rule that is met must hold over all results: no new request until those under way have arrived.
        let settling = self.stop.is_none() && self.stopping.is_holding() && waiting > 0;
        if self.stop.is_none() && self.budget_left() == 0 && waiting == 0 {
            self.assess_missing_checkpoints()?;
            self.redraw_at_the_end()?;
            self.stop = Some(StopReason::Budget);
        }
        if self.stop.is_some()
            || settling
            || self.budget_left() == 0
            || waiting + self.plan.settings.chunk() > self.plan.settings.batch
        {
            return Ok(if waiting == 0 && self.stop.is_some() { Step::Done } else { Step::Wait });
        }
        Ok(self.request_chunk())
    }

    /// Records the outcomes of the oldest chunk under way, in the order of its samples.
    ///
    /// # Errors
    /// [`CampaignError::Nominal`], [`CampaignError::TooManyFailures`].
    pub fn record(&mut self, outcomes: Vec<ObservedOutcome>) -> Result<(), CampaignError> {
        let chunk = self.requests.finish_oldest(outcomes.len());
        let is_nominal = self.data.observations.is_empty();
        let learning = !self.rounds.is_empty();
        let is_repetition = chunk.iter().all(PendingSample::is_repetition);
        for (pending, outcome) in chunk.into_iter().zip(outcomes) {
            match outcome {
                outcome if !pending.not_by.is_empty() => self.record_repetition(&pending.z, outcome),
                Ok(observed) if pending.exploring => {
                    let judgement =
                        judge(&self.surrogates.models, &self.problem.modes, &pending.z, &observed);
                    self.data.add_exploring(pending.z, observed, judgement);
                }
                Ok(observed) => self.data.observations.add_for(&pending.z, observed, pending.mode),
                Err(cause) if self.plan.retry && !pending.stricter => {
                    self.requests.retries.push_back((PendingSample { stricter: true, ..pending }, cause));
                }
                Err(cause) => {
                    self.data.add_failed(pending.z, cause, learning, pending.beyond);
                }
            }
        }
        self.assessment = None;
        if is_nominal {
            let failed = self.data.failed.first().map(|failed| failed.cause.clone());
            return failed.map_or(Ok(()), |cause| Err(CampaignError::Nominal { cause }));
        }
        if !learning && !is_repetition {
            self.data.observations.close_design();
        }
        let samples = self.requests.samples_received();
        check_failures(self.data.unexpected_failures(), samples, self.plan.settings.max_failed)
    }

    /// Simulations the budget leaves.
    pub(super) fn budget_left(&self) -> usize {
        self.plan.settings.max_evaluations.saturating_sub(self.requests.total)
    }

    /// Requests the rest of the initial design: the user's own samples, or a Latin hypercube; as published, or if the population is all there
    /// is, the points of the population nearest to it.
    fn request_initial_design(&mut self) -> Step {
        let count = self.plan.settings.initial.saturating_sub(1).min(self.budget_left());
        let (population, seed) = (&self.classified.population, self.plan.settings.seed);
        let own = &self.plan.settings.initial_samples;
        let chunk = if !own.is_empty() {
            let inputs = &self.problem.inputs;
            own.iter().take(count).map(|x| PendingSample::at(inputs.standardise(x), inputs)).collect()
        } else if self.plan.is_as_published() || self.plan.largest_population <= population.len() {
            let chosen = choose_by_latin_hypercube(population, count, seed);
            chosen.into_iter().map(|j| self.requests.take(&self.classified, j)).collect()
        } else {
            let inputs = &self.problem.inputs;
            let design = latin_hypercube(inputs, count, seed);
            design.chunks_exact(inputs.dimension()).map(|z| PendingSample::at(z.to_vec(), inputs)).collect()
        };
        self.requests.begin(chunk)
    }

    /// Requests again what failed once, as far as the budget allows.
    fn request_retries(&mut self) -> Step {
        let count = self.budget_left().min(self.requests.retries.len());
        let retries = self.requests.retries.drain(..count).map(|(pending, _)| pending).collect();
        self.requests.begin(retries)
    }

    /// Requests the next chunk: exploring points first, then those of the learning function.
    fn request_chunk(&mut self) -> Step {
        if self.plan.is_as_published() {
            let mut chunk = self.choose_as_published();
            chunk.truncate(self.budget_left());
            return self.requests.begin(chunk);
        }
        let count = self.plan.settings.chunk().min(self.budget_left());
        let exploring = self.stopping.exploring(self.data.results() + self.data.failed.len(), count);
        let mut chunk = self.explore(exploring);
        let assessment = self.assessment.as_mut().expect("all outcomes have been assessed");
        // One after the other: a choice marks its copies in a conditional population, which the selection, made
        // before, does not know.
        let Assessment { selection, modes, .. } = assessment;
        while chunk.len() < count {
            let Some(j) = selection.choose(modes) else { break };
            if !self.requests.requested[j] {
                chunk.push(self.requests.take(&self.classified, j));
            }
        }
        if chunk.is_empty() {
            // Every point of the population was simulated or is under way.
            if self.requests.under_way() == 0 {
                self.stop = Some(StopReason::Rule(Rule::Learning));
                return Step::Done;
            }
            return Step::Wait;
        }
        self.requests.begin(chunk)
    }

    /// Assesses all outcomes received and decides whether learning stops or needs another population. Where outliers are to be evaluated
    /// again first, there is no assessment.
    fn assess_and_decide(&mut self) -> Result<(), CampaignError> {
        let unrepeated = self.requests.retries.iter().map(|(_, cause)| cause);
        let causes = self.data.failed.iter().map(|failed| &failed.cause).chain(unrepeated);
        check_results(self.data.observations.len(), causes, self.requests.samples_received())?;
        loop {
            let (assessment, met) = self.assess_until_fresh()?;
            if self.note_outliers(&assessment) {
                return Ok(());
            }
            let failed = assessment.governing_failed();
            self.add_round(&assessment);
            self.surrogates.previous_curves = Some(assessment.curves.clone());
            let (classified, plan) = (&mut self.classified, &self.plan);
            let (ends, replaced) = if plan.is_as_published() {
                (met.is_some(), met.is_some() && classified.grow_if_needed(plan, failed))
            } else {
                let barred = assessment.feasibility.barred_share(classified.unconditional());
                let rare = classified.is_rare(plan, failed, barred);
                let points = if rare && !classified.is_conditional() {
                    plan.targets.points_before_condition()
                } else {
                    plan.targets.points_to_hold(self.problem.inputs.dimension(), rare)
                };
                let needed = (plan.targets.hold, points);
                let held = self.stopping.record_round(met, self.data.results(), needed);
                let ends = held && self.requests.under_way() == 0;
                let surrogates = &assessment.surrogates;
                let at_once = plan.settings.is_rare && self.rounds.len() == 1;
                (ends, (ends || at_once) && classified.replace_if_needed(plan, surrogates, failed, barred))
            };
            if replaced {
                self.restart_on_new_population();
                continue;
            }
            if ends {
                self.stop = met.map(StopReason::Rule);
            }
            self.assessment = Some(assessment);
            return Ok(());
        }
    }

    /// Draws a conditional population once more where the budget ends learning before it has settled: the last results
    /// may have shown failures outside the event it is conditional on. What changes counts as an error.
    pub(super) fn redraw_at_the_end(&mut self) -> Result<(), CampaignError> {
        let Some(assessment) = self.assessment.as_ref().filter(|_| self.classified.is_conditional()) else {
            return Ok(());
        };
        let before = self.classified.condition.probability * assessment.governing_failed();
        self.classified.draw(&self.plan, &assessment.surrogates);
        self.restart_on_new_population();
        let (assessment, _) = self.assess_until_fresh()?;
        let failed = assessment.governing_failed();
        self.classified.add_change(before, failed);
        self.add_round(&assessment);
        self.assessment = Some(assessment);
        Ok(())
    }

    pub(super) fn add_round(&mut self, assessment: &Assessment) {
        let cov_pf = self.classified.coefficient_of_variation(assessment.governing_failed());
        let mut row = assessment.row(self.classified.condition.probability, self.classified.population.len());
        (row.round, row.evaluations, row.cov_pf) = (self.rounds.len(), self.requests.received, cov_pf);
        row.cycles = self.problem.checkpoints[assessment.governing];
        self.rounds.push(row);
    }

    fn restart_on_new_population(&mut self) {
        self.requests.mark_known(&self.classified.population);
        self.surrogates.reset_population();
        self.stopping.reset(self.classified.similar);
    }

    /// Assesses the outcomes; if a stopping rule is met with lengths that are not fresh, assesses again after
    /// a fit from several starts.
    pub(super) fn assess_until_fresh(&mut self) -> Result<(Assessment, Option<Rule>), CampaignError> {
        let observations = &self.data.observations;
        let n = observations.len();
        let mut effort = self.surrogates.effort(n);
        let mut repairs = 0;
        let error = || largest_prediction_error(&self.surrogates.models, &self.problem.modes, observations);
        let contradicted = std::mem::take(&mut self.data.contradicted);
        if self.stopping.is_holding() {
            let far_off = error() > CONTRADICTION;
            if far_off {
                effort = Effort::MultiStart;
            }
            if far_off || contradicted {
                self.stopping.reset(false);
                self.classified.require_another_draw();
            }
        }
        let round = u32::try_from(self.rounds.len()).unwrap_or(u32::MAX);
        loop {
            let Self { problem, plan, classified, requests, data, surrogates, .. } = self;
            let population = &classified.population;
            let mut assessment =
                assess((problem, plan), population, requests, data, surrogates, (round, effort))?;
            repairs += assessment.repairs;
            assessment.repairs = repairs;
            self.surrogates.models.clone_from(&assessment.surrogates);
            self.surrogates.record_fit(effort, n);
            if self.plan.is_as_published() {
                let least = self.least_u_as_published(&assessment);
                assessment.figures.min_u = least;
                return Ok((assessment, (least >= UNCERTAIN).then_some(Rule::Learning)));
            }
            let met = self.plan.targets.met(&assessment.figures);
            if met.is_none() || self.surrogates.is_fresh(n) {
                return Ok((assessment, met));
            }
            effort = Effort::MultiStart;
        }
    }

    /// Point `j` of the population `(d,)` [SI].
    pub fn sample(&self, j: usize) -> Vec<f64> {
        self.classified.population.physical(j)
    }

    /// Number of evaluations whose outcome has been recorded, failed ones included.
    pub fn evaluations(&self) -> usize {
        self.requests.received
    }
}
