//! The state of one unit from what was observed of it: Bayesian updating of a population by measurements, survival and
//! failure.
//!
//! The state v `(D,)` of a unit are independent standard normals: those of its random variables, and the deviations of its
//! responses from the predicted means. A model predicts, from a state, the values that were measured and the life. The prior
//! is the population; observations weight it, one after the other; where too few points carry the weight, sequential Monte
//! Carlo moves them.
//!
//! | file | computes |
//! |---|---|
//! | `evidence` | likelihood and predictive probability of an observation |
//! | `particles` | weighted states with their predictions, effective size, quantiles |
//! | `proposal` | moves that leave a normal approximation invariant |
//! | `sequential` | updating by weights, and by tempering with Markov chain moves |
//!
//! # Source
//! Del Moral, Doucet, Jasra (2006), Sequential Monte Carlo samplers, Journal of the Royal Statistical Society B 68(3); Chopin
//! (2002), A sequential particle filter method for static models, Biometrika 89(3); Straub, Papaioannou (2015), Bayesian
//! updating with structural reliability methods, Journal of Engineering Mechanics 141(3).

mod evidence;
mod particles;
mod proposal;
mod sequential;
#[cfg(test)]
mod tests;

pub use evidence::Evidence;
pub use particles::{Particles, Predictions};
pub use sequential::{SequentialMonteCarlo, UnitModel, UnitPosterior, Unsupported};
