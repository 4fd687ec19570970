//! Dispatch of a study's samples: each sample becomes a numbered request, which is looked up in the campaign
//! file and otherwise evaluated; outcomes are checked and returned in the order of the requests.

use super::error::{check, recalled};
use super::interim::InterimResult;
use super::learner::{Learner, LearnerStep, run_learner};
use super::plan::ResponseLayout;
use super::result;
use super::{CampaignError, Correction, Observed, ObservedOutcome, SampleRequest, Step, StudyError};
use crate::farm::evaluate::{Demand, EvaluateError, Evaluator, Finished, Request, RequestSource};
use crate::results::journal::Journal;
use crate::results::progress::{Observer, Progress};
use crate::results::summary::Round;
use crate::results::timing::{Timing, WorkerShare};
use common::accuracy::Accuracy;
use common::evaluation_shape::EvaluationShape;
use common::scene::Scene;
use std::collections::{BTreeMap, BTreeSet, VecDeque};
use std::sync::mpsc::{Receiver, Sender, TryRecvError, channel};
use std::time::{Duration, Instant};

/// Shortest time between two notes of the times in the journal: a killed run loses no more of its time than this.
const NOTE_EVERY: Duration = Duration::from_secs(5);

/// A chunk of samples and the outcomes received so far.
struct Chunk {
    /// Number of its first request.
    first: u64,
    /// Values of the variables `(size)(d,)` [SI].
    samples: Vec<Vec<f64>>,
    /// Outcomes by sample; `None` until received.
    outcomes: Vec<Option<ObservedOutcome>>,
}

/// Evaluates the samples of a learner, each under the next request number: scene, journal, observer and counters of a study.
pub(super) struct Dispatcher<'a> {
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
    /// Accuracies of the finer levels, from level 1 on; none unless they are given.
    pub finer: Vec<Accuracy>,
    /// Bound on the evaluations, for the observer.
    budget: usize,
    journal: &'a mut dyn Journal,
    pub observer: &'a mut dyn Observer,
    next_id: u64,
    done: usize,
    /// Evaluations and their time by worker name.
    shares: BTreeMap<String, WorkerShare>,
    started: Instant,
    /// Time of the last note of the times in the journal.
    noted: Instant,
    /// Time the learner took.
    learner: Duration,
    /// Time in which no evaluation was under way.
    idle: Duration,
    /// Times of the runs before this one.
    earlier: Timing,
    /// Number of slots.
    slots: u32,
    /// Workers that simulated in this run.
    workers: BTreeSet<String>,
}

impl<'a> Dispatcher<'a> {
    /// `stricter` is the accuracy for the repetition of failed samples, `budget` the bound on evaluations
    /// that the observer is shown.
    pub fn new(
        scene: &'a Scene,
        stricter: Option<Accuracy>,
        budget: usize,
        journal: &'a mut dyn Journal,
        observer: &'a mut dyn Observer,
    ) -> Self {
        Self {
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
            started: Instant::now(),
            noted: Instant::now(),
            learner: Duration::ZERO,
            idle: Duration::ZERO,
            earlier: Timing::default(),
            slots: 0,
            workers: BTreeSet::new(),
        }
    }

    /// Numbers the requests from `first` on, after evaluations that exist, and corrects all outcomes at the working accuracy by the
    /// difference of the levels, if one is known.
    pub fn going_on(mut self, first: u64, correction: Option<&'a Correction>) -> Self {
        (self.next_id, self.done) = (first, first as usize);
        self.correction = correction;
        self
    }

