//! `coordinator calibrate`: fits free parameters of a scene to measured or published targets, with the workers of a study.

use super::{
    AccuracyArguments, Destination, Done, FarmArguments, SceneArguments, Verbosity, WorkerFarm, answer_with,
    check_linkage, of_mechanism, positive, seed, whole,
};
use clap::Args;
use common::scene::InputFile;
use coordinator::analyses::calibrate::{
    CalibrationSettings, Space, answer, calibrate as fit, of_parameters, read_targets,
};
use std::path::PathBuf;

/// Arguments of `coordinator calibrate`.
#[derive(Debug, Clone, Args)]
pub struct CalibrateArguments {
    #[command(flatten)]
    pub scene: SceneArguments,
    /// Free parameters and targets, TOML
    #[arg(long, value_name = "FILE")]
    pub targets: PathBuf,
    #[command(flatten)]
    pub farm: FarmArguments,
    #[command(flatten)]
    pub accuracy: AccuracyArguments,
    /// Evaluations of the first round [default: four per random variable and free parameter, at least 40]
    #[arg(long, alias = "simulations", value_name = "N", value_parser = positive, help_heading = "Method")]
    pub initial: Option<usize>,
    /// Further rounds around the optimum, each with a third as many evaluations
    #[arg(long, value_name = "N", default_value = "2", value_parser = whole, help_heading = "Method")]
    pub rounds: usize,
    /// Seed of every random draw
    #[arg(long, value_name = "N", default_value = "1", value_parser = seed, help_heading = "Method")]
    pub seed: u64,
    /// Write calibration.html, calibration.md and calibration.json to this folder, created if missing; or the report (Markdown, or JSON
    /// with --json) to this file, which ends in .md, .txt or .json, instead of standard output
    #[arg(long, value_name = "DIR", help_heading = "Output")]
    pub out: Option<Destination>,
}

/// Runs the command.
///
/// # Errors
/// [`super::CommandError`].
pub fn calibrate(arguments: &CalibrateArguments, verbosity: Verbosity) -> Done {
    let source = arguments.scene.load()?;
    let scene = source.nominal();
    check_linkage(source.origin(), &source, scene)?;
    let file = InputFile::load(&arguments.targets)?;
    let targets = read_targets(&file, &source)?;
    let space = Space::new(&source, &targets.free).map_err(|error| of_parameters(&file, &targets, error))?;
    let accuracy = arguments.accuracy.for_one(scene, verbosity.quiet)?.setting;
    let plan = CalibrationSettings {
        simulations: arguments.initial.unwrap_or(0),
        rounds: arguments.rounds,
        seed: arguments.seed,
        accuracy: accuracy.accuracy,
    };
    let campaign = of_mechanism(&space.source, accuracy, &format!("calibrate {plan:?} {targets:?}"));
    let mut farm = WorkerFarm::start(campaign, &arguments.farm, verbosity.quiet)?;
    let found = fit(&targets, &plan, &mut farm.evaluator, &space, &mut |text| verbosity.say(text))?;
    farm.close();
    answer_with(&answer(&found, &scene.name), &found, arguments.out.as_ref(), verbosity.json)
}
