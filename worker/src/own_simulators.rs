//! External simulators that a worker has itself, for coordinators whose scenes name the same ones.
//!
//! A coordinator sends the name of a scene and the digest of its inputs, outputs and version ([`SimulatorId`]), the number
//! of an evaluation and a sample. Command, folder, files, address and time limit are those of the scene file with which this
//! worker was started: nothing that a coordinator sends can change them.

use crate::evaluation_slots::EvaluationSlots;
use crate::service::{Job, Simulator};
use common::external::{
    SimulatorError, SimulatorId, Slot, SlotError, SlotRequest, StopSignal, limit_contact,
};
use common::failure::SimulationFailure;
use common::locks::locked;
use common::outputs::Evaluation;
use common::scene::{Faults, SceneSource};
use common::wire::{Offers, Subject, Task};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::{Arc, Mutex};
use std::time::Instant;
use thiserror::Error;

/// Reasons why a worker cannot offer simulators.
#[derive(Debug, Error)]
pub enum OfferError {
    /// A scene file is faulty.
    #[error(transparent)]
    Scene(#[from] Faults),
    /// A scene describes a mechanism. Holds the file of the scene.
    #[error("--simulator {0}: the scene names no simulator of its own, expected a table [simulator]")]
    NoSimulator(String),
    /// A folder cannot be read, or has no scene files.
    #[error("--simulator {}: {reason}", folder.display())]
    Folder {
        /// Path of the folder.
        folder: PathBuf,
        /// What is wrong with it.
        reason: String,
    },
    /// Two scene files cannot be told apart by a coordinator.
    #[error("--simulator {second}: {first} offers {id} already")]
    Twice {
        /// File of the first scene.
        first: String,
        /// File of the second scene.
        second: String,
        /// Name and digest of both.
        id: SimulatorId,
    },
    /// A simulator cannot be used.
    #[error("--simulator {origin}: {error}")]
    Simulator {
        /// File of the scene.
        origin: String,
        /// What is wrong with the simulator.
        error: SimulatorError,
    },
}

/// Reads scene files; of a folder all files `*.toml` in it, in the order of their names.
///
/// # Errors
/// [`OfferError::Scene`], [`OfferError::Folder`].
pub fn load(paths: &[PathBuf]) -> Result<Vec<SceneSource>, OfferError> {
    let mut sources = Vec::new();
    for path in paths {
        let files = if path.is_dir() { scene_files(path)? } else { vec![path.clone()] };
        for file in files {
            sources.push(SceneSource::load(&file.display().to_string())?);
        }
    }
    Ok(sources)
}

fn scene_files(folder: &Path) -> Result<Vec<PathBuf>, OfferError> {
    let wrong = |reason: String| OfferError::Folder { folder: folder.to_owned(), reason };
    let entries = std::fs::read_dir(folder).and_then(|all| all.collect::<Result<Vec<_>, _>>());
    let entries = entries.map_err(|error| wrong(error.to_string()))?;
    let paths = entries.into_iter().map(|entry| entry.path());
    let mut files: Vec<PathBuf> =
        paths.filter(|path| path.extension().is_some_and(|end| end == "toml")).collect();
    files.sort();
    if files.is_empty() { Err(wrong("no scene file *.toml is in this folder".to_owned())) } else { Ok(files) }
}

/// One simulator with its slots that are not in use.
struct Offer {
    id: SimulatorId,
    /// Number of input values.
    inputs: usize,
    opened: EvaluationSlots,
    idle: Mutex<Vec<Box<dyn Slot>>>,
    /// Number of slots made so far.
    made: AtomicUsize,
}

/// The simulators of a worker. A program runs as often as jobs run at once, and keeps running until its campaign has ended.
pub struct OwnSimulators {
    offers: Vec<Offer>,
    stopped: Arc<AtomicBool>,
    /// Signals that stop the running jobs of a coordinator, by its index.
    stopped_jobs: Mutex<BTreeMap<usize, Arc<AtomicBool>>>,
}

impl OwnSimulators {
    /// Opens the simulators of scenes. A model of a server is checked against its scene; no program is started.
    ///
    /// # Errors
    /// [`OfferError`].
    pub fn open(sources: &[SceneSource]) -> Result<Self, OfferError> {
        let mut offers: Vec<(Offer, &str)> = Vec::new();
        for source in sources {
            let (scene, origin) = (source.nominal(), source.origin());
            let Some(simulator) = &scene.simulator else {
                return Err(OfferError::NoSimulator(origin.to_owned()));
            };
            let id = SimulatorId::new(simulator, scene);
            if let Some((_, first)) = offers.iter().find(|(offer, _)| offer.id == id) {
                let (first, second) = ((*first).to_owned(), origin.to_owned());
                return Err(OfferError::Twice { first, second, id });
            }
            let Some(opened) = EvaluationSlots::open(source) else { unreachable!("it names a simulator") };
            let opened =
                opened.map_err(|error| OfferError::Simulator { origin: origin.to_owned(), error })?;
            let inputs = scene.variables.len();
            let offer = Offer { id, inputs, opened, idle: Mutex::default(), made: AtomicUsize::new(0) };
            offers.push((offer, origin));
        }
        let offers = offers.into_iter().map(|(offer, _)| offer).collect();
        Ok(Self { offers, stopped: Arc::default(), stopped_jobs: Mutex::default() })
    }

