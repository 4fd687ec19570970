//! Studies with limit states that fail below a threshold and outside of two, against closed forms.
//!
//! One standard normal variable x moves an output y(t) = a + b x + c t over the life t = n / 1000. With c > 0 and both bounds in reach,
//!
//!   R(n) = P(lower < a + b x + c t < upper at the start and at every checkpoint up to n)
//!        = Phi((upper - a - c t) / b) - Phi((lower - a) / b),
//!
//! since y grows: the upper bound counts at the checkpoint itself, the lower one at the start of life.

use super::{Method, Problem, Settings, StudyResult, run};
use crate::farm::evaluate::{Request, local::LocalEvaluator};
use crate::results::journal::InMemoryJournal;
use crate::results::progress::Silent;
use crate::statistics::reliability::REACH;
use common::outputs::Evaluation;
use common::random::standard_normal_cdf;
use common::scene::{Scene, SceneSource};

/// Value without deviation at the start of life, effect of the variable, and growth over 1000 cycles.
const RESPONSE: [f64; 3] = [10.0, 1.0, 1.5];
const LOWER: f64 = 8.0;
const UPPER: f64 = 13.0;

fn scene(limit_states: &str) -> Scene {
    let text = format!(
        "scene = {{ name = \"s\" }}\nsimulator = {{ program = [\"s\"] }}\nlife = {{ cycles = 2000, checkpoint_every = 200 }}\n\
         outputs = [{{ name = \"y\" }}]\nlimit_states = [{limit_states}]\n\
         variables = [{{ name = \"x\", mean = 0, std = 1, distribution = \"normal\" }}]"
    );
    SceneSource::parse(&text, "s").unwrap_or_else(|faults| panic!("{faults}")).nominal().clone()
}

fn value(x: f64, cycles: f64) -> f64 {
    let [a, b, c] = RESPONSE;
    a + b * x + c * cycles / 1000.0
}

/// A study of the formula, with its value at the start and an error of 0.01; `raised` is added to the values at the checkpoints.
fn study(scene: &Scene, method: Method, samples: usize, raised: f64) -> StudyResult {
    let settings = Settings { seed: 5, method, samples, ..Settings::from(scene) };
    let checkpoints = scene.life.checkpoints();
    let simulate = |request: &Request| {
        let history = checkpoints.iter().map(|n| raised + value(request.sample[0], f64::from(*n))).collect();
        let mut evaluation = Evaluation::from_histories(checkpoints.clone(), vec![history]);
        evaluation.start = vec![Some(value(request.sample[0], 0.0))];
        evaluation.errors = vec![vec![0.01; checkpoints.len()]];
        Ok(evaluation)
    };
    let mut evaluator = LocalEvaluator::new(1, simulate);
    run(scene, &settings, &mut evaluator, &mut InMemoryJournal::default(), &mut Silent).unwrap()
}

/// P(y in the bounds from the start to `cycles`); a bound may be infinite.
fn exact(lower: f64, upper: f64, cycles: f64) -> f64 {
    let [a, b, c] = RESPONSE;
    let below = |bound: f64, cycles: f64| {
        if bound.is_infinite() {
            if bound > 0.0 { 1.0 } else { 0.0 }
        } else {
            standard_normal_cdf((bound - a - c * cycles / 1000.0) / b)
        }
    };
    (below(upper, cycles) - below(lower, 0.0)).max(0.0)
}

/// R(n) of a curve within four of its standard errors of the closed form, and lives within their intervals.
fn check(result: &StudyResult, curve: &str, lower: f64, upper: f64) {
    for row in &result.summary.reliability {
        let (r, error) = (row.reliability[curve], row.standard_error[curve]);
        let expected = exact(lower, upper, row.cycles.into());
        assert!(
            (r - expected).abs() < 4.0 * error + 1e-3,
            "{curve} at {}: {r} {error} {expected}",
            row.cycles
        );
    }
    for life in result.summary.lives.iter().filter(|life| life.limit_state == curve) {
        let (low, high) = (life.interval.lower, life.interval.upper.unwrap_or(f64::INFINITY));
        // By bisection; between checkpoints the output grows steadily.
        let (mut a, mut b) = (200.0, 2000.0);
        for _ in 0..60 {
            let middle = 0.5 * (a + b);
            if exact(lower, upper, middle) > life.reliability { a = middle } else { b = middle }
        }
        if exact(lower, upper, 200.0) > life.reliability && exact(lower, upper, 2000.0) < life.reliability {
            let slack = 0.02 * a;
            assert!((low - slack..=high + slack).contains(&a), "{curve}: {a} in {low} to {high}");
        }
    }
}

#[test]
fn a_response_within_two_limits_has_the_reliability_of_both() {
    let both = format!("{{ name = \"range\", output = \"y\", lower = {LOWER}, upper = {UPPER} }}");
    let scene = scene(&both);
    assert_eq!(Problem::from_scene(&scene).modes.len(), 1);
    for method in [Method::ActiveLearning, Method::MonteCarlo] {
        let result = study(&scene, method, 10_000, 0.0);
        check(&result, "range", LOWER, UPPER);
        check(&result, "total", LOWER, UPPER);
        let [limit] = &result.summary.limits[..] else { panic!("one limit state") };
        assert_eq!((limit.threshold, limit.lower, limit.fails.as_str()), (UPPER, Some(LOWER), "outside"));
        // The same as two limit states with a threshold each.
        let by_sides = study(
            &self::scene(&format!(
                "{{ name = \"low\", output = \"y\", threshold = {LOWER}, fails = \"below\" }}, \
                 {{ name = \"high\", output = \"y\", threshold = {UPPER} }}"
            )),
            method,
            10_000,
            0.0,
        );
        check(&by_sides, "low", LOWER, f64::INFINITY);
        check(&by_sides, "high", f64::NEG_INFINITY, UPPER);
        check(&by_sides, "total", LOWER, UPPER);
    }
}

