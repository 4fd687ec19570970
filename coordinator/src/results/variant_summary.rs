//! Variants of the model of a study, as written to `summary.json`.

use super::life_summary::LifeRow;
use super::reliability_summary::ReliabilityRow;
use crate::statistics::reliability::paired::Change;
use serde::{Deserialize, Serialize};

/// Result of a variant, by its difference from the study at the same samples.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct VariantRow {
    /// Name of the variant.
    pub name: String,
    /// What it changes, `key = value`.
    pub changes: Vec<String>,
    /// Its simulations, failed ones included.
    pub evaluations: usize,
    /// Those without a result.
    pub failed: usize,
    /// Reliabilities, one row per checkpoint.
    pub reliability: Vec<ReliabilityRow>,
    /// Lives of the system at the usual levels.
    pub lives: Vec<LifeRow>,
    /// Changes of these lives from the study's, with their 95 % limits [cycles]; absent where one of the lives is not known.
    pub changes_of_lives: Vec<Option<Change>>,
}
