//! `coordinator test-plan`: units and cycles of a test that demonstrates a reliability.

use super::shared::{above_zero, within};
use super::{CommandError, Destination, Done, OpenedStudy, answer_with, probability};
use clap::Args;
use coordinator::analyses::test_plan::{TestPlanQuestion, answer, plan};
use std::path::PathBuf;

pub const EXAMPLES: &str = "\
Without a study the plans are those of textbooks: without failures ln(1 - C) / ln R units. With a study its reliability at the life is \
prior knowledge, which saves units, and its lives give the Weibull shape for shorter and longer tests.

Examples:
  coordinator test-plan --reliability 0.99 --at 50000 --confidence 90%
  coordinator test-plan --reliability 0.99 --at 50000 --units 20 --shape 2.5
  coordinator test-plan --reliability 0.99 --at 50000 --shape 2.5 --group 5 --inspect-every 10000
  coordinator test-plan study --reliability 0.99 --at 50000 --prior-units 100 --json";

/// Arguments of `coordinator test-plan`.
#[derive(Debug, Clone, Args)]
pub struct TestPlanArguments {
    /// Folder of a finished study: prior of R and shape of the lives
    pub dir: Option<PathBuf>,
    /// Reliability to be demonstrated
    #[arg(long, value_name = "R", value_parser = probability)]
    pub reliability: f64,
    /// Life at which it is [cycles]
    #[arg(long, value_name = "CYCLES", value_parser = above_zero)]
    pub at: f64,
    /// Confidence of the demonstration
    #[arg(long, value_name = "SHARE", default_value = "90%", value_parser = probability)]
    pub confidence: f64,
    /// Plans with up to this many failures
    #[arg(long, value_name = "N", default_value = "2", value_parser = within::<u64>(0, 20))]
    pub allowed: u64,
    /// Lengths of the test, several with commas [default: the life; with a shape 0.5, 1, 1.5 and 2 lives]
    #[arg(long, value_name = "CYCLES,...", value_delimiter = ',', value_parser = above_zero, conflicts_with = "units")]
    pub length: Vec<f64>,
    /// Seek the length of the test for this number of units
    #[arg(long, value_name = "N", value_parser = within::<u64>(1, 1_000_000))]
    pub units: Option<u64>,
    /// Weibull shape of the lives [default: that of the study]
    #[arg(long, value_name = "B", value_parser = above_zero)]
    pub shape: Option<f64>,
    /// Sudden death too: groups of N units, each up to its first failure
    #[arg(long, value_name = "N", value_parser = within::<u64>(1, 1_000_000))]
    pub group: Option<u64>,
    /// Inspect every N cycles: state the mean length of a test that ends with too many failures
    #[arg(long, value_name = "CYCLES", value_parser = above_zero)]
    pub inspect_every: Option<f64>,
    /// Failures of the study that count: a limit state, or total
    #[arg(long, value_name = "NAME", default_value = "total", requires = "dir")]
    pub curve: String,
    /// Most units that the study is worth as prior [default: what its interval says]
    #[arg(long, value_name = "N", value_parser = above_zero, requires = "dir")]
    pub prior_units: Option<f64>,
    /// Write test-plan.html, test-plan.md and test-plan.json to this folder, created if missing; or the answer to this file
    #[arg(long, value_name = "DIR")]
    pub out: Option<Destination>,
}

/// Runs the command.
///
/// # Errors
/// [`CommandError`].
pub fn test_plan(arguments: &TestPlanArguments, as_json: bool) -> Done {
    let summary = arguments
        .dir
        .as_ref()
        .map(|dir| OpenedStudy::of_units(dir))
        .transpose()?
        .map(|opened| opened.summary);
    let question = TestPlanQuestion {
        reliability: arguments.reliability,
        at: arguments.at,
        confidence: arguments.confidence,
        allowed: arguments.allowed,
        lengths: arguments.length.clone(),
        units: arguments.units,
        shape: arguments.shape,
        group: arguments.group,
        inspect_every: arguments.inspect_every,
        prior_units: arguments.prior_units.unwrap_or(f64::INFINITY),
    };
    let study = summary.as_ref().map(|summary| (summary, arguments.curve.as_str()));
    let report = plan(&question, study).map_err(CommandError::bad_input)?;
    answer_with(&answer(&report), &report, arguments.out.as_ref(), as_json)
}
