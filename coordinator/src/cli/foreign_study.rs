//! A study of another version of the program that this one cannot go on with: refused with both versions.

use common::scene::Faults;
use thiserror::Error;

/// Version of this program.
const OURS: &str = env!("CARGO_PKG_VERSION");

/// What of a stored study this version of the program cannot read. The layout of the file itself is known: another one is
/// [`coordinator::results::store::StoreError::SchemaVersion`].
#[derive(Debug, Error)]
pub enum ForeignPart {
    /// The settings have an unknown form.
    #[error("the settings of this study cannot be read: {0}")]
    Settings(serde_json::Error),
    /// The scene has faults in the present language.
    #[error("the scene of this study is not accepted:\n{0}")]
    Scene(Faults),
}

/// A study that this version of the program cannot read.
#[derive(Debug, Error)]
#[error("{file}: written by version {program} of the program; in this one, version {OURS}, {part}")]
pub struct ForeignStudy {
    /// The campaign file.
    pub file: String,
    /// Version of the program that started the study.
    pub program: String,
    /// The part that cannot be read.
    pub part: ForeignPart,
}
