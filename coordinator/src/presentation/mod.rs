//! How results are shown: the report, the view of a running study, and the terminal.

pub mod monitor;
pub mod report;
pub mod terminal;
