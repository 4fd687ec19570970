//! The learner on published problems of known failure probability, over several seeds: evaluations needed, error of the
//! failure probability in stated standard errors, false stops.
//!
//! ```sh
//! cargo run --release -p coordinator --example published_problems
//! cargo run --release -p coordinator --example published_problems -- --problem four-branch-7 --samples 1000000
//! cargo run --release -p coordinator --example published_problems -- --problem oscillator --learning u --json
//! cargo run --release -p coordinator --example published_problems -- --seeds 3 --without hold
//! ```

mod learn;
mod problems;
mod table;

use clap::{Parser, ValueEnum};
use coordinator::statistics::learning::{LearningFunction, StoppingTargets};
use coordinator::statistics::surrogate::{FormSettings, Kernel, Trend};
use coordinator::study::Settings;
use problems::{PublishedProblem, published_problems};
use std::error::Error;
use table::{Row, markdown, row};

/// An addition of this project to the published learning.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Addition {
    /// Results over which a rule must hold, of which three of four explore.
    Hold,
    /// The stop by the estimated error.
    ErrorRule,
    /// The linear trend, where cross-validation prefers it.
    Trend,
    /// The Matern kernels, where cross-validation prefers one.
    Kernel,
    /// The learning function that lowers the estimated error, in the place of U.
    Gain,
}

impl Addition {
    /// The settings and targets without it.
    fn leave_out(self, settings: &mut Settings, targets: &mut StoppingTargets) {
        match self {
            Self::Hold => *targets = StoppingTargets { hold: 1, hold_points: 0, ..*targets },
            Self::ErrorRule => targets.error = 0.0,
            Self::Trend => settings.forms = FormSettings { trend: Some(Trend::Constant), ..settings.forms },
            Self::Kernel => {
                settings.forms = FormSettings { kernel: Some(Kernel::Gaussian), ..settings.forms }
            }
            Self::Gain => settings.learning = LearningFunction::U,
        }
    }
}

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
    /// Learning function: gain, u, eff or h
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
            let mut targets = settings.targets();
            if let Some(addition) = arguments.without {
                addition.leave_out(&mut settings, &mut targets);
            }
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
