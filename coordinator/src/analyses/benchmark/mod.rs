//! The reliability engine on published problems: cheap limit states with known failure probabilities, learned exactly as a
//! scene is.
//!
//! problems -> runs over seeds -> table; a direct Monte Carlo run -> replay

mod problems;
mod replay;
#[cfg(test)]
mod replay_tests;
mod run;
mod table;

pub use problems::{PublishedProblem, published_problems};
pub use replay::{ReplayError, Replayed, ReplayedRound, replay};
pub use run::{Run, run};
pub use table::{Row, markdown, row};
