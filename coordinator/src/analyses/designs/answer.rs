//! Reliability and lives of designs from the simulations of the augmented study, the best of several designs, and those that cannot be
//! told from it.

use super::space::DesignSpace;
use crate::analyses::error::AnalysisError;
use crate::analyses::paired_results::PairedResults;
use crate::presentation::report::life::{LifeAt, life_at};
use crate::results::summary::StudySummary;
use crate::statistics::reliability::paired::{Change, OtherErrors};
use crate::study::{
    CampaignResult, FurtherLearning, Settings, StoredOutcome, StudyError, Surrogate, learn_with_surrogates,
    result_of,
};
use common::scene::Scene;
use serde::Serialize;
use std::time::Instant;

/// A finished study of the augmented scene.
#[derive(Debug, Clone, Copy)]
pub struct DesignStudy<'a> {
    /// Scene and design variables of the study.
    pub space: &'a DesignSpace,
    /// The augmented scene.
    pub augmented: &'a Scene,
    /// Settings of the study; `samples` is the size of the population of each design.
    pub settings: &'a Settings,
}

/// Reliability over life of one design.
#[derive(Debug, Clone, PartialEq)]
pub struct DesignAnswer {
    /// Values of the design variables `(q,)`, each in its unit.
    pub values: Vec<f64>,
    /// Result of the design, as that of a study without sensitivities.
    pub summary: StudySummary,
    /// Largest estimated surrogate error of any R(n) [1].
    pub surrogate_error: f64,
    /// First failures of its population `(curves)(N,)`, the system last.
    pub(super) first_failures: Vec<Vec<u32>>,
}

impl DesignStudy<'_> {
    /// The design assessed on its own population from `outcomes`, with the surrogates of the first design that was assessed with them,
    /// which becomes `first` if there is none.
    fn assess(
        &self,
        design: &Scene,
        outcomes: &[StoredOutcome],
        first: &mut Option<(Scene, Vec<Surrogate>)>,
    ) -> Result<CampaignResult, StudyError> {
        let fitted = first.as_ref().map(|(scene, surrogates)| (scene, &surrogates[..]));
        let learned = learn_with_surrogates(design, self.augmented, self.settings, outcomes, fitted)?;
        first.get_or_insert_with(|| (design.clone(), learned.assessment.surrogates.clone()));
        Ok(learned)
    }
}

/// Answers for all `designs`, values of the design variables `(., q)`, from these simulations.
///
/// # Errors
/// [`AnalysisError`].
pub fn answers(
    study: &DesignStudy<'_>,
    designs: &[Vec<f64>],
    outcomes: &[StoredOutcome],
) -> Result<Vec<DesignAnswer>, AnalysisError> {
    let (mut first, mut found) = (None, Vec::with_capacity(designs.len()));
    for values in designs {
        let started = Instant::now();
        let scene = study.space.scene_at(values)?;
        let learned = study.assess(&scene, outcomes, &mut first)?;
        found.push(DesignAnswer {
            values: values.clone(),
            summary: result_of(&scene, study.settings, &learned, started).summary,
            surrogate_error: learned.assessment.figures.error,
            first_failures: learned.assessment.first_failures(),
        });
    }
    Ok(found)
}

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

/// Simulates where single designs are still uncertain: the study of the augmented scene bounds the error of R over all designs together,
/// this bounds that of each one. Adds at most `budget` simulations, a batch at a time at the design with the largest error, until the surrogate error of
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
    let candidate = |values: &Vec<f64>| {
        let scene = study.space.scene_at(values)?;
        Ok(RefinedDesign { scene, error: f64::INFINITY, is_exhausted: false })
    };
    let mut candidates: Vec<_> = designs.iter().map(candidate).collect::<Result<_, AnalysisError>>()?;
    loop {
        // Those that are above the target; all of them once none of these is left.
        for pass in 0..2 {
            let mut first = None;
            for candidate in candidates.iter_mut().filter(|candidate| candidate.error > target) {
                let learned = study.assess(&candidate.scene, &outcomes, &mut first)?;
                candidate.error = learned.assessment.figures.error;
            }
            if pass == 1 || candidates.iter().any(|candidate| candidate.error > target) {
                break;
            }
            candidates.iter_mut().for_each(|candidate| candidate.error = f64::INFINITY);
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
        let known = simulate(&FurtherLearning {
            correction: None,
            changed: &candidates[worst].scene,
            studied: study.augmented,
            settings: study.settings,
            stored: &outcomes,
            further: study.settings.batch.min(left),
        })?;
        candidates[worst].is_exhausted = known.len() == outcomes.len();
        outcomes = known;
    }
}

