//! Random variables: distributions, and what in the scene each variable changes.

mod truncated_normal;

pub use truncated_normal::{standard_normal_cdf, standard_normal_pdf, standard_normal_quantile};

use serde::{Deserialize, Serialize};

/// One random variable of a scene.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct RandomVariable {
    /// Unique name, e.g. `rod_length`.
    pub name: String,
    /// Distribution of the value in SI.
    pub distribution: Distribution,
    /// Keys of the scene it sets, e.g. `parameters.rod_length`; none if it is an input of an external simulator.
    pub changes: Vec<String>,
    /// Unit a person reads it in, e.g. `mm`; an input that is a plain number may have one that is only shown.
    pub unit: String,
}

/// A distribution.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub enum Distribution {
    /// Normal(mean, std) of the untruncated parent, cut to [lower, upper].
    TruncatedNormal {
        /// Mean of the parent.
        mean: f64,
        /// Standard deviation of the parent.
        std: f64,
        /// Lower bound.
        lower: f64,
        /// Upper bound.
        upper: f64,
    },
}
