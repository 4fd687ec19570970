//! `coordinator verify`: surrogates of a study against simulations they have not seen.

use super::error::CommandError;
use super::opened::Opened;
use super::output::{print, to_json};
use clap::Args;
use coordinator::study::{Simulated, StudyError, Verification, verify as hold_against};
use std::collections::HashSet;
use std::fmt::Write;
use std::path::PathBuf;

/// A study and the simulations it is held against.
#[derive(Debug, Clone, Args)]
pub struct VerifyArguments {
    /// Folder of the study
    pub dir: PathBuf,
    /// Folder of a study whose simulations the first one has not seen
    #[arg(long, value_name = "DIR")]
    pub against: PathBuf,
    /// Learn from the first N evaluations of the study only [default: all]
    #[arg(long, value_name = "N", value_parser = super::arguments::positive)]
    pub evaluations: Option<usize>,
}

/// Runs the command.
pub fn verify(arguments: &VerifyArguments, as_json: bool) -> Result<(), CommandError> {
    let study = Opened::new(&arguments.dir)?;
    let other = Opened::new(&arguments.against)?;
    if let Some(difference) = study.difference(&other) {
        let (dir, against) = (arguments.dir.clone(), arguments.against.clone());
        return Err(CommandError::NotComparable { dir, against, difference });
    }
    let mut learned = study.simulated()?;
    learned.truncate(arguments.evaluations.unwrap_or(usize::MAX));
    let bits = |point: &Simulated| point.sample.iter().map(|x| x.to_bits()).collect::<Vec<u64>>();
    let seen: HashSet<Vec<u64>> = learned.iter().map(bits).collect();
    let mut unseen = other.simulated()?;
    unseen.retain(|point| !seen.contains(&bits(point)));
    for (dir, points) in [(&arguments.dir, learned.len()), (&arguments.against, unseen.len())] {
        if points < LEAST {
            return Err(CommandError::TooFewSimulations { dir: dir.clone(), points, least: LEAST });
        }
    }
    let found =
        hold_against(&study.scene, &study.options.settings(), &learned, &unseen).map_err(|error| {
            CommandError::Study { error: StudyError::Campaign(error), dir: arguments.dir.clone() }
        })?;
    if as_json { print(&to_json(&found)?) } else { print(&in_words(&found)) }
}

/// Fewest simulations on either side: surrogates need three, and a share of fewer than ten says nothing.
const LEAST: usize = 10;

fn in_words(found: &Verification) -> String {
    let mut out = String::new();
    // Writing to a String cannot fail.
    let _ = write_words(&mut out, found);
    out
}

fn write_words(out: &mut String, found: &Verification) -> std::fmt::Result {
    writeln!(
        out,
        "surrogates of {} simulations against {} that they have not seen\n",
        found.learned_from, found.points
    )?;
    for surrogate in &found.surrogates {
        writeln!(
            out,
            "  {:16} {}: Q2 {:.4} (leave-one-out {:.4}), errors {:.2} times the predicted standard deviation",
            surrogate.limit_state,
            surrogate.form,
            surrogate.q2,
            surrogate.q2_leave_one_out,
            surrogate.variance_ratio.sqrt()
        )?;
    }
    write!(out, "\n{:>10}", "cycles")?;
    for curve in &found.curves {
        write!(out, " | {:^36}", format!("R {curve}: simulated, predicted"))?;
    }
    writeln!(out)?;
    for row in &found.rows {
        write!(out, "{:>10}", row.cycles)?;
        for ((simulated, predicted), error) in
            row.simulated.iter().zip(&row.predicted).zip(&row.standard_error)
        {
            let difference = predicted - simulated;
            write!(out, " | {simulated:.4} {predicted:.4} {difference:+.4} +- {error:.4}   ")?;
        }
        writeln!(out)?;
    }
    writeln!(out, "\nlargest difference of any curve: {:.4}", found.largest_difference())
}
