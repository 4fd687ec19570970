//! Wear and time of the quasi-static tier compared with the dynamics, on built-in scenes reduced to their wear outputs:
//! `cargo bench -p worker --bench quasi_static [-- reference]`. With `reference` errors are relative to that preset, which
//! takes half a minute; else to the balanced dynamics.

use common::accuracy::{Accuracy, Tier};
use common::outputs::Evaluation;
use common::scene::{OutputKind, Scene, SceneSource};
use std::time::Instant;
use worker::simulate::{SimulateOptions, simulate};

/// An evaluation and the shortest of `repeats` times it took [s].
fn timed(scene: &Scene, accuracy: &Accuracy, repeats: usize) -> (Evaluation, f64) {
    let run = || {
        let start = Instant::now();
        let found = simulate(scene, accuracy, SimulateOptions::default())
            .expect("the built-in scenes can be simulated");
        (found, start.elapsed().as_secs_f64())
    };
    let (found, first) = run();
    let shortest = (1..repeats).map(|_| run().1).fold(first, f64::min);
    (found, shortest)
}

fn main() {
    let against_reference = std::env::args().any(|a| a == "reference");
    for name in ["four-bar", "flapping-wing"] {
        let mut scene = SceneSource::builtin(name).expect("built in").nominal().clone();
        scene.outputs.retain(|o| matches!(o.kind, OutputKind::LargestWear { .. }));
        scene.limit_states.retain(|l| l.name == "wear");
        let dynamic = Accuracy { tier: Tier::Dynamic, ..Accuracy::balanced() };
        let (balanced, long) = timed(&scene, &dynamic, 5);
        let reference = if against_reference { timed(&scene, &Accuracy::reference(), 1).0 } else { balanced };
        for (label, accuracy) in [("draft", Accuracy::draft()), ("balanced", Accuracy::balanced())] {
            let (found, short) = timed(&scene, &accuracy, 5);
            let pairs = found.histories[0].iter().zip(&reference.histories[0]);
            let off: Vec<f64> = pairs.map(|(a, b)| a / b - 1.0).collect();
            let reported = found.errors[0].last().zip(found.histories[0].last()).map_or(0.0, |(e, h)| e / h);
            println!(
                "{name}, {label}: quasi-static {}, largest wear off by {:+.3} % at the end of life, {:.3} % at \
                 worst ({:.2} % reported); {short:.3} s, {:.1} times faster than the balanced dynamics",
                found.diagnostics.quasi_static,
                100.0 * off.last().copied().unwrap_or(f64::NAN),
                100.0 * off.iter().fold(0.0, |a: f64, b| a.max(b.abs())),
                100.0 * reported,
                long / short,
            );
        }
    }
}
