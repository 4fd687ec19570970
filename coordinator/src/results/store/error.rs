//! What can go wrong with a campaign file.

use crate::farm::evaluate::EvaluateError;
use std::path::PathBuf;
use thiserror::Error;

/// A campaign file that cannot be made, opened, written or read.
#[derive(Debug, Error)]
pub enum StoreError {
    /// Another running process holds the folder.
    #[error("output folder {}: in use by another running coordinator; wait for it to end or choose another --out", dir.display())]
    InUse {
        /// The folder.
        dir: PathBuf,
    },
    /// A new study was to start in a folder that holds one.
    #[error(
        "output folder {}: already holds a campaign; go on with it by `coordinator resume {}`, or choose another --out",
        dir.display(), dir.display()
    )]
    AlreadyHoldsCampaign {
        /// The folder.
        dir: PathBuf,
    },
    /// An existing campaign was asked for where there is none.
    #[error("folder {}: holds no campaign (no campaign.db); a study's output folder is expected", dir.display())]
    NoCampaign {
        /// The folder.
        dir: PathBuf,
    },
    /// The file is there but is no campaign.
    #[error("{}: is not a campaign file of Hingewise", path.display())]
    NotACampaign {
        /// The file.
        path: PathBuf,
    },
    /// The file was written by a program with another layout.
    #[error("{}: has schema version {found}; this program reads version {supported}", path.display())]
    SchemaVersion {
        /// The file.
        path: PathBuf,
        /// Version in the file.
        found: i64,
        /// Version of this program.
        supported: i64,
    },
    /// The file has an earlier layout, and an evaluation in it cannot be read.
    #[error(
        "{}: has schema version {found}, and its evaluation {id} is in a form that this program cannot read ({reason}); \
         start the study anew", path.display()
    )]
    Migration {
        /// The file.
        path: PathBuf,
        /// Version in the file.
        found: i64,
        /// Number of the evaluation.
        id: i64,
        /// The decoder's message.
        reason: String,
    },
    /// The folder cannot be made or locked.
    #[error("output folder {}: {source}", dir.display())]
    Folder {
        /// The folder.
        dir: PathBuf,
        /// Why.
        source: std::io::Error,
    },
    /// SQLite refused.
    #[error("{}: {source}", path.display())]
    Database {
        /// The file.
        path: PathBuf,
        /// Why.
        source: rusqlite::Error,
    },
    /// A stored value cannot be decoded, or a value cannot be encoded.
    #[error("{}: {what}: {reason}", path.display())]
    Encoding {
        /// The file.
        path: PathBuf,
        /// Which entry.
        what: String,
        /// Why.
        reason: String,
    },
    /// An evaluation is asked for whose number is taken by another sample: the file belongs to another study.
    #[error(
        "{}: evaluation {id} was recorded with another {difference}; the file belongs to another study", path.display()
    )]
    AnotherStudy {
        /// The file.
        path: PathBuf,
        /// Number of the evaluation.
        id: u64,
        /// What differs.
        difference: &'static str,
    },
    /// An outcome was handed in under the number of another request.
    #[error("the outcome of evaluation {outcome} was handed in for request {request}")]
    WrongNumber {
        /// Number of the request.
        request: u64,
        /// Number of the outcome.
        outcome: u64,
    },
}

impl StoreError {
    /// Whether the user named a wrong folder (exit code 2) rather than something having failed (exit code 1).
    pub fn is_bad_input(&self) -> bool {
        matches!(
            self,
            Self::InUse { .. }
                | Self::AlreadyHoldsCampaign { .. }
                | Self::NoCampaign { .. }
                | Self::NotACampaign { .. }
                | Self::SchemaVersion { .. }
                | Self::Migration { .. }
        )
    }
}

impl From<StoreError> for EvaluateError {
    fn from(error: StoreError) -> Self {
        Self::Record(error.into())
    }
}
