//! The ladder climbed with made-up errors of known order.

use super::*;
use crate::farm::evaluate::local::LocalEvaluator;
use crate::statistics::design::nominal_and_random;
use common::scene::SceneSource;
use std::sync::Mutex;

fn scene() -> Scene {
    SceneSource::builtin("flapping-wing").expect("built in").nominal().clone()
}

/// An evaluation of `scene` whose first output has these values and errors, over its threshold; the other is exact.
fn evaluation(scene: &Scene, shares: &[(f64, f64)]) -> Evaluation {
    let threshold = scene.limit_states[0].threshold;
    let scaled = |of: fn(&(f64, f64)) -> f64| shares.iter().map(|s| threshold * of(s)).collect::<Vec<f64>>();
    Evaluation {
        cycles: (1..=shares.len() as u32).map(|k| 1000 * k).collect(),
        histories: vec![scaled(|s| s.0), vec![0.0; shares.len()]],
        errors: vec![scaled(|s| s.1), vec![0.0; shares.len()]],
        ..Evaluation::default()
    }
}

/// The setting chosen, all that were tried, and the wear samples of every evaluation.
type Climb = (Result<NamedAccuracy, BudgetError>, Vec<TriedSetting>, Vec<usize>);

/// Climbs with an error that is the sum of a time part of fourth and a wear part of second order, `factor` at
/// `balanced`, and `random` times that off the nominal point; with the names of all that was evaluated.
fn climb(budget: f64, factor: f64, random: f64) -> Climb {
    let scene = scene();
    let points = nominal_and_random(&scene, scene.study.seed, RANDOM_POINTS);
    let balanced = Accuracy::balanced();
    let seen = Mutex::new(Vec::new());
    let simulate = |request: &Request| {
        let a = request.accuracy.expect("every attempt says how");
        seen.lock().expect("no panic").push(a.wear_samples);
        let time = a.step_tolerance / balanced.step_tolerance;
        let wear = (f64::from(a.cycle_jump) / f64::from(balanced.cycle_jump)).powi(2);
        let off_nominal = if request.sample == points[0] { 1.0 } else { random };
        Ok(evaluation(&scene, &[(0.5, 0.0), (0.9, factor * off_nominal * (0.8 * time + 0.2 * wear))]))
    };
    let mut evaluator = LocalEvaluator::new(2, simulate);
    let mut attempts = Vec::new();
    let mut tried = |attempt: &TriedSetting| attempts.push(attempt.clone());
    let found = choose_setting(&scene, budget, &LADDER, &points, &mut evaluator, &mut tried);
    drop(evaluator);
    (found, attempts, seen.into_inner().expect("no panic"))
}

fn chosen(budget: f64, factor: f64) -> Accuracy {
    climb(budget, factor, 1.0).0.expect("within reach").accuracy
}

#[test]
fn a_looser_budget_is_met_by_a_cheaper_setting() {
    assert_eq!(chosen(0.01, 0.0099), Accuracy::balanced());
    let (loose, tight) = (chosen(0.05, 0.01), chosen(0.001, 0.01));
    assert!(loose.step_tolerance > Accuracy::balanced().step_tolerance);
    assert!(tight.step_tolerance < Accuracy::balanced().step_tolerance);
    assert_eq!(chosen(1.0, 0.01), LADDER[0].parse::<NamedAccuracy>().expect("a setting").accuracy);
}

#[test]
fn what_was_tried_is_told_and_what_cannot_do_is_passed_over() {
    let (found, attempts, evaluated) = climb(0.001, 0.01, 1.0);
    let choice = found.expect("within reach");
    let names: Vec<&str> = attempts.iter().map(|a| a.setting.name.as_str()).collect();
    assert_eq!(names.last().copied(), Some(choice.name.as_str()));
    assert!(names.len() < LADDER.iter().position(|rung| *rung == choice.name).expect("a rung") + 1);
    // The made-up error has no part that a warm-up takes away.
    let others = attempts.iter().filter(|a| !a.setting.name.contains("warm-up"));
    let errors: Vec<f64> = others.map(|a| a.worst.as_ref().expect("a result").error).collect();
    assert!(errors.is_sorted_by(|a, b| a > b) && errors[errors.len() - 1] <= 0.001, "{errors:?}");
    // What fails at the nominal point is tried nowhere else.
    assert_eq!(evaluated.len(), names.len() - 1 + 1 + RANDOM_POINTS);
}

#[test]
fn a_random_point_over_the_budget_counts() {
    let alike = climb(0.02, 0.01, 1.0).0.expect("within reach").accuracy;
    let worse = climb(0.02, 0.01, 9.0).0.expect("within reach").accuracy;
    assert!(worse.step_tolerance < alike.step_tolerance);
}

#[test]
fn a_budget_out_of_reach_names_the_output_and_the_best_error() {
    let said = climb(1e-9, 0.01, 1.0).0.expect_err("no setting is that good").to_string();
    for part in ["below 0.0000001 %", "max_wear_depth", "reference"] {
        assert!(said.contains(part), "no {part:?} in {said}");
    }
}

#[test]
fn where_everything_fails_the_failure_is_told() {
    let scene = scene();
    let fail = |_: &Request| Err(SimulationFailure::NotModelled { what: "that".into() });
    let found =
        choose_setting(&scene, 0.01, &LADDER, &[vec![]], &mut LocalEvaluator::new(1, fail), &mut |_| {});
    assert!(matches!(found, Err(BudgetError::Failed(setting, _)) if setting == "reference"));
}

#[test]
fn errors_count_until_the_limit_is_surely_passed() {
    let scene = scene();
    let error = |values: &[(f64, f64)]| {
        let all = shares(&scene, &evaluation(&scene, values));
        assert_eq!((all.len(), all[1].error), (2, 0.0));
        (all[0].error * 1e6).round() / 1e6
    };
    assert_eq!(error(&[(0.5, 0.01), (1.01, 0.005), (1.5, 0.3)]), 0.01);
    assert_eq!(error(&[(0.5, 0.01), (1.01, 0.02), (1.5, 0.3)]), 0.3);
    assert_eq!(error(&[(0.5, 0.01), (0.6, 0.04)]), 0.04);
    // Without limits, relative to the largest value.
    let free = Scene { limit_states: vec![], ..scene.clone() };
    let all = shares(&free, &evaluation(&scene, &[(0.5, 0.01), (2.0, 0.1)]));
    assert!((all[0].error - 0.05).abs() < 1e-12);
}
