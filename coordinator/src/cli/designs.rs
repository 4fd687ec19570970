//! `coordinator designs`, and the end of a study with design variables: reliability and lives of every design, with
//! simulations where single designs are still uncertain.

use super::shared::within;
use super::{
    CommandError, CommandEvaluator, Destination, Done, FarmArguments, OpenedStudy, StoredStudy, Verbosity,
    answer_with, failed, known_outcomes, positive, stored_correction, value,
};
use clap::Args;
use common::scene::Scene;
use coordinator::analyses::designs::{
    Best, DesignReport, DesignSpace, DesignStudy, Objective, Refined, answer, answers, json, refine,
};
use coordinator::analyses::error::AnalysisError;
use coordinator::farm::evaluate::EvaluateError;
use coordinator::results::progress::Silent;
use coordinator::results::store::FurtherEvaluations;
use coordinator::study::{FurtherLearning, LEVELS, StoredOutcome};
use std::path::{Path, PathBuf};

pub const EXAMPLES: &str = "\
For studies that were started with `run --design KEY=LOWER..UPPER`: reliability and lives of the designs of a grid over the \
ranges, the best one, and those that cannot be told from it. Without --max-evaluations nothing is simulated.

Examples:
  coordinator run four-bar --accuracy draft --design 'parameters.clearance=18 um..30 um' --out clearances
  coordinator designs clearances --points 13 --life 6000
  coordinator designs clearances --set parameters.clearance='21 um' --json
  coordinator designs clearances --max-evaluations 20 --workers auto --out answers";

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
    #[arg(long, value_name = "N", value_parser = within::<usize>(2, 101))]
    pub points: Option<usize>,
    /// Set a design variable, each one of them, and answer for this design alone
    #[arg(long, alias = "at", value_name = "KEY=VALUE", conflicts_with = "points")]
    pub set: Vec<String>,
    /// Look for the largest reliability at this checkpoint [default: for the longest life]
    #[arg(long, value_name = "CYCLES", value_parser = positive)]
    pub life: Option<usize>,
    /// Look for the longest life at this level of R: 0.99, 0.9 or 0.5
    #[arg(long, value_name = "R", default_value = "0.99", value_parser = level, conflicts_with = "life")]
    pub level: f64,
    /// Most evaluations to add, where the reliability of single designs is most uncertain
    #[arg(long, alias = "refine", value_name = "N", value_parser = positive)]
    pub max_evaluations: Option<usize>,
    /// Write designs.html, designs.md, designs.json, designs.csv and figures/ to this folder, created if missing
    #[arg(long, value_name = "DIR")]
    pub out: Option<Destination>,
    #[command(flatten)]
    pub farm: FarmArguments,
}

fn level(text: &str) -> Result<f64, String> {
    value(text, "0.99, 0.9 or 0.5", |level| LEVELS.contains(level))
}

/// Runs the command.
///
/// # Errors
/// [`CommandError`].
pub fn designs(arguments: &DesignsArguments, verbosity: Verbosity) -> Done {
    let dir = &arguments.dir;
    let mut opened = OpenedStudy::open(dir, arguments.max_evaluations.is_some())?;
    let space = opened.space.take().ok_or_else(|| {
        let fault =
            "this study has no design variables; start one with `coordinator run --design KEY=LOWER..UPPER`";
        CommandError::refused(dir.display(), fault)
    })?;
    let objective = objective(arguments, opened.study.scene())?;
    let grid = if arguments.set.is_empty() {
        space.grid(arguments.points.unwrap_or(points_of(&space)))
    } else {
        vec![space.design(&arguments.set)?]
    };
    let asked = AskedDesigns { grid, objective, budget: arguments.max_evaluations.unwrap_or(0) };
    let machines = Machines::ToOpen(&arguments.farm);
    answer_for(&mut opened, &space, &asked, machines, arguments.out.as_ref(), verbosity)
}

/// The end of a study with design variables: adds simulations within its budget until the reliability of every design is as
/// certain as its target asks for, writes the answers into its folder and prints them. Without design variables it returns the study.
///
/// # Errors
/// [`CommandError`].
pub fn after_study(
    study: StoredStudy,
    machines: Machines<'_>,
    verbosity: Verbosity,
) -> Done<Option<StoredStudy>> {
    let mut opened = OpenedStudy::of(study)?;
    let Some(space) = opened.space.take() else { return Ok(Some(opened.study)) };
    let asked = AskedDesigns {
        grid: space.grid(points_of(&space)),
        objective: Objective::Life { level: LEVELS[0] },
        budget: opened.settings.max_evaluations.saturating_sub(opened.outcomes()?.len()),
    };
    let out = Destination::Folder(opened.study.campaign.dir.join(FOLDER));
    answer_for(&mut opened, &space, &asked, machines, Some(&out), verbosity)?;
    Ok(None)
}

