//! `coordinator what-if`: the reliability of a finished study's scene with changed distributions and thresholds, from the
//! simulations that it has, and with further ones where the answer needs them.

use super::announced::announced;
use super::decision_error::DecisionError;
use super::error::CommandError;
use super::farm::CommandEvaluator;
use super::output::{print, to_json};
use super::shared::{FarmArguments, Verbosity, positive, share};
use super::stored_study::{StoredStudy, stored_space, summary_of};
use clap::Args;
use common::scene::SceneSource;
use coordinator::analyses::what_if::{
    FinishedStudy, POPULATION, WhatIf, ask, changed_scene, json, page, redistributed, text,
};
use coordinator::presentation::terminal::Terminal;
use coordinator::results::result_files::write_text;
use coordinator::results::store::{CampaignFile, FurtherEvaluations};
use coordinator::results::summary::StudySummary;
use coordinator::study::{FurtherLearning, Method, Observed, Settings, StoredOutcome, StudyError};
use std::path::PathBuf;

pub const EXAMPLES: &str = "\
KEY is VARIABLE.mean, .std, .lower, .upper, .mode, .truncation or .distribution, LIMIT_STATE.threshold, .lower or \
.upper, correlation(VARIABLE,VARIABLE) or rank_correlation(VARIABLE,VARIABLE), each with a value as in a scene file. \
The answer has the reliability, the lives and the first failures before and after, and their changes with 95 % \
intervals. Without --refine and --target-error nothing is simulated. Further simulations are kept in the study for \
later questions; its own results do not change.

Examples:
  coordinator what-if study --set wear_coefficient.std='2 %' --set wear.threshold='9 um'
  coordinator what-if study --set friction.distribution=lognormal --set 'correlation(friction,clearance_crank)=0.5' --json
  coordinator what-if study --set wear_coefficient.mean='1.2e-13 1/Pa' --refine 20 --workers auto --out harder";

/// Most simulations of a direct study that surrogates are fitted to: the time grows with the third power of their number, and 2000
/// took more than ten minutes.
const MOST_OF_DIRECT: usize = 400;

/// Arguments of `coordinator what-if`.
#[derive(Debug, Clone, Args)]
pub struct WhatIfArguments {
    /// Folder of the finished study
    pub dir: PathBuf,
    /// Change a distribution, a threshold or a correlation; repeatable for different keys
    #[arg(long, value_name = "KEY=VALUE")]
    pub set: Vec<String>,
    /// Add at most this many simulations of the changed scene, where they reduce the error of its reliability most
    #[arg(long, value_name = "N", value_parser = positive)]
    pub refine: Option<usize>,
    /// Add simulations until the surrogate error of any R(n) is below this share, at most --refine or the study's budget
    #[arg(long, value_name = "SHARE", value_parser = share)]
    pub target_error: Option<f64>,
    /// Points of the population [default: that of the study, at most 30000]
    #[arg(long, value_name = "N", value_parser = positive)]
    pub samples: Option<usize>,
    /// Write what-if.html, what-if.json, the changed scene.toml and figures/ to this folder, created if missing
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    #[command(flatten)]
    pub farm: FarmArguments,
}

/// Runs the command.
///
/// # Errors
/// [`CommandError`].
pub fn what_if(arguments: &WhatIfArguments, verbosity: Verbosity) -> Result<(), CommandError> {
    let WhatIfArguments { dir, set, refine, target_error, samples, out, farm } = arguments;
    let refines = refine.is_some() || target_error.is_some();
    let campaign = if refines { CampaignFile::open(dir)? } else { CampaignFile::look(dir)? };
    let summary = summary_of(&campaign)?;
    let mut study = StoredStudy::read(campaign)?;
    // With design variables the question is about the design that the scene itself has, or about the one that is set.
    let space = stored_space(&study.campaign)?;
    let (base, changed) = match &space {
        None => (study.source.clone(), changed_scene(&study.source, set)?),
        Some(space) => {
            let (design, others) = space.present(set)?;
            (space.present(&[])?.0, redistributed(&design, &others)?)
        }
    };
    let settings = Settings {
        samples: samples.unwrap_or_else(|| population(&study.settings, &summary)),
        target_error: target_error.or(study.settings.target_error),
        method: Method::ActiveLearning,
        ..study.settings.clone()
    };
    settings.check(changed.nominal())?;
    let mut outcomes = known_outcomes(&study.campaign)?;
    let known = outcomes.len();
    if study.settings.method != Method::ActiveLearning && known > MOST_OF_DIRECT {
        let (dir, method) = (dir.clone(), study.settings.method.name().to_owned());
        return Err(DecisionError::TooManySimulations {
            dir,
            method,
            simulations: known,
            most: MOST_OF_DIRECT,
        }
        .into());
    }
    if refines {
        let further = refine.unwrap_or(settings.max_evaluations);
        simulate_further(&mut study, &changed, &settings, (&outcomes, further), farm, verbosity)?;
        outcomes = known_outcomes(&study.campaign)?;
    }
    let finished = FinishedStudy {
        scene: base.nominal(),
        simulated: study.scene(),
        settings: &settings,
        outcomes: &outcomes,
        summary: Some(&summary).filter(|_| space.is_none()),
    };
    let answer = ask(&finished, changed.nominal()).map_err(|error| failed(error, dir.clone()))?;
    deliver(arguments, &changed, &answer, outcomes.len() - known, verbosity, out.as_ref())
}

