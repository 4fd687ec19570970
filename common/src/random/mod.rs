//! Random variables: their distributions, their dependence, and tolerances of manufacture.
//!
//! | module | content |
//! |---|---|
//! | [`distribution`] | eleven distributions, each a file with density, moments and source |
//! | `family` | families of distributions fitted to measured values |
//! | `standard` | standard distributions whose location and scale others are; density, distribution function and quantile of the standard normal |
//! | `copula` | dependence of several variables: the Gaussian copula |
//! | `iso286` | limits, clearances and their spread from tolerance classes such as `H7/e8` |

mod copula;
pub mod distribution;
mod family;
mod iso286;
mod standard;

pub use copula::{Correlation, GaussianCopula, NotPositiveDefinite, normal_from_rank_correlation};
pub use distribution::{Distribution, Extreme, FitError, Law, LawError};
pub use family::Family;
pub use iso286::{Feature, ToleranceClass, ToleranceError, clearance_of_fit};
pub use standard::{
    Standard, Tail, standard_normal_cdf, standard_normal_mass, standard_normal_pdf, standard_normal_quantile,
};

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
    /// Unit in which a person reads it, e.g. `mm`; the unit of an input that is a plain number is only displayed.
    pub unit: String,
}
