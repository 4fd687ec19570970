//! What if: the reliability over life of a study's scene with changed distributions, correlations and thresholds, from the
//! simulations that the study has.
//!
//! The surrogates of a study describe the response to any values of the random variables, whatever their distribution. So
//! the changed scene needs new populations, not new simulations, as long as it stays where the surrogates know the response.
//!
//! | module | content |
//! |---|---|
//! | `changes` | what was changed, as data |
//! | `answer` | reliability, lives and first failures before and after, and their changes |
//! | `region` | where the changed population leaves the simulated region |
//! | `report` | the answer as JSON, with tables, its meaning and its errors in words |

mod answer;
mod changes;
mod region;
mod report;
#[cfg(test)]
mod tests;

pub use super::scene_settings::{changed_scene, redistributed};
pub use answer::{FinishedStudy, POPULATION, WhatIf, ask};
pub use report::{answer, json};
