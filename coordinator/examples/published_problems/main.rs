//! The learner on published problems of known failure probability, over several seeds: evaluations needed, error of the
//! failure probability in stated standard errors, false stops.
//!
//! ```sh
//! cargo run --release -p coordinator --example published_problems
//! cargo run --release -p coordinator --example published_problems -- --problem four-branch-7 --samples 1000000
//! cargo run --release -p coordinator --example published_problems -- --problem oscillator --learning u --json
//! cargo run --release -p coordinator --example published_problems -- --seeds 3 --without hold
//! ```

mod addition;
mod learn;
mod problems;
mod table;

use addition::Addition;
use clap::Parser;
use coordinator::statistics::learning::LearningFunction;
use coordinator::study::Settings;
use problems::{PublishedProblem, published_problems};
use std::error::Error;
use table::{Row, markdown, row};

/// Learn published problems of known failure probability, over several seeds
#[derive(Debug, Parser)]
struct Arguments {
    /// A problem, several if repeated [default: all]
    #[arg(long, value_name = "NAME")]
    problem: Vec<String>,
    /// Runs of each problem, with seeds 1, 2, ...
    #[arg(long, default_value = "10", value_name = "N")]
    seeds: u64,
    /// Points of the Monte Carlo population at first
    #[arg(long, default_value = "100000", value_name = "N")]
    samples: usize,
    /// Evaluations under way at once
    #[arg(long, default_value = "1", value_name = "N")]
    batch: usize,
    /// Learning function: gain or u
    #[arg(long, default_value_t)]
    learning: LearningFunction,
    /// Half width of the 95 % interval of any R at which learning may stop, e.g. 0.0125 [default: a surrogate error of 0.006]
    #[arg(long, value_name = "SHARE")]
    target_error: Option<f64>,
    /// Addition to the published learning that is left out
    #[arg(long, value_enum)]
    without: Option<Addition>,
    /// Print the rows as JSON instead of Markdown
    #[arg(long)]
    json: bool,
}

fn main() -> Result<(), Box<dyn Error>> {
    let arguments = Arguments::parse();
    let mut rows: Vec<Row> = Vec::new();
    for problem in chosen(&arguments.problem)? {
        let mut runs = Vec::new();
        for seed in 1..=arguments.seeds.max(1) {
            let mut settings = Settings {
                samples: arguments.samples,
                batch: arguments.batch,
                learning: arguments.learning,
                target_error: arguments.target_error,
                seed,
                ..Settings::default()
            };
            let targets = addition::leave_out(arguments.without, &mut settings);
            let run = learn::learn(&problem, settings, targets)?;
            eprintln!(
                "{} seed {seed}: {} calls, Pf {:.4e} +- {:.1e} (reference {:.4e}), {} of {} points misclassified, {:?}, {:.1} s",
                problem.name,
                run.calls,
                run.pf,
                run.standard_error,
                problem.pf,
                run.misclassified,
                run.population,
                run.stop,
                run.seconds
            );
            runs.push(run);
        }
        rows.push(row(&problem, &runs));
    }
    println!("{}", if arguments.json { serde_json::to_string_pretty(&rows)? } else { markdown(&rows) });
    Ok(())
}

/// The problems of these names, or all.
fn chosen(names: &[String]) -> Result<Vec<PublishedProblem>, String> {
    let mut problems = published_problems();
    let known = problems.iter().map(|problem| problem.name).collect::<Vec<_>>().join(", ");
    if let Some(unknown) = names.iter().find(|name| problems.iter().all(|problem| problem.name != **name)) {
        return Err(format!("--problem {unknown}: unknown, allowed: {known}"));
    }
    problems.retain(|problem| names.is_empty() || names.iter().any(|name| name == problem.name));
    Ok(problems)
}
