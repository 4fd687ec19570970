//! Errors of the campaign file.

use super::exact::OutcomeFault;
use super::schema::{EARLIEST_VERSION, SCHEMA_VERSION};
use crate::farm::evaluate::EvaluateError;
use rusqlite::ErrorCode;
use std::path::{Path, PathBuf};
use thiserror::Error;

/// Version of this program.
const OURS: &str = env!("CARGO_PKG_VERSION");

/// The program that wrote a file, as part of a message.
fn written_by(program: Option<&str>) -> String {
    program.map_or_else(String::new, |version| format!(", written by version {version} of the program,"))
}

/// A campaign file that cannot be created, opened, written or read.
#[derive(Debug, Error)]
pub enum StoreError {
    /// Another running process has locked the folder.
    #[error("output folder {}: in use by another running coordinator; wait for it to end, or start a new study in another folder", .0.display())]
    InUse(PathBuf),
    /// The folder of a new study holds a study already.
    #[error(
        "output folder {dir}: already holds a study; continue it with `coordinator resume {dir}`, or choose another --out",
        dir = .0.display()
    )]
    AlreadyHoldsCampaign(PathBuf),
    /// The folder holds no campaign file.
    #[error("folder {}: holds no study (no campaign.db); the folder of `coordinator run --out` is expected", .0.display())]
    NoCampaign(PathBuf),
    /// The file at this path is not a campaign file.
    #[error("{}: is not a campaign file of Hingewise", .0.display())]
    NotACampaign(PathBuf),
    /// The file has a layout that this program does not know, such as that of a later one.
    #[error(
        "{}: has schema version {found}{} and this program, version {OURS}, reads versions {EARLIEST_VERSION} to {SCHEMA_VERSION}",
        path.display(), written_by(.program.as_deref())
    )]
    SchemaVersion {
        /// Path of the campaign file.
        path: PathBuf,
        /// Version in the file.
        found: i64,
        /// Version of the program that wrote the file, if the layout still says so.
        program: Option<String>,
    },
    /// A recorded evaluation has a form that this program cannot read, although the layout is known.
    #[error(
        "{}: the outcome of evaluation {id}{} cannot be read by this program, version {OURS} ({reason}); use that version, \
         or start a new study", path.display(), written_by(Some(program))
    )]
    Outcome {
        /// Path of the campaign file.
        path: PathBuf,
        /// Number of the evaluation.
        id: i64,
        /// Version of the program that started the study.
        program: String,
        /// What is wrong with its bytes.
        reason: OutcomeFault,
    },
    /// The folder cannot be created or locked.
    #[error("output folder {dir}: {1}", dir = .0.display())]
    Folder(PathBuf, #[source] std::io::Error),
    /// SQLite reports an error of the campaign file at this path.
    #[error("{path}: {1}", path = .0.display())]
    Database(PathBuf, #[source] rusqlite::Error),
    /// A stored value of the campaign file at this path cannot be decoded, or a value cannot be encoded: name of the entry, and message of
    /// the encoder or decoder.
    #[error("{path}: {1}: {2}", path = .0.display())]
    Encoding(PathBuf, String, String),
    /// A request has the number of an evaluation with another sample: the file belongs to another study.
    #[error(
        "{}: evaluation {id} was recorded with another {difference}; the file belongs to another study", path.display()
    )]
    AnotherStudy {
        /// Path of the campaign file.
        path: PathBuf,
        /// Number of the evaluation.
        id: u64,
        /// The property that differs.
        difference: &'static str,
    },
    /// An outcome has the number of another request.
    #[error("the outcome of evaluation {outcome} was recorded for request {request}")]
    WrongNumber {
        /// Number of the request.
        request: u64,
        /// Number of the outcome.
        outcome: u64,
    },
}

impl StoreError {
    /// True if the user named a wrong folder (exit code 2), false for other failures (exit code 1).
    pub fn is_bad_input(&self) -> bool {
        match self {
            Self::Folder(_, source) => is_unusable_path(source),
            Self::Database(_, source) => matches!(
                source.sqlite_error_code(),
                Some(ErrorCode::ReadOnly | ErrorCode::CannotOpen | ErrorCode::PermissionDenied)
            ),
            other => {
                !matches!(other, Self::Encoding(..) | Self::AnotherStudy { .. } | Self::WrongNumber { .. })
            }
        }
    }

    /// What an error of SQLite is of the campaign file at `path`.
    pub(super) fn of(path: &Path) -> impl Fn(rusqlite::Error) -> Self + Copy + '_ {
        |source| Self::Database(path.into(), source)
    }
}

/// Whether an error of the operating system is the fault of the path, which the user has to change, rather than of the
/// disk.
pub fn is_unusable_path(error: &std::io::Error) -> bool {
    use std::io::ErrorKind::{
        AlreadyExists, InvalidFilename, IsADirectory, NotADirectory, NotFound, PermissionDenied,
        ReadOnlyFilesystem,
    };
    matches!(
        error.kind(),
        PermissionDenied
            | NotFound
            | NotADirectory
            | IsADirectory
            | AlreadyExists
            | InvalidFilename
            | ReadOnlyFilesystem
    )
}

impl From<StoreError> for EvaluateError {
    fn from(error: StoreError) -> Self {
        Self::Record(error.into())
    }
}
