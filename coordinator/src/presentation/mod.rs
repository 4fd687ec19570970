//! Presentation of results: the report, the views of a running study, and the terminal.
//!
//! | module | content |
//! |---|---|
//! | [`report`] | the report of a finished study, and the comparison of several |
//! | [`monitor`] | status and live report of a running study |
//! | [`mod@format`] | numbers as text for people |
//! | [`motion_cautions`] | cautions about energy and settling of the simulated motion, and about the number of control points |
//! | [`nominal_life`] | one mechanism against the limits of its scene |
//! | [`progress`] | progress of a study, and the time that it still takes |
//! | [`terminal`] | progress and final summary on the terminal |

pub mod format;
pub mod monitor;
pub mod motion_cautions;
pub mod nominal_life;
pub mod progress;
pub mod report;
pub mod terminal;
