//! Every built-in scene and twelve others, moved, turned, mirrored, and in other sizes: the same results.

use crate::scenes::{scene, shared};
use crate::transformed::Transform;
use common::accuracy::Accuracy;
use common::outputs::Evaluation;
use common::scene::{OutputKind, Scene, SceneSource};
use std::f64::consts::FRAC_PI_2;
use worker::simulate::{SimulateOptions, simulate};

/// A mechanism with the relative difference that rounding may make.
struct Case {
    name: String,
    scene: Scene,
    rounding: f64,
}

/// Rounding of a motion that repeats, after steps chosen by error control [1].
const REGULAR: f64 = 1e-6;

fn cases() -> Vec<Case> {
    let names = SceneSource::builtin_names().into_iter().map(|name| (name.to_owned(), scene(name, &[])));
    let others = SHARED.map(|name| (name.to_owned(), shared(name)));
    let shortened = |(name, mut scene): (String, Scene)| {
        scene.life.cycles = scene.life.cycles.min(scene.life.checkpoint_every);
        Case { rounding: REGULAR, name, scene }
    };
    names.chain(others).map(shortened).collect()
}

const SHARED: [&str; 7] = [
    "scotch-yoke",
    "ideal-four-bar",
    "double-pendulum",
    "free-slider-crank",
    "oscillator",
    "rotor",
    "guided-slider-crank",
];

fn run(scene: &Scene) -> Evaluation {
    simulate(scene, &Accuracy::draft(), SimulateOptions::default()).unwrap_or_else(|e| panic!("{}: {e}", scene.name))
}

/// Largest difference of an output after the change from that before, over its value, and over both stated errors.
fn difference(scene: &Scene, change: &Transform, before: &Evaluation, after: &Evaluation) -> (f64, f64) {
    let (mut relative, mut stated) = (0.0_f64, 0.0_f64);
    for (k, output) in scene.outputs.iter().enumerate() {
        let factor = change.of_output(&output.kind);
        for (j, value) in before.histories[k].iter().enumerate() {
            let off = (after.histories[k][j] / factor - value).abs();
            relative = relative.max(off / value.abs());
            stated = stated.max(off / (before.errors[k][j] + after.errors[k][j] / factor));
        }
    }
    (relative, stated)
}

#[test]
fn print_differences() {
    for case in cases() {
        let before = run(&case.scene);
        println!("{}: {:?} steps {}", case.name, before.histories.iter().map(|h| h[0]).collect::<Vec<_>>(), before.diagnostics.steps);
        for by in [[1.0, -7.0], [30.0, 0.0], [1000.0, 0.0]] {
            let after = run(&case.scene.moved(by));
            println!("   {by:?} {:?}", difference(&case.scene, &Transform::NONE, &before, &after));
        }
        let changes = [
            Transform { turn: 0.7, ..Transform::NONE },
            Transform { turn: FRAC_PI_2, ..Transform::NONE },
            Transform { mirrored: true, ..Transform::NONE },
            Transform { scale: 1e-3, ..Transform::NONE },
            Transform { scale: 1e3, ..Transform::NONE },
        ];
        for change in changes {
            let differs = |o: &common::scene::Output| matches!(o.kind, OutputKind::AngleDifference { .. });
            if change.turn != 0.0 && case.scene.outputs.iter().any(differs) {
                continue;
            }
            let after = run(&change.of(case.scene.clone()));
            println!("   {change:?} {:?}", difference(&case.scene, &change, &before, &after));
        }
    }
}
