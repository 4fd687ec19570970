//! Fixed and chosen lengths of the wear blocks of the flapping-wing drive, against blocks of 250 cycles at the same
//! time steps: `cargo run --release -p worker --example blocks [-- POINTS]`, POINTS random points beside the nominal one
//! (none unless given). Errors are relative to the thresholds of the limit states.

use common::accuracy::Accuracy;
use common::outputs::Evaluation;
use common::scene::{Scene, SceneSource};
use worker::simulate::simulate;

/// Largest difference of an output over all checkpoints, relative to its threshold.
fn off(scene: &Scene, a: &Evaluation, b: &Evaluation, k: usize) -> f64 {
    let threshold = scene.limit_states.iter().find(|l| l.output == k).map_or(1.0, |l| l.threshold);
    let pairs = a.histories[k].iter().zip(&b.histories[k]);
    pairs.fold(0.0, |m: f64, (x, y)| m.max((x - y).abs() / threshold))
}

fn main() {
    let source = SceneSource::builtin("flapping-wing").expect("built in");
    let points: u32 = std::env::args().nth(1).map_or(0, |n| n.parse().expect("a number of points"));
    // Each variable at its own multiple of the golden ratio between three tenths and seven tenths of its range.
    let sample = |point: u32| -> Vec<f64> {
        let shift = |k: usize| (f64::from(point) * 0.754_877 + k as f64 * 0.618_034).fract() - 0.5;
        let of = source.variables().iter().zip(source.means()).enumerate();
        of.map(|(k, (v, mean))| {
            let (_, upper) = v.distribution.limits();
            mean + 0.8 * shift(k) * (upper - mean)
        })
        .collect()
    };
    let balanced = Accuracy::balanced();
    let fixed = [500, 1000, 2000, 4000, 8000].map(|cycle_jump| Accuracy { cycle_jump, ..balanced });
    let chosen = [1e-2, 3e-3, 1e-3, 3e-4].map(|jump_tolerance| Accuracy {
        cycle_jump: 8000,
        jump_tolerance,
        ..balanced
    });
    println!("| point | largest jump | tolerance | cycles | steps | wear stages | wear off | gamma off |");
    println!("|---|---|---|---|---|---|---|---|");
    for point in 0..=points {
        let at = if point == 0 { source.means() } else { sample(point) };
        let scene = source.resolve_sample(&at).expect("within the bounds of the variables");
        let run = |accuracy: &Accuracy| simulate(&scene, accuracy, false).expect("simulated");
        let fine = run(&Accuracy { cycle_jump: 250, ..balanced });
        for accuracy in fixed.iter().chain(&chosen) {
            let found = run(accuracy);
            println!(
                "| {point} | {} | {} | {} | {} | {} | {:.3} % | {:.2} % |",
                accuracy.cycle_jump,
                accuracy.jump_tolerance,
                found.diagnostics.simulated_cycles,
                found.diagnostics.steps,
                found.diagnostics.wear_stages,
                100.0 * off(&scene, &found, &fine, 0),
                100.0 * off(&scene, &found, &fine, 1),
            );
        }
    }
}
