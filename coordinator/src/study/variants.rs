//! A variant of the model of a finished study: the same variables, outputs and limits with another choice of the model, e.g. its contact law.
//!
//! Some of the samples of the study are simulated once more by the variant, chosen like those of the pairs of finer levels; the
//! differences, a constant or a line over the value, shift all results, from which the variant is learned like the study itself. The
//! correction of the study to finer levels is that of the variant, too. Spread and error of the differences are in its intervals.

use super::dispatching::Dispatcher;
use super::pairs::PairedCampaign;
use super::{
    CampaignResult, Correction, Settings, StoredOutcome, StudyError, campaign_from_results,
    complete_outcomes, learn_from_results,
};
use crate::farm::evaluate::Evaluator;
use crate::results::journal::Journal;
use crate::results::progress::Silent;
use common::scene::Scene;

/// Level of the first variant: those before it are levels of accuracy.
pub const FIRST_VARIANT: u8 = 16;

/// A finished study, as far as its variants need it.
#[derive(Debug, Clone, Copy)]
pub struct StudyOfVariants<'a> {
    /// Scene of the study.
    pub scene: &'a Scene,
    /// Settings of the study; `samples` is the size of the population.
    pub settings: &'a Settings,
    /// Outcomes of all simulations, corrected where a correction is known.
    pub stored: &'a [StoredOutcome],
    /// The correction to finer levels.
    pub correction: Option<&'a Correction>,
}

/// A variant learned from pairs.
#[derive(Debug)]
pub struct LearnedVariant {
    /// Its result; `None` if too few pairs gave one.
    pub learned: Option<CampaignResult>,
    /// Simulations of the variant, and those without a result.
    pub evaluations: [usize; 2],
}

impl StudyOfVariants<'_> {
    /// The study itself from its results, in the same way as its variants.
    ///
    /// # Errors
    /// [`StudyError`].
    pub fn base(&self) -> Result<CampaignResult, StudyError> {
        learn_from_results(self.scene, self.scene, self.settings, self.stored)
    }

    /// Learns a variant, whose simulations are made by `evaluator` and recorded in `journal` under this level.
    ///
    /// # Errors
    /// [`StudyError`]; finished simulations are in the journal by then.
    pub fn learn(
        &self,
        variant: &Scene,
        level: u8,
        evaluator: &mut dyn Evaluator,
        journal: &mut dyn Journal,
    ) -> Result<LearnedVariant, StudyError> {
        let Self { scene, settings, stored, correction } = *self;
        let campaign = campaign_from_results(scene, scene, settings, stored, 0);
        let mut paired =
            PairedCampaign::of_variant(scene, campaign, &complete_outcomes(scene, stored), level);
        Dispatcher::new(variant, None, stored.len(), evaluator, journal, &mut Silent)
            .going_on(stored.len() as u64, correction)
            .run(&mut paired)?;
        let (shift, evaluations) = paired.of_pairs();
        let shifted = shift.map(|shift| shift.correct_all(stored.to_vec()));
        let learned = shifted.map(|shifted| learn_from_results(scene, scene, settings, &shifted));
        Ok(LearnedVariant { learned: learned.transpose()?, evaluations })
    }
}
