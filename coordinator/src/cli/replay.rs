//! `coordinator replay`: a study learned from the simulations of a direct Monte Carlo run.

use super::arguments::positive;
use super::error::CommandError;
use super::names::{KernelName, LearningName, TrendName};
use super::opened::Opened;
use super::options::{forms, learning_function};
use super::output::{print, to_json};
use clap::Args;
use coordinator::analyses::benchmark::{Replayed, replay as learn_again};
use coordinator::study::{Method, Settings};
use std::fmt::Write;
use std::path::PathBuf;

/// A direct Monte Carlo run, and how to learn from it.
#[derive(Debug, Clone, Args)]
pub struct ReplayArguments {
    /// Folder of a study with --method monte-carlo
    pub dir: PathBuf,
    /// Use its first N samples only [default: all]
    #[arg(long, value_name = "N", value_parser = positive)]
    pub samples: Option<usize>,
    /// Evaluations of the initial design [default: the scene's]
    #[arg(long, value_name = "N", value_parser = positive)]
    pub initial: Option<usize>,
    /// Budget of evaluations [default: the scene's]
    #[arg(long, value_name = "N", value_parser = positive)]
    pub max_evaluations: Option<usize>,
    /// Evaluations under way at once [default: the scene's]
    #[arg(long, value_name = "N", value_parser = positive)]
    pub batch: Option<usize>,
    /// Which points are simulated next [default: gain]
    #[arg(long, value_enum)]
    pub learning: Option<LearningName>,
    /// Kernel of the surrogates' correlation [default: auto, by cross-validation]
    #[arg(long, value_enum)]
    pub kernel: Option<KernelName>,
    /// Trend of the surrogates [default: auto, by cross-validation]
    #[arg(long, value_enum)]
    pub trend: Option<TrendName>,
}

/// Runs the command.
pub fn replay(arguments: &ReplayArguments, as_json: bool) -> Result<(), CommandError> {
    let opened = Opened::new(&arguments.dir)?;
    let mut samples = opened.simulated()?;
    if samples.len() < 2 {
        return Err(CommandError::TooFewSimulations { dir: arguments.dir.clone(), points: 0, least: 2 });
    }
    let nominal = samples.remove(0);
    samples.truncate(arguments.samples.unwrap_or(usize::MAX));
    let was = opened.options.settings();
    let mut settings = Settings::of(&opened.scene, was.accuracy.clone());
    settings.method = Method::ActiveLearning;
    let study = &mut settings.study;
    study.seed = was.study.seed;
    study.initial = arguments.initial.unwrap_or(study.initial);
    study.max_evaluations = arguments.max_evaluations.unwrap_or(study.max_evaluations);
    study.batch = arguments.batch.unwrap_or(study.batch);
    if samples.len() < study.initial {
        let (dir, points, least) = (arguments.dir.clone(), samples.len(), study.initial);
        return Err(CommandError::TooFewSimulations { dir, points, least });
    }
    settings.learning = learning_function(arguments.learning.unwrap_or_default());
    settings.forms = forms(arguments.kernel.unwrap_or_default(), arguments.trend.unwrap_or_default());
    let found = learn_again(&opened.scene, &settings, &nominal, &samples)
        .map_err(|error| CommandError::Replay { dir: arguments.dir.clone(), error })?;
    if as_json { print(&to_json(&found)?) } else { print(&in_words(&found)) }
}

fn in_words(found: &Replayed) -> String {
    let mut out = String::new();
    // Writing to a String cannot fail.
    let _ = write_words(&mut out, found);
    out
}

fn write_words(out: &mut String, found: &Replayed) -> std::fmt::Result {
    writeln!(
        out,
        "learning from {} samples as its population; errors are the largest of any R(n)\n",
        found.population
    )?;
    writeln!(
        out,
        "{:>11} {:>13} {:>11} {:>12} {:>10}  surrogates: kernel, trend, Q2 by leaving one out, by cross-validation, factor on variances",
        "evaluations", "stated error", "true error", "true/stated", "uncertain"
    )?;
    for round in &found.rounds {
        writeln!(
            out,
            "{:>11} {:>13.4} {:>11.4} {:>12.2} {:>8.1} %  {}",
            round.evaluations,
            round.stated_error,
            round.true_error,
            round.error_ratio,
            100.0 * round.uncertain,
            round.surrogates.join("; ")
        )?;
    }
    writeln!(out, "\nstopped by {}, {:.1} s of learning", found.stopped_by, found.seconds)
}
