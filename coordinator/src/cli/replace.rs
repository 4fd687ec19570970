//! `coordinator replace`: the age, or the measured level, of replacement with the least cost, from a finished study.

use super::decision_error::DecisionError;
use super::error::CommandError;
use super::output::{check_destination, deliver, to_json};
use super::stored_study::{StoredStudy, summary_of};
use clap::Args;
use common::scene::Scene;
use coordinator::analyses::quantity::output_quantity;
use coordinator::analyses::replace::{
    InspectionPlan, Schedule, check_costs, inspect, replace as age_of_replacement, text,
};
use coordinator::statistics::replacement::{PolicyCosts, ReplacementCosts};
use coordinator::study::{LifeModel, Method, Settings, learn_from_results};
use std::path::PathBuf;

pub const EXAMPLES: &str = "\
Costs are in any currency; only their ratios decide. The cost of a failure is its total, with the replacement: run to failure costs \
failure cost / mean life per cycle. Intervals are 95 % intervals with every error that the study states. \
What lies beyond the last checkpoint is not known: it is stated as a bound. With --inspect-every or --inspect-at the study must \
have surrogates (--method ak), from which lives and measured values of 20 000 units follow.

Examples:
  coordinator replace study --failure-cost 10
  coordinator replace study --planned-cost 250 --failure-cost 4000 --curve wear --json
  coordinator replace study --failure-cost 10 --inspect-every 1000,2000 --inspect-cost 0.05 --inspect-error '0.5 um'
  coordinator replace study --failure-cost 10 --inspect-at 4500,5000,5500 --inspect-cost 0.02";

/// Population on which surrogates are assessed.
const SAMPLES: usize = 20_000;

/// Arguments of `coordinator replace`.
#[derive(Debug, Clone, Args)]
pub struct ReplaceArguments {
    /// Folder of the study
    pub dir: PathBuf,
    /// Cost of a planned replacement
    #[arg(long, value_name = "C", default_value = "1", value_parser = cost)]
    pub planned_cost: f64,
    /// Total cost of a failure, its replacement included, not a surcharge
    #[arg(long, value_name = "C", value_parser = cost)]
    pub failure_cost: f64,
    /// Failures that count: a limit state, or total
    #[arg(long, value_name = "NAME", default_value = "total")]
    pub curve: String,
    /// Inspect every N cycles and replace above a measured level; several distances with commas
    #[arg(long, value_name = "N,...", value_delimiter = ',', value_parser = cost, group = "schedule")]
    pub inspect_every: Vec<f64>,
    /// Inspect at these lives instead, increasing, with commas
    #[arg(long, value_name = "N,...", value_delimiter = ',', value_parser = cost, group = "schedule")]
    pub inspect_at: Vec<f64>,
    /// Cost of an inspection
    #[arg(long, value_name = "C", default_value = "0", value_parser = cost_or_zero, requires = "schedule")]
    pub inspect_cost: f64,
    /// Output that is measured [default: that of the limit states, if all have the same]
    #[arg(long, value_name = "OUTPUT", requires = "schedule")]
    pub inspect_output: Option<String>,
    /// Standard deviation of the measurement's error, with a unit [default: exact]
    #[arg(long, value_name = "QUANTITY", requires = "schedule")]
    pub inspect_error: Option<String>,
    /// Write the answer (text, or JSON with --json) to this file instead of standard output
    #[arg(long, value_name = "FILE")]
    pub out: Option<PathBuf>,
}

/// Reads a number above zero.
fn cost(text: &str) -> Result<f64, String> {
    let value = text.trim().parse::<f64>().ok().filter(|x| *x > 0.0 && x.is_finite());
    value.ok_or_else(|| "allowed: a number above 0".to_owned())
}

/// Reads a number from zero on.
fn cost_or_zero(text: &str) -> Result<f64, String> {
    let value = text.trim().parse::<f64>().ok().filter(|x| *x >= 0.0 && x.is_finite());
    value.ok_or_else(|| "allowed: a number >= 0".to_owned())
}

