//! Ask and tell: which points to simulate next, and what is known once they are. No scene, no evaluator, no clock.

use super::failures::{Failed, check_failures};
use super::learned::Learned;
use super::observations::{Observations, Observed};
use super::plan::{Plan, Problem};
use super::populations::LookedAt;
use super::round::{Assessment, Known, assess};
use super::so_far::SoFar;
use super::step::{Ask, CampaignError, Step, Stop};
use super::surprise::{largest_surprise, matters_to};
use super::surrogates::Surrogate;
use crate::results::summary::Round;
use crate::statistics::design::{Population, choose_by_latin_hypercube};
use crate::statistics::learning::{Rule, Stopping};
use crate::statistics::surrogate::{Effort, PredictionCache};
use common::failure::SimulationFailure;
use std::collections::VecDeque;

/// Growth of the number of results after which the lengths are fitted anew: every fit costs a prediction of the whole
/// population, while points added at the same lengths cost a row each.
const REFIT: f64 = 1.1;
/// Growth after which they are fitted from several starts, and forms compared, against a lasting local optimum.
const FRESH_FIT: f64 = 1.3;
/// Error in predicted standard deviations from which a result counts as a surprise while a stopping rule holds.
const SURPRISED: f64 = 4.0;

/// A simulation that is under way.
#[derive(Debug, Clone)]
struct Asked {
    /// Standardised point `(d,)` [1].
    z: Vec<f64>,
    sample: Vec<f64>,
    /// Its place in the population, if it has one.
    member: Option<usize>,
    stricter: bool,
    /// Whether it was chosen for how little is known there.
    exploring: bool,
}

/// A campaign of active learning.
///
/// Ask and tell with a look-ahead: [`Campaign::next_step`] may be called while outcomes are missing, and answers
/// [`Step::Wait`] once as many points are under way as the plan allows. Chunks are told in the order they were asked
/// for, so the points depend on the outcomes, not on when they came.
#[derive(Debug)]
pub struct Campaign {
    problem: Problem,
    plan: Plan,
    looked_at: LookedAt,
    /// Points of the population that were asked for `(N,)`.
    asked: Vec<bool>,
    /// Chunks under way, the oldest first.
    under_way: VecDeque<Vec<Asked>>,
    /// Failed once, to be asked for again, and why.
    retries: VecDeque<(Asked, SimulationFailure)>,
    observations: Observations,
    /// Standardised points where exploring results were as predicted, and not taken up.
    confirmed: Vec<Vec<f64>>,
    failed: Vec<Failed>,
    /// Simulations asked for and told.
    total: usize,
    told: usize,
    /// Of the last look, per mode; none before the first.
    surrogates: Vec<Surrogate>,
    caches: Vec<PredictionCache>,
    /// Results at the last fit of the lengths, and at the last one from several starts.
    fitted: (usize, usize),
    /// Curves of the round before, over the present population.
    previous: Option<Vec<Vec<f64>>>,
    stopping: Stopping,
    rounds: Vec<Round>,
    /// Of all that was told; absent while something new is not yet looked at.
    assessment: Option<Assessment>,
    stop: Option<Stop>,
}

impl Campaign {
    /// Draws the population. The plan must have `initial` >= 3 and `batch` >= 1; one mode at least.
    pub fn new(problem: Problem, plan: Plan) -> Self {
        let population = Population::draw(&problem.inputs, plan.settings.samples, plan.settings.seed);
        Self {
            asked: vec![false; population.len()],
            under_way: VecDeque::new(),
            retries: VecDeque::new(),
            observations: Observations::new(problem.inputs.dimension(), problem.outputs),
            confirmed: Vec::new(),
            failed: Vec::new(),
            total: 0,
            told: 0,
            surrogates: Vec::new(),
            caches: vec![PredictionCache::default(); problem.modes.len()],
            fitted: (0, 0),
            previous: None,
            stopping: Stopping::default(),
            rounds: Vec::new(),
            assessment: None,
            stop: None,
            looked_at: LookedAt::new(population),
            problem,
            plan,
        }
    }

    /// What to do next. Fits and classifies when something new has been told.
    ///
    /// # Errors
    /// [`CampaignError::Surrogate`].
    pub fn next_step(&mut self) -> Result<Step, CampaignError> {
        if self.total == 0 {
            return Ok(self.ask_initial_design());
        }
        if self.stop.is_some() {
            return Ok(if self.under_way.is_empty() { Step::Done } else { Step::Wait });
        }
        if !self.retries.is_empty() && self.left() > 0 {
            let count = self.left().min(self.retries.len());
            let retries = self.retries.drain(..count).map(|(asked, _)| asked).collect();
            return Ok(self.ask(retries));
        }
        let waiting: usize = self.under_way.iter().map(Vec::len).sum();
        if self.rounds.is_empty() && waiting > 0 {
            return Ok(Step::Wait);
        }
        if self.assessment.is_none() {
            self.look()?;
        }
        // A rule that is met must hold with everything known: nothing new is asked for until that is told.
        let settling = self.stop.is_none() && self.stopping.holding() && waiting > 0;
        if self.stop.is_none() && self.left() == 0 && waiting == 0 {
            self.stop = Some(Stop::Budget);
        }
        if self.stop.is_some()
            || settling
            || self.left() == 0
            || waiting + self.plan.settings.chunk() > self.plan.settings.batch
        {
            return Ok(if waiting == 0 && self.stop.is_some() { Step::Done } else { Step::Wait });
        }
        Ok(self.ask_chunk())
    }

