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
//! | `outside` | intervals where most of it does |
//! | `report` | the answer as JSON, with tables, its meaning and its errors in words |

mod answer;
mod changes;
mod outside;
mod region;
mod report;
#[cfg(test)]
mod tests;

pub use super::scene_settings::{changed_scene, redistributed};
pub use answer::{Agreement, FinishedStudy, POPULATION, WhatIf, ask};
pub use changes::{ChangedCorrelation, ChangedThreshold, ChangedVariable, Changes, LawParameters};
pub use region::{OutsideVariable, Region};
pub use report::{answer, json};
