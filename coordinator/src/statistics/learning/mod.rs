//! Active learning for several competing limit states over a life of checkpoints: what the surrogates say of the
//! population, how far that can be trusted, which points to simulate next, and when to stop.
//!
//! A limit state ("mode") s has failed by checkpoint n when its output reached the threshold at any checkpoint up to n.
//! The surrogates therefore model the running maximum of each output's history, and predicted means are taken as
//! running maxima too: failure is absorbing in the data and in the prediction. The system fails with its first mode.

mod checkpoints;
mod classification;
mod criterion;
mod error;
mod exploration;
mod function;
mod noise;
mod pool;
mod selection;
mod stopping;

pub use checkpoints::checkpoints_that_matter;
pub use classification::{Classification, classify, classify_cached, curves};
pub use criterion::{Coupled, UNCERTAIN, coupled_criterion, dominance};
pub use error::{CurveErrors, estimate_errors};
pub use exploration::explore;
pub use function::LearningFunction;
pub use noise::noise_shifts;
pub use pool::{Pool, choose_pool};
pub use selection::Selection;
pub use stopping::{Figures, Rule, Stopping, Targets};

/// One limit state as learning sees it: failure when `output` has reached `threshold`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Mode {
    /// Index of the output it watches.
    pub output: usize,
    /// Threshold in the unit of the output.
    pub threshold: f64,
}

/// History `(m,)` as its running maximum.
pub fn running_maximum(history: &[f64]) -> Vec<f64> {
    let largest_so_far = |largest: &mut f64, value: &f64| {
        *largest = largest.max(*value);
        Some(*largest)
    };
    history.iter().scan(f64::NEG_INFINITY, largest_so_far).collect()
}