    /// Evaluates the learner's samples until the learner is done.
    ///
    /// # Errors
    /// [`StudyError`]; finished evaluations are in the journal by then.
    pub fn run(
        &mut self,
        evaluator: &mut dyn Evaluator,
        learner: &mut dyn Learner,
    ) -> Result<(), StudyError> {
        self.slots = evaluator.concurrency();
        self.earlier = self.journal.times()?;
        let (outcomes, recorded) = channel();
        let (sender, steps) = channel();
        let ended = std::thread::scope(|scope| {
            scope.spawn(move || run_learner(learner, &recorded, &sender));
            let mut study = StudyRequests {
                dispatcher: &mut *self,
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
        let noted = self.note_times(true);
        ended?;
        Ok(noted?)
    }

    /// Notes in the journal that the study makes no further request.
    ///
    /// # Errors
    /// [`StudyError::Evaluate`].
    pub fn end(&mut self) -> Result<(), StudyError> {
        self.note_times(true)?;
        Ok(self.journal.ended(self.next_id)?)
    }

    /// Times of the study so far, its earlier runs included.
    pub fn timing(&self) -> Timing {
        self.earlier.with_run(&Timing {
            total: self.started.elapsed().as_secs_f64(),
            simulation: self.shares.values().map(|share| share.simulation_s).sum(),
            surrogate: self.learner.as_secs_f64(),
            idle: self.idle.as_secs_f64() * f64::from(self.slots),
            runs: 1,
            workers: u32::try_from(self.workers.len()).unwrap_or(u32::MAX),
        })
    }

    /// Evaluations and simulation time by worker, in the order of the names.
    pub fn shares(&self) -> Vec<WorkerShare> {
        self.shares.values().cloned().collect()
    }

    /// Makes outcomes durable and notifies the observer.
    fn store(&mut self, outcomes: &[(Request, Finished)]) -> Result<(), EvaluateError> {
        self.journal.record_all(outcomes)?;
        for (_, finished) in outcomes {
            self.workers.insert(finished.worker.clone());
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
        if !ends && self.noted.elapsed() < NOTE_EVERY {
            return Ok(());
        }
        self.noted = Instant::now();
        let timing = self.timing();
        self.journal.note_times(&timing)
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
    dispatcher: &'s mut Dispatcher<'a>,
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
            self.dispatcher.idle += since.elapsed();
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
        let checked = outcomes.iter().try_for_each(|(_, finished)| check(finished, &self.dispatcher.shape));
        checked.map_err(|error| self.fail(error))?;
        self.dispatcher.store(&outcomes)?;
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
                        answer.map_err(|error| StudyError::from_campaign(error, self.dispatcher.scene))?;
                    self.dispatcher.learner += took;
                    self.dispatcher.note_rounds(rounds)?;
                    constant.into_iter().for_each(|mode| self.dispatcher.note_constant(mode));
                    if let Some(interim) = interim {
                        self.dispatcher.note_interim(&interim);
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
        let share = self.dispatcher.shares.entry(name.clone()).or_insert_with(unused);
        share.evaluations += 1;
        share.simulation_s += finished.wall;
        let id = finished.id;
        let chunk = self.chunks.iter_mut().rev().find(|chunk| chunk.first <= id);
        let chunk = chunk.expect("every request has a chunk");
        let place = (id - chunk.first) as usize;
        let Dispatcher { responses, correction, .. } = &*self.dispatcher;
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
        let (first, size) = (self.dispatcher.next_id, wanted.len());
        self.dispatcher.next_id += size as u64;
        let samples = wanted.iter().map(|wanted| wanted.sample.clone()).collect();
        self.chunks.push_back(Chunk { first, samples, outcomes: vec![None; size] });
        let mut missing = Vec::new();
        for (id, wanted) in (first..).zip(wanted) {
            let SampleRequest { sample, stricter, level, not_by } = wanted;
            let accuracy = match usize::from(level) {
                0 => self.dispatcher.stricter.filter(|_| stricter),
                level => self.dispatcher.finer.get(level - 1).copied(),
            };
            let with_first_cycle = id == 0 || (id == 1 && stricter); // The nominal point, or its repetition.
            let request = Request { id, sample, with_first_cycle, accuracy, level, not_by };
            match recalled(self.dispatcher.journal, &request, &self.dispatcher.shape)? {
                Some(finished) => {
                    self.dispatcher.note_evaluated(&finished, true);
                    self.settle(finished);
                }
                None => {
                    self.requests.insert(id, request.clone());
                    missing.push(request);
                }
            }
        }
        self.dispatcher.observer.notice(&Progress::BatchStarted {
            planned: self.dispatcher.next_id as usize,
            budget: self.dispatcher.budget,
            purpose: purpose.to_owned(),
        });
        Ok(missing)
    }
}
