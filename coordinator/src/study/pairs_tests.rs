//! Studies whose finer levels are analytic: what the corrected R(n) is, and what its interval contains.

use super::finer_levels::FinerLevels;
use super::{Settings, StudyResult, run};
use crate::farm::evaluate::Request;
use crate::farm::evaluate::local::LocalEvaluator;
use crate::results::journal::InMemoryJournal;
use crate::results::progress::Silent;
use crate::statistics::design::{InputModel, Population};
use common::outputs::Evaluation;
use common::scene::{Scene, SceneSource};

/// Threshold of the scene [m].
const LIMIT: f64 = 8e-6;

/// Exact wear at the checkpoints `(8,)` [m], with R near 1/2 at the sixth.
fn exact(scene: &Scene, sample: &[f64]) -> Vec<f64> {
    let z = InputModel::from_scene(scene).standardise(sample);
    let u = |k: usize| z[k];
    let scale = 1.0 + 0.04 * u(0) + 0.02 * u(1) + 0.01 * u(2) * u(3);
    (1..=8).map(|n| LIMIT * f64::from(n) / 6.0 * scale).collect()
}

/// A number from -1 to 1 that differs from sample to sample, and from level to level.
fn noise(level: u8, sample: &[f64]) -> f64 {
    (1e9 * sample.iter().sum::<f64>() + f64::from(level)).sin()
}

/// Study of the four-bar whose simulations at level k have wear that differs by `error(k, sample, wear)` from the exact one.
fn study(
    settings: &Settings,
    threads: usize,
    error: impl Fn(u8, &[f64], f64) -> f64 + Sync,
) -> (StudyResult, usize) {
    let source = SceneSource::builtin("four-bar").unwrap();
    let scene = source.nominal();
    let evaluate = |request: &Request| {
        let wear = exact(scene, &request.sample).into_iter();
        let wear: Vec<f64> = wear.map(|y| y + error(request.level, &request.sample, y)).collect();
        Ok(Evaluation::from_histories((1..=8).map(|n| 1000 * n).collect(), vec![wear.clone(), wear]))
    };
    let mut journal = InMemoryJournal::default();
    let mut evaluator = LocalEvaluator::new(threads, evaluate);
    let result = run(scene, settings, &mut evaluator, &mut journal, &mut Silent).unwrap();
    (result, journal.outcomes().len())
}

fn settings() -> Settings {
    let source = SceneSource::builtin("four-bar").unwrap();
    Settings { samples: 6000, initial: 20, max_evaluations: 60, seed: 3, ..Settings::from(source.nominal()) }
}

/// R at the sixth checkpoint, its interval and its numerical part, and the exact R of the same population.
fn at_the_fall(settings: &Settings, result: &StudyResult) -> (f64, [f64; 2], f64, f64) {
    let source = SceneSource::builtin("four-bar").unwrap();
    let scene = source.nominal();
    let population = Population::draw(InputModel::from_scene(scene), settings.samples, settings.seed);
    let safe = (0..settings.samples).filter(|j| exact(scene, &population.physical(*j))[5] < LIMIT).count();
    let row = &result.summary.reliability[5];
    let interval = row.interval_of("total").unwrap();
    let truth = safe as f64 / settings.samples as f64;
    (row.reliability["total"], [interval.lower, interval.upper], row.parts["total"].numerical, truth)
}

#[test]
fn levels_that_converge_correct_the_results() {
    let settings = settings();
    // Errors of 3.2 %, 0.8 % and 0.2 % of the value, of second order.
    let error = |level: u8, _: &[f64], y: f64| -0.032 * y / 4f64.powi(level.into());
    let (corrected, evaluations) = study(&settings, 2, error);
    let (r, [lower, upper], numerical, truth) = at_the_fall(&settings, &corrected);
    assert!((r - truth).abs() < 0.01 && lower < truth && truth < upper, "{r} {truth} [{lower}, {upper}]");
    assert!(numerical > 0.0 && upper - lower < 0.06, "{numerical} [{lower}, {upper}]");
    let levels = corrected.summary.levels.as_ref().unwrap();
    let row = &levels.differences[0];
    assert_eq!((levels.pairs, levels.evaluations), ([6, 5], 11));
    assert_eq!((corrected.summary.evaluations.total, row.form.as_str()), (evaluations, "line"));
    assert!(
        (row.order.unwrap() - 2.0).abs() < 1e-6 && (row.correction / 0.032 - 1.0).abs() < 0.05,
        "{row:?}"
    );
    // The same bits with another number of workers.
    let (again, _) = study(&settings, 1, error);
    assert_eq!(again.summary.reliability, corrected.summary.reliability);
    // Without finer levels R is off by what the interval, which knows of no error, leaves out.
    let (alone, _) = study(&Settings { levels: FinerLevels::None, ..settings.clone() }, 2, error);
    let (r, [_, upper], numerical, _) = at_the_fall(&settings, &alone);
    assert!(upper < r + 0.05 && r - truth > 0.15 && numerical == 0.0 && alone.summary.levels.is_none());
}

