//! The price of accuracy, for one scene: time of the accuracy settings against the error of its outputs, whether the stated
//! errors hold, and what the errors mean for the reliability, at the nominal point and at random points of the
//! variables.
//!
//! names -> [`settings`] -> [`Plan::measure`] -> [`compare`] -> [`table`], [`csv`], [`values_csv`], [`figures`]

mod compare;
mod csv;
mod figures;
mod lives;
mod measure;
mod page;
mod settings;
mod stated;
#[cfg(test)]
mod tests;

pub use compare::{OutputError, Row, compare, reference_row};
pub use csv::{csv, values_csv};
pub use figures::figures;
pub use lives::{At, LifeChange, life_changes};
pub use measure::{Measured, Measurement, Plan, Progress};
pub use page::table;
pub use settings::{QUICK, full, settings};
pub use stated::{Case, Stated};