/// Size of the population: that of the study, up to [`POPULATION`].
pub fn population(settings: &Settings, summary: &StudySummary) -> usize {
    let of_study = if settings.method == Method::ActiveLearning && summary.conditional.is_none() {
        summary.population.max(settings.samples)
    } else {
        POPULATION
    };
    of_study.min(POPULATION)
}

/// Sample and outcome of every simulation that the campaign file holds.
///
/// # Errors
/// [`CommandError::Store`].
pub fn known_outcomes(campaign: &CampaignFile) -> Result<Vec<StoredOutcome>, CommandError> {
    let mut all = Vec::new();
    campaign.for_each_known(|sample, outcome| {
        all.push(StoredOutcome { sample, outcome: outcome.map(Observed::from_evaluation) });
    })?;
    Ok(all)
}

/// Goes on learning on the changed scene, after the `outcomes` that are known, with at most `further` simulations, which are
/// kept in the campaign file.
fn simulate_further(
    study: &mut StoredStudy,
    changed: &SceneSource,
    settings: &Settings,
    (outcomes, further): (&[StoredOutcome], usize),
    farm: &FarmArguments,
    verbosity: Verbosity,
) -> Result<(), CommandError> {
    // Samples and accuracy determine what is simulated, so the workers receive the scene of the study.
    let campaign = || announced(&study.source, settings, true);
    let mut evaluator = CommandEvaluator::open(&study.source, campaign, farm)?;
    evaluator.start_workers()?;
    if !verbosity.quiet {
        evaluator.print_endpoints();
    }
    let mut terminal = Terminal::new(verbosity.quiet);
    let dir = study.campaign.dir().to_path_buf();
    let learning = FurtherLearning {
        changed: changed.nominal(),
        studied: study.source.nominal(),
        settings,
        stored: outcomes,
        further,
    };
    let mut journal = FurtherEvaluations::of(&mut study.campaign);
    let learned = learning.learn(evaluator.evaluator(), &mut journal, &mut terminal);
    terminal.finish();
    learned.map_err(|error| failed(error, dir))?;
    evaluator.close();
    Ok(())
}

/// The error of a question about the study in the folder `dir`.
pub fn failed(error: StudyError, dir: PathBuf) -> CommandError {
    match error {
        // An interruption leaves the finished simulations in the study: the same command goes on from them.
        StudyError::Evaluate(error) => CommandError::Evaluate(error),
        error => CommandError::Study { dir, error },
    }
}

/// Prints the answer and writes its files.
fn deliver(
    arguments: &WhatIfArguments,
    changed: &SceneSource,
    answer: &WhatIf,
    added: usize,
    verbosity: Verbosity,
    out: Option<&PathBuf>,
) -> Result<(), CommandError> {
    let scene = changed.nominal();
    let sets: String = arguments.set.iter().map(|set| format!(" --set '{set}'")).collect();
    let command = format!("coordinator what-if {}{sets}", arguments.dir.display());
    let document = to_json(&json(answer, added))?;
    let mut written = String::new();
    if let Some(out) = out {
        let page = page(answer, &arguments.set, added, scene, &command).write(out, "what-if")?;
        write_text(&out.join("what-if.json"), &document)?;
        write_text(&out.join("scene.toml"), changed.text())?;
        written = format!("page: {}\n", page.display());
    }
    if verbosity.json {
        return print(&document);
    }
    print(&format!("{}{written}", text(answer, &arguments.set, added, scene, &command)))
}
