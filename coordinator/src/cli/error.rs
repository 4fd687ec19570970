//! Errors of commands: one message and an exit code each.

use common::failure::SimulationFailure;
use common::scene::{Body, FaultKind, Faults, Motion, Scene};
use coordinator::analyses::budget::BudgetError;
use coordinator::analyses::error::AnalysisError;
use coordinator::farm::dispatch::{ClientError, DispatchError};
use coordinator::farm::evaluate::EvaluateError;
use coordinator::results::result_files::ResultFileError;
use coordinator::results::store::{StoreError, is_unusable_path};
use coordinator::study::{CampaignError, SettingError, StudyError};
use std::fmt::Display;
use std::path::{Path, PathBuf};
use thiserror::Error;
use worker::mechanism::Prescribed;
use worker::service::ServiceError;

const FAILURE: u8 = 1;
const BAD_INPUT: u8 = 2;

/// Exit code after an interruption.
pub const INTERRUPTED: u8 = 130;

/// An error that ends a command.
#[derive(Debug, Error)]
pub enum CommandError {
    /// The scene or a setting is faulty.
    #[error(transparent)]
    Scene(#[from] Faults),
    /// What was given, an option, a file or a study, is not what the command can use.
    #[error("{0}")]
    BadInput(String),
    /// What a command had to do and could not, in words.
    #[error("{0}")]
    Failed(String),
    /// The evaluations were interrupted or cannot be distributed.
    #[error(transparent)]
    Evaluate(EvaluateError),
    /// No accuracy keeps the error budget.
    #[error("--max-error: {0}")]
    Budget(#[from] BudgetError),
    /// A setting of the study that is out of range.
    #[error("{} {} is out of range, allowed: {}", option_of(.0.key), .0.value, .0.allowed)]
    Setting(#[from] SettingError),
    /// An analysis without a result.
    #[error(transparent)]
    Analysis(AnalysisError),
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
    /// A coordinator does not report its status.
    #[error("{0}")]
    Client(#[from] ClientError),
    /// A local worker cannot be started.
    #[error("local worker: {0}")]
    Worker(#[from] ServiceError),
    /// A result file or a report cannot be written.
    #[error(transparent)]
    ResultFile(#[from] ResultFileError),
    /// A result that cannot be represented in JSON.
    #[error("the result cannot be written as JSON: {0}")]
    Json(#[from] serde_json::Error),
    /// Standard output is closed.
    #[error("standard output: {0}")]
    Output(#[source] std::io::Error),
}

/// Result of a command, or of a part of one.
pub type Done<T = ()> = Result<T, CommandError>;

impl From<AnalysisError> for CommandError {
    fn from(error: AnalysisError) -> Self {
        match error {
            AnalysisError::Scene(faults) => Self::Scene(faults),
            AnalysisError::Evaluate(error) | AnalysisError::Study(StudyError::Evaluate(error)) => {
                Self::Evaluate(error)
            }
            error => Self::Analysis(error),
        }
    }
}

impl CommandError {
    /// What was given, an option, a file or a study, and why the command cannot use it.
    pub fn refused(subject: impl Display, fault: impl Display) -> Self {
        Self::BadInput(format!("{subject}: {fault}"))
    }

    /// Input that the command cannot use, by the error that says why.
    pub fn bad_input(error: impl Display) -> Self {
        Self::BadInput(error.to_string())
    }

    /// A command on mechanisms, and a scene without one.
    pub fn no_mechanism(origin: &str) -> Self {
        Self::refused(origin, "the scene names its own simulator; this command is for mechanisms")
    }

    /// The failure of a simulation.
    pub fn failed_simulation(origin: &str, failure: &SimulationFailure) -> Self {
        Self::Failed(format!("{origin}: the simulation failed: {failure}"))
    }

    /// Exit code of the process.
    pub fn exit_code(&self) -> u8 {
        let is_bad_input = match self {
            Self::Scene(_)
            | Self::BadInput(_)
            | Self::Setting(_)
            | Self::Budget(BudgetError::OutOfReach { .. } | BudgetError::NothingToHold)
            | Self::Study { error: StudyError::Setting(_), .. }
            | Self::Worker(ServiceError::Settings { .. }) => true,
            Self::Interrupted { .. }
            | Self::Evaluate(EvaluateError::Interrupted)
            | Self::Budget(BudgetError::Evaluate(EvaluateError::Interrupted)) => return INTERRUPTED,
            // A reader that closes the pipe has what it needs.
            Self::Output(error) if error.kind() == std::io::ErrorKind::BrokenPipe => return 0,
            Self::Store(error) => error.is_bad_input(),
            Self::Dispatch(error) => error.is_bad_input(),
            Self::ResultFile(error) => error.is_bad_input(),
            Self::Client(error) => error.is_bad_input(),
            _ => false,
        };
        if is_bad_input { BAD_INPUT } else { FAILURE }
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
            Self::ResultFile(ResultFileError::Write(_, error)) if is_unusable_path(&error) => {
                let fault = format!("no file can be written here ({error}); name another folder with --out");
                Self::refused(dir.display(), fault)
            }
            error => error,
        }
    }

    /// The failure of a simulation; a linkage that cannot work is a fault of its joint.
    pub fn of_simulation(origin: &str, scene: &Scene, failure: SimulationFailure) -> Self {
        let fault =
            |key: &str, message| Self::Scene(Faults::one(origin, key, FaultKind::Inconsistent(message)));
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
            SimulationFailure::NotModelled { what } => {
                Self::refused(origin, format!("not modelled yet: {what}"))
            }
            failure => Self::failed_simulation(&origin, &failure),
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
        StudyError::Campaign(CampaignError::Nominal {
            cause:
                SimulationFailure::Reported { .. }
                | SimulationFailure::TimedOut { .. }
                | SimulationFailure::Crashed { .. }
                | SimulationFailure::NoNumber { .. }
                | SimulationFailure::SimulatorUnusable { .. },
        }) => {
            format!("once its cause is removed from the simulator, `coordinator resume {dir}` tries again")
        }
        StudyError::Campaign(CampaignError::Nominal { .. }) => {
            "change the scene, and start another study".to_owned()
        }
        _ => format!("everything done so far is saved in {dir}"),
    }
}

/// The command-line option of a setting, e.g. `--max-evaluations`.
fn option_of(key: &str) -> String {
    format!("--{}", key.replace('_', "-"))
}

/// Angles of the driven bodies at a time [s], e.g. `crank angle 123.4 deg`.
fn drive_at(scene: &Scene, time: f64) -> String {
    let angle = |body: &Body| {
        let motion = Prescribed::from_body(body).filter(|_| body.motion != Motion::Fixed)?;
        let turned = motion.angle(time).to_degrees().rem_euclid(360.0);
        Some(format!("{} angle {turned:.1} deg", body.name))
    };
    let angles: Vec<String> = scene.bodies.iter().filter_map(angle).collect();
    if angles.is_empty() { format!("t = {time} s") } else { angles.join(", ") }
}
