//! The surrogates at the end of a study, as written to `summary.json`.

use serde::{Deserialize, Serialize};

/// The surrogate of one limit state at the end of a study.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct SurrogateRow {
    /// Name of the limit state.
    pub limit_state: String,
    /// Smallest leave-one-out Q2 over the governing checkpoints [1].
    pub q2: f64,
    /// Smallest cross-validated Q2 with the correlation lengths fitted anew [1]; absent with fewer than ten results, and in
    /// studies by earlier versions.
    #[serde(default)]
    pub q2_cross_validated: Option<f64>,
    /// Factor on the predicted variances, from cross-validation or leave-one-out errors [1]; absent in studies by earlier
    /// versions.
    #[serde(default)]
    pub variance_factor: Option<f64>,
    /// Variance of the noise common to all points over the process variance [1].
    pub nugget: f64,
    /// Mean variance of the noise in proportion to the stated errors over the process variance [1].
    pub stated_noise: f64,
    /// Variance of both noises over that of the simulated values, largest over the governing checkpoints [1]; absent in
    /// studies by earlier versions.
    #[serde(default)]
    pub noise_share: Option<f64>,
    /// Name of the correlation kernel; empty in studies by earlier versions.
    #[serde(default)]
    pub kernel: String,
    /// Name of the trend; empty in studies by earlier versions.
    #[serde(default)]
    pub trend: String,
    /// True if separate correlations for early and late checkpoints would predict clearly better than the common one; absent
    /// with one checkpoint.
    #[serde(default)]
    pub separate_would_gain: Option<bool>,
    /// Standard deviation of the noise over the stated errors [1]; absent without stated errors.
    pub share_of_stated_error: Option<f64>,
    /// Number of different values of the response, if it reaches its limit with a jump of more than a tenth of their standard
    /// deviation; absent otherwise, and in studies by earlier versions.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub different_values: Option<usize>,
    /// Largest distance of a simulated value from the median of all over their interquartile range [1]; absent where it is not that of an
    /// outlier, and in studies by earlier versions.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub outlier: Option<f64>,
}

/// Failure probabilities that no simulation has tested, whose intervals are bounded by the independent samples alone.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct UntestedRow {
    /// Limit states, and `total` for the system.
    pub curves: Vec<String>,
    /// Number of independent samples without a failure.
    pub samples: usize,
    /// Failure probability that these exclude with 95 % [1].
    pub bound: f64,
    /// Upper limit of the failure probability of the system at the end of life by the surrogates alone [1].
    pub predicted: f64,
}

/// Share of the variance above which the noise of the simulations costs more than a finer accuracy [1].
const MUCH_NOISE: f64 = 0.02;

impl SurrogateRow {
    /// The share of noise in the simulations, if it is large enough to limit learning [1].
    pub fn much_noise(&self) -> Option<f64> {
        self.noise_share.filter(|share| *share > MUCH_NOISE)
    }
}
