//! Levels of accuracy of a study: the working accuracy, at which the surrogates learn, and finer ones for pairs.

use common::accuracy::{LevelsError, NamedAccuracy};
use serde::{Deserialize, Serialize};

/// Levels of a study finer than its working accuracy.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum FinerLevels {
    /// None: the errors that the simulations state are all that is known of their numerical error.
    #[default]
    None,
    /// Two, each with half of every length of the discretisation ([`common::accuracy::Accuracy::halved`]).
    Halved,
    /// These, from the coarser to the finer.
    Named(Vec<NamedAccuracy>),
}

impl FinerLevels {
    /// Working accuracy and finer levels by the names of all levels, the working accuracy first.
    ///
    /// # Errors
    /// [`LevelsError`].
    pub fn of_names(levels: &[NamedAccuracy]) -> Result<(NamedAccuracy, Self), LevelsError> {
        match (LevelsError::of(levels), levels) {
            (None, [working]) => Ok((working.clone(), Self::None)),
            (None, [working, finer @ ..]) => Ok((working.clone(), Self::Named(finer.to_vec()))),
            (Some(error), _) => Err(error),
            (None, []) => Err(LevelsError::Count(0)),
        }
    }

    /// True if there is none; for the stored form, where they are left out then.
    pub(super) fn is_none(&self) -> bool {
        *self == Self::None
    }
}
