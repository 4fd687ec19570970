//! When to replace: age replacement from a curve of reliability, replacement by inspection from samples, and the failure
//! density, hazard and mean life of a curve, each with a 95 % interval.
//!
//! | file | computes |
//! |---|---|
//! | `survival_curve` | R between its points, its integral, lives, density and hazard |
//! | `age_replacement` | cost rate of replacement at an age, and its minimum |
//! | `curve_band` | intervals of what follows from a curve, with errors correlated along it |
//! | `inspection` | cost rate of replacement above a measured level, and its minimum |
//!
//! # Example
//! A part that lives 1000 to 2000 cycles, equally likely, and whose failure costs ten times a planned replacement:
//! ```
//! use statistics::replacement::{ReplacementCosts, SurvivalCurve};
//!
//! let curve = SurvivalCurve::new(&[0.0, 1000.0, 2000.0], &[1.0, 1.0, 0.0]);
//! let best = ReplacementCosts { planned: 1.0, failure: 10.0 }.best_age(&curve);
//! // The hazard begins at 1000 cycles, and any failure is too expensive from the first on.
//! assert_eq!((best.age, best.at_the_end), (1000.0, false));
//! assert!((best.cost_rate - 1.0 / 1000.0).abs() < 1e-12);
//! ```
//!
//! # Source
//! Barlow, Proschan (1965), Mathematical Theory of Reliability, Wiley, chapter 3; the inspection policy is that of
//! condition-based maintenance, e.g. Jardine, Tsang (2013), Maintenance, Replacement, and Reliability, CRC Press, chapter 3.

mod age_replacement;
mod curve_band;
mod inspection;
mod survival_curve;

pub use age_replacement::{AgeReplacement, ReplacementCosts};
pub use curve_band::CurveBand;
pub use inspection::{
    InspectedSamples, InspectionPolicy, PolicyCosts, PolicyOutcome, best_policy, outcome_of,
};
pub use survival_curve::SurvivalCurve;