#[test]
fn predictions_and_numerical_errors_of_two_limits_are_distances_from_their_middle() {
    let scene = scene(&format!("{{ name = \"range\", output = \"y\", lower = {LOWER}, upper = {UPPER} }}"));
    let result = study(&scene, Method::ActiveLearning, 10_000, 0.0);
    let [row] = &result.summary.predictions[..] else { panic!("one limit state") };
    assert!(row.simulated.iter().all(|distance| (0.0..20.0).contains(distance)), "{row:?}");
    assert!(row.q2 > 0.95, "{}", row.q2);
    for row in &result.summary.reliability {
        let (range, r) = (row.interval["range"], row.reliability["range"]);
        assert!(range.lower <= r && r <= range.upper, "{row:?}");
        // Errors of 0.01 move each bound by a hundredth of the standard deviation.
        assert!((0.0..0.02 / (2.0 * REACH)).contains(&row.parts["range"].numerical), "{row:?}");
    }
}

#[test]
fn issue_a_limit_exceeded_unworn_was_forgotten_where_the_output_recovers() {
    // Every unit starts below the lower bound, and is above it before the first checkpoint.
    let scene = scene("{ name = \"range\", output = \"y\", lower = 15, upper = 40 }");
    for method in [Method::ActiveLearning, Method::MonteCarlo] {
        let result = study(&scene, method, 2000, 10.0);
        for row in &result.summary.reliability {
            assert!(row.reliability["range"] < 1e-3, "{method:?}: {row:?}");
        }
    }
}

/// P of -h < a k + 0.2 b < h for k of the start of life and of `cycles`, a and b standard normal: the largest distance is at one of
/// the two, since it is convex in k; by the midpoint rule over a.
fn exact_of_growing_swing(h: f64, cycles: f64) -> f64 {
    let ends = [1.0, 1.0 + 0.02 * cycles];
    let steps = 40_000;
    let width = 16.0 / f64::from(steps);
    let piece = |i: i32| {
        let a = -8.0 + (f64::from(i) + 0.5) * width;
        let lower = ends.map(|k| (-h - a * k) / 0.2).into_iter().fold(f64::NEG_INFINITY, f64::max);
        let upper = ends.map(|k| (h - a * k) / 0.2).into_iter().fold(f64::INFINITY, f64::min);
        let within = (standard_normal_cdf(upper) - standard_normal_cdf(lower)).max(0.0);
        common::random::standard_normal_pdf(a) * within * width
    };
    (0..steps).map(piece).sum()
}

#[test]
fn issue_a_budget_that_ended_learning_left_intervals_without_the_truth() {
    // The distance from the middle has a kink in the middle of the population, its two sides have none.
    const LIMIT: f64 = 2.5;
    let text = format!(
        "scene = {{ name = \"s\" }}\nsimulator = {{ program = [\"s\"] }}\nlife = {{ cycles = 10, checkpoint_every = 2 }}\n\
         outputs = [{{ name = \"y\" }}]\n\
         limit_states = [{{ name = \"range\", output = \"y\", lower = -{LIMIT}, upper = {LIMIT} }}]\n\
         variables = [{{ name = \"a\", mean = 0, std = 1, distribution = \"normal\" }},\n\
         {{ name = \"b\", mean = 0, std = 1, distribution = \"normal\" }}]"
    );
    let scene = SceneSource::parse(&text, "s").unwrap_or_else(|faults| panic!("{faults}")).nominal().clone();
    let cycles = scene.life.checkpoints();
    let value = |x: &[f64], n: u32| x[0] * (1.0 + 0.02 * f64::from(n)) + 0.2 * x[1];
    for seed in 1..=2 {
        let settings =
            Settings { seed, samples: 20_000, initial: 12, max_evaluations: 16, ..Settings::from(&scene) };
        let simulate = |request: &Request| {
            let history = cycles.iter().map(|n| value(&request.sample, *n)).collect();
            let mut evaluation = Evaluation::from_histories(cycles.clone(), vec![history]);
            evaluation.start = vec![Some(value(&request.sample, 0))];
            Ok(evaluation)
        };
        let mut evaluator = LocalEvaluator::new(1, simulate);
        let result =
            run(&scene, &settings, &mut evaluator, &mut InMemoryJournal::default(), &mut Silent).unwrap();
        for row in &result.summary.reliability {
            let (r, error) = (row.reliability["range"], row.standard_error["range"]);
            let expected = exact_of_growing_swing(LIMIT, row.cycles.into());
            assert!(
                (r - expected).abs() < 4.0 * error,
                "seed {seed} at {}: {r} {error} {expected}",
                row.cycles
            );
            // Nearly that of the population: the two sides are planes.
            assert!(error < 2e-3, "{row:?}");
        }
        let [row] = &result.summary.predictions[..] else { panic!("one limit state") };
        assert!(row.q2 > 0.999, "{}", row.q2);
    }
}
