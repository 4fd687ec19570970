//! Validates the surrogates of a study against simulations that they were not fitted to, or round by round against a direct
//! Monte Carlo study. Nothing is simulated. What it finds of a study is kept in `verified.json` in its folder, which `coordinator report`
//! states.
//!
//! ```sh
//! coordinator run four-bar --out study
//! coordinator run four-bar --method monte-carlo --samples 1000 --out direct
//! cargo run --release -p coordinator --example verify -- study --against direct
//! cargo run --release -p coordinator --example verify -- direct --initial 40 --max-evaluations 100
//!
//! coordinator run four-bar --method monte-carlo --accuracy reference --samples 100 --out reference
//! cargo run --release -p coordinator --example verify -- direct --finer reference --study study
//! ```

mod against;
mod finer;
mod rounds;
mod simulated;

use against::{Verification, verify};
use clap::Parser;
use common::accuracy::Accuracy;
use common::scene::{Scene, SceneSource};
use coordinator::presentation::report::SUMMARY_DOCUMENT;
use coordinator::results::store::{CampaignFile, StoreError};
use coordinator::results::summary::StudySummary;
use coordinator::results::verified::{VerificationRow, add_verification};
use coordinator::statistics::learning::LearningFunction;
use coordinator::statistics::reliability::REACH;
use coordinator::statistics::surrogate::{Kernel, Trend};
use coordinator::study::{Observed, Settings, StoredOutcome};
use finer::{finer_reliability, print_finer};
use rounds::{Replayed, replay};
use simulated::SimulatedPoint;
use std::collections::HashSet;
use std::error::Error;
use std::path::{Path, PathBuf};

/// Fewest simulations of either study: surrogates need three, and a share of fewer than ten has no meaning.
const LEAST: usize = 10;

/// Validate the surrogates of a study; without --against learn again from the samples of a direct Monte Carlo study
#[derive(Debug, Parser)]
struct Arguments {
    /// Folder of the study
    dir: PathBuf,
    /// Folder of a study whose simulations are compared with the surrogates of the first one
    #[arg(long)]
    against: Option<PathBuf>,
    /// Folder of a direct study of the same samples, or the first of them, at a finer accuracy
    #[arg(long, conflicts_with = "against")]
    finer: Option<PathBuf>,
    /// Folders of studies whose intervals are compared with R(n) at the finer accuracy
    #[arg(long, num_args = 1.., requires = "finer")]
    study: Vec<PathBuf>,
    /// Use the first N samples only
    #[arg(long)]
    samples: Option<usize>,
    /// Evaluations of the initial design
    #[arg(long)]
    initial: Option<usize>,
    /// Budget of evaluations
    #[arg(long)]
    max_evaluations: Option<usize>,
    /// Evaluations under way at once
    #[arg(long)]
    batch: Option<usize>,
    /// Learning function
    #[arg(long)]
    learning: Option<LearningFunction>,
    /// Half width of the 95 % interval of any R at which learning may stop
    #[arg(long)]
    target_error: Option<f64>,
    /// Correlation kernel of the surrogates
    #[arg(long)]
    kernel: Option<Kernel>,
    /// Trend of the surrogates
    #[arg(long)]
    trend: Option<Trend>,
}

impl Arguments {
    /// The scene's settings with the options, and the seed of the study.
    fn settings(&self, scene: &Scene, seed: u64) -> Settings {
        let mut settings = Settings { seed, ..Settings::from(scene) };
        settings.initial = self.initial.unwrap_or(settings.initial);
        settings.max_evaluations = self.max_evaluations.unwrap_or(settings.max_evaluations);
        settings.batch = self.batch.unwrap_or(settings.batch);
        settings.learning = self.learning.unwrap_or(settings.learning);
        settings.target_error = self.target_error.or(settings.target_error);
        settings.forms.kernel = self.kernel.or(settings.forms.kernel);
        settings.forms.trend = self.trend.or(settings.forms.trend);
        settings
    }
}

/// A study with its scene, settings and outcomes.
struct Study {
    source: SceneSource,
    settings: Settings,
    outcomes: Vec<StoredOutcome>,
}

impl Study {
    fn read(dir: &Path) -> Result<Self, Box<dyn Error>> {
        let campaign = CampaignFile::look(dir)?;
        let source = SceneSource::parse(&campaign.meta.scene_source, "study")?;
        let settings = Settings::from_stored(&campaign.meta.settings)?;
        let mut outcomes = Vec::new();
        campaign.for_each(|stored| -> Result<(), StoreError> {
            let outcome = stored.outcome.map(Observed::from_evaluation);
            // Other levels are corrections of the working accuracy.
            if stored.level == 0 {
                outcomes.push(StoredOutcome { sample: stored.sample, outcome });
            }
            Ok(())
        })?;
        Ok(Self { source, settings, outcomes })
    }

    /// The evaluations that gave a result, in the order of their numbers.
    fn simulated(&self) -> Vec<SimulatedPoint> {
        let point = |StoredOutcome { sample, outcome }: StoredOutcome| {
            Some(SimulatedPoint { sample, observed: outcome.ok()? })
        };
        self.outcomes.iter().cloned().filter_map(point).collect()
    }

    /// Its accuracy.
    fn accuracy(&self) -> Accuracy {
        self.settings.accuracy.setting.accuracy
    }

    /// True if both are of the same mechanism and life.
    fn is_like(&self, other: &Self) -> bool {
        let [a, b] = [self, other].map(|study| study.source.nominal());
        a.variables == b.variables
            && a.limit_states == b.limit_states
            && a.outputs == b.outputs
            && a.life.checkpoints() == b.life.checkpoints()
    }
}

