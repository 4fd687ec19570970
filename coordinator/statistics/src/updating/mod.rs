//! The state of one unit, or the parameters of a population, from what was observed of units: Bayesian updating by
//! measurements, survival and failure.
//!
//! The state v `(D,)` of a unit are independent standard normals: those of its random variables, and the deviations of its
//! responses from the predicted means. A model predicts, from a state, the values that were measured and the life. The prior
//! is the population; observations weight it, one after the other; where too few points carry the weight, sequential Monte
//! Carlo moves them.
//!
//! | file | computes |
//! |---|---|
//! | `confidence` | R(n) and lives at a confidence, from many sets of parameters |
//! | `evidence` | likelihood and predictive probability of an observation |
//! | `hierarchy` | weights of points under changed distributions; likelihood of a population's parameters from the states of its units |
//! | `parameters` | unknown parameters of distributions with their priors, and those that few samples leave open |
//! | `particles` | weighted states with their predictions, effective size, quantiles |
//! | `sequential` | updating by weights, and by tempering with Markov chain moves |
//!
//! # Source
//! Del Moral, Doucet, Jasra (2006), Sequential Monte Carlo samplers, Journal of the Royal Statistical Society B 68(3); Chopin
//! (2002), A sequential particle filter method for static models, Biometrika 89(3); Straub, Papaioannou (2015), Bayesian
//! updating with structural reliability methods, Journal of Engineering Mechanics 141(3).

mod confidence;
mod evidence;
mod hierarchy;
mod parameters;
mod particles;
mod sequential;
#[cfg(test)]
mod tests;

pub use confidence::{ConfidentLife, ConfidentLimitState, ConfidentReliability, ConfidentRow, CurveDraws};
pub use evidence::Evidence;
pub use hierarchy::{Fleet, Reweighting, UnitPoints};
pub use parameters::{
    ParameterPrior, ParameterSpace, PopulationParameter, UncertainVariable, fitted_draws, is_positive_family,
};
pub use particles::{Particles, Predictions};
pub use sequential::{SequentialMonteCarlo, UnitModel, UnitPosterior, Unsupported};
