//! `coordinator designs`, and the end of a study with design variables: reliability and lives of every design, with
//! simulations where single designs are still uncertain.

use super::announced::announced;
use super::decision_error::DecisionError;
use super::error::CommandError;
use super::farm::CommandEvaluator;
use super::output::{print, to_json};
use super::shared::{FarmArguments, Verbosity, positive};
use super::stored_study::{StoredStudy, stored_space, summary_of};
use super::what_if::{failed, known_outcomes, population};
use clap::Args;
use coordinator::analyses::designs::{
    Best, DesignAnswer, DesignError, DesignReport, DesignSpace, DesignStudy, Objective, Refined, answers,
    csv, json, page, refine, text,
};
use coordinator::presentation::report::ReportError;
use coordinator::presentation::terminal::print_message;
use coordinator::results::progress::Silent;
use coordinator::results::result_files::write_text;
use coordinator::results::store::{CampaignFile, FurtherEvaluations};
use coordinator::study::{FurtherLearning, LEVELS, Method, Settings, StoredOutcome};
use std::path::{Path, PathBuf};

pub const EXAMPLES: &str = "\
For studies that were started with `run --design KEY=LOWER..UPPER`: reliability and lives of the designs of a grid over the \
ranges, the best one, and those that cannot be told from it. Without --refine nothing is simulated.

Examples:
  coordinator run --scene four-bar --accuracy draft --design 'parameters.clearance=18 um..30 um' --out clearances
  coordinator designs clearances --points 13 --life 6000
  coordinator designs clearances --at parameters.clearance='21 um' --json
  coordinator designs clearances --refine 20 --workers auto --out answers";

/// Points per design variable in the table, by the number of variables.
const POINTS: [usize; 3] = [9, 5, 3];

/// Folder of the answers within that of the study.
const FOLDER: &str = "designs";

/// Arguments of `coordinator designs`.
#[derive(Debug, Clone, Args)]
pub struct DesignsArguments {
    /// Folder of the finished study
    pub dir: PathBuf,
    /// Values per design variable [default: 9, 5 or 3 with one, two or three variables]
    #[arg(long, value_name = "N", value_parser = points)]
    pub points: Option<usize>,
    /// Answer for the design with this value alone, one for each design variable
    #[arg(long, value_name = "KEY=VALUE", conflicts_with = "points")]
    pub at: Vec<String>,
    /// Look for the largest reliability at this checkpoint [default: for the longest life]
    #[arg(long, value_name = "CYCLES", value_parser = positive)]
    pub life: Option<usize>,
    /// Look for the longest life at this level of R: 0.99, 0.9 or 0.5
    #[arg(long, value_name = "R", default_value = "0.99", value_parser = level, conflicts_with = "life")]
    pub level: f64,
    /// Add at most this many simulations, where the reliability of single designs is most uncertain
    #[arg(long, value_name = "N", value_parser = positive)]
    pub refine: Option<usize>,
    /// Write designs.html, designs.json, designs.csv and figures/ to this folder, created if missing
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    #[command(flatten)]
    pub farm: FarmArguments,
}

fn points(text: &str) -> Result<usize, String> {
    text.parse()
        .ok()
        .filter(|n| (2..=101).contains(n))
        .ok_or("allowed: a whole number from 2 to 101".to_owned())
}

fn level(text: &str) -> Result<f64, String> {
    let level: Option<f64> = text.parse().ok();
    level.filter(|level| LEVELS.contains(level)).ok_or("allowed: 0.99, 0.9 or 0.5".to_owned())
}

/// Runs the command.
///
/// # Errors
/// [`CommandError`].
pub fn designs(arguments: &DesignsArguments, verbosity: Verbosity) -> Result<(), CommandError> {
    let dir = &arguments.dir;
    let campaign =
        if arguments.refine.is_some() { CampaignFile::open(dir)? } else { CampaignFile::look(dir)? };
    let space = stored_space(&campaign)?.ok_or_else(|| DecisionError::NoDesigns { dir: dir.clone() })?;
    let mut study = StoredStudy::read(campaign)?;
    let objective = objective(arguments, &study)?;
    let grid = if arguments.at.is_empty() {
        space.grid(arguments.points.unwrap_or(points_of(&space)))
    } else {
        vec![space.design(&arguments.at)?]
    };
    let budget = arguments.refine.unwrap_or(0);
    let machines = Machines::ToOpen(&arguments.farm);
    let found = find(&mut study, &space, &grid, budget, machines, verbosity)?;
    deliver(&study, &space, &found, objective, arguments.out.as_deref(), verbosity)
}

/// The end of a study with design variables: adds simulations within its budget until the reliability of every design is as
/// certain as its target asks for, writes the answers into its folder and prints them. `None` without design variables.
///
/// # Errors
/// [`CommandError`].
pub fn after_study(
    study: &mut StoredStudy,
    machines: Machines<'_>,
    verbosity: Verbosity,
) -> Result<Option<()>, CommandError> {
    let Some(space) = stored_space(&study.campaign)? else { return Ok(None) };
    let grid = space.grid(points_of(&space));
    let known = known_outcomes(&study.campaign)?.len();
    let budget = study.settings.max_evaluations.saturating_sub(known);
    let found = find(study, &space, &grid, budget, machines, verbosity)?;
    let out = study.campaign.dir().join(FOLDER);
    deliver(study, &space, &found, Objective::Life { level: LEVELS[0] }, Some(&out), verbosity)?;
    Ok(Some(()))
}

