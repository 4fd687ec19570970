//! Error and cost of the length of the wear blocks of the flapping-wing drive, compared with blocks of 250 cycles at the same
//! time steps: `cargo bench -p worker --bench blocks [-- POINTS]` adds POINTS random points to the nominal one (default 0).
//! Errors are relative to the thresholds of the limit states.

mod points;

use common::accuracy::Accuracy;
use common::scene::SceneSource;
use points::{relative_difference, scene_at};
use worker::simulate::{SimulateOptions, simulate};

fn main() {
    let source = SceneSource::builtin("flapping-wing").expect("built in");
    // Cargo passes `--bench` to every benchmark.
    let points: u32 = std::env::args().skip(1).find_map(|argument| argument.parse().ok()).unwrap_or(0);
    let balanced = Accuracy::balanced();
    let lengths = [500, 1000, 2000, 4000, 8000].map(|cycle_jump| Accuracy { cycle_jump, ..balanced });
    println!("| point | block length | cycles | steps | wear stages | wear off | gamma off |");
    println!("|---|---|---|---|---|---|---|");
    for point in 0..=points {
        let scene = scene_at(&source, point, 0.4);
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
                100.0 * relative_difference(&scene, &found, &fine, 0, u32::MAX),
                100.0 * relative_difference(&scene, &found, &fine, 1, u32::MAX),
            );
        }
    }
}
