//! Errors of commands: one message and an exit code each.

use super::decision_error::DecisionError;
use super::drive_angles::drive_at;
use super::foreign_study::ForeignStudy;
use super::{pdf::PdfError, signals::INTERRUPTED};
use common::external::SimulatorError;
use common::failure::SimulationFailure;
use common::scene::{FaultKind, Faults, Scene};
use coordinator::analyses::budget::BudgetError;
use coordinator::analyses::calibrate::CalibrationError;
use coordinator::analyses::optimise::OptimiseError;
use coordinator::analyses::replay::ReplayError;
use coordinator::farm::dispatch::{ClientError, DispatchError};
use coordinator::farm::evaluate::EvaluateError;
use coordinator::presentation::monitor::MonitorError;
use coordinator::presentation::report::ReportError;
use coordinator::presentation::report::compare::Incomparable;
use coordinator::results::result_files::ResultFileError;
use coordinator::results::store::{StoreError, is_unusable_path};
use coordinator::study::{CampaignError, SettingError, StudyError};
use std::path::{Path, PathBuf};
use thiserror::Error;
use worker::service::ServiceError;

const FAILURE: u8 = 1;
const BAD_INPUT: u8 = 2;

/// An error that ends a command.
#[derive(Debug, Error)]
pub enum CommandError {
    /// The scene or a setting is faulty.
    #[error(transparent)]
    Scene(#[from] Faults),
    /// A command on mechanisms, and a scene without one.
    #[error("{origin}: the scene names its own simulator; this command is for mechanisms")]
    NoMechanism {
        /// File or name of the scene.
        origin: String,
    },
    /// An option on mechanisms, and a scene that names its own simulator.
    #[error("{option} is not for {origin}: {reason}")]
    NotForSimulators {
        /// File or name of the scene.
        origin: String,
        /// Name of the option.
        option: &'static str,
        /// Reason in words.
        reason: &'static str,
    },
    /// Licences, and a study of a mechanism.
    #[error("--licences is for scenes that name their own simulator, not for mechanisms")]
    NoLicences,
    /// A page that cannot be printed.
    #[error(transparent)]
    Pdf(#[from] PdfError),
    /// The simulator that the scene names cannot be used.
    #[error(transparent)]
    Simulator(#[from] SimulatorError),
    /// A folder that cannot be created.
    #[error("{}: {error}", path.display())]
    Folder {
        /// Path of the folder.
        path: PathBuf,
        /// The error of the operating system.
        error: std::io::Error,
    },
    /// The evaluations were interrupted or cannot be distributed.
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
        /// The missing feature.
        what: String,
    },
    /// The simulation failed.
    #[error("{origin}: the simulation failed: {failure}")]
    Simulation {
        /// File or name of the scene.
        origin: String,
        /// Failure of the simulation.
        failure: SimulationFailure,
    },
    /// Extreme cases outside of their stated error.
    #[error(
        "{origin}: {unsound} of {cases} extremes differ from half the step by more than their stated error, or fail with it"
    )]
    Disagreement {
        /// File or name of the scene.
        origin: String,
        /// Number of these cases.
        unsound: usize,
        /// Number of all cases.
        cases: usize,
    },
    /// A scene without random variables or without limit states.
    #[error(
        "{origin}: a study needs at least one random variable and one limit state; `simulate` needs neither"
    )]
    NothingToStudy {
        /// File or name of the scene.
        origin: String,
    },
    /// A setting of the study that is out of range.
    #[error("{} {} is out of range, allowed: {}", option_of(.0.key), .0.value, .0.allowed)]
    Setting(#[from] SettingError),
    /// A file that cannot be written at its destination.
    #[error("--out {}: {fault}", file.display())]
    Destination {
        /// Path of the file.
        file: PathBuf,
        /// The fault of the destination.
        fault: String,
    },
    /// A study of another version of the program.
    #[error(transparent)]
    Foreign(#[from] ForeignStudy),
    /// Studies that cannot be compared.
    #[error(transparent)]
    Incomparable(#[from] Incomparable),
    /// A file that exists already.
    #[error("{}: file exists; choose another name with --out, or move the file", file.display())]
    Existing {
        /// Path of the file.
        file: PathBuf,
    },
    /// A name that is not allowed for a scene.
    #[error(
        "name {name}: allowed are letters, digits, hyphens and underscores, at least one, and no built-in scene's name"
    )]
    SceneName {
        /// The name as given.
        name: String,
    },
    /// A study that is not finished.
    #[error("{}: this study is not finished; continue it with `coordinator resume {}`", dir.display(), dir.display())]
    NotFinished {
        /// Folder of the study.
        dir: PathBuf,
    },
    /// A study that ended without a result.
    #[error("{}: this study ended without a result: {reason}", dir.display())]
    EndedWithoutResult {
        /// Folder of the study.
        dir: PathBuf,
        /// Reason with what can be done about it.
        reason: String,
    },
    /// A folder of a study in which nothing can be written.
    #[error("{}: no file can be written here ({error}); name another folder with --out", dir.display())]
    ReadOnlyStudy {
        /// Folder of the study.
        dir: PathBuf,
        /// The error of the operating system.
        error: std::io::Error,
    },
    /// Two studies that differ in the scene or the accuracy.
    #[error("{} and {} differ in their {difference}; expected are studies of the same scene at the same accuracy", dir.display(), against.display())]
    NotComparable {
        /// Folder of the first study.
        dir: PathBuf,
        /// Folder of the second study.
        against: PathBuf,
        /// The property in which they differ.
        difference: &'static str,
    },
    /// A study with too few simulations.
    #[error("{}: {points} usable simulations, expected at least {least}", dir.display())]
    TooFewSimulations {
        /// Folder of the study.
        dir: PathBuf,
        /// Number of usable simulations.
        points: usize,
        /// Smallest allowed number.
        least: usize,
    },
    /// Parameters that could not be fitted.
    #[error(transparent)]
    Calibration(#[from] CalibrationError),
    /// A design that could not be optimised.
    #[error(transparent)]
    Optimise(#[from] OptimiseError),
    /// Simulations that cannot be replayed.
    #[error("{}: {error}", dir.display())]
    Replay {
        /// Folder of the study.
        dir: PathBuf,
        /// Error with its cause.
        error: ReplayError,
    },
    /// A decision from a finished study failed.
    #[error(transparent)]
    Decision(#[from] DecisionError),
    /// The user stopped the study.
    #[error("interrupted; everything done so far is saved, continue with `coordinator resume {}`", dir.display())]
    Interrupted {
        /// Folder of the study.
        dir: PathBuf,
    },
    /// The study ended with an error.
    #[error("{error}; {}", what_to_do(error, dir))]
    Study {
        /// Folder of the study.
        dir: PathBuf,
        /// Error with its cause.
        error: StudyError,
    },
    /// The campaign file cannot be created, read or written.
    #[error(transparent)]
    Store(#[from] StoreError),
    /// The coordinator cannot listen.
    #[error(transparent)]
    Dispatch(#[from] DispatchError),
    /// The live page or the metrics cannot be served.
    #[error(transparent)]
    Monitor(#[from] MonitorError),
    /// A coordinator does not report its status.
    #[error("{0}")]
    Client(#[from] ClientError),
    /// Checks of `coordinator doctor` failed.
    #[error("{failed} of {tried} checks failed")]
    Unhealthy {
        /// Number of failed checks.
        failed: usize,
        /// Number of all checks.
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
    /// The operating system refused a signal handler.
    #[error("signals: {0}")]
    Signals(#[source] std::io::Error),
    /// The thread that asks a batch system for workers could not be started.
    #[error("workers cannot be asked for")]
    Scale(#[source] std::io::Error),
    /// Options of a study before a command.
    #[error("options of a study go after `run`: coordinator run --workers ...")]
    MisplacedOptions,
    /// A result that cannot be represented in JSON.
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
            | Self::NoMechanism { .. }
            | Self::NotForSimulators { .. }
            | Self::NoLicences
            | Self::Simulator(_)
            | Self::NotModelled { .. }
            | Self::NothingToStudy { .. }
            | Self::Setting(_)
            | Self::Destination { .. }
            | Self::Foreign(_)
            | Self::Incomparable(_)
            | Self::Existing { .. }
            | Self::SceneName { .. }
            | Self::NotFinished { .. }
            | Self::EndedWithoutResult { .. }
            | Self::ReadOnlyStudy { .. }
            | Self::NotComparable { .. }
            | Self::TooFewSimulations { .. }
            | Self::Replay { error: ReplayError::Foreign(_), .. }
            | Self::Calibration(CalibrationError::Scene(_))
            | Self::Decision(_)
            | Self::Monitor(_)
            | Self::MisplacedOptions => BAD_INPUT,
            Self::Interrupted { .. }
            | Self::Calibration(CalibrationError::Evaluate(EvaluateError::Interrupted))
            | Self::Optimise(OptimiseError::Evaluate(EvaluateError::Interrupted))
            | Self::Evaluate(EvaluateError::Interrupted)
            | Self::Budget(BudgetError::Evaluate(EvaluateError::Interrupted)) => INTERRUPTED,
            Self::Budget(BudgetError::OutOfReach { .. } | BudgetError::NothingToHold) => BAD_INPUT,
            Self::Study { error: StudyError::Setting(_), .. } => BAD_INPUT,
            Self::Store(error) if error.is_bad_input() => BAD_INPUT,
            Self::Dispatch(error) if error.is_bad_input() => BAD_INPUT,
            Self::ResultFile(error) | Self::Report(ReportError::File(error)) if error.is_bad_input() => {
                BAD_INPUT
            }
            Self::Report(ReportError::Store(error)) if error.is_bad_input() => BAD_INPUT,
            Self::Folder { error, .. } if is_unusable_path(error) => BAD_INPUT,
            Self::Client(error) if error.is_bad_input() => BAD_INPUT,
            Self::Worker(ServiceError::Settings { .. }) => BAD_INPUT,
            // A reader that closes the pipe has what it needs.
            Self::Output(error) if error.kind() == std::io::ErrorKind::BrokenPipe => 0,
            _ => FAILURE,
        }
    }

    /// The error of the study in the folder `dir`.
    pub fn of_study(error: StudyError, dir: &Path) -> Self {
        match error {
            StudyError::Evaluate(EvaluateError::Interrupted) => Self::Interrupted { dir: dir.to_path_buf() },
            error => Self::Study { dir: dir.to_path_buf(), error },
        }
    }

    /// The error of a report into the study's own folder `dir`, where writing may not be allowed.
    pub fn of_report_in(self, dir: &Path) -> Self {
        match self {
            Self::Report(ReportError::File(ResultFileError::Write { source: error, .. }))
                if is_unusable_path(&error) =>
            {
                Self::ReadOnlyStudy { dir: dir.to_path_buf(), error }
            }
            error => error,
        }
    }

    /// The failure of a simulation; a linkage that cannot work is a fault of its joint.
    pub fn of_simulation(origin: &str, scene: &Scene, failure: SimulationFailure) -> Self {
        let fault =
            |key: &str, message| Self::Scene(Faults::one(origin, key, FaultKind::Inconsistent { message }));
        let at = |joint: &str, message| fault(&format!("joints.{joint}"), message);
        let message = failure.to_string();
        let origin = origin.to_owned();
        match failure {
            SimulationFailure::CannotAssemble { joint, .. }
            | SimulationFailure::ChangePoint { joint, .. } => at(&joint, message),
            SimulationFailure::StartVelocity { key, .. } => fault(&key, message[key.len() + 2..].to_owned()),
            SimulationFailure::DeadPoint { joint, time, .. } => {
                let angle = drive_at(scene, time);
                let locks = format!(
                    "the linkage locks: joint {joint} can follow no further than to {angle}; check lengths and start positions"
                );
                at(&joint, locks)
            }
            SimulationFailure::OverConstrained { joint } => {
                at(&joint, format!("{message}; give one of the joints a clearance or remove it"))
            }
            SimulationFailure::NotModelled { what } => Self::NotModelled { origin, what },
            failure => Self::Simulation { origin, failure },
        }
    }
}

/// What a user can do about a study in `dir` that ended with this error.
fn what_to_do(error: &StudyError, dir: &Path) -> String {
    let dir = dir.display();
    match error {
        StudyError::Campaign(CampaignError::TooManyFailures { failed, total, .. }) => {
            // The next full ten percent, with a tenth in reserve.
            let share = (*failed * 10 / (*total).max(1) + 2).min(10) * 10;
            format!("to go on in spite of them: `coordinator resume {dir} --max-failed {share}%`")
        }
        StudyError::Campaign(CampaignError::Nominal { .. }) => {
            format!("once its cause is removed from the simulator, `coordinator resume {dir}` tries again")
        }
        _ => format!("everything done so far is saved in {dir}"),
    }
}

/// The command-line option of a setting, e.g. `--max-evaluations`.
fn option_of(key: &str) -> String {
    format!("--{}", key.replace('_', "-"))
}