/// What makes a design good; both refer to the whole system.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Objective {
    /// The life at which R falls to this level, one of [`LEVELS`](crate::study::LEVELS).
    Life {
        /// Level of R [1].
        level: f64,
    },
    /// R at this checkpoint.
    Reliability {
        /// Checkpoint of life [cycles].
        cycles: u32,
    },
}

/// The best design.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Best {
    /// What was compared.
    pub objective: Objective,
    /// Index of the best design among the answers.
    pub index: usize,
    /// Its objective [cycles, or 1].
    pub value: f64,
    /// Whether the objective of the best design is only known to be at least `value`: its life ends beyond the life studied.
    pub is_bound: bool,
    /// Indices of the designs whose difference from the best one lies within the 95 % interval of the difference.
    pub equal: Vec<usize>,
}

impl Objective {
    /// The objective of a design, and whether it is a lower bound; `None` where it is not known.
    fn value(self, answer: &DesignAnswer) -> Option<(f64, bool)> {
        match self {
            Self::Life { level } => match life_at(&answer.summary, "total", level) {
                LifeAt::Cycles { life, .. } => Some((life, false)),
                LifeAt::Beyond { end, .. } => Some((end, true)),
                LifeAt::Unworn { .. } | LifeAt::Between { .. } => None,
            },
            Self::Reliability { cycles } => {
                let row = answer.summary.reliability.iter().find(|row| row.cycles == cycles)?;
                Some((*row.reliability.get("total")?, false))
            }
        }
    }

    /// The change of the objective from `best` to `other` with its interval; `None` where it is not known.
    fn change(self, best: &DesignAnswer, other: &DesignAnswer) -> Option<Change> {
        let [before, after] = [best, other].map(|answer| answer.first_failures.clone());
        let paired = PairedResults::new(before, after, OtherErrors::Independent);
        match self {
            Self::Life { level } => {
                let rows = paired.lives(&best.summary, &other.summary);
                rows.iter().find(|row| row.is_of("total", level))?.cycles
            }
            Self::Reliability { cycles } => {
                let rows = paired.reliability(&best.summary, &other.summary);
                rows.iter().find(|row| row.cycles == cycles)?.change.get("total").copied()
            }
        }
    }
}

impl Best {
    /// The best of the answers; `None` if the objective of none is known.
    pub fn among(answers: &[DesignAnswer], objective: Objective) -> Option<Self> {
        let values: Vec<Option<(f64, bool)>> = answers.iter().map(|answer| objective.value(answer)).collect();
        let known =
            values.iter().enumerate().filter_map(|(i, value)| value.map(|(value, is)| (i, value, is)));
        // The first of equal ones.
        let (index, value, is_bound) =
            known.reduce(|best, next| if next.1 > best.1 { next } else { best })?;
        let is_equal = |i: &usize| match values[*i] {
            _ if *i == index => true,
            Some((_, true)) => is_bound,
            Some((_, false)) if !is_bound => {
                let change = objective.change(&answers[index], &answers[*i]);
                change.is_some_and(|change| change.upper.is_none_or(|upper| upper >= 0.0))
            }
            _ => false,
        };
        let equal = (0..answers.len()).filter(is_equal).collect();
        Some(Self { objective, index, value, is_bound, equal })
    }
}
