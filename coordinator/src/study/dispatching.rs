//! Numbered requests, the campaign file first, then the evaluator; outcomes checked and in order.

use super::responses::Responses;
use super::{Ask, CampaignError, Observed, Step, StudyError};
use crate::evaluate::{EvaluateError, Evaluator, Finished, Request};
use crate::journal::Journal;
use crate::progress::{Observer, Progress};
use crate::summary::{Round, WorkerShare};
use common::accuracy::Accuracy;
use common::failure::SimulationFailure;
use common::scene::Scene;
use std::collections::{BTreeMap, VecDeque};
use std::time::{Duration, Instant};

/// Outcome of one sample.
pub(super) type Outcome = Result<Observed, SimulationFailure>;

/// Who decides what is simulated: asks and is told, chunk by chunk, in order.
pub(super) trait Learner {
    /// What it wants next; see [`Step`].
    fn next_step(&mut self) -> Result<Step, CampaignError>;
    /// The outcomes of its oldest chunk.
    fn tell(&mut self, outcomes: Vec<Outcome>) -> Result<(), CampaignError>;
    /// The rounds so far.
    fn rounds(&self) -> &[Round];
    /// What its next chunk is for, in words.
    fn purpose(&self) -> String;
}

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
    open: usize,
    noted: usize,
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
            open: 0,
            noted: 0,
            shares: BTreeMap::new(),
            thinking: Duration::ZERO,
            idle: Duration::ZERO,
        };
        Self {
            outputs: scene.outputs.len(),
            responses: Responses::of(scene),
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
    pub fn pursue(&mut self, learner: &mut dyn Learner) -> Result<(), StudyError> {
        let Self { outputs, responses, checkpoints, stricter, budget, evaluator, record } = self;
        let mut stage = Stage {
            outputs: *outputs,
            responses,
            checkpoints,
            stricter: *stricter,
            budget: *budget,
            record,
            learner,
        };
        let mut chunks: VecDeque<Chunk> = VecDeque::new();
        let mut requests: BTreeMap<u64, Request> = BTreeMap::new();
        // What the learner makes of outcomes is no matter of the evaluator: it ends, and the error is answered here.
        let mut failed = None;
        let first = stage.advance(&mut chunks, &mut requests)?;
        if !first.is_empty() {
            let ended = evaluator.pursue(first, &mut |finished| {
                let known = requests.remove(&finished.id);
                let Some(request) = known else {
                    return Err(EvaluateError::Transport(format!(
                        "an outcome of evaluation {} that is not being waited for",
                        finished.id
                    )));
                };
                stage.record.keep(&request, &finished)?;
                let settled = stage
                    .settle(finished, &mut chunks)
                    .and_then(|()| stage.advance(&mut chunks, &mut requests));
                settled.map_err(|error| {
                    failed = Some(error);
                    EvaluateError::Interrupted
                })
            });
            if let Some(error) = failed {
                return Err(error);
            }
            ended?;
        }
        match requests.keys().next() {
            Some(id) => Err(StudyError::Unanswered { id: *id }),
            None => Ok(()),
        }
    }

    /// Passes a notice on.
    pub fn notice(&mut self, progress: &Progress) {
        self.record.observer.notice(progress);
    }

    /// Sum of the simulations' own times [s].
    pub fn simulation_seconds(&self) -> f64 {
        self.record.shares.values().map(|(_, wall)| wall).sum()
    }

    /// Time the learner took, and that part of it in which nothing was under way [s].
    pub fn thinking_seconds(&self) -> (f64, f64) {
        (self.record.thinking.as_secs_f64(), self.record.idle.as_secs_f64())
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
    /// Makes an outcome durable and tells the observer.
    fn keep(&mut self, request: &Request, finished: &Finished) -> Result<(), EvaluateError> {
        self.journal.record(request, finished)?;
        self.done += 1;
        notice(self.observer, self.done, finished, false);
        Ok(())
    }

    /// Passes finished rounds on to file and observer.
    fn note_rounds(&mut self, rounds: &[Round]) -> Result<(), StudyError> {
        for round in &rounds[self.noted..] {
            self.journal.note_round(round)?;
            self.observer.notice(&Progress::RoundFinished(round.clone()));
        }
        self.noted = rounds.len();
        Ok(())
    }
}

/// A learner being served.
struct Stage<'s, 'a> {
    outputs: usize,
    responses: &'s Responses,
    checkpoints: &'s [u32],
    stricter: Option<Accuracy>,
    budget: usize,
    record: &'s mut Record<'a>,
    learner: &'s mut dyn Learner,
}

impl Stage<'_, '_> {
    /// Puts an outcome into its place.
    fn settle(&mut self, finished: Finished, chunks: &mut VecDeque<Chunk>) -> Result<(), StudyError> {
        let share = self.record.shares.entry(finished.worker.clone()).or_default();
        share.0 += 1;
        share.1 += finished.wall;
        let id = finished.id;
        let observed = checked(finished, self.outputs, self.checkpoints)?;
        let outcome = observed.map(|observed| self.responses.complete(observed));
        let chunk =
            chunks.iter_mut().rev().find(|chunk| chunk.first <= id).expect("every request has a chunk");
        chunk.outcomes[(id - chunk.first) as usize] = Some(outcome);
        self.record.open -= 1;
        Ok(())
    }

    /// Tells what is complete, the oldest chunk first, and asks until the learner waits; what is to be evaluated.
    ///
    /// After each chunk told the learner is asked before it is told the next one, so its questions do not depend on
    /// which outcomes came together.
    fn advance(
        &mut self,
        chunks: &mut VecDeque<Chunk>,
        requests: &mut BTreeMap<u64, Request>,
    ) -> Result<Vec<Request>, StudyError> {
        let mut missing = Vec::new();
        loop {
            let started = Instant::now();
            let idle = self.record.open == 0;
            let step = self.learner.next_step()?;
            self.record.thinking += started.elapsed();
            self.record.idle += if idle { started.elapsed() } else { Duration::ZERO };
            self.record.note_rounds(self.learner.rounds())?;
            match step {
                Step::Done => return Ok(missing),
                Step::Evaluate(asks) => {
                    let more = self.begin(asks, &self.learner.purpose(), chunks)?;
                    requests.extend(more.iter().map(|request| (request.id, request.clone())));
                    missing.extend(more);
                }
                Step::Wait => {
                    let complete = |chunk: &Chunk| chunk.outcomes.iter().all(Option::is_some);
                    if !chunks.front().is_some_and(complete) {
                        return Ok(missing);
                    }
                    let chunk = chunks.pop_front().expect("there is one");
                    self.learner.tell(chunk.outcomes.into_iter().flatten().collect())?;
                }
            }
        }
    }

    /// Numbers a chunk, takes what the campaign file knows of it; the rest.
    fn begin(
        &mut self,
        asks: Vec<Ask>,
        purpose: &str,
        chunks: &mut VecDeque<Chunk>,
    ) -> Result<Vec<Request>, StudyError> {
        let first = self.record.next_id;
        let size = asks.len();
        self.record.next_id += size as u64;
        self.record.open += size;
        chunks.push_back(Chunk { first, outcomes: vec![None; size] });
        let mut missing = Vec::new();
        for (id, ask) in (first..).zip(asks) {
            let accuracy = self.stricter.filter(|_| ask.stricter);
            let request = Request { id, sample: ask.sample, with_first_cycle: id == 0, accuracy };
            match self.record.journal.finished(&request)? {
                Some(finished) => {
                    self.record.done += 1;
                    notice(self.record.observer, self.record.done, &finished, true);
                    self.settle(finished, chunks)?;
                }
                None => missing.push(request),
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
    if evaluation.errors.is_empty() {
        return Ok(Ok(Observed::exact(evaluation.histories)));
    }
    if evaluation.errors.len() != outputs {
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
    Ok(Ok(Observed { histories: evaluation.histories, errors: evaluation.errors }))
}