    /// Takes the outcomes of the chunk that was asked for first, in its order.
    ///
    /// # Errors
    /// [`CampaignError::TooManyFailures`].
    pub fn tell(&mut self, outcomes: Vec<Result<Observed, SimulationFailure>>) -> Result<(), CampaignError> {
        let chunk = self.under_way.pop_front().expect("outcomes are told of what was asked for");
        assert_eq!(chunk.len(), outcomes.len(), "every sample asked for has one outcome");
        let initial = self.told == 0;
        self.told += chunk.len();
        for (asked, outcome) in chunk.into_iter().zip(outcomes) {
            match outcome {
                Ok(observed)
                    if asked.exploring
                        && !matters_to(&self.surrogates, &self.problem.modes, &asked.z, &observed) =>
                {
                    self.confirmed.push(asked.z);
                }
                Ok(observed) => self.observations.add(&asked.z, observed),
                Err(cause) if self.plan.retry && !asked.stricter => {
                    self.retries.push_back((Asked { stricter: true, ..asked }, cause));
                }
                Err(cause) => self.failed.push(Failed { z: asked.z, cause }),
            }
        }
        if initial {
            self.observations.close_design();
        }
        self.assessment = None;
        check_failures(self.failed.iter().map(|f| &f.cause), self.told, self.plan.settings.max_failed)
    }

    /// Learns to the end from simulations that are made here and now, one after the other. `look` sees the campaign after
    /// each step.
    ///
    /// # Errors
    /// [`CampaignError`].
    pub fn learn_from(
        mut self,
        mut simulate: impl FnMut(&[f64]) -> Result<Observed, SimulationFailure>,
        mut look: impl FnMut(&Self),
    ) -> Result<Learned, CampaignError> {
        let mut under_way = VecDeque::new();
        loop {
            let step = self.next_step()?;
            look(&self);
            match step {
                Step::Evaluate(asks) => under_way.push_back(asks),
                Step::Wait => {
                    let asks: Vec<Ask> = under_way.pop_front().expect("it waits for something asked for");
                    self.tell(asks.iter().map(|ask| simulate(&ask.sample)).collect())?;
                }
                Step::Done => break,
            }
        }
        Ok(self.finish().expect("a campaign that is done has learned something"))
    }

    /// Results so far.
    fn results(&self) -> usize {
        self.observations.len() + self.confirmed.len()
    }

    /// Simulations the budget leaves.
    fn left(&self) -> usize {
        self.plan.settings.max_evaluations.saturating_sub(self.total)
    }

    fn ask(&mut self, chunk: Vec<Asked>) -> Step {
        self.total += chunk.len();
        let asks = chunk.iter().map(|a| Ask { sample: a.sample.clone(), stricter: a.stricter }).collect();
        self.under_way.push_back(chunk);
        Step::Evaluate(asks)
    }

    /// The nominal point first, then the population's points nearest a Latin hypercube.
    fn ask_initial_design(&mut self) -> Step {
        let count = self.plan.settings.initial.min(self.plan.settings.max_evaluations);
        let chosen = choose_by_latin_hypercube(
            &self.looked_at.population,
            count.saturating_sub(1),
            self.plan.settings.seed,
        );
        let sample = self.problem.inputs.means();
        let nominal = self.problem.inputs.standardise(&sample);
        let mut chunk = vec![Asked { z: nominal, sample, member: None, stricter: false, exploring: false }];
        chunk.extend(chosen.into_iter().map(|j| self.take(j)));
        self.ask(chunk)
    }

    fn ask_chunk(&mut self) -> Step {
        let count = self.plan.settings.chunk().min(self.left());
        let exploring = self.stopping.exploring(self.results(), count);
        let assessment = self.assessment.as_mut().expect("everything told was looked at");
        let mut chosen =
            assessment.explore((&self.looked_at.population, &self.asked), &self.confirmed, exploring);
        let exploring = chosen.len();
        chosen.extend(assessment.selection.choose(&assessment.modes, count - chosen.len()));
        if chosen.is_empty() {
            // Every point of the population was simulated or is under way.
            if self.under_way.is_empty() {
                self.stop = Some(Stop::Rule(Rule::Learning));
                return Step::Done;
            }
            return Step::Wait;
        }
        let mut chunk: Vec<Asked> = chosen.into_iter().map(|j| self.take(j)).collect();
        chunk[..exploring].iter_mut().for_each(|asked| asked.exploring = true);
        self.ask(chunk)
    }

    /// Marks point `j` as asked for.
    fn take(&mut self, j: usize) -> Asked {
        self.asked[j] = true;
        let z = self.looked_at.population.standardised(j).to_vec();
        let sample = self.looked_at.population.physical(j);
        Asked { z, sample, member: Some(j), stricter: false, exploring: false }
    }

