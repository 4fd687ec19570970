//! The statistics of a study: which points are simulated, what surrogates learn from them, and what follows
//! for reliability and sensitivity.
//!
//! Nothing here knows a scene file, a worker or the campaign file: numbers in, numbers out.
//!
//! | module | computes |
//! |---|---|
//! | [`design`] | input model, Monte Carlo population, Latin hypercube |
//! | [`surrogate`] | Kriging models of the responses |
//! | [`learning`] | which point is simulated next, and when to stop |
//! | [`reliability`] | R(n) with its standard error, subset simulation |
//! | [`levels`] | differences between levels of numerical accuracy, by pairs of simulations |
//! | [`replacement`] | age replacement, replacement by inspection, hazard and mean life |
//! | [`updating`] | the state of one unit from its measurements |
//! | [`life_data`] | lives of a population: Weibull fit with suspensions, test of a computed curve |
//! | [`test_plan`] | units and cycles of a test that demonstrates a reliability |
//! | [`optimisation`] | minimum cost under constraints, discrete choices |
//! | [`goodness_of_fit`] | whether measured values can come from a fitted family |
//! | [`sensitivity`] | derivatives of the failure probability, Sobol indices |
//! | [`mod@named`] | names of the values of settings |

pub mod design;
pub mod goodness_of_fit;
pub mod learning;
pub mod levels;
pub mod life_data;
pub mod named;
pub mod optimisation;
pub mod reliability;
pub mod replacement;
pub mod sensitivity;
pub mod surrogate;
pub mod test_plan;
pub mod updating;

/// Published problems with reference failure probabilities, those of the example.
#[cfg(test)]
#[allow(dead_code)] // The example reads more of a problem than the tests do.
#[path = "../../examples/published_problems/problems.rs"]
pub(crate) mod models;
