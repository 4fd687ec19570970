//! The learner on a family of random problems of known failure probability that were used for nothing else: coverage of
//! the stated 95 % intervals, distances in stated standard errors, evaluations. Even problems are for settling on a method,
//! odd ones for reporting it.
//!
//! ```sh
//! cargo run --release -p coordinator --example random_problems -- --half settle --samples 20000
//! cargo run --release -p coordinator --example random_problems -- --half report --class islands --csv islands.csv
//! cargo run --release -p coordinator --example random_problems -- --family bulk --without hold
//! cargo run --release -p coordinator --example random_problems -- --family lives --count 60
//! ```
//!
//! The family `bulk` has bumps, ridges and waves where most of the population lies, with failure probabilities of 1e-3 to
//! 0.1. The family `lives` has wear over 20 to 60 checkpoints; a second table tells in how many problems the true lives at
//! R = 0.99, 0.9 and 0.5 lie within the lives read from the limits of R(n).

#[path = "../published_problems/addition.rs"]
mod addition;
mod bulk;
mod course;
mod draw;
mod family;
mod first;
mod known_lives;
mod learn;
mod lives;
mod lives_table;
mod problem;
mod response;
mod table;
mod truth;

use addition::Addition;
use clap::{Parser, ValueEnum};
use coordinator::study::Settings;
use family::Family;
use std::error::Error;
use std::fs::File;
use std::io::Write;
use std::time::Instant;

/// Half of the family.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Half {
    /// Even problems.
    Settle,
    /// Odd problems.
    Report,
}

/// Learn a family of random problems of known failure probability
#[derive(Debug, Parser)]
struct Arguments {
    /// Family of problems
    #[arg(long, default_value = "first")]
    family: Family,
    /// Half of the family: problems for settling on a method, or for reporting it
    #[arg(long, default_value = "settle")]
    half: Half,
    /// Number of problems of this half
    #[arg(long, default_value = "120", value_name = "N")]
    count: u64,
    /// A class of the family, several if repeated: islands, kink, fourier, lines, system, jump, history; bumps, ridge,
    /// periodic; lognormal, exponential, weibull, bimodal, wear, competing [default: all]
    #[arg(long, value_name = "NAME")]
    class: Vec<String>,
    /// A problem by its number, several if repeated [default: all]
    #[arg(long, value_name = "NUMBER")]
    problem: Vec<u64>,
    /// Seed of the family
    #[arg(long, default_value = "1", value_name = "N")]
    seed: u64,
    /// Points of the Monte Carlo population at first [default: that of a scene]
    #[arg(long, value_name = "N")]
    samples: Option<usize>,
    /// Threads; results do not depend on it
    #[arg(long, default_value = "1", value_name = "N")]
    jobs: usize,
    /// Write one line per problem to this file
    #[arg(long, value_name = "FILE")]
    csv: Option<String>,
    /// Addition to the published learning that is left out
    #[arg(long, value_enum)]
    without: Option<Addition>,
    /// Write every simulation and round to standard error
    #[arg(long)]
    trace: bool,
    /// Print only the truths, learn nothing
    #[arg(long)]
    truths: bool,
}

fn main() -> Result<(), Box<dyn Error>> {
    let arguments = Arguments::parse();
    rayon::ThreadPoolBuilder::new().num_threads(arguments.jobs).build_global()?;
    let mut csv = arguments.csv.as_ref().map(File::create).transpose()?;
    let mut write = |line: &str| -> std::io::Result<()> {
        println!("{line}");
        csv.as_mut().map_or(Ok(()), |file| writeln!(file, "{line}"))
    };
    let has_lives = arguments.family == Family::Lives;
    if !arguments.truths {
        write(&format!("{}{}", table::HEADER, if has_lives { lives_table::HEADER } else { "" }))?;
    }
    let mut runs = Vec::new();
    for index in chosen(&arguments)? {
        let started = Instant::now();
        let problem = arguments.family.problem(arguments.seed, index);
        let truth = truth::truth(&problem);
        if arguments.truths {
            let (d, m) = (problem.dimension(), problem.checkpoints());
            let last = truth.standard_error[m - 1] / truth.pf[m - 1];
            let seconds = started.elapsed().as_secs_f64();
            println!(
                "{index} {} d {d} limit states {} checkpoints {m} Pf {:.4e} (relative error {last:.1e}), {seconds:.2} s",
                problem.class.name(),
                problem.modes.len(),
                truth.pf[m - 1]
            );
            continue;
        }
        let defaults = Settings::for_variables(problem.dimension());
        let samples = arguments.samples.unwrap_or(defaults.samples);
        let mut settings = Settings { samples, seed: index + 1, ..defaults };
        let targets = addition::leave_out(arguments.without, &mut settings);
        let run = learn::learn(&problem, &truth, (settings, targets), arguments.trace)?;
        let lives = if has_lives { lives_table::columns(&run) } else { String::new() };
        write(&format!("{}{lives}", table::line(&run)))?;
        runs.push(run);
    }
    if !runs.is_empty() {
        println!("\n{}", table::markdown(&table::rows(&runs)));
        if has_lives {
            println!("{}", lives_table::markdown(&runs));
        }
    }
    Ok(())
}

/// Numbers of the problems asked for.
fn chosen(arguments: &Arguments) -> Result<Vec<u64>, String> {
    let known = arguments.family.classes();
    if let Some(unknown) = arguments.class.iter().find(|name| !known.contains(&name.as_str())) {
        return Err(format!("--class {unknown}: unknown, allowed: {}", known.join(", ")));
    }
    if !arguments.problem.is_empty() {
        return Ok(arguments.problem.clone());
    }
    let offset = u64::from(arguments.half == Half::Report);
    let wanted = |index: &u64| {
        arguments.class.is_empty()
            || arguments.class.iter().any(|name| name == arguments.family.class_of(*index).name())
    };
    Ok((0..arguments.count).map(|i| 2 * i + offset).filter(wanted).collect())
}