    /// What the worker offers.
    pub fn ids(&self) -> impl Iterator<Item = &SimulatorId> {
        self.offers.iter().map(|offer| &offer.id)
    }

    /// The offer for a job, if its sample fits.
    fn offer(&self, job: &Job) -> Result<&Offer, String> {
        let Subject::Simulator(wanted) = &job.order.subject else {
            return Err("this worker evaluates its own simulators only, no scenes".to_owned());
        };
        let offer = self.offers.iter().find(|offer| offer.id == *wanted);
        let offer = offer.ok_or_else(|| format!("this worker does not offer {wanted}"))?;
        let found = job.sample().len();
        if found != offer.inputs {
            return Err(format!("a sample of {wanted} has {} values, not {found}", offer.inputs));
        }
        Ok(offer)
    }
}

impl Offer {
    fn evaluate(&self, job: &Job, stop: &StopSignal) -> Result<Evaluation, SimulationFailure> {
        if stop.is_set() {
            return Err(SimulationFailure::SimulatorUnusable { reason: SlotError::Stopped.to_string() });
        }
        let free = locked(&self.idle).pop();
        let mut slot = free.unwrap_or_else(|| self.opened.slot(self.made.fetch_add(1, Ordering::Relaxed)));
        let Task { key, level, with_first_cycle, .. } = job.task;
        let request = SlotRequest { id: key.task, level, with_first_cycle, sample: job.sample() };
        let evaluated = slot.evaluate(request, stop);
        locked(&self.idle).push(slot);
        evaluated.unwrap_or_else(|error| {
            if !matches!(error, SlotError::Stopped) {
                tracing::error!("{}: {error}", self.id);
            }
            Err(SimulationFailure::SimulatorUnusable { reason: error.to_string() })
        })
    }
}

impl Simulator for OwnSimulators {
    fn offers(&self) -> Offers {
        Offers::Simulators(self.ids().cloned().collect())
    }

    fn simulate(&self, job: &Job) -> Result<Evaluation, SimulationFailure> {
        let offer = self.offer(job).map_err(|reason| {
            tracing::error!("an evaluation is refused: {reason}");
            SimulationFailure::SimulatorUnusable { reason }
        })?;
        let of_coordinator = Arc::clone(locked(&self.stopped_jobs).entry(job.coordinator).or_default());
        let stop = StopSignal::new([Arc::clone(&self.stopped), of_coordinator]);
        offer.evaluate(job, &stop.needing(job.order.licensed.then_some(job.coordinator)))
    }

    /// Ends the programs that wait for samples.
    fn on_campaign_ended(&self) {
        for offer in &self.offers {
            let idle = std::mem::take(&mut *locked(&offer.idle));
            drop(idle);
        }
    }

    /// Kills the programs at work for a coordinator.
    fn stop_jobs_of(&self, coordinator: usize) {
        if let Some(stopped) = locked(&self.stopped_jobs).remove(&coordinator) {
            stopped.store(true, Ordering::Relaxed);
        }
    }

    /// Programs that need licences end at that time, even if this process is stopped.
    fn limit_contact(&self, coordinator: usize, until: Option<Instant>) {
        let left = until.map(|until| until.saturating_duration_since(Instant::now()));
        if let Err(error) = limit_contact(coordinator, left) {
            tracing::error!("programs under licences cannot be given a time limit: {error}");
        }
    }

    /// Kills the programs at work; no further one is started.
    fn stop(&self) {
        self.stopped.store(true, Ordering::Relaxed);
    }
}
