//! Why a distribution cannot be taken from measured values.

use super::law::LawError;
use thiserror::Error;

/// Why a distribution cannot be taken from measured values.
#[derive(Debug, Clone, Copy, PartialEq, Error)]
pub enum FitError {
    /// Fewer values than the distribution needs.
    #[error("{found} values, at least {least} are needed")]
    TooFew {
        /// Number of values.
        found: usize,
        /// Fewest values that it needs.
        least: usize,
    },
    /// All values are equal.
    #[error("all values are equal")]
    AllEqual,
    /// A value that is not positive in a family of positive values.
    #[error("value {} is not positive", place + 1)]
    NotPositive {
        /// Index of the value.
        place: usize,
    },
    /// The fitted parameters are outside the range of the distribution.
    #[error(transparent)]
    Law(#[from] LawError),
}
