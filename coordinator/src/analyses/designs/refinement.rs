//! Simulations where single designs are still uncertain: the study of the augmented scene bounds the error of R over all
//! designs together, these bound that of each one.

use super::answer::DesignStudy;
use crate::analyses::error::AnalysisError;
use crate::study::{FurtherLearning, StoredOutcome, Surrogate};
use common::scene::Scene;

/// What refinement has done.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Refined {
    /// Simulations that were added.
    pub added: usize,
    /// Largest estimated surrogate error of R of any design that was refined for [1].
    pub largest_error: f64,
    /// Surrogate error at which a study with these settings may stop [1].
    pub target_error: f64,
}

impl Refined {
    /// True if every design has reached the target.
    pub fn is_reached(&self) -> bool {
        self.largest_error <= self.target_error
    }
}

/// Designs with their scenes, errors and whether learning at them has more to ask for.
struct RefinedDesign {
    scene: Scene,
    error: f64,
    is_exhausted: bool,
}

/// Adds at most `budget` simulations, a batch at a time at the design with the largest error, until the surrogate error of
/// every R(n) of every one of `designs` is below the target. `simulate` goes on learning and returns all outcomes so far;
/// `progress` receives the largest error and the number of simulations added.
///
/// # Errors
/// [`AnalysisError`], and those of `simulate`.
pub fn refine(
    study: &DesignStudy<'_>,
    designs: &[Vec<f64>],
    mut outcomes: Vec<StoredOutcome>,
    budget: usize,
    simulate: &mut dyn FnMut(&FurtherLearning<'_>) -> Result<Vec<StoredOutcome>, AnalysisError>,
    progress: &mut dyn FnMut(f64, usize),
) -> Result<Refined, AnalysisError> {
    let target = study.settings.targets().error;
    let before = outcomes.len();
    let mut candidates = Vec::with_capacity(designs.len());
    for values in designs {
        let scene = study.space.scene_at(values)?;
        candidates.push(RefinedDesign { scene, error: f64::INFINITY, is_exhausted: false });
    }
    loop {
        // Those that are above the target; all of them once none of these is left.
        assess(study, &mut candidates, &outcomes, target)?;
        if candidates.iter().all(|candidate| candidate.error <= target) {
            candidates.iter_mut().for_each(|candidate| candidate.error = f64::INFINITY);
            assess(study, &mut candidates, &outcomes, target)?;
        }
        let largest = candidates.iter().map(|candidate| candidate.error).fold(0.0, f64::max);
        let added = outcomes.len() - before;
        progress(largest, added);
        let open = candidates.iter().enumerate().filter(|(_, c)| c.error > target && !c.is_exhausted);
        let worst = open.max_by(|(_, a), (_, b)| a.error.total_cmp(&b.error)).map(|(i, _)| i);
        let left = budget.saturating_sub(added);
        let Some(worst) = worst.filter(|_| left > 0) else {
            return Ok(Refined { added, largest_error: largest, target_error: target });
        };
        let further = study.settings.batch.min(left);
        let learning = FurtherLearning {
            correction: None,
            changed: &candidates[worst].scene,
            studied: study.augmented,
            settings: study.settings,
            stored: &outcomes,
            further,
        };
        let known = simulate(&learning)?;
        candidates[worst].is_exhausted = known.len() == outcomes.len();
        outcomes = known;
    }
}

/// Assesses the candidates above the target.
fn assess(
    study: &DesignStudy<'_>,
    candidates: &mut [RefinedDesign],
    outcomes: &[StoredOutcome],
    target: f64,
) -> Result<(), AnalysisError> {
    let mut surrogates: Vec<Surrogate> = vec![];
    for candidate in candidates.iter_mut().filter(|candidate| candidate.error > target) {
        let learned = study.assess(&candidate.scene, outcomes, &surrogates)?;
        candidate.error = learned.assessment.errors.largest();
        if surrogates.is_empty() {
            surrogates = learned.assessment.surrogates;
        }
    }
    Ok(())
}
