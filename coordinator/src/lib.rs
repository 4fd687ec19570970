//! The coordinator: reliability studies of mechanisms with worn hinges.
//!
//! Data flows one way: design -> evaluate (dispatch) -> surrogate -> learning -> reliability -> sensitivity ->
//! report; `study` is the campaign as one page.

pub mod benchmark;
pub mod budget;
pub mod calibrate;
pub mod design;
pub mod dispatch;
pub mod evaluate;
pub mod journal;
pub mod learning;
pub mod output_unit;
pub mod progress;
pub mod reliability;
pub mod report;
pub mod result_files;
pub mod sensitivity;
pub mod sight;
pub mod store;
pub mod study;
pub mod summary;
pub mod surrogate;
pub mod terminal;
pub mod tradeoff;
