//! Analyses besides the study itself.
//!
//! | module | content |
//! |---|---|
//! | [`budget`] | the cheapest accuracy within an error budget |
//! | [`tradeoff`] | time against error of the accuracy settings |
//! | [`calibrate`] | free parameters fitted to measurements |
//! | [`scene_settings`] | a scene with values set by key, before a study or in a finished one |
//! | [`scene_difference`] | the keys in which scenes differ |
//! | [`designs`] | one study for all designs within ranges of design variables |
//! | [`optimise`] | the cheapest design that reaches a reliability |
//! | [`what_if`] | reliability of a study's scene with changed distributions and thresholds |
//! | [`replace`] | the age, or the measured level, of replacement with the least cost |
//! | [`test_plan`] | units and cycles of a test that demonstrates a reliability |
//! | [`weibull`] | Weibull distribution of lives of a population, beside a study |
//! | [`learn`] | parameters of a population from its units, R at a confidence |
//! | [`variants`] | other choices of the model of a study, by differences |
//! | [`update`] | single units from what was measured of them |
//! | [`paired_results`] | changes between two results from the same simulations |
//! | [`error`] | reasons why there is no answer |
//! | [`quantity`] | quantities of outputs as a person writes them |

pub mod budget;
pub mod calibrate;
pub mod designs;
pub mod error;
pub mod learn;
pub mod optimise;
pub mod paired_results;
pub mod quantity;
pub mod replace;
pub mod scene_difference;
pub mod scene_settings;
mod setting;
pub mod test_plan;
pub mod tradeoff;
pub mod update;
pub mod variants;
pub mod weibull;
pub mod what_if;
