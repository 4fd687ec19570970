//! Dispatch of a study's samples: each sample becomes a numbered request, which is looked up in the campaign
//! file and otherwise evaluated; outcomes are checked and returned in the order of the requests.

use super::error::{check, recalled};
use super::interim::InterimResult;
use super::learner::{Learner, LearnerStep, run_learner};
use super::plan::ResponseLayout;
use super::result;
use super::run_times::RunTimes;
use super::{CampaignError, Correction, Observed, ObservedOutcome, SampleRequest, Step, StudyError};
use crate::farm::evaluate::{Demand, EvaluateError, Evaluator, Finished, Request, RequestSource};
use crate::results::journal::Journal;
use crate::results::progress::{Observer, Progress};
use crate::results::summary::Round;
use crate::results::timing::{Timing, WorkerShare};
use common::accuracy::Accuracy;
use common::evaluation_shape::EvaluationShape;
use common::scene::Scene;
use std::collections::{BTreeMap, VecDeque};
use std::sync::mpsc::{Receiver, Sender, TryRecvError, channel};
use std::time::Instant;

/// A chunk of samples and the outcomes received so far.
struct Chunk {
    /// Number of its first request.
    first: u64,
    /// Values of the variables `(size)(d,)` [SI].
    samples: Vec<Vec<f64>>,
    /// Outcomes by sample; `None` until received.
    outcomes: Vec<Option<ObservedOutcome>>,
}

/// Evaluates the samples of a learner, each under the next request number.
pub(super) struct Dispatcher<'a> {
    evaluator: &'a mut dyn Evaluator,
    record: Record<'a>,
}

/// The scene of a study, its journal, observer and counters.
struct Record<'a> {
    scene: &'a Scene,
    responses: ResponseLayout,
    /// Correction of the outcomes by finer levels.
    correction: Option<&'a Correction>,
    /// Names of the limit states and, last, of the system.
    names: Vec<String>,
    checkpoints: Vec<u32>,
    shape: EvaluationShape,
    /// Accuracy for the repetition of failed samples; `None` if nothing is repeated.
    stricter: Option<Accuracy>,
    /// Accuracies of the finer levels, from level 1 on.
    finer: Vec<Accuracy>,
    /// Bound on the evaluations, for the observer.
    budget: usize,
    journal: &'a mut dyn Journal,
    observer: &'a mut dyn Observer,
    next_id: u64,
    done: usize,
    /// Evaluations and their time by worker name.
    shares: BTreeMap<String, WorkerShare>,
    times: RunTimes,
}

impl<'a> Dispatcher<'a> {
    /// `stricter` is the accuracy for the repetition of failed samples, `budget` the bound on evaluations
    /// that the observer is shown.
    pub fn new(
        scene: &'a Scene,
        stricter: Option<Accuracy>,
        budget: usize,
        evaluator: &'a mut dyn Evaluator,
        journal: &'a mut dyn Journal,
        observer: &'a mut dyn Observer,
    ) -> Self {
        let record = Record {
            scene,
            responses: ResponseLayout::from_scene(scene),
            correction: None,
            names: result::curve_names(scene),
            checkpoints: scene.life.checkpoints(),
            shape: EvaluationShape::of(scene),
            stricter,
            finer: vec![],
            budget,
            journal,
            observer,
            next_id: 0,
            done: 0,
            shares: BTreeMap::new(),
            times: RunTimes::start(evaluator.concurrency()),
        };
        Self { evaluator, record }
    }

    /// Numbers the requests from `first` on, after evaluations that exist, and corrects all outcomes at the working accuracy by the
    /// difference of the levels, if one is known.
    pub fn going_on(mut self, first: u64, correction: Option<&'a Correction>) -> Self {
        (self.record.next_id, self.record.done) = (first, first as usize);
        self.record.correction = correction;
        self
    }

    /// Evaluates requests of level k >= 1 at the accuracy `finer[k - 1]`.
    pub fn with_finer(mut self, finer: Vec<Accuracy>) -> Self {
        self.record.finer = finer;
        self
    }

    /// Evaluates the learner's samples until the learner is done.
    ///
    /// # Errors
    /// [`StudyError`]; finished evaluations are in the journal by then.
    pub fn run(&mut self, learner: &mut dyn Learner) -> Result<(), StudyError> {
        let Self { evaluator, record } = self;
        record.times.earlier = record.journal.times()?;
        let (outcomes, recorded) = channel();
        let (sender, steps) = channel();
        let ended = std::thread::scope(|scope| {
            scope.spawn(move || run_learner(learner, &recorded, &sender));
            let mut study = StudyRequests {
                record: &mut *record,
                chunks: VecDeque::new(),
                requests: BTreeMap::new(),
                steps,
                outcomes,
                learner_waits: false,
                polled: Instant::now(),
                failed: None,
            };
            let ended = evaluator.run(&mut study);
            let StudyRequests { failed, requests, .. } = study;
            if let Some(error) = failed {
                return Err(error);
            }
            ended?;
            match requests.keys().next() {
                Some(id) => Err(EvaluateError::NoOutcome(*id).into()),
                None => Ok(()),
            }
        });
        let noted = record.note_times(true);
        ended?;
        Ok(noted?)
    }

