//! Check of the levels of accuracy of a study: one to three, each finer than the one before.

use super::{Accuracy, NamedAccuracy};
use thiserror::Error;

/// Most levels of a study: the working accuracy, a finer one, and a third for the observed order of convergence.
pub const MOST_LEVELS: usize = 3;

/// Reason why accuracies are no levels of a study.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
pub enum LevelsError {
    /// None, or too many.
    #[error("{count} levels; allowed: one to {MOST_LEVELS}")]
    Count {
        /// Number of levels.
        count: usize,
    },
    /// A level that is not finer than the one before.
    #[error(
        "level {finer:?} is not finer than {coarser:?}: levels go from the coarsest to the finest, and no setting may become coarser"
    )]
    Order {
        /// Name of the level before.
        coarser: String,
        /// Name of the level that ought to be finer.
        finer: String,
    },
}

impl LevelsError {
    /// The first reason why `levels` are none.
    pub fn of(levels: &[NamedAccuracy]) -> Option<Self> {
        if !(1..=MOST_LEVELS).contains(&levels.len()) {
            return Some(Self::Count { count: levels.len() });
        }
        let wrong = levels.windows(2).find(|pair| !is_finer(&pair[1].accuracy, &pair[0].accuracy))?;
        Some(Self::Order { coarser: wrong[0].name.clone(), finer: wrong[1].name.clone() })
    }
}

/// True if steps, blocks, samples and control points of `a` are at least as fine as those of `b`, and one of them is finer.
fn is_finer(a: &Accuracy, b: &Accuracy) -> bool {
    let numbers = |a: &Accuracy| {
        [
            a.step_tolerance.recip(),
            a.largest_step.recip(),
            f64::from(a.cycle_jump).recip(),
            a.wear_tolerance.recip(),
            a.wear_samples as f64,
            f64::from(a.points),
        ]
    };
    let pairs: Vec<(f64, f64)> = numbers(a).into_iter().zip(numbers(b)).collect();
    pairs.iter().all(|(a, b)| a >= b) && pairs.iter().any(|(a, b)| a > b)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn fault(names: &[&str]) -> Option<String> {
        let levels: Vec<NamedAccuracy> = names.iter().map(|name| name.parse().expect(name)).collect();
        LevelsError::of(&levels).map(|error| error.to_string())
    }

    #[test]
    fn levels_become_finer() {
        assert_eq!(fault(&["draft", "balanced+jump-2000", "reference"]), None);
        assert_eq!(fault(&["balanced", "balanced+points-x2"]), None);
        assert_eq!(fault(&["draft"]), None);
        assert!(
            fault(&["reference", "draft"]).unwrap().contains("\"draft\" is not finer than \"reference\"")
        );
        assert!(fault(&["draft", "draft"]).is_some() && fault(&["draft+points-x2", "balanced"]).is_some());
        assert_eq!(fault(&[]).unwrap(), "0 levels; allowed: one to 3");
    }
}
