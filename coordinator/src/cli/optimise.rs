//! `coordinator optimise`: the cheapest design that reaches the reliabilities of a problem file, from a finished study, with
//! simulations at the optimum.

use super::announced::announced;
use super::error::CommandError;
use super::farm::CommandEvaluator;
use super::output::{print, to_json};
use super::shared::{FarmArguments, Verbosity, whole};
use super::stored_study::{StoredStudy, stored_space, summary_of};
use super::what_if::{failed, known_outcomes, population};
use clap::Args;
use common::scene::{InputFile, Scene};
use coordinator::analyses::optimise::{
    DesignProblem, OptimisationProgress, OptimisationResult, OptimiseError, StudyBasis, design_settings,
    markdown, optimise as find, page, read_problem,
};
use coordinator::analyses::what_if::{FinishedStudy, ask, json, redistributed};
use coordinator::presentation::report::ReportError;
use coordinator::presentation::terminal::print_message;
use coordinator::results::result_files::write_text;
use coordinator::results::store::{CampaignFile, FurtherEvaluations};
use coordinator::study::{
    Method, ObservedOutcome, Problem, SampleRequest, Settings, complete_outcomes, simulate_samples,
};
use std::path::PathBuf;

pub const EXAMPLES: &str = "\
The problem file has [[quantities]], means, standard deviations or tolerances of random variables with bounds and costs, \
and [[targets]], reliabilities to be reached. The optimum is found on the surrogates of the study and confirmed by \
simulations there, which are kept in the study for later questions; its own results do not change.

A problem file:
  [[quantities]]
  change = \"clearance_crank.std\"
  lower = \"0.5 um\"
  upper = \"4 um\"
  cost = { model = \"reciprocal-power\", c0 = 1, c1 = 2, k = 1, unit = \"um\" }

  [[targets]]
  limit_state = \"wear\"
  cycles = 6000
  reliability = 0.99

Examples:
  coordinator optimise study --problem tolerances.toml
  coordinator optimise study --problem tolerances.toml --max-evaluations 40 --workers auto --out optimum
  coordinator optimise study --problem tolerances.toml --max-evaluations 0 --json";

/// Arguments of `coordinator optimise`.
#[derive(Debug, Clone, Args)]
pub struct OptimiseArguments {
    /// Folder of the finished study
    pub dir: PathBuf,
    /// Quantities with bounds and costs, and targets, TOML
    #[arg(long, value_name = "FILE")]
    pub problem: PathBuf,
    /// Most simulations to add; with 0 the optimum is not confirmed
    #[arg(long, value_name = "N", default_value = "100", value_parser = whole)]
    pub max_evaluations: usize,
    /// Write optimum.html, optimum.md, optimum.json, the scene.toml of the optimum and figures/ to this folder
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    #[command(flatten)]
    pub farm: FarmArguments,
}

/// Runs the command.
///
/// # Errors
/// [`CommandError`].
pub fn optimise(arguments: &OptimiseArguments, verbosity: Verbosity) -> Result<(), CommandError> {
    let dir = &arguments.dir;
    let simulates = arguments.max_evaluations > 0;
    let campaign = if simulates { CampaignFile::open(dir)? } else { CampaignFile::look(dir)? };
    let summary = summary_of(&campaign)?;
    let mut study = StoredStudy::read(campaign)?;
    let space = stored_space(&study.campaign)?;
    let base = match &space {
        None => study.source.clone(),
        Some(space) => space.present(&[])?.0,
    };
    let file = InputFile::load(&arguments.problem)?;
    let problem = read_problem(&file, &base, space.as_ref().map(|space| (space, study.scene())))?;
    let settings = Settings {
        samples: population(&study.settings, &summary),
        method: Method::ActiveLearning,
        ..study.settings.clone()
    };
    let result = search(&mut study, base.nominal(), &problem, &settings, arguments, verbosity)?;
    let sets = design_settings(&problem, base.nominal(), &result.values).map_err(OptimiseError::Law)?;
    let changed = redistributed(&base, &sets)?;
    let outcomes = known_outcomes(&study.campaign)?;
    let finished = FinishedStudy {
        scene: base.nominal(),
        simulated: study.scene(),
        settings: &settings,
        outcomes: &outcomes,
        summary: Some(&summary).filter(|_| space.is_none()),
    };
    let answer = ask(&finished, changed.nominal()).map_err(|error| failed(error, dir.clone()))?;
    let result = result.with_numerical_errors(&answer.after);
    let mut document = json(&answer, result.evaluations.added);
    document["optimum"] = serde_json::to_value(&result)?;
    let document = to_json(&document)?;
    let text = markdown(&result);
    let mut written = String::new();
    if let Some(out) = &arguments.out {
        let curves =
            vec![("study".to_owned(), answer.before.clone()), ("optimum".to_owned(), answer.after.clone())];
        let page =
            page(&result, &study.scene().name, curves).map_err(ReportError::from)?.write(out, "optimum")?;
        write_text(&out.join("scene.toml"), changed.text())?;
        write_text(&out.join("optimum.json"), &document)?;
        write_text(&out.join("optimum.md"), &text)?;
        written = format!("\npage: {}\n", page.display());
    }
    if verbosity.json {
        return print(&document);
    }
    print(&format!("{text}{written}"))
}

/// Finds the optimum from the design `base`, with simulations by the workers of the command.
fn search(
    study: &mut StoredStudy,
    base: &Scene,
    problem: &DesignProblem,
    settings: &Settings,
    arguments: &OptimiseArguments,
    verbosity: Verbosity,
) -> Result<OptimisationResult, CommandError> {
    let StoredStudy { campaign, source, .. } = study;
    let scene = source.nominal();
    let basis = StudyBasis {
        problem: Problem::of_changed_scene(base, scene),
        settings: settings.clone(),
        outcomes: complete_outcomes(scene, &known_outcomes(campaign)?),
    };
    let mut progress = |progress: OptimisationProgress| {
        if !verbosity.quiet {
            let OptimisationProgress { round, cost, feasible, added } = progress;
            let met = if feasible { "" } else { ", none within the trust region meets the targets" };
            print_message(format_args!(
                "round {round}: cost {cost:.5} on the present surrogates{met}; {added} simulations added"
            ));
        }
    };
    if arguments.max_evaluations == 0 {
        let mut none = |_: &[SampleRequest]| -> Result<Vec<ObservedOutcome>, OptimiseError> { Ok(vec![]) };
        return Ok(find(&basis, problem, 0, &mut none, &mut progress)?);
    }
    let announced = || announced(source, settings, true);
    let mut evaluator = CommandEvaluator::open(source, announced, &arguments.farm)?;
    evaluator.start_workers()?;
    if !verbosity.quiet {
        evaluator.print_endpoints();
    }
    let mut journal = FurtherEvaluations::of(campaign);
    let mut next = basis.outcomes.len() as u64;
    let mut simulate = |requests: &[SampleRequest]| -> Result<Vec<ObservedOutcome>, OptimiseError> {
        let found = simulate_samples(scene, settings, requests, next, evaluator.evaluator(), &mut journal)?;
        next += requests.len() as u64;
        Ok(found)
    };
    let result = find(&basis, problem, arguments.max_evaluations, &mut simulate, &mut progress)?;
    evaluator.close();
    Ok(result)
}
