//! Reliability over life, with standard errors, and the distributions of the outputs behind it.

mod curve;
mod distribution;

pub use curve::{CurvePoint, coefficient_of_variation, governing_checkpoint, reliability_curve};
pub use distribution::{
    Histogram, OutputDistribution, PROBABILITIES, distributions_from_samples, predict_distributions,
};
