//! Numbered requests, the campaign file first, then the evaluator; outcomes checked and in order.

use super::responses::Responses;
use super::{Observed, StudyError};
use crate::evaluate::{EvaluateError, Evaluator, Finished, Request};
use crate::journal::Journal;
use crate::progress::{Observer, Progress};
use crate::summary::{Round, WorkerShare};
use common::failure::SimulationFailure;
use common::scene::Scene;
use std::collections::BTreeMap;
use std::time::{Duration, Instant};

/// Outcome of one sample.
pub(super) type Outcome = Result<Observed, SimulationFailure>;

/// Gets samples evaluated, each under the next number.
pub(super) struct Dispatcher<'a> {
    outputs: usize,
    responses: Responses,
    checkpoints: Vec<u32>,
    evaluator: &'a mut dyn Evaluator,
    journal: &'a mut dyn Journal,
    observer: &'a mut dyn Observer,
    next_id: u64,
    done: usize,
    shares: BTreeMap<String, (usize, f64)>,
    waiting: Duration,
}

impl<'a> Dispatcher<'a> {
    pub fn new(
        scene: &Scene,
        evaluator: &'a mut dyn Evaluator,
        journal: &'a mut dyn Journal,
        observer: &'a mut dyn Observer,
    ) -> Self {
        Self {
            outputs: scene.outputs.len(),
            responses: Responses::of(scene),
            checkpoints: scene.life.checkpoints(),
            evaluator,
            journal,
            observer,
            next_id: 0,
            done: 0,
            shares: BTreeMap::new(),
            waiting: Duration::ZERO,
        }
    }

    /// Evaluates samples `(count)(d,)` [SI]; the outcomes in the same order.
    pub fn evaluate(
        &mut self,
        samples: Vec<Vec<f64>>,
        purpose: &str,
        budget: usize,
    ) -> Result<Vec<Outcome>, StudyError> {
        let started = Instant::now();
        let first = self.next_id;
        let requests: Vec<Request> = (first..)
            .zip(samples)
            .map(|(id, sample)| Request { id, sample, with_first_cycle: id == 0, accuracy: None })
            .collect();
        self.next_id += requests.len() as u64;

        // What the campaign file knows.
        let mut finished: Vec<Option<Finished>> = vec![None; requests.len()];
        let mut missing = Vec::new();
        for (place, request) in finished.iter_mut().zip(&requests) {
            *place = self.journal.finished(request)?;
            match place {
                Some(outcome) => {
                    self.done += 1;
                    notice(self.observer, self.done, outcome, true);
                }
                None => missing.push(request.clone()),
            }
        }

        self.observer.notice(&Progress::BatchStarted {
            size: requests.len(),
            planned: self.done + missing.len(),
            budget,
            purpose: purpose.to_owned(),
        });

        // The rest.
        if !missing.is_empty() {
            let (journal, observer, done) = (&mut *self.journal, &mut *self.observer, &mut self.done);
            self.evaluator.evaluate(&missing, &mut |outcome: Finished| {
                let place = outcome.id.checked_sub(first).and_then(|i| finished.get_mut(i as usize));
                let Some(place) = place.filter(|place| place.is_none()) else {
                    return Err(EvaluateError::Transport(format!(
                        "an outcome of evaluation {} that is not being waited for",
                        outcome.id
                    )));
                };
                journal.record(&requests[(outcome.id - first) as usize], &outcome)?;
                *done += 1;
                notice(observer, *done, &outcome, false);
                *place = Some(outcome);
                Ok(())
            })?;
        }
        self.waiting += started.elapsed();

        let settle = |(request, outcome): (&Request, Option<Finished>)| {
            let outcome = outcome.ok_or(StudyError::Unanswered { id: request.id })?;
            let share = self.shares.entry(outcome.worker.clone()).or_default();
            share.0 += 1;
            share.1 += outcome.wall;
            let observed = checked(outcome, self.outputs, &self.checkpoints)?;
            Ok(observed.map(|observed| self.responses.complete(observed)))
        };
        requests.iter().zip(finished).map(settle).collect()
    }

    /// Passes a finished round on to file and observer.
    pub fn note_round(&mut self, round: &Round) -> Result<(), StudyError> {
        self.journal.note_round(round)?;
        self.observer.notice(&Progress::RoundFinished(round.clone()));
        Ok(())
    }

    /// Passes a notice on.
    pub fn notice(&mut self, progress: &Progress) {
        self.observer.notice(progress);
    }

    /// Sum of the simulations' own times [s].
    pub fn simulation_seconds(&self) -> f64 {
        self.shares.values().map(|(_, wall)| wall).sum()
    }

    /// Time spent with batches out [s].
    pub fn waiting_seconds(&self) -> f64 {
        self.waiting.as_secs_f64()
    }

    /// Who did how much, by name.
    pub fn shares(&self) -> Vec<WorkerShare> {
        let share = |(name, (evaluations, simulation_s)): (&String, &(usize, f64))| WorkerShare {
            name: name.clone(),
            evaluations: *evaluations,
            simulation_s: *simulation_s,
        };
        self.shares.iter().map(share).collect()
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
