//! Every built-in scene and twelve others, moved, turned, mirrored and in other sizes: the same results.

use crate::scenes::{every_joint, scene, shared};
use crate::transformed::Transform;
use common::accuracy::Accuracy;
use common::outputs::Evaluation;
use common::scene::{
    ContactLaw, IdealFriction, JointKind, OutputKind, Scene, SceneSource, WearDistribution, WearingSurfaces,
};
use std::sync::LazyLock;
use worker::simulate::{SimulateOptions, simulate};

/// Scenes of the folder that tests share.
const SHARED: [&str; 7] = [
    "scotch-yoke",
    "ideal-four-bar",
    "double-pendulum",
    "free-slider-crank",
    "oscillator",
    "rotor",
    "guided-slider-crank",
];

/// Built-in scenes whose motion does not repeat itself: rounding grows until it changes every digit.
const IRREGULAR: [&str; 3] = ["slider-crank", "guided-slider-crank", "flapping-wing-experiment"];

struct Case {
    name: String,
    scene: Scene,
    result: Evaluation,
}

/// The scenes with their results.
static CASES: LazyLock<Vec<Case>> = LazyLock::new(|| {
    let names = SceneSource::builtin_names().into_iter().map(|name| (name.to_owned(), scene(name, &[])));
    let cases = names.chain(SHARED.map(|name| (name.to_owned(), shared(name)))).chain(variants());
    let shortened = |(name, mut scene): (String, Scene)| {
        scene.life.cycles = scene.life.cycles.min(scene.life.checkpoint_every);
        let result = run(&scene);
        Case { name, scene, result }
    };
    let mut first: Vec<(String, Scene)> = cases.collect();
    let second = first.split_off(first.len() / 2);
    let run_all = |part: Vec<(String, Scene)>| part.into_iter().map(shortened).collect::<Vec<Case>>();
    // All tests here wait for these: on two processors.
    std::thread::scope(|scope| {
        let beside = scope.spawn(|| run_all(second));
        let mut all = run_all(first);
        all.extend(beside.join().expect("every scene is simulated"));
        all
    })
});

/// Five more, of other laws and joints.
fn variants() -> Vec<(String, Scene)> {
    let parsed = |text: &str| SceneSource::parse(text, "variant").expect("valid").nominal().clone();
    let press = parsed(&include_str!("../../../coordinator/src/cli/init.toml").replace("@name@", "press"));
    let repeating = parsed(include_str!("../../benches/lsoda/slider-crank.toml"));
    let mut foundation = scene("four-bar", &[]);
    every_joint(&mut foundation, |hinge| {
        (hinge.contact_law, hinge.wears) = (ContactLaw::Foundation, WearingSurfaces::Both);
    });
    let mut one_hinge = scene("four-bar", &[]);
    for joint in &mut one_hinge.joints[1..] {
        joint.kind = JointKind::Revolute;
    }
    let mut rubbing = shared("scotch-yoke");
    for joint in rubbing.joints.iter_mut().filter(|joint| joint.name == "guide") {
        joint.friction = Some(IdealFriction { coefficient: 0.1, speed: 0.01, size: 0.1 });
    }
    let named = |name: &str, scene: Scene| (name.to_owned(), scene);
    vec![
        named("press", press),
        named("repeating slider-crank", repeating),
        named("foundation", foundation),
        named("one hinge", one_hinge),
        named("rubbing yoke", rubbing),
    ]
}

fn run(scene: &Scene) -> Evaluation {
    let result = simulate(scene, &Accuracy::draft(), SimulateOptions::default());
    result.unwrap_or_else(|failure| panic!("{}: {failure}", scene.name))
}

/// Differences of a result after a change from that before: the largest over the values themselves, and over both stated errors.
fn difference(case: &Case, change: &Transform, after: &Evaluation) -> (f64, f64) {
    let (mut relative, mut stated) = (0.0_f64, 0.0_f64);
    for (k, output) in case.scene.outputs.iter().enumerate() {
        let factor = change.of_output(&output.kind);
        for (j, value) in case.result.histories[k].iter().enumerate() {
            let off = (after.histories[k][j] / factor - value).abs();
            relative = relative.max(off / value.abs());
            stated = stated.max(off / (case.result.errors[k][j] + after.errors[k][j] / factor));
        }
    }
    (relative, stated)
}

/// Checks that `change` changes the results of regular motions by no more than `rounding`, and of others by no more than twice the stated errors.
fn check(case: &Case, what: &str, change: &Transform, changed: &Scene, rounding: f64) {
    let after = run(changed);
    // A control point that enters the arc by rounding has its whole share at once.
    let jumps = case.scene.wear.distribution == WearDistribution::PointsInside;
    let rounding = if jumps { rounding.max(1e-4) } else { rounding };
    let (relative, stated) = difference(case, change, &after);
    println!("{}, {what}: {relative:.1e}, of the stated errors {stated:.1e}", case.name);
    if std::env::var("PRINT").is_err() {
        let same = relative <= rounding || IRREGULAR.contains(&&*case.name) && stated <= 2.0;
        assert!(same, "{}, {what}: {relative:e}, of the stated errors {stated:e}", case.name);
    }
}

#[test]
fn issue_results_depended_on_the_place_of_the_mechanism() {
    for case in CASES.iter() {
        check(case, "moved by 1000 m", &Transform::NONE, &case.scene.moved([1000.0, 0.0]), 1e-6);
    }
}

#[test]
fn issue_results_depended_on_the_direction_of_the_mechanism() {
    for case in CASES.iter() {
        // A difference of angles of bodies that turn in opposite senses is from the axes, and so are wanted coordinates.
        let is_from_axes = |kind: &OutputKind| match kind {
            OutputKind::AngleDifference { .. } => true,
            OutputKind::PositionError { wanted, .. } => wanted.iter().any(Option::is_some),
            _ => false,
        };
        if !case.scene.outputs.iter().any(|output| is_from_axes(&output.kind)) {
            let change = Transform { turn: 0.7, ..Transform::NONE };
            check(case, "turned", &change, &change.of(case.scene.clone()), 1e-3);
        }
        let change = Transform { mirrored: true, ..Transform::NONE };
        check(case, "mirrored", &change, &change.of(case.scene.clone()), 1e-5);
    }
}

#[test]
fn issue_results_depended_on_the_unit_of_length() {
    for (k, case) in CASES.iter().enumerate() {
        // The wear steps of `foundation` probe the stiffness of a surface by 1e-8 m, many times the penetrations of so small a bore, and
        // then end by name.
        let scale = if k % 2 == 0 || case.name == "foundation" { 1e3 } else { 1e-3 };
        let change = Transform { scale, ..Transform::NONE };
        check(case, &format!("scaled by {scale}"), &change, &change.of(case.scene.clone()), 1e-5);
    }
}
