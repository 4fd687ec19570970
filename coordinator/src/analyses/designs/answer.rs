//! Reliability and lives of designs from the simulations of the augmented study.

use super::space::DesignSpace;
use crate::analyses::error::AnalysisError;
use crate::results::summary::StudySummary;
use crate::study::{
    CampaignResult, Settings, StoredOutcome, StudyError, Surrogate, learn_with_surrogates, result_of,
};
use common::scene::Scene;
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
    /// The design with these values, assessed on its own population from `outcomes`, with the surrogates of an earlier
    /// assessment of the same outcomes, if there are any.
    pub(super) fn assess(
        &self,
        design: &Scene,
        outcomes: &[StoredOutcome],
        surrogates: &[Surrogate],
    ) -> Result<CampaignResult, StudyError> {
        learn_with_surrogates(design, self.augmented, self.settings, outcomes, surrogates)
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
    let mut surrogates: Vec<Surrogate> = vec![];
    let mut found = Vec::with_capacity(designs.len());
    for values in designs {
        let started = Instant::now();
        let scene = study.space.scene_at(values)?;
        let learned = study.assess(&scene, outcomes, &surrogates)?;
        found.push(DesignAnswer {
            values: values.clone(),
            summary: result_of(&scene, study.settings, &learned, started).summary,
            surrogate_error: learned.assessment.errors.largest(),
            first_failures: learned.assessment.first_failures(),
        });
        if surrogates.is_empty() {
            surrogates = learned.assessment.surrogates;
        }
    }
    Ok(found)
}
