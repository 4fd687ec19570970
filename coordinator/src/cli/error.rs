//! Why a command ended early, in one message, with its exit code.

use super::signals::INTERRUPTED;
use common::failure::SimulationFailure;
use common::scene::{Faults, Motion, Scene};
use coordinator::analyses::benchmark::ReplayError;
use coordinator::analyses::budget::BudgetError;
use coordinator::analyses::calibrate::CalibrationError;
use coordinator::farm::dispatch::{DispatchError, VisitError};
use coordinator::farm::evaluate::EvaluateError;
use coordinator::farm::evaluate::external::SimulatorError;
use coordinator::presentation::monitor::MonitorError;
use coordinator::presentation::report::ReportError;
use coordinator::presentation::report::compare::Incomparable;
use coordinator::results::result_files::ResultFileError;
use coordinator::results::store::StoreError;
use coordinator::study::{CampaignError, StudyError};
use std::path::{Path, PathBuf};
use thiserror::Error;
use worker::mechanism::Prescribed;
use worker::service::ServiceError;

const FAILURE: u8 = 1;
const BAD_INPUT: u8 = 2;

/// What ended a command.
#[derive(Debug, Error)]
pub enum CommandError {
    /// The scene or a setting is faulty.
    #[error(transparent)]
    Scene(#[from] Faults),
    /// The ideal linkage cannot be put together where the cycle starts.
    #[error(
        "{origin}: the linkage cannot be assembled: joint {joint} stays open by {gap} mm where the cycle starts; \
         check lengths and start positions"
    )]
    OpenLinkage {
        /// File or name of the scene.
        origin: String,
        /// Joint with the largest gap.
        joint: String,
        /// Remaining gap [mm].
        gap: f64,
    },
    /// The ideal linkage cannot turn through its cycle.
    #[error(
        "{origin}: the linkage locks: joint {joint} can follow no further than to {angle}; check lengths and start \
         positions"
    )]
    LockedLinkage {
        /// File or name of the scene.
        origin: String,
        /// Joint that opens first beyond it.
        joint: String,
        /// Where the drive stands, in words.
        angle: String,
    },
    /// Ideal joints forbid a motion twice.
    #[error("{origin}: {failure}; give one of the joints a clearance or take it away")]
    OverConstrained {
        /// File or name of the scene.
        origin: String,
        /// Which joint.
        failure: SimulationFailure,
    },
    /// A command that looks at mechanisms, and a scene without one.
    #[error("{origin}: the scene names a simulator of its own; this command is for mechanisms")]
    NoMechanism {
        /// File or name of the scene.
        origin: String,
    },
    /// An option for mechanisms, and a scene that names a simulator of its own.
    #[error("{option} is not for {origin}: {reason}")]
    NotForSimulators {
        /// File or name of the scene.
        origin: String,
        /// Which.
        option: &'static str,
        /// Why not.
        reason: &'static str,
    },
    /// The simulator that the scene names cannot be used.
    #[error(transparent)]
    Simulator(#[from] SimulatorError),
    /// A folder that cannot be made.
    #[error("{}: {error}", path.display())]
    Folder {
        /// Folder.
        path: PathBuf,
        /// Why.
        error: std::io::Error,
    },
    /// A measurement did not come to its end.
    #[error(transparent)]
    Evaluate(EvaluateError),
    /// No accuracy keeps the error budget.
    #[error("--max-error: {0}")]
    Budget(#[from] BudgetError),
    /// The scene is valid but asks for something this version does not model.
    #[error("{origin}: not modelled yet: {what}")]
    NotModelled {
        /// File or name of the scene.
        origin: String,
        /// What.
        what: String,
    },
    /// The simulation has no result.
    #[error("{origin}: the simulation failed: {failure}")]
    Simulation {
        /// File or name of the scene.
        origin: String,
        /// Why.
        failure: SimulationFailure,
    },
    /// A table of extremes with a number that nobody should have been given.
    #[error(
        "{origin}: {unsound} of {cases} extremes differ from half the step by more than their stated error"
    )]
    Disagreement {
        /// File or name of the scene.
        origin: String,
        /// Cases that are not sound.
        unsound: usize,
        /// All cases.
        cases: usize,
    },
    /// A published problem that could not be learned.
    #[error("{problem}, seed {seed}: {error}")]
    Benchmark {
        /// Which.
        problem: &'static str,
        /// Seed of the run.
        seed: u64,
        /// Why.
        error: CampaignError,
    },
    /// A published problem that nobody knows.
    #[error("--problem {name}: unknown, allowed: {allowed}")]
    UnknownProblem {
        /// As given.
        name: String,
        /// Those there are.
        allowed: String,
    },
    /// A scene without anything random, or without a limit state.
    #[error(
        "{origin}: a study needs at least one random variable and one limit state; `simulate` does without"
    )]
    NothingToStudy {
        /// File or name of the scene.
        origin: String,
    },
    /// An option that does not fit the others.
    #[error("{option} {value} is out of range, allowed: {allowed}")]
    Option {
        /// Which.
        option: &'static str,
        /// Its value.
        value: usize,
        /// What is allowed.
        allowed: String,
    },
    /// A file that cannot be written where it is to go.
    #[error("--out {}: {fault}", file.display())]
    Destination {
        /// The file.
        file: PathBuf,
        /// What is wrong with its place.
        fault: String,
    },
    /// The campaign file has settings of another version.
    #[error("{file}: the settings of this study cannot be read: {reason}")]
    ForeignSettings {
        /// The campaign file.
        file: String,
        /// Why.
        reason: String,
    },
    /// Studies that cannot be laid over each other.
    #[error(transparent)]
    Incomparable(#[from] Incomparable),
    /// A file that is there already.
    #[error("{}: is there already; give another place by --out, or move it away", file.display())]
    Existing {
        /// The file.
        file: PathBuf,
    },
    /// A name that a scene cannot have.
    #[error(
        "name {name}: allowed are letters, digits, hyphens and underscores, at least one, and no built-in scene's name"
    )]
    SceneName {
        /// As given.
        name: String,
    },
    /// A study without an end.
    #[error("{}: this study is not finished; go on with `coordinator resume {}`", dir.display(), dir.display())]
    NotFinished {
        /// Its folder.
        dir: PathBuf,
    },
    /// Two studies of different things.
    #[error("{} and {} differ in their {difference}; compared are studies of the same scene at the same accuracy", dir.display(), against.display())]
    NotComparable {
        /// Folder of the one.
        dir: PathBuf,
        /// Folder of the other.
        against: PathBuf,
        /// In what.
        difference: &'static str,
    },
    /// A study with too little to compare.
    #[error("{}: {points} simulations to compare, expected at least {least}", dir.display())]
    TooFewSimulations {
        /// Its folder.
        dir: PathBuf,
        /// How many it has.
        points: usize,
        /// How many it takes.
        least: usize,
    },
    /// Parameters that could not be fitted.
    #[error(transparent)]
    Calibration(#[from] CalibrationError),
    /// Simulations that cannot be learned from again.
    #[error("{}: {error}", dir.display())]
    Replay {
        /// Folder of the study.
        dir: PathBuf,
        /// Why not.
        error: ReplayError,
    },
    /// The user stopped the study.
    #[error("interrupted; everything done so far is saved, go on with `coordinator resume {}`", dir.display())]
    Interrupted {
        /// Its folder.
        dir: PathBuf,
    },
    /// The study cannot come to an end.
    #[error("{error}; everything done so far is saved in {}", dir.display())]
    Study {
        /// Its folder.
        dir: PathBuf,
        /// Why.
        error: StudyError,
    },
    /// The campaign file cannot be made, read or written.
    #[error(transparent)]
    Store(#[from] StoreError),
    /// The coordinator cannot listen.
    #[error(transparent)]
    Dispatch(#[from] DispatchError),
    /// Nobody else can look.
    #[error(transparent)]
    Monitor(#[from] MonitorError),
    /// A coordinator does not tell how it is.
    #[error("{0}")]
    Visit(#[from] VisitError),
    /// Something that a worker needs does not work.
    #[error("{failed} of {tried} checks failed")]
    Unhealthy {
        /// So many.
        failed: usize,
        /// Of so many.
        tried: usize,
    },
    /// A local worker cannot be started.
    #[error("local worker: {0}")]
    Worker(#[from] ServiceError),
    /// A result file cannot be written.
    #[error(transparent)]
    ResultFile(#[from] ResultFileError),
    /// The report cannot be written.
    #[error(transparent)]
    Report(#[from] ReportError),
    /// The system refuses a signal handler.
    #[error("signals: {0}")]
    Signals(#[source] std::io::Error),
    /// Options of a study before a command.
    #[error("options of a study go after `run`: coordinator run --workers ...")]
    MisplacedOptions,
    /// A result that JSON cannot hold.
    #[error("the result cannot be written as JSON: {0}")]
    Json(#[from] serde_json::Error),
    /// Standard output is closed.
    #[error("standard output: {0}")]
    Output(#[source] std::io::Error),
}

impl CommandError {
    /// Exit code of the process.
    pub fn exit_code(&self) -> u8 {
        match self {
            Self::Scene(_)
            | Self::OpenLinkage { .. }
            | Self::LockedLinkage { .. }
            | Self::OverConstrained { .. }
            | Self::NoMechanism { .. }
            | Self::NotForSimulators { .. }
            | Self::Simulator(_)
            | Self::Folder { .. }
            | Self::NotModelled { .. }
            | Self::NothingToStudy { .. }
            | Self::Option { .. }
            | Self::UnknownProblem { .. }
            | Self::Destination { .. }
            | Self::ForeignSettings { .. }
            | Self::Incomparable(_)
            | Self::Existing { .. }
            | Self::SceneName { .. }
            | Self::NotFinished { .. }
            | Self::NotComparable { .. }
            | Self::TooFewSimulations { .. }
            | Self::Replay { error: ReplayError::Foreign(_), .. }
            | Self::Calibration(CalibrationError::Targets { .. } | CalibrationError::Scene(_))
            | Self::MisplacedOptions => BAD_INPUT,
            Self::Interrupted { .. }
            | Self::Calibration(CalibrationError::Evaluate(EvaluateError::Interrupted))
            | Self::Evaluate(EvaluateError::Interrupted)
            | Self::Budget(BudgetError::Evaluate(EvaluateError::Interrupted)) => INTERRUPTED,
            Self::Budget(BudgetError::OutOfReach { .. } | BudgetError::NothingToHold) => BAD_INPUT,
            Self::Study { error: StudyError::Setting { .. }, .. } => BAD_INPUT,
            Self::Store(error) if error.is_bad_input() => BAD_INPUT,
            Self::Dispatch(error) if error.is_bad_input() => BAD_INPUT,
            Self::Monitor(error) if error.is_bad_input() => BAD_INPUT,
            Self::Visit(error) if error.is_bad_input() => BAD_INPUT,
            Self::Worker(ServiceError::Settings { .. }) => BAD_INPUT,
            // Whoever closed the pipe has read all it wanted.
            Self::Output(error) if error.kind() == std::io::ErrorKind::BrokenPipe => 0,
            _ => FAILURE,
        }
    }

    /// How a study ended early; `dir` is its folder.
    pub fn of_study(error: StudyError, dir: &Path) -> Self {
        match error {
            StudyError::Evaluate(EvaluateError::Interrupted) => Self::Interrupted { dir: dir.to_path_buf() },
            error => Self::Study { dir: dir.to_path_buf(), error },
        }
    }

    /// A failure of the physics, told apart from an input that cannot work.
    pub fn of_simulation(origin: &str, scene: &Scene, failure: SimulationFailure) -> Self {
        let origin = origin.to_owned();
        match failure {
            SimulationFailure::CannotAssemble { joint, gap, .. } => {
                Self::OpenLinkage { origin, joint, gap: (gap * 1e6).round() / 1e3 }
            }
            SimulationFailure::DeadPoint { joint, time, .. } => {
                Self::LockedLinkage { origin, joint, angle: drive_at(scene, time) }
            }
            failure @ SimulationFailure::OverConstrained { .. } => Self::OverConstrained { origin, failure },
            SimulationFailure::NotModelled { what } => Self::NotModelled { origin, what },
            failure => Self::Simulation { origin, failure },
        }
    }
}

/// Where the driven bodies stand at a time, e.g. `crank angle 123.4 deg`.
fn drive_at(scene: &Scene, time: f64) -> String {
    let angles: Vec<String> = scene
        .bodies
        .iter()
        .filter_map(|body| {
            let motion = Prescribed::of(body).filter(|_| body.motion != Motion::Fixed)?;
            let turned = motion.angle(time).to_degrees().rem_euclid(360.0);
            Some(format!("{} angle {turned:.1} deg", body.name))
        })
        .collect();
    if angles.is_empty() { format!("t = {time} s") } else { angles.join(", ") }
}
