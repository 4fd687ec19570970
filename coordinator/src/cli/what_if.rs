//! `coordinator what-if`: the reliability of a finished study's scene with changed distributions and thresholds, from the
//! simulations that it has, and with further ones where the answer needs them.

use super::learn::confidence as confidence_level;
use super::{
    CommandError, Destination, Done, FarmArguments, OpenedStudy, Verbosity, answer_with, positive, share,
};
use clap::Args;
use coordinator::analyses::learn::{confident_figure, confident_parts};
use coordinator::analyses::what_if::{answer, changed_scene, json, redistributed};
use std::path::PathBuf;

pub const EXAMPLES: &str = "\
KEY is VARIABLE.mean, .std, .lower, .upper, .mode, .truncation or .distribution, LIMIT_STATE.threshold, .lower or \
.upper, correlation(VARIABLE,VARIABLE) or rank_correlation(VARIABLE,VARIABLE), each with a value as in a scene file. \
The answer has the reliability, the lives and the first failures before and after, and their changes with 95 % \
intervals. Without --max-evaluations and --target-error nothing is simulated. Further simulations are kept in the study for \
later questions; its own results do not change.

Examples:
  coordinator what-if study --set wear_coefficient.std='2 %' --set wear.threshold='9 um'
  coordinator what-if study --set friction.distribution=lognormal --set 'correlation(friction,clearance_crank)=0.5' --json
  coordinator what-if study --set wear_coefficient.mean='1.2e-13 1/Pa' --max-evaluations 20 --workers auto --out harder";

/// Most simulations of a direct study that surrogates are fitted to: the time grows with the third power of their number, and 2000
/// took more than ten minutes.
const MOST_OF_DIRECT: usize = 400;

/// Arguments of `coordinator what-if`.
#[derive(Debug, Clone, Args)]
pub struct WhatIfArguments {
    /// Folder of the finished study
    pub dir: PathBuf,
    /// Set a distribution, a threshold or a correlation; repeatable for different keys
    #[arg(long, value_name = "KEY=VALUE")]
    pub set: Vec<String>,
    /// Most evaluations of the changed scene to add, where they reduce the error of its reliability most
    #[arg(long, alias = "refine", value_name = "N", value_parser = positive)]
    pub max_evaluations: Option<usize>,
    /// Half width of the whole 95 % interval of every R(n) that the surrogates' part is to suit: adds at most --max-evaluations, or the
    /// study's budget
    #[arg(long, value_name = "SHARE", value_parser = share)]
    pub target_error: Option<f64>,
    /// Bounds of R and the lives at this confidence, with what the samples of measured variables leave open
    #[arg(long, value_name = "SHARE", value_parser = confidence_level)]
    pub confidence: Option<f64>,
    /// Points of the population [default: that of the study, at most 30000]
    #[arg(long, value_name = "N", value_parser = positive)]
    pub samples: Option<usize>,
    /// Write what-if.html, what-if.md, what-if.json, the changed scene.toml and figures/ to this folder, created if missing
    #[arg(long, value_name = "DIR")]
    pub out: Option<Destination>,
    #[command(flatten)]
    pub farm: FarmArguments,
}

/// Runs the command.
///
/// # Errors
/// [`CommandError`].
pub fn what_if(arguments: &WhatIfArguments, verbosity: Verbosity) -> Done {
    let WhatIfArguments { dir, set, max_evaluations, target_error, confidence, samples, out, farm } =
        arguments;
    let refines = max_evaluations.is_some() || target_error.is_some();
    let mut opened = OpenedStudy::open(dir, refines)?;
    let base = opened.present()?;
    // With design variables the question is about the design that the scene itself has, or about the one that is set.
    let changed = match &opened.space {
        None => changed_scene(&base, set)?,
        Some(space) => {
            let (design, others) = space.present(set)?;
            redistributed(&design, &others)?
        }
    };
    opened.settings.samples = samples.unwrap_or(opened.settings.samples);
    opened.settings.target_error = target_error.or(opened.settings.target_error);
    opened.settings.check(changed.nominal())?;
    let (known, method) = (opened.outcomes()?.len(), opened.study.settings.method);
    if !method.learns() && known > MOST_OF_DIRECT {
        let fault = format!(
            "this study of --method {} has {known} simulations, and the answer needs surrogates, which are fitted to at most \
             {MOST_OF_DIRECT}; start a study with --method ak",
            method.name()
        );
        return Err(CommandError::refused(dir.display(), fault));
    }
    if refines {
        let further = max_evaluations.unwrap_or(opened.settings.max_evaluations);
        let mut evaluator = opened.evaluator(farm, verbosity.quiet)?;
        opened.refine(changed.nominal(), further, &mut evaluator, verbosity.quiet)?;
        evaluator.close();
    }
    let found = opened.ask(&base, &changed)?;
    let added = found.simulations - known;
    let sets: String = set.iter().map(|set| format!(" --set '{set}'")).collect();
    let command = format!("coordinator what-if {}{sets}", dir.display());
    let mut answer = answer(&found, set, added, changed.nominal(), &command);
    answer.files.push(("scene.toml".to_owned(), changed.text().to_owned()));
    let mut as_json = json(&found, added);
    if let Some(confidence) = confidence {
        let confident = opened.confident(&changed, *confidence)?;
        let end = f64::from(changed.nominal().life.cycles);
        answer.parts.splice(1..1, confident_parts(&confident, end));
        answer.figures.push(confident_figure(&confident, &found.after.reliability, end));
        as_json["confident"] = serde_json::to_value(&confident)?;
    }
    answer_with(&answer, &as_json, out.as_ref(), verbosity.json)
}
