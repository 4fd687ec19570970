//! Evaluations at the limits of the model: a scene with each quantity at an extreme under every contact law, compared with a run at
//! half the time step. Prints a table in Markdown; the exit code is 1 if a case is not sound.
//!
//! A case is sound if the two runs agree within the error that the first one states, or if the evaluation fails with a
//! reason. Any other case is a disagreement: the stated error is too small.
//!
//! ```sh
//! cargo run --release -p worker --example extremes -- four-bar
//! cargo run --release -p worker --example extremes -- flapping-wing --accuracy draft
//! ```

mod cases;
mod outcome;

use cases::cases;
use clap::Parser;
use common::accuracy::NamedAccuracy;
use common::scene::{Scene, SceneSource};
use outcome::{Outcome, Row, run_all};
use std::process::ExitCode;

/// Compare extreme cases of a mechanism with runs at half the time step
#[derive(Debug, Parser)]
struct Arguments {
    /// Scene file, or name of a built-in scene
    #[arg(default_value = "flapping-wing")]
    scene: String,
    /// Accuracy of the runs, as for `coordinator run`
    #[arg(long, default_value = "balanced")]
    accuracy: NamedAccuracy,
}

fn main() -> ExitCode {
    let arguments = Arguments::parse();
    let source = match SceneSource::load(&arguments.scene) {
        Ok(source) => source,
        Err(faults) => {
            eprint!("{}", faults.explained());
            return ExitCode::from(2);
        }
    };
    let scene = source.nominal();
    let cases = cases(scene, &arguments.accuracy.accuracy);
    let threads = std::thread::available_parallelism().map_or(1, usize::from);
    let rows =
        run_all(&cases, threads, |row| eprintln!("{}, {}: {}", row.case, row.law.word(), verdict(row)));
    println!(
        "| case | contact law | outcome | output | cycles | value | stated error | difference | steps | at half |"
    );
    println!("|---|---|---|---|---|---|---|---|---|---|");
    rows.iter().for_each(|row| print(scene, row));
    let is_sound = rows.iter().all(|row| row.outcome.is_sound());
    if is_sound { ExitCode::SUCCESS } else { ExitCode::FAILURE }
}

fn verdict(row: &Row) -> &'static str {
    match row.outcome {
        Outcome::Agrees => "agrees",
        Outcome::Refused(_) => "refused",
        Outcome::Disagrees => "DISAGREES",
        Outcome::Unconfirmed(_) => "UNCONFIRMED",
    }
}

/// Prints a failure, and a line per output at the checkpoint where the two runs differ most.
fn print(scene: &Scene, row: &Row) {
    let head = format!("| {} | {} | {} |", row.case, row.law.word(), verdict(row));
    let steps = format!("| {} | {} |", row.steps, row.steps_of_half);
    if let Outcome::Refused(failure) | Outcome::Unconfirmed(failure) = &row.outcome {
        println!("{head} {failure} | | | | {steps}");
    }
    for compared in &row.compared {
        let output = &scene.outputs[compared.output];
        let unit = scene.unit_of(output);
        let [value, stated, difference] =
            [compared.value, compared.error, compared.difference].map(|si| unit.to_shown(si));
        let (name, cycles) = (&output.name, compared.cycles);
        println!(
            "{head} {name} | {cycles} | {value:.4} {} | {stated:.1e} | {difference:.1e} {steps}",
            unit.symbol()
        );
    }
}