fn main() -> Result<(), Box<dyn Error>> {
    let arguments = Arguments::parse();
    let study = Study::read(&arguments.dir)?;
    let scene = study.source.nominal();
    if let Some(finer) = &arguments.finer {
        let finer = Study::read(finer)?;
        if !study.is_like(&finer) {
            return Err("the studies differ in their scenes".into());
        }
        let summary = |dir: &PathBuf| -> Result<(String, StudySummary), Box<dyn Error>> {
            let found = CampaignFile::look(dir)?.document(SUMMARY_DOCUMENT)?;
            Ok((dir.display().to_string(), found.ok_or("the study is not finished")?))
        };
        let studies = arguments.study.iter().map(summary).collect::<Result<Vec<_>, _>>()?;
        let truth = finer_reliability(&study, &finer)?;
        let compared =
            format!("intervals of R with R at a finer accuracy, from {} pairs of simulations", truth.pairs);
        for (dir, found) in arguments.study.iter().zip(print_finer(&truth, &studies)) {
            keep(dir, &compared, found)?;
        }
        return Ok(());
    }
    let Some(against) = &arguments.against else {
        let mut samples = study.simulated();
        if samples.len() < 2 {
            return Err("the study has no samples that were simulated".into());
        }
        let nominal = samples.remove(0);
        samples.truncate(arguments.samples.unwrap_or(usize::MAX));
        let settings = arguments.settings(scene, study.settings.seed);
        if samples.len() < settings.initial {
            return Err(format!("{} samples are fewer than an initial design", samples.len()).into());
        }
        print_rounds(&replay(scene, &settings, &nominal, &samples)?, samples.len());
        return Ok(());
    };
    let other = Study::read(against)?;
    if !study.is_like(&other) || study.accuracy() != other.accuracy() {
        return Err("the studies differ in their scenes or accuracies".into());
    }
    let bits = |sample: &[f64]| sample.iter().map(|x| x.to_bits()).collect::<Vec<u64>>();
    let learned = study.simulated();
    let seen: HashSet<Vec<u64>> = learned.iter().map(|point| bits(&point.sample)).collect();
    let mut unseen = other.simulated();
    unseen.retain(|point| !seen.contains(&bits(&point.sample)));
    if learned.len().min(unseen.len()) < LEAST {
        return Err(
            format!("{} and {} simulations, expected at least {LEAST}", learned.len(), unseen.len()).into()
        );
    }
    let found = verify(scene, &study.settings, &study.outcomes, &unseen)?;
    print_verification(&found);
    let compared = format!(
        "surrogates fitted to {} simulations with {} others of the study {}",
        found.learned_from,
        found.points,
        against.display()
    );
    let q2 = found.surrogates.iter().map(|surrogate| surrogate.q2).fold(1.0, f64::min);
    let off = found.largest_difference();
    keep(
        &arguments.dir,
        &compared,
        format!("R of any curve differs by at most {off:.4}, Q2 at least {q2:.4}"),
    )
}

/// Keeps what was found of the study in a folder, for its report.
fn keep(dir: &Path, compared: &str, found: String) -> Result<(), Box<dyn Error>> {
    let summary: Option<StudySummary> = CampaignFile::look(dir)?.document(SUMMARY_DOCUMENT)?;
    let evaluations = summary.map_or(0, |summary| summary.evaluations.total);
    let now = "SELECT strftime('%Y-%m-%dT%H:%M:%SZ', 'now')";
    let made = rusqlite::Connection::open_in_memory()?.query_row(now, [], |row| row.get(0))?;
    let row = VerificationRow { made, evaluations, compared: compared.to_owned(), found };
    add_verification(dir, row)?;
    println!("kept in {}; `coordinator report` states it", dir.join("verified.json").display());
    Ok(())
}

fn print_verification(found: &Verification) {
    println!(
        "surrogates fitted to {} simulations, compared with {} others",
        found.learned_from, found.points
    );
    println!(
        "limit state | surrogate | Q2 | leave-one-out Q2 | errors over predicted std (root mean square)"
    );
    for surrogate in &found.surrogates {
        let (name, form, ratio) = (&surrogate.limit_state, &surrogate.form, surrogate.variance_ratio.sqrt());
        println!("{name} | {form} | {:.4} | {:.4} | {ratio:.2}", surrogate.q2, surrogate.q2_leave_one_out);
    }
    println!("cycles | per curve ({}): R counted, by surrogates, difference", found.curves.join(", "));
    for row in &found.rows {
        let curves = row.simulated.iter().zip(&row.predicted).zip(&row.standard_error);
        let cells = curves.map(|((simulated, predicted), error)| {
            format!("{simulated:.4}, {predicted:.4}, {:+.4} ± {:.4}", predicted - simulated, REACH * error)
        });
        println!("{} | {}", row.cycles, cells.collect::<Vec<_>>().join(" | "));
    }
    println!("largest difference of any curve: {:.4}", found.largest_difference());
}

fn print_rounds(found: &Replayed, population: usize) {
    println!("learning again, with the {population} simulated samples as the population");
    println!(
        "evaluations | stated error | true error | ratio | uncertain | kernel, trend, Q2 left out, Q2 crossed, factor"
    );
    for round in &found.rounds {
        println!(
            "{} | {:.4} | {:.4} | {:.2} | {:.1} % | {}",
            round.evaluations,
            round.stated_error,
            round.true_error,
            round.error_ratio,
            100.0 * round.uncertain,
            round.surrogates.join("; ")
        );
    }
    println!("stopped by {}, {:.1} s of learning", found.stopped_by, found.seconds);
}
