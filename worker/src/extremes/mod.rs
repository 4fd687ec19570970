//! What an evaluation does at the edges of its model: a scene with every quantity at its extremes, each case held
//! against a run at half the time step.
//!
//! A case is sound if the two runs agree within the error that the first one states of itself, or if it is refused by a
//! failure that says why. Anything else is a disagreement: a number that nobody should have been given.

mod cases;
mod outcome;

pub use cases::{Case, cases};
pub use outcome::{Compared, Outcome, Row, run, run_all};