/// Where simulations are run.
pub enum Machines<'a> {
    /// An evaluator whose workers are there.
    Open(&'a mut CommandEvaluator),
    /// Workers to be started once simulations are needed.
    ToOpen(&'a FarmArguments),
}

/// Answers of the designs of a grid.
struct FoundDesigns {
    answers: Vec<DesignAnswer>,
    refined: Refined,
    /// Number of all simulations.
    simulations: usize,
}

fn points_of(space: &DesignSpace) -> usize {
    POINTS[(space.variables().len() - 1).min(POINTS.len() - 1)]
}

fn objective(arguments: &DesignsArguments, study: &StoredStudy) -> Result<Objective, CommandError> {
    let Some(life) = arguments.life else { return Ok(Objective::Life { level: arguments.level }) };
    let checkpoints = study.scene().life.checkpoints();
    let found = checkpoints.iter().find(|cycles| **cycles as usize == life);
    found.map(|cycles| Objective::Reliability { cycles: *cycles }).ok_or_else(|| {
        let nearest = checkpoints.iter().min_by_key(|cycles| (**cycles as usize).abs_diff(life));
        let fault =
            format!("is no checkpoint of the study; the nearest one is {}", nearest.copied().unwrap_or(0));
        DecisionError::Option { option: "--life", value: life.to_string(), fault }.into()
    })
}

/// Assesses the designs, and adds at most `budget` simulations where their errors are above the target.
fn find(
    study: &mut StoredStudy,
    space: &DesignSpace,
    grid: &[Vec<f64>],
    budget: usize,
    machines: Machines<'_>,
    verbosity: Verbosity,
) -> Result<FoundDesigns, CommandError> {
    let summary = summary_of(&study.campaign)?;
    let settings = Settings {
        samples: population(&study.settings, &summary),
        method: Method::ActiveLearning,
        ..study.settings.clone()
    };
    let StoredStudy { campaign, source, .. } = study;
    let dir = campaign.dir().to_path_buf();
    let of_designs = |error| match error {
        DesignError::Scene(faults) => CommandError::Scene(faults),
        DesignError::Study(error) => failed(error, dir.clone()),
    };
    let designs = DesignStudy { space, augmented: source.nominal(), settings: &settings };
    let outcomes = known_outcomes(campaign)?;
    let found = answers(&designs, grid, &outcomes).map_err(of_designs)?;
    let largest_error = found.iter().map(|answer| answer.surrogate_error).fold(0.0, f64::max);
    let refined = Refined { added: 0, largest_error, target_error: settings.targets().error };
    if refined.is_reached() || budget == 0 {
        return Ok(FoundDesigns { answers: found, refined, simulations: outcomes.len() });
    }
    let mut opened = None;
    let evaluator = match machines {
        Machines::Open(evaluator) => evaluator,
        Machines::ToOpen(farm) => {
            let mut evaluator = CommandEvaluator::open(source, || announced(source, &settings, true), farm)?;
            evaluator.start_workers()?;
            if !verbosity.quiet {
                evaluator.print_endpoints();
            }
            opened.insert(evaluator)
        }
    };
    let mut simulate = |learning: &FurtherLearning<'_>| -> Result<Vec<StoredOutcome>, RefinementError> {
        let mut journal = FurtherEvaluations::of(campaign);
        let learned = learning.learn(evaluator.evaluator(), &mut journal, &mut Silent);
        learned.map_err(|error| RefinementError::Design(DesignError::Study(error)))?;
        known_outcomes(campaign).map_err(|error| RefinementError::Command(Box::new(error)))
    };
    let mut progress = |error: f64, added: usize| {
        if !verbosity.quiet {
            print_message(format_args!(
                "designs: largest surrogate error of R {error:.4}, target {:.4}; {added} simulations added",
                settings.targets().error
            ));
        }
    };
    let refined = refine(&designs, grid, outcomes, budget, &mut simulate, &mut progress);
    let refined = refined.map_err(|error| match error {
        RefinementError::Design(error) => of_designs(error),
        RefinementError::Command(error) => *error,
    })?;
    if let Some(evaluator) = opened {
        evaluator.close();
    }
    let outcomes = known_outcomes(campaign)?;
    let answers = answers(&designs, grid, &outcomes).map_err(of_designs)?;
    Ok(FoundDesigns { answers, refined, simulations: outcomes.len() })
}

/// An error while simulations are added.
enum RefinementError {
    Design(DesignError),
    Command(Box<CommandError>),
}

impl From<DesignError> for RefinementError {
    fn from(error: DesignError) -> Self {
        Self::Design(error)
    }
}

/// Prints the answers and writes their files.
fn deliver(
    study: &StoredStudy,
    space: &DesignSpace,
    found: &FoundDesigns,
    objective: Objective,
    out: Option<&Path>,
    verbosity: Verbosity,
) -> Result<(), CommandError> {
    let own = summary_of(&study.campaign)?.evaluations.total;
    let report = DesignReport {
        space,
        answers: &found.answers,
        objective,
        best: Best::among(&found.answers, objective),
        refined: found.refined,
        simulations: (found.simulations, found.simulations.saturating_sub(own)),
        command: format!("coordinator designs {}", study.campaign.dir().display()),
    };
    let document = to_json(&json(&report))?;
    let mut written = String::new();
    if let Some(out) = out {
        let page = page(&report).map_err(ReportError::from)?.write(out, "designs")?;
        write_text(&out.join("designs.json"), &document)?;
        write_text(&out.join("designs.csv"), &csv(space, &found.answers))?;
        written = format!("page: {}\n", page.display());
    }
    if verbosity.json {
        return print(&document);
    }
    print(&format!("{}{written}", text(&report)))
}