    /// Notes in the journal that the study makes no further request.
    ///
    /// # Errors
    /// [`StudyError::Evaluate`].
    pub fn end(&mut self) -> Result<(), StudyError> {
        self.record.note_times(true)?;
        Ok(self.record.journal.ended(self.record.next_id)?)
    }

    /// Passes a notice to the observer.
    pub fn notice(&mut self, progress: &Progress) {
        self.record.observer.notice(progress);
    }

    /// Times of the study so far, its earlier runs included.
    pub fn timing(&self) -> Timing {
        self.record.times.study(self.record.simulation_seconds())
    }

    /// Evaluations and simulation time by worker, in the order of the names.
    pub fn shares(&self) -> Vec<WorkerShare> {
        self.record.shares.values().cloned().collect()
    }
}

impl Record<'_> {
    /// Makes outcomes durable and notifies the observer.
    fn store(&mut self, outcomes: &[(Request, Finished)]) -> Result<(), EvaluateError> {
        self.journal.record_all(outcomes)?;
        for (_, finished) in outcomes {
            self.times.add_worker(&finished.worker);
            self.note_evaluated(finished, false);
        }
        self.note_times(false)
    }

    /// Counts an evaluation that ended, or was `recalled`, and notifies the observer.
    fn note_evaluated(&mut self, Finished { outcome, wall, .. }: &Finished, recalled: bool) {
        self.done += 1;
        let (done, failed) = (self.done, outcome.is_err());
        self.observer.notice(&Progress::Evaluated { done, failed, recalled, wall: *wall });
    }

    /// Notes the times of the study in the journal, if it is time to or if the run ends.
    fn note_times(&mut self, ends: bool) -> Result<(), EvaluateError> {
        let simulation = self.simulation_seconds();
        self.times.note(self.journal, simulation, ends)
    }

    /// Sum of the simulations' own times [s].
    fn simulation_seconds(&self) -> f64 {
        self.shares.values().map(|share| share.simulation_s).sum()
    }

    /// Notifies the observer of the interim reliability.
    fn note_interim(&mut self, interim: &InterimResult) {
        let rows = interim.rows(&self.names, &self.checkpoints);
        self.observer.notice(&Progress::Reliability { rows, samples: interim.points });
    }

    /// Warns of a limit state whose output was the same in every simulation of the initial design.
    fn note_constant(&mut self, mode: usize) {
        let what = "its output is the same in every simulation of the initial design";
        let text = format!("limit state {}: {what}; it does not depend on any variable", self.names[mode]);
        self.observer.notice(&Progress::Warning(text));
    }

    /// Passes finished rounds to the journal and the observer.
    fn note_rounds(&mut self, rounds: Vec<Round>) -> Result<(), StudyError> {
        for round in rounds {
            self.journal.note_round(&round)?;
            self.observer.notice(&Progress::RoundFinished(round));
        }
        Ok(())
    }
}

/// A study in progress, between the learner thread and the evaluator.
struct StudyRequests<'s, 'a> {
    record: &'s mut Record<'a>,
    /// Chunks that have not been returned to the learner, the oldest first.
    chunks: VecDeque<Chunk>,
    /// Requests under way.
    requests: BTreeMap<u64, Request>,
    steps: Receiver<Result<LearnerStep, CampaignError>>,
    outcomes: Sender<Vec<ObservedOutcome>>,
    /// True while the learner waits for its oldest chunk.
    learner_waits: bool,
    /// Time of the last poll for new requests.
    polled: Instant,
    /// Error that ended the study; the evaluator only receives an interruption.
    failed: Option<StudyError>,
}

impl RequestSource for StudyRequests<'_, '_> {
    fn next(&mut self) -> Result<Demand, EvaluateError> {
        // With nothing under way the workers wait for the learner.
        let since = std::mem::replace(&mut self.polled, Instant::now());
        if self.requests.is_empty() {
            self.record.times.idle += since.elapsed();
        }
        self.take_steps().map_err(|error| self.fail(error))
    }

    fn record(&mut self, finished: Finished) -> Result<(), EvaluateError> {
        self.record_all(vec![finished])
    }

    fn record_all(&mut self, finished: Vec<Finished>) -> Result<(), EvaluateError> {
        let mut outcomes = Vec::with_capacity(finished.len());
        for finished in finished {
            let Some(request) = self.requests.remove(&finished.id) else {
                return Err(EvaluateError::UnrequestedOutcome(finished.id));
            };
            outcomes.push((request, finished));
        }
        let checked = outcomes.iter().try_for_each(|(_, finished)| check(finished, &self.record.shape));
        checked.map_err(|error| self.fail(error))?;
        self.record.store(&outcomes)?;
        self.polled = Instant::now();
        outcomes.into_iter().for_each(|(_, finished)| self.settle(finished));
        Ok(())
    }
}

