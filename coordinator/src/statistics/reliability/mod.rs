//! Reliability over life, with standard errors and what numerical errors mean for it, and the distributions of the outputs behind it.

mod curve;
mod distribution;
mod killers;
mod numerical;
mod subset;

pub use curve::{Condition, CurvePoint, coefficient_of_variation, governing_checkpoint, reliability_curve};
pub use distribution::{
    Histogram, OutputDistribution, PROBABILITIES, distributions_from_samples, predict_distributions,
};
pub use killers::killers;
pub use numerical::{NumericalBand, Shifted, first_failure_with, shift_population};
pub use subset::{Subset, subset_simulation};
