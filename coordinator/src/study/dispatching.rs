//! Numbered requests, the campaign file first, then the evaluator; outcomes checked and in order.

use super::responses::Responses;
use super::result;
use super::so_far::SoFar;
use super::thinking::{Learner, Thought, think};
use super::{Ask, CampaignError, Observed, Step, StudyError};
use crate::farm::evaluate::{Demand, EvaluateError, Evaluator, Finished, Request, RequestSource};
use crate::results::journal::Journal;
use crate::results::progress::{Observer, Progress};
use crate::results::summary::{Round, WorkerShare};
use common::accuracy::Accuracy;
use common::failure::SimulationFailure;
use common::scene::Scene;
use std::collections::{BTreeMap, VecDeque};
use std::sync::mpsc::{Receiver, Sender, TryRecvError, channel};
use std::time::{Duration, Instant};

/// Outcome of one sample.
pub(super) type Outcome = Result<Observed, SimulationFailure>;

/// A chunk that is not yet complete.
struct Chunk {
    /// Number of its first request.
    first: u64,
    outcomes: Vec<Option<Outcome>>,
}

/// Gets what a learner asks for evaluated, each sample under the next number.
pub(super) struct Dispatcher<'a> {
    outputs: usize,
    responses: Responses,
    /// Limit states, and the system.
    names: Vec<String>,
    checkpoints: Vec<u32>,
    /// Setting for what failed once.
    stricter: Option<Accuracy>,
    budget: usize,
    evaluator: &'a mut dyn Evaluator,
    record: Record<'a>,
}

/// Journal, observer and what is counted.
struct Record<'a> {
    journal: &'a mut dyn Journal,
    observer: &'a mut dyn Observer,
    next_id: u64,
    done: usize,
    shares: BTreeMap<String, (usize, f64)>,
    /// Time the learner took [s].
    thinking: Duration,
    /// That part of it in which nothing was under way.
    idle: Duration,
}

impl<'a> Dispatcher<'a> {
    /// `stricter` is the setting for what failed once, `budget` the bound on evaluations, for the observer.
    pub fn new(
        scene: &Scene,
        stricter: Option<Accuracy>,
        budget: usize,
        evaluator: &'a mut dyn Evaluator,
        journal: &'a mut dyn Journal,
        observer: &'a mut dyn Observer,
    ) -> Self {
        let record = Record {
            journal,
            observer,
            next_id: 0,
            done: 0,
            shares: BTreeMap::new(),
            thinking: Duration::ZERO,
            idle: Duration::ZERO,
        };
        Self {
            outputs: scene.outputs.len(),
            responses: Responses::of(scene),
            names: result::curve_names(scene),
            checkpoints: scene.life.checkpoints(),
            stricter,
            budget,
            evaluator,
            record,
        }
    }

    /// Evaluates what the learner asks for until it asks for no more.
    ///
    /// # Errors
    /// [`StudyError`]; whatever was evaluated is in the journal by then.
    pub fn run(&mut self, learner: &mut dyn Learner) -> Result<(), StudyError> {
        let Self { outputs, responses, names, checkpoints, stricter, budget, evaluator, record } = self;
        let (tell, told) = channel();
        let (sender, thoughts) = channel();
        std::thread::scope(|scope| {
            scope.spawn(move || think(learner, &told, &sender));
            let mut stage = Stage {
                outputs: *outputs,
                responses,
                names,
                checkpoints,
                stricter: *stricter,
                budget: *budget,
                record,
                chunks: VecDeque::new(),
                requests: BTreeMap::new(),
                thoughts,
                tell,
                waits: false,
                looked: Instant::now(),
                failed: None,
            };
            let ended = evaluator.run(&mut stage);
            let Stage { failed, requests, .. } = stage;
            if let Some(error) = failed {
                return Err(error);
            }
            ended?;
            match requests.keys().next() {
                Some(id) => Err(StudyError::Unanswered { id: *id }),
                None => Ok(()),
            }
        })
    }

    /// Passes a notice on.
    pub fn notice(&mut self, progress: &Progress) {
        self.record.observer.notice(progress);
    }

    /// Sum of the simulations' own times [s].
    pub fn simulation_seconds(&self) -> f64 {
        self.record.shares.values().map(|(_, wall)| wall).sum()
    }

    /// Time of the learner, and the part of it in which all slots were idle, summed over the slots [s].
    pub fn thinking_seconds(&self) -> (f64, f64) {
        let slots = f64::from(self.evaluator.concurrency());
        (self.record.thinking.as_secs_f64(), self.record.idle.as_secs_f64() * slots)
    }