    /// Looks at all that was told, and decides whether learning may stop.
    fn look(&mut self) -> Result<(), CampaignError> {
        loop {
            let (assessment, met) = self.assess_until_fresh()?;
            let failed = assessment.governing_failed();
            let cov = self.looked_at.coefficient_of_variation(failed);
            let population = self.looked_at.population.len();
            let mut row = assessment.row(self.looked_at.condition.probability, population);
            (row.round, row.evaluations, row.cov_pf) = (self.rounds.len(), self.told, cov);
            row.cycles = self.problem.checkpoints[assessment.governing];
            self.rounds.push(row);
            self.previous = Some(assessment.curves.clone());
            let points = self.results();
            if self.stopping.note(met, points, &self.plan.targets) && self.under_way.is_empty() {
                let surrogates = &assessment.surrogates;
                if self.looked_at.changes(&self.problem, &self.plan, surrogates, failed, cov) {
                    self.asked = vec![false; self.looked_at.population.len()];
                    self.caches.fill(PredictionCache::default());
                    self.previous = None;
                    if self.looked_at.condition.levels == 0 {
                        self.stopping.go_on();
                    } else {
                        self.stopping.reset();
                    }
                    continue;
                }
                self.stop = met.map(Stop::Rule);
            }
            self.assessment = Some(assessment);
            return Ok(());
        }
    }

    /// How much to spend on the lengths, by how much is new.
    fn effort(&self) -> Effort {
        let (n, (fitted, fresh)) = (self.observations.len() as f64, self.fitted);
        if n >= FRESH_FIT * fresh as f64 {
            Effort::MultiStart
        } else if n >= REFIT * fitted as f64 {
            Effort::Warm
        } else {
            Effort::Keep
        }
    }

    /// Assesses; where a stopping rule is met and the last fit from several starts is of fewer results than that by more than
    /// [`REFIT`], again after one.
    fn assess_until_fresh(&mut self) -> Result<(Assessment, Option<Rule>), CampaignError> {
        let mut effort = self.effort();
        let mut repairs = 0;
        let surprise = || largest_surprise(&self.surrogates, &self.problem.modes, &self.observations);
        if self.stopping.holding() && surprise() > SURPRISED {
            self.stopping.reset();
            effort = Effort::MultiStart;
        }
        let under_way: Vec<usize> =
            self.under_way.iter().flatten().filter_map(|asked| asked.member).collect();
        loop {
            let known = Known {
                problem: &self.problem,
                plan: &self.plan,
                population: &self.looked_at.population,
                asked: &self.asked,
                under_way: &under_way,
                observations: &self.observations,
                failed: &self.failed,
                surrogates: &self.surrogates,
                previous: self.previous.as_deref(),
                round: u32::try_from(self.rounds.len()).unwrap_or(u32::MAX),
            };
            let mut assessment = assess(&known, &mut self.caches, effort)?;
            repairs += assessment.repairs;
            assessment.repairs = repairs;
            self.surrogates.clone_from(&assessment.surrogates);
            let n = self.observations.len();
            match effort {
                Effort::Keep => {}
                Effort::Warm | Effort::TwoStarts(_) => self.fitted.0 = n,
                Effort::MultiStart => self.fitted = (n, n),
            }
            let met = self.plan.targets.met(&assessment.figures);
            let fresh = (n as f64) < REFIT * self.fitted.1 as f64;
            if met.is_none() || fresh {
                return Ok((assessment, met));
            }
            effort = Effort::MultiStart;
        }
    }

    /// The rounds so far.
    pub fn rounds(&self) -> &[Round] {
        &self.rounds
    }

    /// Point `j` of the population `(d,)`, SI.
    pub fn sample(&self, j: usize) -> Vec<f64> {
        self.looked_at.population.physical(j)
    }

    /// What was found of all that was told; absent while something new is not yet looked at.
    pub fn assessment(&self) -> Option<&Assessment> {
        self.assessment.as_ref()
    }

    /// What is known after the last round, if nothing was told since.
    pub(super) fn so_far(&self) -> Option<SoFar> {
        let assessment = self.assessment.as_ref()?;
        Some(SoFar {
            failed: assessment.curves.clone(),
            points: self.looked_at.population.len(),
            surrogate: assessment.combined_errors(),
            condition: self.looked_at.condition,
        })
    }

    /// Evaluations told so far, failed ones included.
    pub fn evaluations(&self) -> usize {
        self.told
    }

    /// What was learned, once [`Step::Done`] has been answered.
    pub fn finish(mut self) -> Option<Learned> {
        let stop = self.stop?;
        // What the budget left no second attempt for.
        self.failed.extend(self.retries.drain(..).map(|(asked, cause)| Failed { z: asked.z, cause }));
        Some(Learned {
            looked_at: self.looked_at,
            observations: self.observations,
            assessment: self.assessment?,
            rounds: self.rounds,
            evaluations: self.told,
            failed: self.failed,
            stop,
        })
    }
}
