//! Longer time steps while they make no difference (`worker/src/simulate/longer_steps.rs`) against steps of the accuracy's own length.

use crate::scenes::{every_joint, short};
use common::accuracy::{Accuracy, Tier};
use common::outputs::Evaluation;
use common::scene::{Scene, SceneSource};
use worker::simulate::{SimulateOptions, simulate};

const WEAR: usize = 0;
const ASYMMETRY: usize = 1;
const LIMITS: [f64; 2] = [30e-6, 25.0 * std::f64::consts::TAU / 60.0];

fn evaluate(scene: &Scene, accuracy: Accuracy) -> Evaluation {
    simulate(scene, &accuracy, SimulateOptions::default()).expect("simulated")
}

/// Largest difference of output `k` over its limit, up to `life` [cycles] [1].
fn difference(a: &Evaluation, b: &Evaluation, k: usize, life: u32) -> f64 {
    let pairs = a.cycles.iter().zip(a.histories[k].iter().zip(&b.histories[k]));
    let within = pairs.filter(|(cycles, _)| **cycles <= life);
    within.fold(0.0, |m: f64, (_, (a, b))| m.max((a - b).abs() / LIMITS[k]))
}

/// Every value of `found` is within its stated error of that of `fine`.
fn assert_within_stated_errors(found: &Evaluation, fine: &Evaluation) {
    for k in [WEAR, ASYMMETRY] {
        for (i, life) in found.cycles.iter().enumerate() {
            let off = (found.histories[k][i] - fine.histories[k][i]).abs();
            assert!(off <= found.errors[k][i], "output {k} at {life}: {off} > {}", found.errors[k][i]);
        }
    }
}

/// Points of the drive that no choice was made with.
fn points() -> [Scene; 2] {
    let source = SceneSource::builtin("flapping-wing").expect("built in");
    [0.31, -0.47].map(|share| {
        let variables = source.variables().iter().zip(source.means()).enumerate();
        let sample = variables.map(|(k, (variable, mean))| {
            let (_, upper) = variable.distribution.limits();
            mean + if k % 2 == 0 { share } else { -share } * (upper - mean)
        });
        source.resolve_sample(&sample.collect::<Vec<_>>()).expect("valid")
    })
}

#[test]
fn early_cycles_of_the_drive_take_longer_steps_and_late_ones_its_own() {
    let own = Accuracy { cycle_jump: 2000, tier: Tier::Dynamic, ..Accuracy::balanced() };
    let [scene, _] = points();
    let found = evaluate(&scene, Accuracy { tier: Tier::Automatic, ..own });
    let (plain, fine) = (evaluate(&scene, own), evaluate(&scene, own.refined(2.0)));
    let share = found.diagnostics.steps as f64 / plain.diagnostics.steps as f64;
    println!("steps {share:.2}");
    // Of the two wings one keeps the longer steps to its end.
    assert!((0.4..0.6).contains(&share), "{share}");
    // With longer steps to the end the asymmetry is off by a tenth of its limit there.
    for (k, life, bound) in [
        (WEAR, 72_000, 1e-3),
        (ASYMMETRY, 48_000, 1e-3),
        (ASYMMETRY, 60_000, 2e-3),
        (ASYMMETRY, 72_000, 1e-2),
    ] {
        let off = difference(&found, &fine, k, life);
        println!("output {k} up to {life}: off by {off:.2e}");
        assert!(off < bound, "output {k} up to {life} cycles: {off}");
    }
    assert_within_stated_errors(&found, &fine);
}

#[test]
fn early_cycles_of_a_draft_take_longer_steps() {
    let own = Accuracy { tier: Tier::Dynamic, ..Accuracy::draft() };
    let [_, scene] = points();
    let found = evaluate(&scene, Accuracy::draft());
    let (plain, fine) = (evaluate(&scene, own), evaluate(&scene, own.refined(2.5)));
    let share = found.diagnostics.steps as f64 / plain.diagnostics.steps as f64;
    println!("steps {share:.2}");
    assert!((0.7..0.85).contains(&share), "{share}");
    for (k, life, bound) in [(WEAR, 72_000, 1e-3), (ASYMMETRY, 48_000, 1e-3), (ASYMMETRY, 60_000, 5e-3)] {
        let off = difference(&found, &fine, k, life);
        println!("output {k} up to {life}: off by {off:.2e}");
        assert!(off < bound, "output {k} up to {life} cycles: {off}");
    }
    assert_within_stated_errors(&found, &fine);
}

#[test]
fn motions_that_do_not_repeat_keep_their_steps() {
    let own = Accuracy { cycle_jump: 50, tier: Tier::Dynamic, ..Accuracy::balanced() };
    let scene = short("slider-crank", &[], 500);
    let (plain, found) = (evaluate(&scene, own), evaluate(&scene, Accuracy { tier: Tier::Automatic, ..own }));
    assert_eq!((found.histories, found.errors), (plain.histories, plain.errors));
}

#[test]
fn a_motion_that_the_steps_decide_keeps_its_own() {
    // Without any damping the vibration of the contacts lasts, and steps twice as long change it.
    let mut scene = short("flapping-wing", &[], 200);
    every_joint(&mut scene, |joint| (joint.friction, joint.film_damping) = (0.0, 1e-3));
    let own = Accuracy { cycle_jump: 100, tier: Tier::Dynamic, ..Accuracy::balanced() };
    let (plain, found) = (evaluate(&scene, own), evaluate(&scene, Accuracy { tier: Tier::Automatic, ..own }));
    assert_eq!(found.histories, plain.histories);
}

#[test]
fn a_probe_whose_steps_alone_make_a_difference_takes_one_cycle_with_finer_ones() {
    let scene = SceneSource::builtin("flapping-wing").expect("built in").nominal().clone();
    let found = evaluate(&scene, Accuracy::draft());
    // One to settle, fourteen lives, longer steps tried and checked, and at the end of life one with finer steps and one with the same.
    assert_eq!(found.diagnostics.simulated_cycles, 1 + 14 + 2 + 2);
    // The finer ones change the asymmetry by more than half a per cent, which counts three times two and a half.
    let last = found.cycles.len() - 1;
    let least = 3.0 * 2.5 * 0.005 * found.histories[ASYMMETRY][last];
    assert!(found.errors[ASYMMETRY][last] > least, "{:?} {least}", found.errors[ASYMMETRY]);
}
