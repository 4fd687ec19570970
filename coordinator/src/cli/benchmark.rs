//! `coordinator benchmark`: published problems of known failure probability.

use super::arguments::{Talk, positive};
use super::error::CommandError;
use super::names::LearningName;
use super::options::{learning_function, targets};
use super::output::{check_destination, deliver, to_json};
use clap::Args;
use coordinator::analyses::benchmark::{PublishedProblem, Row, markdown, published_problems, row, run};
use std::path::PathBuf;

/// Published problems.
#[derive(Debug, Clone, Args)]
pub struct BenchmarkArguments {
    /// A problem, several if repeated [default: all]
    #[arg(long, value_name = "NAME")]
    pub problem: Vec<String>,
    /// Runs of each, with seeds 1, 2, ...
    #[arg(long, default_value = "10", value_name = "N", value_parser = positive)]
    pub seeds: usize,
    /// Points of the Monte Carlo population to begin with
    #[arg(long, default_value = "100000", value_name = "N", value_parser = positive)]
    pub samples: usize,
    /// Evaluations under way at once
    #[arg(long, default_value = "1", value_name = "N", value_parser = positive)]
    pub batch: usize,
    /// Which points are evaluated next [default: gain]
    #[arg(long, value_enum)]
    pub learning: Option<LearningName>,
    /// Surrogate error of any R at which learning may stop [default: 0.006, and 2 % of P_f; both follow]
    #[arg(long, value_name = "SHARE", value_parser = super::accuracy::share)]
    pub target_error: Option<f64>,
    /// Write the table to this file instead of standard output
    #[arg(long, value_name = "FILE")]
    pub out: Option<PathBuf>,
}

/// Runs the command.
pub fn benchmark(arguments: &BenchmarkArguments, talk: Talk) -> Result<(), CommandError> {
    check_destination(arguments.out.as_deref())?;
    let problems = chosen(&arguments.problem)?;
    let how = (learning_function(arguments.learning.unwrap_or_default()), targets(arguments.target_error));
    let mut rows: Vec<Row> = Vec::new();
    for problem in &problems {
        let mut runs = Vec::new();
        for seed in 1..=arguments.seeds as u64 {
            let found = run(problem, (arguments.samples, arguments.batch), how, seed)
                .map_err(|error| CommandError::Benchmark { problem: problem.name, seed, error })?;
            if !talk.quiet {
                eprintln!(
                    "{} seed {seed}: {} calls, Pf {:.4e} +- {:.1e} (reference {:.4e}), {} of {} points misclassified, {:?}, {:.1} s",
                    problem.name,
                    found.calls,
                    found.pf,
                    found.standard_error,
                    problem.pf,
                    found.misclassified,
                    found.population,
                    found.stop,
                    found.seconds
                );
            }
            runs.push(found);
        }
        rows.push(row(problem, &runs));
    }
    let text = if talk.json { to_json(&rows)? } else { markdown(&rows) };
    deliver(&text, arguments.out.as_deref())
}

/// The problems of these names, all if there are none.
fn chosen(names: &[String]) -> Result<Vec<PublishedProblem>, CommandError> {
    let all = published_problems();
    if names.is_empty() {
        return Ok(all);
    }
    let known: Vec<&str> = all.iter().map(|problem| problem.name).collect();
    if let Some(unknown) = names.iter().find(|name| !known.contains(&name.as_str())) {
        return Err(CommandError::UnknownProblem { name: unknown.clone(), allowed: known.join(", ") });
    }
    Ok(all.into_iter().filter(|problem| names.iter().any(|name| name == problem.name)).collect())
}
