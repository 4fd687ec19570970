//! Error and cost of the time steps of the flapping-wing drive, by the error control and of equal length, compared with steps shorter by
//! 2.5: `cargo bench -p worker --bench steps [-- POINTS]` takes the worst of POINTS random points (default 8), in blocks of 2000 cycles.
//! Errors are relative to the thresholds of the limit states.

mod points;

use common::accuracy::{Accuracy, Tier};
use common::outputs::Evaluation;
use common::scene::{Scene, SceneSource};
use points::{relative_difference, scene_at};
use worker::simulate::{LaneWidth, SimulateOptions, SimulationInput, simulate_side_by_side};

/// Tolerance that no step exceeds: the steps are as long as the largest allowed [1].
const NO_CONTROL: f64 = 1e-2;

/// Evaluations of all `scenes` at this accuracy.
fn run(scenes: &[Scene], accuracy: Accuracy) -> Vec<Evaluation> {
    let mut inputs = scenes.iter().map(|scene| {
        Ok(SimulationInput { scene: scene.clone(), accuracy, options: SimulateOptions::default() })
    });
    let mut found: Vec<(usize, Evaluation)> = vec![];
    simulate_side_by_side(LaneWidth::Widest, 8, &mut || inputs.next(), &mut |number, evaluation, _| {
        found.push((number, evaluation.expect("the drive can be simulated")));
    });
    found.sort_by_key(|(number, _)| *number);
    found.into_iter().map(|(_, evaluation)| evaluation).collect()
}

fn main() {
    let source = SceneSource::builtin("flapping-wing").expect("built in");
    // Cargo passes `--bench` to every benchmark.
    let points: u32 = std::env::args().skip(1).find_map(|argument| argument.parse().ok()).unwrap_or(8);
    let scenes: Vec<Scene> = (1..=points).map(|point| scene_at(&source, point, 0.8)).collect();
    let program = Accuracy { cycle_jump: 2000, ..Accuracy::balanced() };
    // Without longer steps while they make no difference.
    let blocks = Accuracy { tier: Tier::Dynamic, ..program };
    let fine = run(&scenes, blocks.refined(2.5));
    let controlled = [0.8, 1.0, 1.1, 1.25, 1.5, 1.75].map(|factor| {
        let accuracy = blocks.refined(1.0 / factor);
        (format!("by error, longer by {factor}"), accuracy)
    });
    let equal = [12_000, 10_000, 8000, 6000].map(|steps| {
        let largest_step = 1.0 / f64::from(steps);
        (
            format!("{steps} equal ones a cycle"),
            Accuracy { step_tolerance: NO_CONTROL, largest_step, ..blocks },
        )
    });
    println!("| steps | million steps | wear off | gamma off | up to 48 000 cycles |");
    println!("|---|---|---|---|---|");
    let program = ("longer by 1.75 while this makes no difference".to_owned(), program);
    for (name, accuracy) in controlled.into_iter().chain(equal).chain([program]) {
        let found = run(&scenes, accuracy);
        let worst = |k: usize, until: u32| {
            let pairs = scenes.iter().zip(found.iter().zip(&fine));
            pairs.fold(0.0, |m: f64, (scene, (a, b))| m.max(relative_difference(scene, a, b, k, until)))
        };
        let steps: u64 = found.iter().map(|evaluation| evaluation.diagnostics.steps).sum();
        println!(
            "| {name} | {:.2} | {:.3} % | {:.2} % | {:.3} % |",
            steps as f64 / (f64::from(points) * 1e6),
            100.0 * worst(0, u32::MAX),
            100.0 * worst(1, u32::MAX),
            100.0 * worst(1, 48_000),
        );
    }
}
