//! What tests of several modules share.

pub mod test_study;

/// Published problems with reference failure probabilities, those of the example.
#[allow(dead_code)] // The example reads more of a problem than the tests do.
#[path = "../../examples/published_problems/problems.rs"]
pub mod models;
