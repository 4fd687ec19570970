//! Reliability over life R(n) with its standard error, its range under the numerical errors of the
//! simulations, lives between the checkpoints, shares of first failures, distributions of the outputs, and
//! subset simulation and importance sampling for rare failures, and line sampling for failure probabilities that are smooth
//! in the parameters of a design.
//!
//! # Source
//! Each file names its own.
//!
//! # Example
//! A failure probability of Phi(-4) = 3.2e-5 by subset simulation:
//!
//! ```
//! use statistics::design::{Stream, open_stream};
//! use statistics::reliability::SubsetSimulation;
//!
//! // Fails where u_1 + u_2 >= 4 sqrt(2), for independent standard normals u.
//! let respond = |u: &[f64]| u.chunks_exact(2).map(|u| (u[0] + u[1]) / 2f64.sqrt() - 4.0).collect();
//! let simulation = SubsetSimulation { variables: 2, samples: 4000, most_levels: 10 };
//! let subset = simulation.run(&mut open_stream(1, Stream::Subset(0)), &respond);
//! let pf = subset.probability * subset.failed_share();
//! assert!((pf / 3.167e-5 - 1.0).abs() < 0.5);
//! ```

mod crossing;
mod curve;
mod distribution;
mod importance;
mod interpolation;
mod life_counts;
mod life_curve;
mod line_sampling;
pub mod paired;
mod population_lives;
mod subset;

pub use crossing::{Crossing, Track};
pub use curve::{
    Condition, CurvePoint, REACH, coefficient_of_variation, governing_checkpoint, reliability_curve,
    surrogate_error_at,
};
pub use distribution::{
    Histogram, OutputDistribution, PROBABILITIES, distributions_from_samples, predict_distributions,
};
pub use importance::ImportanceSampling;
pub use life_counts::{ErrorLine, LifeCounts, LifeEstimate, LifePosition, ModeLives, mode_lives};
pub use life_curve::{LifeAtLevel, LifeCurve, LifeCurveInput, half_width};
pub use line_sampling::{LineEstimate, LineRoot, LineSampling, Margins};
pub use population_lives::{PredictedHistory, PredictedMode, population_lives};
pub use subset::{Responses, Subset, SubsetSimulation};
