//! `coordinator calibrate`: fits free parameters of a scene to measured or published targets, with the workers of a study.

use super::accuracy::AccuracyArguments;
use super::error::CommandError;
use super::farm::WorkerFarm;
use super::output::{check_destination, deliver, to_json};
use super::scenes::check_linkage;
use super::shared::{DEFAULT_SCENE, FarmArguments, Verbosity, positive, seed, whole};
use clap::Args;
use common::evaluation_shape::EvaluationShape;
use common::scene::{InputFile, SceneSource};
use coordinator::analyses::calibrate::{
    CalibrationProgress, CalibrationSettings, Space, calibrate as fit, markdown, of_parameters, read_targets,
};
use coordinator::farm::dispatch::CampaignSpec;
use coordinator::presentation::terminal::print_message;
use std::path::PathBuf;

/// Arguments of `coordinator calibrate`.
#[derive(Debug, Clone, Args)]
pub struct CalibrateArguments {
    /// Scene file, or name of a built-in scene
    #[arg(long, default_value = DEFAULT_SCENE, value_name = "NAME-or-FILE")]
    pub scene: String,
    /// Free parameters and targets, TOML
    #[arg(long, value_name = "FILE")]
    pub targets: PathBuf,
    #[command(flatten)]
    pub farm: FarmArguments,
    #[command(flatten)]
    pub accuracy: AccuracyArguments,
    /// Simulations of the first round [default: four per random variable and free parameter, at least 40]
    #[arg(long, value_name = "N", value_parser = positive, help_heading = "Method")]
    pub simulations: Option<usize>,
    /// Further rounds around the optimum, each with a third as many simulations
    #[arg(long, value_name = "N", default_value = "2", value_parser = whole, help_heading = "Method")]
    pub rounds: usize,
    /// Seed of every random draw
    #[arg(long, value_name = "N", default_value = "1", value_parser = seed, help_heading = "Method")]
    pub seed: u64,
    /// Write the report (Markdown, or JSON with --json) to this file instead of standard output
    #[arg(long, value_name = "FILE", help_heading = "Output")]
    pub out: Option<PathBuf>,
}

/// Runs the command.
///
/// # Errors
/// [`CommandError`].
pub fn calibrate(arguments: &CalibrateArguments, verbosity: Verbosity) -> Result<(), CommandError> {
    check_destination(arguments.out.as_deref())?;
    let source = SceneSource::load(&arguments.scene)?;
    let scene = source.nominal();
    if scene.simulator.is_some() {
        return Err(CommandError::NoMechanism { origin: source.origin().to_owned() });
    }
    check_linkage(source.origin(), &source, scene)?;
    let file = InputFile::load(&arguments.targets)?;
    let targets = read_targets(&file, &source)?;
    let space = Space::new(&source, &targets.free).map_err(|error| of_parameters(&file, &targets, error))?;
    let accuracy = arguments.accuracy.for_one(scene, verbosity.quiet)?.setting;
    let plan = CalibrationSettings {
        simulations: arguments.simulations.unwrap_or(0),
        rounds: arguments.rounds,
        seed: arguments.seed,
        accuracy: accuracy.accuracy,
    };
    let digest =
        common::scene::source::digest(&format!("calibrate {plan:?} {targets:?}\n{}", space.source.text()));
    let campaign = CampaignSpec {
        // The low half of a 128-bit hash is a 64-bit hash.
        id: digest as u64,
        scene: space.source.text().to_owned(),
        accuracy: accuracy.accuracy,
        accuracy_name: accuracy.name,
        build: Some(worker::BUILD),
        shape: Some(EvaluationShape::of(scene)),
        simulator: None,
        cross_check: None,
        resumed: false,
    };
    let mut farm = WorkerFarm::start(campaign, &arguments.farm)?;
    if !verbosity.quiet {
        farm.print_endpoints();
    }
    let report_progress = &mut |CalibrationProgress { round, done, all }: CalibrationProgress| {
        if !verbosity.quiet && (done == all || done % 10 == 0) {
            print_message(format_args!("round {round}: {done}/{all} simulations"));
        }
    };
    let found = fit(&targets, &plan, &mut farm.evaluator, &space, report_progress)?;
    farm.close();
    let text = if verbosity.json { to_json(&found)? } else { markdown(&found) };
    deliver(&text, arguments.out.as_deref())
}