impl StudyRequests<'_, '_> {
    /// Keeps the error of the study and returns the interruption for the evaluator.
    fn fail(&mut self, error: StudyError) -> EvaluateError {
        self.failed = Some(error);
        EvaluateError::Interrupted
    }

    /// Carries out the learner's steps so far, and returns the oldest chunk to it if it waits for that.
    fn take_steps(&mut self) -> Result<Demand, StudyError> {
        loop {
            self.return_oldest_chunk();
            match self.steps.try_recv() {
                Ok(answer) => {
                    let LearnerStep { step, purpose, rounds, interim, constant, took } =
                        answer.map_err(|error| StudyError::from_campaign(error, self.record.scene))?;
                    self.record.times.learner += took;
                    self.record.note_rounds(rounds)?;
                    constant.into_iter().for_each(|mode| self.record.note_constant(mode));
                    if let Some(interim) = interim {
                        self.record.note_interim(&interim);
                    }
                    match step {
                        Step::Done => return Ok(Demand::End),
                        Step::Wait => self.learner_waits = true,
                        Step::Evaluate(samples) => {
                            let missing = self.begin(samples, &purpose)?;
                            if !missing.is_empty() {
                                return Ok(Demand::Begin(missing));
                            }
                        }
                    }
                }
                Err(TryRecvError::Empty) => return Ok(Demand::Later),
                // The learner is done, or has panicked, which the scope reports.
                Err(TryRecvError::Disconnected) => return Ok(Demand::End),
            }
        }
    }

    /// Sends the oldest chunk to the learner if it is complete and the learner waits for it.
    fn return_oldest_chunk(&mut self) {
        let complete = |chunk: &Chunk| chunk.outcomes.iter().all(Option::is_some);
        if self.learner_waits && self.chunks.front().is_some_and(complete) {
            let chunk = self.chunks.pop_front().expect("the front was complete");
            self.learner_waits = false;
            // A learner that has ended has sent its reason.
            let _ = self.outcomes.send(chunk.outcomes.into_iter().flatten().collect());
        }
    }

    /// Stores an outcome in its chunk.
    fn settle(&mut self, finished: Finished) {
        let name = &finished.worker;
        let unused = || WorkerShare { name: name.clone(), evaluations: 0, simulation_s: 0.0 };
        let share = self.record.shares.entry(name.clone()).or_insert_with(unused);
        share.evaluations += 1;
        share.simulation_s += finished.wall;
        let id = finished.id;
        let chunk = self.chunks.iter_mut().rev().find(|chunk| chunk.first <= id);
        let chunk = chunk.expect("every request has a chunk");
        let place = (id - chunk.first) as usize;
        let Record { responses, correction, .. } = &*self.record;
        let observed = |found| {
            let observed = Observed::from_evaluation(found).by(id, &finished.worker);
            responses.complete(match correction {
                Some(correction) => correction.correct(&chunk.samples[place], observed),
                None => observed,
            })
        };
        chunk.outcomes[place] = Some(finished.outcome.map(observed));
    }

    /// Numbers the samples of a chunk, takes the finished ones from the campaign file, and returns the others.
    fn begin(&mut self, wanted: Vec<SampleRequest>, purpose: &str) -> Result<Vec<Request>, StudyError> {
        let (first, size) = (self.record.next_id, wanted.len());
        self.record.next_id += size as u64;
        let samples = wanted.iter().map(|wanted| wanted.sample.clone()).collect();
        self.chunks.push_back(Chunk { first, samples, outcomes: vec![None; size] });
        let mut missing = Vec::new();
        for (id, wanted) in (first..).zip(wanted) {
            let SampleRequest { sample, stricter, level, not_by } = wanted;
            let accuracy = match usize::from(level) {
                0 => self.record.stricter.filter(|_| stricter),
                level => self.record.finer.get(level - 1).copied(),
            };
            let with_first_cycle = id == 0 || (id == 1 && stricter); // The nominal point, or its repetition.
            let request = Request { id, sample, with_first_cycle, accuracy, level, not_by };
            match recalled(self.record.journal, &request, &self.record.shape)? {
                Some(finished) => {
                    self.record.note_evaluated(&finished, true);
                    self.settle(finished);
                }
                None => {
                    self.requests.insert(id, request.clone());
                    missing.push(request);
                }
            }
        }
        self.record.observer.notice(&Progress::BatchStarted {
            planned: self.record.next_id as usize,
            budget: self.record.budget,
            purpose: purpose.to_owned(),
        });
        Ok(missing)
    }
}