#[test]
fn levels_that_disagree_widen_the_interval() {
    let settings = settings();
    // The finer levels have an error of their own from sample to sample, and do not converge.
    let error = |level: u8, sample: &[f64], y: f64| {
        if level == 0 { 0.0 } else { 0.03 * y * noise(level, sample) }
    };
    let (found, _) = study(&settings, 2, error);
    let (r, [lower, upper], numerical, truth) = at_the_fall(&settings, &found);
    assert!(lower < truth && truth < upper, "{r} {truth} [{lower}, {upper}]");
    assert!(upper - lower > 0.1 && numerical > 0.02, "{numerical} [{lower}, {upper}]");
    assert!(found.summary.levels.unwrap().differences[0].rough > 0.01);
}

#[test]
fn pairs_follow_until_the_interval_of_the_system_is_narrow() {
    let settings = Settings { samples: 40_000, initial: 40, ..settings() };
    // The finer levels differ by up to 0.4 % from the working accuracy, from sample to sample, which six pairs do not know well enough,
    // and not from each other.
    let error = |level: u8, sample: &[f64], y: f64| match level {
        0 => 0.0,
        _ => 0.004 * y * noise(1, sample),
    };
    let (narrow, _) = study(&settings, 2, error);
    let (wide, _) = study(&Settings { target_error: Some(0.05), ..settings.clone() }, 2, error);
    let pairs = |result: &StudyResult| result.summary.levels.as_ref().unwrap().pairs;
    // Without the end by the interval there would be 18, as many as the cost permits; a wider one needs the first six alone.
    assert_eq!((pairs(&narrow), pairs(&wide)), ([15, 3], [6, 3]));
}

#[test]
fn an_exact_finest_level_that_differs_by_a_function_of_the_variables_is_followed() {
    let text = "scene = { name = \"levels\" }\n\
        simulator = { program = [\"closure\"], levels = [\"coarse\", \"fine\"], finest_is_exact = true }\n\
        life = { cycles = 400, checkpoint_every = 100 }\n\
        outputs = [{ name = \"y\", unit = \"\" }]\n\
        limit_states = [{ name = \"limit\", output = \"y\", threshold = 6.0 }]\n\
        variables = [{ name = \"a\", mean = 0.0, std = 1.0 }, { name = \"b\", mean = 0.0, std = 1.0 }]";
    let source = SceneSource::parse(text, "levels").unwrap();
    let scene = source.nominal();
    let last = |level: u8, x: &[f64]| {
        let exact = 6.0 + x[0] + 0.5 * x[1];
        exact + if level == 0 { 0.5 + 0.8 * (1.3 * x[0] - x[1]).sin() } else { 0.0 }
    };
    let evaluate = |request: &Request| {
        let y = last(request.level, &request.sample);
        let history = (1..=4).map(|n| y - 0.5 * f64::from(4 - n)).collect();
        Ok(Evaluation::from_histories((1..=4).map(|n| 100 * n).collect(), vec![history]))
    };
    let settings = Settings { samples: 6000, seed: 3, ..Settings::from(scene) };
    let mut evaluator = LocalEvaluator::new(2, evaluate);
    let found =
        run(scene, &settings, &mut evaluator, &mut InMemoryJournal::default(), &mut Silent).unwrap().summary;
    let interval = found.reliability[3].interval_of("total").unwrap();
    assert_eq!(found.levels.as_ref().unwrap().differences[0].form, "kriging");
    assert!(interval.lower < 0.5 && 0.5 < interval.upper, "{interval:?}");
    assert!(interval.upper - interval.lower < 0.2, "{interval:?}");
}
