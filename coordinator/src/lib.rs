//! The coordinator: reliability studies of mechanisms with worn hinges.
//!
//! Data flows one way: design -> evaluate (dispatch) -> surrogate -> learning -> reliability -> sensitivity ->
//! report; `study` is the campaign as one page.

pub mod design;
pub mod evaluate;
pub mod journal;
pub mod learning;
pub mod progress;
pub mod reliability;
pub mod sensitivity;
pub mod study;
pub mod summary;
pub mod surrogate;
