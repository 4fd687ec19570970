//! Reliability over life R(n) with its standard error, its range under the numerical errors of the
//! simulations, shares of first failures, distributions of the outputs, and subset simulation for rare
//! failures.
//!
//! # Source
//! Each file names its own.
//!
//! # Example
//! A failure probability of Phi(-4) = 3.2e-5 by subset simulation:
//!
//! ```
//! use coordinator::statistics::design::{Stream, open_stream};
//! use coordinator::statistics::reliability::SubsetSimulation;
//!
//! // Fails where u_1 + u_2 >= 4 sqrt(2), for independent standard normals u.
//! let respond = |u: &[f64]| u.chunks_exact(2).map(|u| (u[0] + u[1]) / 2f64.sqrt() - 4.0).collect();
//! let simulation = SubsetSimulation { variables: 2, samples: 4000, most_levels: 10 };
//! let subset = simulation.run(&mut open_stream(1, Stream::Subset(0)), &respond);
//! let pf = subset.probability * subset.failed_share();
//! assert!((pf / 3.167e-5 - 1.0).abs() < 0.5);
//! ```

mod curve;
mod distribution;
mod first_failure;
mod numerical;
mod subset;

pub use curve::{Condition, CurvePoint, coefficient_of_variation, governing_checkpoint, reliability_curve};
pub use distribution::{
    Histogram, OutputDistribution, PROBABILITIES, distributions_from_samples, predict_distributions,
};
pub use first_failure::first_failure_shares;
pub use numerical::{NumericalBand, ShiftedFailures, first_failure_with, shift_population};
pub use subset::{Subset, SubsetSimulation};
