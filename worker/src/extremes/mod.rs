//! Evaluations at the limits of the model: a scene with each quantity at an extreme, compared with a run at half the time step.
//!
//! A case is sound if the two runs agree within the error that the first one states, or if the evaluation fails with a
//! reason. Any other case is a disagreement: the stated error is too small.

mod cases;
mod outcome;

pub use cases::{Case, cases};
pub use outcome::{Compared, Outcome, Row, run, run_all};
