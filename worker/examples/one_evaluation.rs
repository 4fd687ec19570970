//! One evaluation of a built-in scene: `cargo run --release -p worker --example one_evaluation`.
//!
//! A `SceneSource` is a checked scene file with its random variables; a `Scene` is one sample of it. `simulate` wears a scene
//! through its life and returns every output at every checkpoint, each with an estimate of its numerical error.

use common::accuracy::Accuracy;
use common::scene::SceneSource;
use worker::simulate::{SimulateOptions, simulate};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let source = SceneSource::builtin("four-bar")?;
    // The means of the random variables, with one of them changed; values are in SI units.
    let mut sample = source.means();
    println!("{}: {} -> {}", source.variables()[0].name, sample[0], 1.01 * sample[0]);
    sample[0] *= 1.01;
    let mut scene = source.resolve_sample(&sample)?;
    scene.life.cycles = 3000;

    let evaluation = simulate(&scene, &Accuracy::draft(), SimulateOptions::default())?;
    for (k, output) in scene.outputs.iter().enumerate() {
        let unit = scene.unit_of(output);
        for (i, cycles) in evaluation.cycles.iter().enumerate() {
            let value = unit.to_shown(evaluation.histories[k][i]);
            let error = unit.to_shown(evaluation.errors[k][i]);
            println!("{} after {cycles} cycles: {value:.4} +- {error:.4} {}", output.name, unit.symbol());
        }
    }
    let work = &evaluation.diagnostics;
    println!("{} time steps in {} simulated cycles", work.steps, work.simulated_cycles);
    Ok(())
}
