//! Random variables: distributions, and what in the scene each variable changes.

mod beta;
mod constant;
mod copula;
mod distribution;
mod exponential;
mod gumbel;
mod iso286;
mod law;
mod lognormal;
mod normal;
mod standard_normal;
#[cfg(test)]
mod tests;
mod tilted;
mod triangular;
mod truncated_normal;
mod uniform;
mod weibull;

pub use beta::Beta;
pub use constant::Constant;
pub use copula::{Correlation, GaussianCopula, NotPositiveDefinite, normal_from_rank_correlation};
pub use distribution::Distribution;
pub use exponential::Exponential;
pub use gumbel::{Extreme, Gumbel};
pub use iso286::{Feature, Fit, ToleranceClass, ToleranceError};
pub use law::LawError;
pub use lognormal::Lognormal;
pub use normal::Normal;
pub use standard_normal::{standard_normal_cdf, standard_normal_pdf, standard_normal_quantile};
pub use triangular::Triangular;
pub use uniform::Uniform;
pub use weibull::Weibull;

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
