//! Error and cost of the length of the wear blocks of the flapping-wing drive, compared with blocks of 250 cycles at the same
//! time steps: `cargo bench -p worker --bench blocks [-- POINTS]` adds POINTS random points to the nominal one (default 0).
//! Errors are relative to the thresholds of the limit states.

use common::accuracy::Accuracy;
use common::outputs::Evaluation;
use common::scene::{Scene, SceneSource};
use worker::simulate::{SimulateOptions, simulate};

/// Largest difference of output `k` over all checkpoints, relative to its threshold [1].
fn relative_difference(scene: &Scene, a: &Evaluation, b: &Evaluation, k: usize) -> f64 {
    let threshold = scene.limit_states.iter().find(|l| l.output == k).map_or(1.0, |l| l.threshold);
    let pairs = a.histories[k].iter().zip(&b.histories[k]);
    pairs.fold(0.0, |m: f64, (x, y)| m.max((x - y).abs() / threshold))
}

fn main() {
    let source = SceneSource::builtin("flapping-wing").expect("built in");
    // Cargo passes `--bench` to every benchmark.
    let points: u32 = std::env::args().skip(1).find_map(|argument| argument.parse().ok()).unwrap_or(0);
    // Each variable at its own multiple of the golden ratio between three tenths and seven tenths of its range.
    let sample = |point: u32| -> Vec<f64> {
        let shift = |k: usize| (f64::from(point) * 0.754_877 + k as f64 * 0.618_034).fract() - 0.5;
        let variables = source.variables().iter().zip(source.means()).enumerate();
        variables
            .map(|(k, (variable, mean))| {
                let (_, upper) = variable.distribution.limits();
                mean + 0.8 * shift(k) * (upper - mean)
            })
            .collect()
    };
    let balanced = Accuracy::balanced();
    let lengths = [500, 1000, 2000, 4000, 8000].map(|cycle_jump| Accuracy { cycle_jump, ..balanced });
    println!("| point | block length | cycles | steps | wear stages | wear off | gamma off |");
    println!("|---|---|---|---|---|---|---|");
    for point in 0..=points {
        let at = if point == 0 { source.means() } else { sample(point) };
        let scene = source.resolve_sample(&at).expect("within the bounds of the variables");
        let run =
            |accuracy: &Accuracy| simulate(&scene, accuracy, SimulateOptions::default()).expect("simulated");
        let fine = run(&Accuracy { cycle_jump: 250, ..balanced });
        for accuracy in &lengths {
            let found = run(accuracy);
            println!(
                "| {point} | {} | {} | {} | {} | {:.3} % | {:.2} % |",
                accuracy.cycle_jump,
                found.diagnostics.simulated_cycles,
                found.diagnostics.steps,
                found.diagnostics.wear_stages,
                100.0 * relative_difference(&scene, &found, &fine, 0),
                100.0 * relative_difference(&scene, &found, &fine, 1),
            );
        }
    }
}
