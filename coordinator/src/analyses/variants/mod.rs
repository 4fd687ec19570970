//! The model's own doubt: named variants of the model of a study, e.g. another contact law or damping, each by its difference from the
//! study at some of its samples.

mod variants_file;

pub use variants_file::{ModelVariant, read};

use crate::analyses::paired_results::PairedResults;
use crate::results::summary::StudySummary;
use crate::results::summary_rows::VariantRow;
use crate::statistics::reliability::paired::OtherErrors;
use crate::study::{CampaignResult, LearnedVariant, Settings, result_of};
use common::scene::Scene;
use std::time::Instant;

/// Name of the document of a campaign file with its variants.
pub const VARIANTS_DOCUMENT: &str = "variants";

/// The row of a variant, from the study and the variant as learned from the same samples.
pub fn row(
    scene: &Scene,
    settings: &Settings,
    variant: &ModelVariant,
    base: &CampaignResult,
    found: &LearnedVariant,
) -> VariantRow {
    let (learned, [evaluations, failed]) = found;
    let row = VariantRow {
        name: variant.name.clone(),
        changes: variant.changes.clone(),
        evaluations: *evaluations,
        failed: *failed,
        ..VariantRow::default()
    };
    let Some(learned) = learned else { return row };
    let summary = |learned| -> StudySummary { result_of(scene, settings, learned, Instant::now()).summary };
    let (before, after) = (summary(base), summary(learned));
    let [first, changed] = [base, learned].map(|learned| learned.assessment.first_failures());
    let changes = PairedResults::new(first, changed, OtherErrors::Nested).lives(&before, &after);
    let of_system = changes.into_iter().filter(|change| change.limit_state == "total");
    VariantRow {
        reliability: after.reliability,
        lives: after.lives.into_iter().filter(|life| life.limit_state == "total").collect(),
        changes_of_lives: of_system.map(|of| of.cycles).collect(),
        ..row
    }
}