    /// Who did how much, by name.
    pub fn shares(&self) -> Vec<WorkerShare> {
        let share = |(name, (evaluations, simulation_s)): (&String, &(usize, f64))| WorkerShare {
            name: name.clone(),
            evaluations: *evaluations,
            simulation_s: *simulation_s,
        };
        self.record.shares.iter().map(share).collect()
    }
}

impl Record<'_> {
    /// Makes outcomes durable and tells the observer.
    fn keep(&mut self, outcomes: &[(Request, Finished)]) -> Result<(), EvaluateError> {
        self.journal.record_all(outcomes)?;
        for (_, finished) in outcomes {
            self.done += 1;
            notice(self.observer, self.done, finished, false);
        }
        Ok(())
    }

    /// Tells the observer what is known so far.
    fn tell(&mut self, so_far: &SoFar, names: &[String], checkpoints: &[u32]) {
        let rows = so_far.rows(names, checkpoints);
        self.observer.notice(&Progress::Reliability { rows, samples: so_far.points });
    }

    /// Passes finished rounds on to file and observer.
    fn note_rounds(&mut self, rounds: Vec<Round>) -> Result<(), StudyError> {
        for round in rounds {
            self.journal.note_round(&round)?;
            self.observer.notice(&Progress::RoundFinished(round));
        }
        Ok(())
    }
}

/// A study being served: between the thread that thinks and whoever evaluates.
struct Stage<'s, 'a> {
    outputs: usize,
    responses: &'s Responses,
    names: &'s [String],
    checkpoints: &'s [u32],
    stricter: Option<Accuracy>,
    budget: usize,
    record: &'s mut Record<'a>,
    /// Asked for and not yet told, the oldest first.
    chunks: VecDeque<Chunk>,
    /// Under way.
    requests: BTreeMap<u64, Request>,
    thoughts: Receiver<Result<Thought, CampaignError>>,
    tell: Sender<Vec<Outcome>>,
    /// Whether the learner waits for its oldest chunk.
    waits: bool,
    /// When it was last looked what to begin.
    looked: Instant,
    /// What ended the study: no matter of the evaluator, which is only told to end.
    failed: Option<StudyError>,
}

impl RequestSource for Stage<'_, '_> {
    fn next(&mut self) -> Result<Demand, EvaluateError> {
        // With nothing under way everybody waits for the learner.
        let since = std::mem::replace(&mut self.looked, Instant::now());
        if self.requests.is_empty() {
            self.record.idle += since.elapsed();
        }
        let next = self.heard();
        next.map_err(|error| self.fail(error))
    }

    fn record(&mut self, finished: Finished) -> Result<(), EvaluateError> {
        self.record_all(vec![finished])
    }

    fn record_all(&mut self, finished: Vec<Finished>) -> Result<(), EvaluateError> {
        let mut outcomes = Vec::with_capacity(finished.len());
        for finished in finished {
            let Some(request) = self.requests.remove(&finished.id) else {
                return Err(EvaluateError::UnrequestedOutcome { id: finished.id });
            };
            outcomes.push((request, finished));
        }
        self.record.keep(&outcomes)?;
        self.looked = Instant::now();
        let settled = outcomes.into_iter().try_for_each(|(_, finished)| self.settle(finished));
        settled.map_err(|error| self.fail(error))
    }
}

impl Stage<'_, '_> {
    fn fail(&mut self, error: StudyError) -> EvaluateError {
        self.failed = Some(error);
        EvaluateError::Interrupted
    }

    /// Takes up what the learner has come to, and tells it what it waits for.
    fn heard(&mut self) -> Result<Demand, StudyError> {
        loop {
            self.pass_on();
            match self.thoughts.try_recv() {
                Ok(thought) => {
                    let Thought { step, purpose, rounds, so_far, took } = thought?;
                    self.record.thinking += took;
                    self.record.note_rounds(rounds)?;
                    if let Some(so_far) = so_far {
                        self.record.tell(&so_far, self.names, self.checkpoints);
                    }
                    match step {
                        Step::Done => return Ok(Demand::End),
                        Step::Wait => self.waits = true,
                        Step::Evaluate(asks) => {
                            let missing = self.begin(asks, &purpose)?;
                            if !missing.is_empty() {
                                return Ok(Demand::Begin(missing));
                            }
                        }
                    }
                }
                Err(TryRecvError::Empty) => return Ok(Demand::Later),
                // It is done, or has panicked, which the scope reports.
                Err(TryRecvError::Disconnected) => return Ok(Demand::End),
            }
        }
    }

