//! The coordinator: reliability studies of mechanisms with worn hinges.
//!
//! Data flows one way: design -> evaluate (dispatch) -> surrogate -> learning -> reliability -> sensitivity ->
//! report; `study` is the campaign as one page.

pub mod dispatch;
pub mod evaluate;
pub mod journal;
pub mod progress;
pub mod summary;
