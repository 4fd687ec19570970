//! Tests that demonstrate a reliability: n units run for a life, and the test is passed with at most c failures.
//!
//! | file | computes |
//! |---|---|
//! | `plan` | units without prior knowledge, with inspections, and by groups of which each runs to its first failure |
//! | `prior` | units with a prior distribution of R |
//!
//! # Example
//! R = 0.99 with a confidence of 90 % takes 230 units without a failure, ln(1 - C) / ln R:
//! ```
//! use statistics::test_plan::{pass_probability, units};
//!
//! assert_eq!(units(0.99, 0, 0.9), Some(230));
//! assert!(pass_probability(230, 0, 0.99) <= 0.1 && pass_probability(229, 0, 0.99) > 0.1);
//! ```

mod plan;
mod prior;

pub use plan::{
    MOST_UNITS, group_plan, mean_length, pass_probability, reliability_over, reliability_passed, units,
};
pub use prior::BetaPrior;
