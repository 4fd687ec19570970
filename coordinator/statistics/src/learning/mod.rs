//! Active learning for several competing limit states over the checkpoints of a life: classification of the
//! population by the surrogates, the error of that classification, the selection of the next samples, and the
//! stopping rules.
//!
//! A limit state ("mode") s has failed by checkpoint n if its response reached the threshold at the start of life, where
//! that is known, or at any checkpoint up to n. The surrogates therefore model the running maximum of each response's history, and
//! predictions are taken as running maxima too: failure is absorbing in the data and in the prediction.
//! The system is in series, it fails with its first mode.
//!
//! | file | computes |
//! |---|---|
//! | `checkpoints` | the checkpoints that matter |
//! | `classification` | predicted first failures, failure shares, and U_c, the learning function U over competing modes |
//! | `pool` | the uncertain points with their joint posterior |
//! | `selection` | the next samples, chosen by a learning function |
//! | `exploration` | samples at the largest predicted variance, or far from all others |
//! | `gaps` | samples in the widest gaps of the population |
//! | `error` | surrogate error of the failure shares, and the effect of the simulator's noise on them |
//! | `steps` | threshold of the surrogate of an output with steps |
//! | `stopping` | the stopping rules |
//!
//! # Source
//! Running maxima: Hu, Mahadevan (2016), A single-loop Kriging surrogate modeling for time-dependent
//! reliability analysis, Journal of Mechanical Design 138(6). Systems: Fauriat, Gayton (2014), AK-SYS: an
//! adaptation of the AK-MCS method for system reliability, Reliability Engineering & System Safety 123.
//! Competing failures with a coupled criterion: Cui et al. (2026), China Mechanical Engineering 37(6),
//! 1472-1485, doi 10.3969/j.issn.1004-132X.2026.06.020.

mod checkpoints;
mod classification;
mod error;
mod exploration;
mod gaps;
mod pool;
mod selection;
mod steps;
mod stopping;

pub use checkpoints::{checkpoints_that_matter, is_settled};
pub use classification::{
    Classification, ClassifiedMode, Coupled, UNCERTAIN, classify_cached, coupled_criterion, curves,
    dominance, with_system,
};
pub use error::{SURROGATE_SAFETY, estimate_errors, noise_shifts};
pub use exploration::{draw_rim, explore, farthest};
pub use gaps::{Gap, largest_gap, sample_of_open, widest_gap};
pub use pool::{JointPool, Pool, choose_pool};
pub use selection::{LearningFunction, Selection};
pub use steps::{LearnedThreshold, is_on_grid, learned_threshold};
pub use stopping::{EARLY, Figures, Rule, Stopping, StoppingTargets};

/// One limit state: failure when `output` has reached `threshold` from below.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Mode {
    /// Index of the response.
    pub output: usize,
    /// Threshold [unit of the output].
    pub threshold: f64,
}

/// The running maximum of a history `(m,)`: max over the value at the `start` of life, if that is known, and the checkpoints up to
/// each one `(m,)` [unit of the output].
pub fn running_maximum(start: Option<f64>, history: &[f64]) -> Vec<f64> {
    let largest_so_far = |largest: &mut f64, value: &f64| {
        *largest = largest.max(*value);
        Some(*largest)
    };
    history.iter().scan(start.unwrap_or(f64::NEG_INFINITY), largest_so_far).collect()
}
