//! Outliers among the results of a study and their further evaluations, as written to `summary.json`.

use serde::{Deserialize, Serialize};

/// An outlier whose sample was evaluated again.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct OutlierRow {
    /// Name of the limit state.
    pub limit_state: String,
    /// Checkpoint of the values [cycles].
    pub cycles: u32,
    /// Distance from the median of all values over their interquartile range [1].
    pub distance: f64,
    /// Evaluations of the sample, that of the outlier first.
    pub evaluations: Vec<OutlierEvaluation>,
}

/// One evaluation of the sample of an outlier.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct OutlierEvaluation {
    /// Number of the evaluation, as in `campaign.db`; absent of a failed one.
    pub number: Option<u64>,
    /// Worker that made it; empty of a failed one.
    pub worker: String,
    /// Value of the output at the checkpoint [unit of the output in files]; absent of a failed one.
    pub value: Option<f64>,
    /// True if it agrees with what the study uses.
    pub used: bool,
}

impl OutlierRow {
    /// True if the study uses the outlier because another evaluation agrees with it.
    pub fn is_confirmed(&self) -> bool {
        self.evaluations.first().is_some_and(|first| first.used)
    }
}
