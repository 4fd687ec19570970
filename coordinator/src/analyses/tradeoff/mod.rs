//! Trade-off between speed and accuracy for one scene: simulation time of the accuracy settings against the error of the
//! outputs, validity of the stated errors, and effect of the errors on the reliability, at the nominal point and at random
//! points of the variables.
//!
//! names -> [`settings`] -> [`TradeoffPlan::measure`] -> [`compare`] -> [`answer`], [`values_csv`]

mod compare;
mod lives;
mod measure;
mod page;
#[cfg(test)]
mod tests;

pub use compare::{compare, reference_row};
pub use measure::TradeoffPlan;
pub use measure::{QUICK, full, settings};
pub use page::{answer, values_csv};
