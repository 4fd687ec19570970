//! Variants with a known difference from an analytic study.

use super::finer_levels::FinerLevels;
use super::result::curves_from_learning;
use super::{
    CampaignResult, Correction, FIRST_VARIANT, Observed, Settings, StoredOutcome, StudyOfVariants, run,
};
use crate::farm::evaluate::Request;
use crate::farm::evaluate::local::LocalEvaluator;
use crate::results::journal::InMemoryJournal;
use crate::results::progress::Silent;
use crate::results::summary::StudySummary;
use crate::results::timing::Timing;
use crate::statistics::design::{InputModel, Population};
use common::outputs::Evaluation;
use common::scene::{Scene, SceneSource};
use std::sync::LazyLock;

/// Threshold of the scene [m].
const LIMIT: f64 = 8e-6;

fn scene() -> Scene {
    SceneSource::builtin("four-bar").unwrap().nominal().clone()
}

fn settings() -> Settings {
    let of_scene = Settings::from(&scene());
    Settings {
        samples: 6000,
        initial: 20,
        max_evaluations: 60,
        seed: 3,
        levels: FinerLevels::None,
        ..of_scene
    }
}

/// Wear at the checkpoints `(8,)` [m], with R near 1/2 at the sixth.
fn wear(scene: &Scene, sample: &[f64]) -> Vec<f64> {
    let z = InputModel::from_scene(scene).standardise(sample);
    let scale = 1.0 + 0.04 * z[0] + 0.02 * z[1] + 0.01 * z[2] * z[3];
    (1..=8).map(|n| LIMIT * f64::from(n) / 6.0 * scale).collect()
}

/// The evaluation of a model whose wear is what `of` makes of that of the study.
fn evaluation(scene: &Scene, sample: &[f64], of: impl Fn(f64) -> f64) -> Evaluation {
    let wear: Vec<f64> = wear(scene, sample).into_iter().map(of).collect();
    Evaluation::from_histories((1..=8).map(|n| 1000 * n).collect(), vec![wear.clone(), wear])
}

/// Outcomes of the study.
static STUDIED: LazyLock<Vec<StoredOutcome>> = LazyLock::new(|| {
    let (scene, mut journal) = (&scene(), InMemoryJournal::default());
    let mut evaluator =
        LocalEvaluator::new(2, |request: &Request| Ok(evaluation(scene, &request.sample, |y| y)));
    run(scene, &settings(), &mut evaluator, &mut journal, &mut Silent).unwrap();
    crate::tests::stored(&journal)
});

fn summary(scene: &Scene, learned: &CampaignResult) -> StudySummary {
    curves_from_learning(scene, &settings(), learned).result(scene, Timing::default(), vec![]).summary
}

/// The study and a variant whose wear is what `of` makes of it.
fn learn(
    correction: Option<&Correction>,
    of: impl Fn(f64) -> f64 + Sync,
) -> (StudySummary, StudySummary, usize) {
    let (scene, settings) = (scene(), settings());
    let stored = match correction {
        None => STUDIED.clone(),
        Some(correction) => correction.correct_all(STUDIED.clone()),
    };
    let study = StudyOfVariants { scene: &scene, settings: &settings, stored: &stored, correction };
    let base = study.base().unwrap();
    let mut journal = InMemoryJournal::default();
    let mut evaluator = LocalEvaluator::new(2, |request: &Request| {
        assert_eq!((request.level, request.accuracy), (FIRST_VARIANT, None));
        Ok(evaluation(&scene, &request.sample, &of))
    });
    let found = study.learn(&scene, FIRST_VARIANT, &mut evaluator, &mut journal).unwrap();
    let (Some(learned), [evaluations, 0]) = found else { panic!("a result without failures") };
    assert_eq!(journal.outcomes().len(), evaluations);
    (summary(&scene, &base), summary(&scene, &learned), evaluations)
}

/// The study and a variant that wears faster by a twentieth.
static SHIFTED: LazyLock<(StudySummary, StudySummary, usize)> = LazyLock::new(|| learn(None, |y| 1.05 * y));

#[test]
fn a_variant_that_is_the_study_differs_in_no_bit() {
    let scene = scene();
    let finer = |one: &StoredOutcome| {
        let finer = evaluation(&scene, &one.sample, |y| 1.01 * y);
        (1, StoredOutcome { sample: one.sample.clone(), outcome: Ok(Observed::from_evaluation(finer)) })
    };
    let pairs: Vec<(u8, StoredOutcome)> = STUDIED.iter().take(6).map(finer).collect();
    let correction = Correction::from_stored(&scene, &STUDIED, &pairs);
    assert!(correction.is_some());
    for correction in [None, correction.as_ref()] {
        let (base, variant, evaluations) = learn(correction, |y| y);
        assert_eq!((base.reliability, base.lives), (variant.reliability, variant.lives));
        assert_eq!(evaluations, 6);
    }
}

#[test]
fn a_known_shift_is_found_with_six_pairs() {
    let (base, variant, evaluations) = &*SHIFTED;
    assert_eq!(*evaluations, 6);
    // R at the sixth checkpoint is the share of the population whose wear, 5 % larger, is below the limit.
    let (scene, settings) = (scene(), settings());
    let population = Population::draw(InputModel::from_scene(&scene), settings.samples, settings.seed);
    let safe = |j: &usize| 1.05 * wear(&scene, &population.physical(*j))[5] < LIMIT;
    let truth = (0..settings.samples).filter(safe).count() as f64 / settings.samples as f64;
    let row = &variant.reliability[5];
    let interval = row.interval_of("total").unwrap();
    assert!((row.reliability["total"] - truth).abs() < 0.01, "{truth} {row:?}");
    assert!(
        interval.lower <= truth && truth <= interval.upper && base.reliability[5].reliability["total"] > 0.4
    );
    // Wear grows in proportion to life, so that lives are shorter by the same factor.
    for (before, after) in
        base.lives.iter().zip(&variant.lives).filter(|(life, _)| life.limit_state == "total")
    {
        let (before, after) = (before.cycles.unwrap(), after.cycles.unwrap());
        assert!((after * 1.05 / before - 1.0).abs() < 2e-3, "{before} {after}");
    }
}

#[test]
fn a_difference_that_scatters_widens_the_interval() {
    let scattered = |y: f64| 1.05 * y * (1.0 + 0.02 * (1e12 * y).sin());
    let (_, rough, evaluations) = learn(None, scattered);
    let width = |summary: &StudySummary| {
        let interval = summary.reliability[5].interval_of("total").unwrap();
        interval.upper - interval.lower
    };
    assert!(
        width(&rough) > 2.0 * width(&SHIFTED.1) && evaluations > 6,
        "{} {}",
        width(&rough),
        width(&SHIFTED.1)
    );
}