/// Runs the command.
///
/// # Errors
/// [`CommandError`].
pub fn replace(arguments: &ReplaceArguments, as_json: bool) -> Result<(), CommandError> {
    check_destination(arguments.out.as_deref())?;
    let costs = ReplacementCosts { planned: arguments.planned_cost, failure: arguments.failure_cost };
    check_costs(&costs).map_err(DecisionError::from)?;
    let study = StoredStudy::look(&arguments.dir)?;
    let summary = summary_of(&study.campaign)?;
    let mut report = age_of_replacement(&summary, &arguments.curve, &costs).map_err(DecisionError::from)?;
    if !(arguments.inspect_every.is_empty() && arguments.inspect_at.is_empty()) {
        let plan = plan(arguments, study.scene())?;
        let model = life_model(&study)?;
        report.inspections =
            inspect(study.scene(), &model, &plan, study.settings.seed).map_err(DecisionError::from)?;
    }
    let text = if as_json { to_json(&report)? } else { text(&report, study.scene()) };
    deliver(&text, arguments.out.as_deref())
}

/// The predictor of lives by the surrogates of a finished study.
///
/// # Errors
/// [`DecisionError::NoSurrogates`], or the error of the campaign file or the surrogates.
pub fn life_model(study: &StoredStudy) -> Result<LifeModel, CommandError> {
    let dir = study.campaign.dir().to_path_buf();
    if study.settings.method != Method::ActiveLearning {
        let method = study.settings.method.name().to_owned();
        return Err(DecisionError::NoSurrogates { dir, method }.into());
    }
    // The surrogates are wanted, not the curves of the whole population.
    let settings = Settings { samples: study.settings.samples.min(SAMPLES), ..study.settings.clone() };
    let learned = learn_from_results(study.scene(), study.scene(), &settings, &study.outcomes()?)
        .map_err(|error| CommandError::of_study(error, &dir))?;
    Ok(LifeModel::new(study.scene(), &learned))
}

/// The inspections asked for.
fn plan(arguments: &ReplaceArguments, scene: &Scene) -> Result<InspectionPlan, DecisionError> {
    let names = || scene.outputs.iter().map(|output| output.name.as_str()).collect::<Vec<_>>().join(", ");
    let fault = |option, value: &str, fault| DecisionError::Option { option, value: value.to_owned(), fault };
    let output = match &arguments.inspect_output {
        Some(name) => scene.outputs.iter().position(|output| output.name == *name).ok_or_else(|| {
            fault("--inspect-output", name, format!("this study has no such output; allowed: {}", names()))
        })?,
        None => {
            let first = scene.limit_states[0].output;
            if scene.limit_states.iter().any(|limit| limit.output != first) {
                let missing = format!("the limit states have several outputs, name one of {}", names());
                return Err(fault("--inspect-output", "(none)", missing));
            }
            first
        }
    };
    let error = match &arguments.inspect_error {
        None => 0.0,
        Some(text) => {
            let read = output_quantity(&scene.outputs[output], text);
            let positive =
                read.and_then(
                    |error| if error >= 0.0 { Ok(error) } else { Err("allowed: 0 or above".to_owned()) },
                );
            positive.map_err(|what| fault("--inspect-error", text, what))?
        }
    };
    let costs = PolicyCosts {
        planned: arguments.planned_cost,
        failure: arguments.failure_cost,
        inspection: arguments.inspect_cost,
    };
    let given = (!arguments.inspect_at.is_empty()).then(|| Schedule::At(arguments.inspect_at.clone()));
    let schedules =
        arguments.inspect_every.iter().map(|every| Schedule::Every(*every)).chain(given).collect();
    // The name of the curve has been checked: that of a limit state, or `total`.
    let limit_state = scene.limit_states.iter().position(|limit| limit.name == arguments.curve);
    Ok(InspectionPlan { limit_state, output, error, schedules, costs })
}
