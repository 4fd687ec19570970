//! `coordinator replace`: the age, or the measured level, of replacement with the least cost, from a finished study.

use super::shared::above_zero;
use super::{CommandError, Destination, Done, OpenedStudy, answer_with, probability, value};
use clap::Args;
use common::scene::Scene;
use coordinator::analyses::quantity::output_quantity;
use coordinator::analyses::replace::{
    InspectionPlan, Schedule, answer, check_costs, inspect, replace as age_of_replacement,
};
use coordinator::statistics::replacement::{PolicyCosts, ReplacementCosts};
use std::path::PathBuf;

pub const EXAMPLES: &str = "\
Costs are in any currency; only their ratios decide. The cost of a failure is its total, with the replacement: run to failure costs \
failure cost / mean life per cycle. Intervals are 95 % intervals with every error that the study states. \
What lies beyond the last checkpoint is not known: it is stated as a bound. With --inspect-every or --inspect-at the study must \
have surrogates (--method ak), from which lives and measured values of 20 000 units follow.

Examples:
  coordinator replace study --failure-cost 10
  coordinator replace study --failure-cost 10 --reliability 0.99 --confidence 95%
  coordinator replace study --planned-cost 250 --failure-cost 4000 --curve wear --json
  coordinator replace study --failure-cost 10 --inspect-every 1000,2000 --inspect-cost 0.05 --inspect-error '0.5 um'
  coordinator replace study --failure-cost 10 --inspect-at 4500,5000,5500 --inspect-cost 0.02";

/// Arguments of `coordinator replace`.
#[derive(Debug, Clone, Args)]
pub struct ReplaceArguments {
    /// Folder of the study
    pub dir: PathBuf,
    /// Cost of a planned replacement
    #[arg(long, value_name = "C", default_value = "1", value_parser = above_zero)]
    pub planned_cost: f64,
    /// Total cost of a failure, its replacement included, not a surcharge
    #[arg(long, value_name = "C", value_parser = above_zero)]
    pub failure_cost: f64,
    /// Failures that count: a limit state, or total
    #[arg(long, value_name = "NAME", default_value = "total")]
    pub curve: String,
    /// Least reliability at the age of replacement, e.g. 0.99
    #[arg(long, value_name = "R", value_parser = probability)]
    pub reliability: Option<f64>,
    /// Confidence with which it is to hold, over the errors of the study
    #[arg(long, value_name = "SHARE", default_value = "90%", value_parser = probability, requires = "reliability")]
    pub confidence: f64,
    /// Inspect every N cycles and replace above a measured level; several distances with commas
    #[arg(long, value_name = "CYCLES,...", value_delimiter = ',', value_parser = above_zero, group = "schedule")]
    pub inspect_every: Vec<f64>,
    /// Inspect at these lives instead, increasing, with commas
    #[arg(long, value_name = "CYCLES,...", value_delimiter = ',', value_parser = above_zero, group = "schedule")]
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
    /// Write replace.html, replace.md and replace.json to this folder, created if missing; or the answer (text, or JSON with --json) to
    /// this file, which ends in .txt, .md or .json, instead of standard output
    #[arg(long, value_name = "DIR")]
    pub out: Option<Destination>,
}

/// Reads a number from zero on.
fn cost_or_zero(text: &str) -> Result<f64, String> {
    value(text, "a number >= 0", |x: &f64| *x >= 0.0 && x.is_finite())
}

/// Runs the command.
///
/// # Errors
/// [`CommandError`].
pub fn replace(arguments: &ReplaceArguments, as_json: bool) -> Done {
    let costs = ReplacementCosts { planned: arguments.planned_cost, failure: arguments.failure_cost };
    check_costs(&costs).map_err(CommandError::bad_input)?;
    let opened = OpenedStudy::of_units(&arguments.dir)?;
    let OpenedStudy { study, summary, .. } = &opened;
    let confidence = arguments.confidence;
    let demand = arguments.reliability.map(|reliability| (reliability, confidence));
    let mut report =
        age_of_replacement(summary, &arguments.curve, &costs, demand).map_err(CommandError::bad_input)?;
    if !(arguments.inspect_every.is_empty() && arguments.inspect_at.is_empty()) {
        let plan = plan(arguments, study.scene())?;
        report.inspections = inspect(study.scene(), &opened.model_of_units()?, &plan, study.settings.seed)
            .map_err(CommandError::bad_input)?;
    }
    answer_with(&answer(&report, study.scene()), &report, arguments.out.as_ref(), as_json)
}

/// The inspections asked for.
fn plan(arguments: &ReplaceArguments, scene: &Scene) -> Done<InspectionPlan> {
    let names: Vec<&str> = scene.outputs.iter().map(|output| output.name.as_str()).collect();
    let refused = |option: &str, value: &str, fault: String| {
        CommandError::refused(format_args!("{option} {value}"), fault)
    };
    let (given, first) = (&arguments.inspect_output, scene.limit_states[0].output);
    let (output, fault) = match given {
        Some(name) => (names.iter().position(|own| own == name), "this study has no such output; allowed:"),
        None => {
            let is_same = scene.limit_states.iter().all(|limit| limit.output == first);
            (is_same.then_some(first), "the limit states have several outputs, name one of")
        }
    };
    let output = output.ok_or_else(|| {
        let value = given.as_deref().unwrap_or("(none)");
        refused("--inspect-output", value, format!("{fault} {}", names.join(", ")))
    })?;
    let error = match &arguments.inspect_error {
        None => 0.0,
        Some(text) => output_quantity(&scene.outputs[output], text)
            .and_then(|error| if error >= 0.0 { Ok(error) } else { Err("allowed: 0 or above".to_owned()) })
            .map_err(|fault| refused("--inspect-error", text, fault))?,
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
