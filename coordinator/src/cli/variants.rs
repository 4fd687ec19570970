//! `run --variants` and `resume --variants`: other choices of the model of a study, each by its difference from the study.

use super::results::write_results;
use super::{
    CommandError, CommandEvaluator, Done, FarmArguments, OpenedStudy, StoredStudy, Verbosity, failed,
    known_outcomes, stored_correction,
};
use common::scene::{InputFile, SceneSource};
use coordinator::analyses::variants::{ModelVariant, VARIANTS_DOCUMENT, read, row};
use coordinator::presentation::report::SUMMARY_DOCUMENT;
use coordinator::results::store::FurtherEvaluations;
use coordinator::results::summary::VariantRow;
use coordinator::study::{Method, Settings, StudyOfVariants};
use std::path::Path;

/// The variants of a file for a study of this scene.
///
/// # Errors
/// [`CommandError::Scene`], [`CommandError::Refused`].
pub fn variants_of(
    file: &Path,
    source: &SceneSource,
    method: Method,
    has_designs: bool,
) -> Done<Vec<ModelVariant>> {
    let refused =
        |fault: &str| Err(CommandError::refused(format_args!("--variants {}", file.display()), fault));
    if has_designs {
        return refused("a study with --design has no variants; run it for one design");
    }
    if method != Method::ActiveLearning {
        return refused("variants need --method ak");
    }
    Ok(read(&InputFile::load(file)?, source)?)
}

/// Writes variants into the campaign file of a study, in the place of those of an earlier file.
///
/// # Errors
/// [`CommandError::Store`].
pub fn store_variants(study: &mut StoredStudy, variants: &[ModelVariant]) -> Done {
    let known = study.campaign.document(VARIANTS_DOCUMENT)?.unwrap_or_default();
    Ok(study.campaign.put_document(VARIANTS_DOCUMENT, &ModelVariant::merged(known, variants))?)
}

/// Learns the variants of a finished study that its summary lacks, and writes its results again.
///
/// # Errors
/// [`CommandError`]; finished simulations are in the study by then.
pub fn after_study(study: StoredStudy, farm: &FarmArguments, verbosity: Verbosity) -> Done<StoredStudy> {
    let known: Vec<ModelVariant> = study.campaign.document(VARIANTS_DOCUMENT)?.unwrap_or_default();
    let asked: Vec<ModelVariant> = known.into_iter().filter(|variant| variant.is_asked).collect();
    if asked.is_empty() {
        return Ok(study);
    }
    let mut opened = OpenedStudy::of(study)?;
    let is_done = |(done, asked): (&VariantRow, &ModelVariant)| {
        (&done.name, &done.changes) == (&asked.name, &asked.changes)
    };
    let rows = &opened.summary.variants;
    if rows.len() == asked.len() && rows.iter().zip(&asked).all(is_done) {
        return Ok(opened.study);
    }
    let dir = opened.study.campaign.dir.clone();
    let outcomes = known_outcomes(&opened.study.campaign, opened.study.scene())?;
    let correction = stored_correction(&opened.study.campaign, opened.study.scene())?;
    let scene = opened.study.scene().clone();
    let (settings, correction) = (&opened.settings, correction.as_ref());
    let of_variants = StudyOfVariants { scene: &scene, settings, stored: &outcomes, correction };
    let base = of_variants.base().map_err(|error| failed(error, &dir))?;
    let mut rows = Vec::new();
    for variant in &asked {
        let source = SceneSource::parse(&variant.scene, &variant.name)?;
        let mut settings: Settings = opened.settings.clone();
        settings.accuracy.setting = variant.accuracy.clone().unwrap_or(settings.accuracy.setting);
        let mut evaluator = CommandEvaluator::started(&source, &settings, farm, verbosity.quiet)?;
        let mut journal = FurtherEvaluations(&mut opened.study.campaign);
        let found = of_variants.learn(source.nominal(), variant.level, evaluator.evaluator(), &mut journal);
        let found = found.map_err(|error| CommandError::of_study(error, &dir))?;
        evaluator.close();
        let [evaluations, failed] = found.1;
        verbosity.say(format_args!("variant {}: {evaluations} simulations, {failed} failed", variant.name));
        rows.push(row(&scene, &opened.settings, variant, &base, &found));
    }
    opened.summary.variants = rows;
    opened.study.campaign.put_document(SUMMARY_DOCUMENT, &opened.summary)?;
    write_results(&opened.study.campaign, &dir, &[])?;
    Ok(opened.study)
}
