//! Errors of the campaign file.

use super::exact::OutcomeFault;
use crate::farm::evaluate::EvaluateError;
use rusqlite::ErrorCode;
use std::path::PathBuf;
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
    #[error("output folder {}: in use by another running coordinator; wait for it to end, or start a new study in another folder", dir.display())]
    InUse {
        /// Folder of the study.
        dir: PathBuf,
    },
    /// The folder of a new study holds a study already.
    #[error(
        "output folder {}: already holds a study; continue it with `coordinator resume {}`, or choose another --out",
        dir.display(), dir.display()
    )]
    AlreadyHoldsCampaign {
        /// Folder of the study.
        dir: PathBuf,
    },
    /// The folder holds no campaign file.
    #[error("folder {}: holds no study (no campaign.db); the folder of `coordinator run --out` is expected", dir.display())]
    NoCampaign {
        /// Folder of the study.
        dir: PathBuf,
    },
    /// The file is not a campaign file.
    #[error("{}: is not a campaign file of Hingewise", path.display())]
    NotACampaign {
        /// Path of the campaign file.
        path: PathBuf,
    },
    /// The file has a layout that this program does not know, such as that of a later one.
    #[error(
        "{}: has schema version {found}{} and this program, version {OURS}, reads versions {earliest} to {latest}",
        path.display(), written_by(.program.as_deref())
    )]
    SchemaVersion {
        /// Path of the campaign file.
        path: PathBuf,
        /// Version in the file.
        found: i64,
        /// Version of the program that wrote the file, if the layout still says so.
        program: Option<String>,
        /// Earliest version that this program reads.
        earliest: i64,
        /// Latest version that this program reads, which it also writes.
        latest: i64,
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
    #[error("output folder {}: {source}", dir.display())]
    Folder {
        /// Folder of the study.
        dir: PathBuf,
        /// Error of the operating system.
        source: std::io::Error,
    },
    /// SQLite reports an error.
    #[error("{}: {source}", path.display())]
    Database {
        /// Path of the campaign file.
        path: PathBuf,
        /// Error of SQLite.
        source: rusqlite::Error,
    },
    /// A stored value cannot be decoded, or a value cannot be encoded.
    #[error("{}: {what}: {reason}", path.display())]
    Encoding {
        /// Path of the campaign file.
        path: PathBuf,
        /// Name of the entry.
        what: String,
        /// Message of the encoder or decoder.
        reason: String,
    },
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
            Self::InUse { .. }
            | Self::AlreadyHoldsCampaign { .. }
            | Self::NoCampaign { .. }
            | Self::NotACampaign { .. }
            | Self::SchemaVersion { .. }
            | Self::Outcome { .. } => true,
            Self::Folder { source, .. } => is_unusable_path(source),
            Self::Database { source, .. } => matches!(
                source.sqlite_error_code(),
                Some(ErrorCode::ReadOnly | ErrorCode::CannotOpen | ErrorCode::PermissionDenied)
            ),
            Self::Encoding { .. } | Self::AnotherStudy { .. } | Self::WrongNumber { .. } => false,
        }
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