    /// Tells the oldest chunk, if it is complete and waited for.
    fn pass_on(&mut self) {
        let complete = |chunk: &Chunk| chunk.outcomes.iter().all(Option::is_some);
        if self.waits && self.chunks.front().is_some_and(complete) {
            let chunk = self.chunks.pop_front().expect("there is one");
            self.waits = false;
            // A learner that has gone away has said why.
            let _ = self.tell.send(chunk.outcomes.into_iter().flatten().collect());
        }
    }

    /// Puts an outcome into its place.
    fn settle(&mut self, finished: Finished) -> Result<(), StudyError> {
        let share = self.record.shares.entry(finished.worker.clone()).or_default();
        share.0 += 1;
        share.1 += finished.wall;
        let id = finished.id;
        let observed = checked(finished, self.outputs, self.checkpoints)?;
        let outcome = observed.map(|observed| self.responses.complete(observed));
        let chunk = self.chunks.iter_mut().rev().find(|chunk| chunk.first <= id);
        let chunk = chunk.expect("every request has a chunk");
        chunk.outcomes[(id - chunk.first) as usize] = Some(outcome);
        Ok(())
    }

    /// Numbers a chunk, takes what the campaign file knows of it; the rest.
    fn begin(&mut self, asks: Vec<Ask>, purpose: &str) -> Result<Vec<Request>, StudyError> {
        let first = self.record.next_id;
        let size = asks.len();
        self.record.next_id += size as u64;
        self.chunks.push_back(Chunk { first, outcomes: vec![None; size] });
        let mut missing = Vec::new();
        for (id, ask) in (first..).zip(asks) {
            let accuracy = self.stricter.filter(|_| ask.stricter);
            let request = Request { id, sample: ask.sample, with_first_cycle: id == 0, accuracy };
            match self.record.journal.finished(&request)? {
                Some(finished) => {
                    self.record.done += 1;
                    notice(self.record.observer, self.record.done, &finished, true);
                    self.settle(finished)?;
                }
                None => {
                    self.requests.insert(id, request.clone());
                    missing.push(request);
                }
            }
        }
        self.record.observer.notice(&Progress::BatchStarted {
            size,
            planned: self.record.next_id as usize,
            budget: self.budget,
            purpose: purpose.to_owned(),
        });
        Ok(missing)
    }
}

fn notice(observer: &mut dyn Observer, done: usize, outcome: &Finished, recalled: bool) {
    let failed = outcome.outcome.is_err();
    observer.notice(&Progress::Evaluated { done, failed, recalled, wall: outcome.wall });
}

/// The histories and their stated errors, if they have the scene's shape and only finite values, no error below zero. An
/// evaluation that states no errors counts as exact.
fn checked(outcome: Finished, outputs: usize, checkpoints: &[u32]) -> Result<Outcome, StudyError> {
    let Finished { id, worker, outcome, .. } = outcome;
    let evaluation = match outcome {
        Ok(evaluation) => evaluation,
        Err(failure) => return Ok(Err(failure)),
    };
    let malformed = |what: String| Err(StudyError::Malformed { id, worker, what });
    if evaluation.cycles != checkpoints {
        return malformed(format!("{} checkpoints, not {}", evaluation.cycles.len(), checkpoints.len()));
    }
    if evaluation.histories.len() != outputs {
        return malformed(format!("{} outputs, not {outputs}", evaluation.histories.len()));
    }
    for (o, history) in evaluation.histories.iter().enumerate() {
        if history.len() != checkpoints.len() {
            return malformed(format!("output {o} has {} values", history.len()));
        }
        if let Some(n) = history.iter().position(|value| !value.is_finite()) {
            return malformed(format!("output {o} is {} at {} cycles", history[n], checkpoints[n]));
        }
    }
    if !evaluation.errors.is_empty() && evaluation.errors.len() != outputs {
        return malformed(format!("errors of {} outputs, not {outputs}", evaluation.errors.len()));
    }
    for (o, errors) in evaluation.errors.iter().enumerate() {
        if errors.len() != checkpoints.len() {
            return malformed(format!("output {o} has {} stated errors", errors.len()));
        }
        if let Some(n) = errors.iter().position(|error| !(error.is_finite() && *error >= 0.0)) {
            return malformed(format!(
                "the stated error of output {o} is {} at {} cycles",
                errors[n], checkpoints[n]
            ));
        }
    }
    Ok(Ok(Observed::of(evaluation)))
}
