//! The coordinator: reliability studies of mechanisms with worn hinges.
//!
//! Data flows one way: design -> evaluate (dispatch) -> surrogate -> learning -> reliability -> sensitivity ->
//! report; `study` is the campaign as one page.
//!
//! | layer | content | may use |
//! |---|---|---|
//! | [`statistics`] | design, surrogate, learning, reliability, sensitivity | - |
//! | [`farm`] | evaluators and the dispatch of tasks to workers | - |
//! | [`results`] | summary, campaign file, result files | `farm` |
//! | [`study`] | the study from its design to its result | the three above |
//! | [`presentation`] | report, view of a running study, terminal | `farm`, `results`, `study` |
//! | [`analyses`] | trade of speed for accuracy, calibration, verification | all above |

pub mod analyses;
pub mod farm;
pub mod presentation;
pub mod results;
pub mod statistics;
pub mod study;
