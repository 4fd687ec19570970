//! Errors of the commands that decide from a finished study.

use coordinator::analyses::replace::ReplacementError;
use std::path::PathBuf;
use thiserror::Error;

/// An error of a decision from a finished study.
#[derive(Debug, Error)]
pub enum DecisionError {
    /// The question about a replacement has no answer.
    #[error(transparent)]
    Replacement(#[from] ReplacementError),
    /// A study without design variables.
    #[error(
        "{}: this study has no design variables; start one with `coordinator run --design KEY=LOWER..UPPER`",
        dir.display()
    )]
    NoDesigns {
        /// Folder of the study.
        dir: PathBuf,
    },
    /// An option with a value that is not allowed.
    #[error("{option} {value}: {fault}")]
    Option {
        /// Name of the option.
        option: &'static str,
        /// Value as given.
        value: String,
        /// Fault and allowed values.
        fault: String,
    },
    /// A study without surrogates.
    #[error(
        "{}: this study has no surrogates (method {method}); the responses of units need a study with --method ak",
        dir.display()
    )]
    NoSurrogates {
        /// Folder of the study.
        dir: PathBuf,
        /// Method of the study.
        method: String,
    },
    /// A study with more simulations than surrogates are fitted to.
    #[error(
        "{}: this study of --method {method} has {simulations} simulations, and the answer needs surrogates, which are fitted to at most \
         {most}; start a study with --method ak",
        dir.display()
    )]
    TooManySimulations {
        /// Folder of the study.
        dir: PathBuf,
        /// Method of the study.
        method: String,
        /// Simulations that the study has.
        simulations: usize,
        /// Largest number for surrogates.
        most: usize,
    },
}