/// Where simulations are run.
pub enum Machines<'a> {
    /// An evaluator whose workers are there.
    Open(&'a mut CommandEvaluator),
    /// Workers to be started once simulations are needed.
    ToOpen(&'a FarmArguments),
}

/// The designs of a grid, what makes one of them good, and the most simulations to be added for them.
struct AskedDesigns {
    grid: Vec<Vec<f64>>,
    objective: Objective,
    budget: usize,
}

fn points_of(space: &DesignSpace) -> usize {
    POINTS[(space.variables.len() - 1).min(POINTS.len() - 1)]
}

fn objective(arguments: &DesignsArguments, scene: &Scene) -> Done<Objective> {
    let Some(life) = arguments.life else { return Ok(Objective::Life { level: arguments.level }) };
    let checkpoints = scene.life.checkpoints();
    let found = checkpoints.iter().find(|cycles| **cycles as usize == life);
    found.map(|cycles| Objective::Reliability { cycles: *cycles }).ok_or_else(|| {
        let nearest = checkpoints.iter().min_by_key(|cycles| (**cycles as usize).abs_diff(life));
        let fault =
            format!("is no checkpoint of the study; the nearest one is {}", nearest.copied().unwrap_or(0));
        CommandError::refused(format_args!("--life {life}"), fault)
    })
}

/// Assesses the designs, with simulations where their errors are above the target, prints the answers and writes their files.
fn answer_for(
    opened: &mut OpenedStudy,
    space: &DesignSpace,
    asked: &AskedDesigns,
    machines: Machines<'_>,
    out: Option<&Destination>,
    verbosity: Verbosity,
) -> Done {
    let dir = opened.study.campaign.dir.clone();
    let mut outcomes = opened.outcomes()?;
    let source = opened.study.source.clone();
    let designs = DesignStudy { space, augmented: source.nominal(), settings: &opened.settings.clone() };
    let mut found = answers(&designs, &asked.grid, &outcomes).map_err(|error| of_designs(error, &dir))?;
    let largest_error = found.iter().map(|answer| answer.surrogate_error).fold(0.0, f64::max);
    let mut refined = Refined { added: 0, largest_error, target_error: designs.settings.targets().error };
    if !refined.is_reached() && asked.budget > 0 {
        refined = refine_with(opened, &designs, asked, outcomes, machines, verbosity)?;
        outcomes = opened.outcomes()?;
        found = answers(&designs, &asked.grid, &outcomes).map_err(|error| of_designs(error, &dir))?;
    }
    let report = DesignReport {
        space,
        answers: &found,
        objective: asked.objective,
        best: Best::among(&found, asked.objective),
        refined,
        simulations: (outcomes.len(), outcomes.len().saturating_sub(opened.summary.evaluations.total)),
        command: format!("coordinator designs {}", dir.display()),
    };
    answer_with(&answer(&report), &json(&report), out, verbosity.json)
}

fn of_designs(error: AnalysisError, dir: &Path) -> CommandError {
    match error {
        AnalysisError::Study(error) => failed(error, dir),
        error => error.into(),
    }
}

/// Adds simulations to the study where the errors of single designs are above the target.
fn refine_with(
    opened: &mut OpenedStudy,
    designs: &DesignStudy<'_>,
    asked: &AskedDesigns,
    outcomes: Vec<StoredOutcome>,
    machines: Machines<'_>,
    verbosity: Verbosity,
) -> Done<Refined> {
    let mut own = None;
    let evaluator = match machines {
        Machines::Open(evaluator) => evaluator,
        Machines::ToOpen(farm) => own.insert(opened.evaluator(farm, verbosity.quiet)?),
    };
    let StoredStudy { campaign, source, .. } = &mut opened.study;
    let correction = stored_correction(campaign, source.nominal())?;
    let mut simulate = |learning: &FurtherLearning<'_>| -> Result<Vec<StoredOutcome>, AnalysisError> {
        let learning = FurtherLearning { correction: correction.as_ref(), ..*learning };
        learning.learn(evaluator.evaluator(), &mut FurtherEvaluations(campaign), &mut Silent)?;
        Ok(known_outcomes(campaign, source.nominal()).map_err(EvaluateError::from)?)
    };
    let mut progress = |error: f64, added: usize| {
        let target = designs.settings.targets().error;
        verbosity.say(format_args!(
            "designs: largest surrogate error of R {error:.4}, target {target:.4}; {added} simulations added"
        ));
    };
    let refined = refine(designs, &asked.grid, outcomes, asked.budget, &mut simulate, &mut progress);
    let refined = refined.map_err(|error| of_designs(error, &opened.study.campaign.dir))?;
    if let Some(evaluator) = own {
        evaluator.close();
    }
    Ok(refined)
}
