//! Parameters of a population from what was observed of its units, and the reliability that follows with a confidence, from the
//! surrogates of a finished study.
//!
//! ```text
//! fleet.csv -> units updated one by one -> likelihood of the population's parameters -> sequential Monte Carlo -> R(n) at a confidence
//! ```
//!
//! | module | content |
//! |---|---|
//! | `space` | unknown parameters, their priors, and the distributions of the points |
//! | `population` | R(n) and lives of many sets of parameters over one weighted population |
//! | `fleet` | the posterior of the parameters; units and variables to be checked |
//! | `data_value` | which further data would narrow the bound most |
//! | `result`, `text` | settings and answer |
//!
//! The surrogates' errors count as scatter between units: an error that all units share is not in the bounds.

mod data_value;
#[cfg(test)]
mod dependence_tests;
mod fleet;
mod population;
mod result;
mod space;
#[cfg(test)]
mod tests;
mod text;

pub use fleet::learn;
pub use population::{fitted_reliability, uncertain_fits};
pub use result::{LearnReport, LearnSettings};
pub use space::{hold_known, scene_of_units};
pub use text::{answer, confident_answer, confident_figure, confident_parts};
