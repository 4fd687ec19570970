//! The reliability engine on published problems: cheap limit states with known failure probabilities, learned exactly as a
//! scene is.
//!
//! problems -> runs over seeds -> table

mod problems;
mod run;
mod table;

pub use problems::{PublishedProblem, published_problems};
pub use run::{Run, run};
pub use table::{Row, markdown, row};
