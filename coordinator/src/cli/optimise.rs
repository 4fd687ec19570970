//! `coordinator optimise`: the cheapest design that reaches the reliabilities of a problem file, from a finished study, with
//! simulations at the optimum.

use super::{
    Destination, Done, FarmArguments, OpenedStudy, StoredStudy, Verbosity, answer_with, stored_correction,
    whole,
};
use clap::Args;
use common::scene::{InputFile, Scene};
use coordinator::analyses::error::AnalysisError;
use coordinator::analyses::optimise::{
    DesignProblem, OptimisationResult, StudyBasis, answer, optimise as find, read_problem,
};
use coordinator::analyses::what_if::{json, redistributed};
use coordinator::presentation::report::compare::ComparedStudy;
use coordinator::results::store::FurtherEvaluations;
use coordinator::study::{ObservedOutcome, Problem, SampleRequest, complete_outcomes, simulate_samples};
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
    /// Most evaluations to add; with 0 the optimum is not confirmed
    #[arg(long, value_name = "N", default_value = "100", value_parser = whole)]
    pub max_evaluations: usize,
    /// Write optimum.html, optimum.md, optimum.json, the scene.toml of the optimum and figures/ to this folder
    #[arg(long, value_name = "DIR")]
    pub out: Option<Destination>,
    #[command(flatten)]
    pub farm: FarmArguments,
}

/// Runs the command.
///
/// # Errors
/// [`super::CommandError`].
pub fn optimise(arguments: &OptimiseArguments, verbosity: Verbosity) -> Done {
    let mut opened = OpenedStudy::open(&arguments.dir, arguments.max_evaluations > 0)?;
    let base = opened.present()?;
    let file = InputFile::load(&arguments.problem)?;
    let space = opened.space.as_ref().map(|space| (space, opened.study.scene()));
    let problem = read_problem(&file, &base, space)?;
    let result = search(&mut opened, base.nominal(), &problem, arguments, verbosity)?;
    let sets = problem.settings(base.nominal(), &result.values).map_err(AnalysisError::from)?;
    let changed = redistributed(&base, &sets)?;
    let found = opened.ask(&base, &changed)?;
    let result = result.with_errors_of(&found.after, found.region.unknown_share());
    let mut document = json(&found, result.evaluations.added);
    document["optimum"] = serde_json::to_value(&result)?;
    let curves = [("study", found.before), ("optimum", found.after)]
        .map(|(name, summary)| ComparedStudy { name: name.to_owned(), summary });
    let mut answer = answer(&result, &opened.study.scene().name, curves.to_vec());
    answer.files.push(("scene.toml".to_owned(), changed.text().to_owned()));
    answer_with(&answer, &document, arguments.out.as_ref(), verbosity.json)
}

/// Finds the optimum from the design `base`, with simulations by the workers of the command.
fn search(
    opened: &mut OpenedStudy,
    base: &Scene,
    problem: &DesignProblem,
    arguments: &OptimiseArguments,
    verbosity: Verbosity,
) -> Done<OptimisationResult> {
    let basis = StudyBasis {
        problem: Problem::of_changed_scene(base, opened.study.scene()),
        settings: opened.settings.clone(),
        outcomes: complete_outcomes(opened.study.scene(), &opened.outcomes()?),
    };
    let mut say = |text| verbosity.say(text);
    if arguments.max_evaluations == 0 {
        return Ok(find(&basis, problem, 0, &mut |_| Ok(vec![]), &mut say)?);
    }
    let mut evaluator = opened.evaluator(&arguments.farm, verbosity.quiet)?;
    let correction = stored_correction(&opened.study.campaign, opened.study.scene())?;
    let OpenedStudy { study: StoredStudy { campaign, source, .. }, settings, .. } = opened;
    let mut journal = FurtherEvaluations(campaign);
    let mut next = basis.outcomes.len() as u64;
    let mut simulate = |requests: &[SampleRequest]| -> Result<Vec<ObservedOutcome>, AnalysisError> {
        let (scene, evaluator) = (source.nominal(), evaluator.evaluator());
        let numbered = (next, correction.as_ref());
        let found = simulate_samples(scene, settings, requests, numbered, evaluator, &mut journal)?;
        next += requests.len() as u64;
        Ok(found)
    };
    let result = find(&basis, problem, arguments.max_evaluations, &mut simulate, &mut say)?;
    evaluator.close();
    Ok(result)
}
