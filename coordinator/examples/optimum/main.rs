//! Optimisation on problems of known optimum, over several seeds: cost against the truth, simulations, confirmed
//! constraints.
//!
//! ```sh
//! cargo run --release -p coordinator --example optimum
//! cargo run --release -p coordinator --example optimum -- --problem youn-choi --seeds 10
//! cargo run --release -p coordinator --example optimum -- --problem linear --first 101 --seeds 20
//! ```

mod problems;
mod run;

use clap::Parser;
use problems::{NamedProblem, linear, stack, youn_choi};
use run::{Outcome, solve};
use std::error::Error;

/// Optimise problems of known optimum, over several seeds
#[derive(Debug, Parser)]
struct Arguments {
    /// `youn-choi`, `stack` or `linear`, several if repeated [default: all]
    #[arg(long, value_name = "NAME")]
    problem: Vec<String>,
    /// Runs of each problem
    #[arg(long, default_value = "10", value_name = "N")]
    seeds: u64,
    /// First seed; the problems of the family `linear` are drawn from it too
    #[arg(long, default_value = "1", value_name = "N")]
    first: u64,
    /// Simulations in all, those of the first study included
    #[arg(long, default_value = "80", value_name = "N")]
    budget: usize,
    /// Print the report of each run
    #[arg(long)]
    report: bool,
}

fn main() -> Result<(), Box<dyn Error>> {
    let arguments = Arguments::parse();
    let known: [NamedProblem; 3] =
        [("youn-choi", |_| youn_choi()), ("stack", |_| stack()), ("linear", linear)];
    if let Some(unknown) = arguments.problem.iter().find(|name| known.iter().all(|(known, _)| known != name))
    {
        return Err(format!("--problem {unknown}: unknown, allowed: youn-choi, stack, linear").into());
    }
    println!(
        "| problem | runs | confirmed | calls: least, median, most | error of the cost: median, largest | within its 95 % | \
         error of beta at the optimum: largest | time |\n|---|---|---|---|---|---|---|---|"
    );
    for (name, problem) in known {
        if !arguments.problem.is_empty() && !arguments.problem.iter().any(|chosen| chosen == name) {
            continue;
        }
        let mut outcomes = Vec::new();
        for seed in arguments.first..arguments.first + arguments.seeds.max(1) {
            let problem = problem(seed);
            let outcome = solve(&problem, seed, arguments.budget, arguments.report)?;
            eprintln!("{name} seed {seed}: {outcome}");
            outcomes.push(outcome);
        }
        println!("{}", row(name, &outcomes));
    }
    Ok(())
}

/// The runs of a problem as a row of the table.
fn row(name: &str, outcomes: &[Outcome]) -> String {
    let sorted = |of: &dyn Fn(&Outcome) -> f64| {
        let mut values: Vec<f64> = outcomes.iter().map(of).collect();
        values.sort_by(f64::total_cmp);
        values
    };
    let n = outcomes.len();
    let (calls, errors) = (sorted(&|o| o.calls as f64), sorted(&|o| o.error.abs()));
    let (betas, seconds) = (sorted(&|o| o.beta_error.abs()), sorted(&|o| o.seconds));
    let count = |of: &dyn Fn(&&Outcome) -> bool| outcomes.iter().filter(of).count();
    format!(
        "| {name} | {n} | {} | {}, {}, {} | {:.3} %, {:.3} % | {} | {:.4} | {:.1} s |",
        count(&|o| o.confirmed),
        calls[0],
        calls[n / 2],
        calls[n - 1],
        100.0 * errors[n / 2],
        100.0 * errors[n - 1],
        count(&|o| o.within),
        betas[n - 1],
        seconds[n / 2]
    )
}
