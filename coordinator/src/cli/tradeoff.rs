//! `coordinator tradeoff`: time against error of the accuracy settings of a scene, with the workers of a study.

use super::{
    CommandError, Done, FarmArguments, SceneArguments, Verbosity, WorkerFarm, accuracy_name, check_linkage,
    of_mechanism, positive, print,
};
use clap::{Args, ValueEnum};
use common::accuracy::NamedAccuracy;
use coordinator::analyses::tradeoff::{
    QUICK, TradeoffPlan, answer, compare, full, reference_row, settings, values_csv,
};
use coordinator::results::result_files::{create_folder, write_text};
use coordinator::statistics::design::nominal_and_random;
use std::path::PathBuf;

/// Set of accuracy settings to measure.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum SettingsGrid {
    /// Ten settings that trade time for error well
    Quick,
    /// All measured settings
    Full,
}

/// Arguments of `coordinator tradeoff`.
#[derive(Debug, Clone, Args)]
pub struct TradeoffArguments {
    #[command(flatten)]
    pub scene: SceneArguments,
    #[command(flatten)]
    pub farm: FarmArguments,
    /// Points of the random variables, the nominal one included
    #[arg(long, alias = "points", default_value = "3", value_name = "N", value_parser = positive, help_heading = "Method")]
    pub samples: usize,
    /// Settings to measure
    #[arg(long, value_enum, default_value = "full", help_heading = "Method")]
    pub settings: SettingsGrid,
    /// Measure this setting, and others by repeating the option: a preset, or one with changed parameters, e.g.
    /// draft+step-x0.71+jump-4000
    #[arg(long, value_name = "NAME", value_parser = accuracy_name(), hide_possible_values = true, conflicts_with = "settings", help_heading = "Method")]
    pub setting: Vec<NamedAccuracy>,
    /// Accuracy that all are compared with, e.g. reference+points-x4 for the effect of the control points
    #[arg(long, value_name = "NAME", default_value = "reference", value_parser = accuracy_name(), hide_possible_values = true, help_heading = "Method")]
    pub reference: NamedAccuracy,
    /// Folder for the results, created if missing
    #[arg(long, value_name = "DIR", help_heading = "Output")]
    pub out: Option<PathBuf>,
}

/// Runs the command.
///
/// # Errors
/// [`CommandError`].
pub fn tradeoff(arguments: &TradeoffArguments, verbosity: Verbosity) -> Done {
    let source = arguments.scene.load()?;
    let scene = source.nominal();
    check_linkage(source.origin(), &source, scene)?;
    arguments.out.as_deref().map(create_folder).transpose()?;
    let plan = TradeoffPlan {
        reference: arguments.reference.clone(),
        settings: chosen(arguments),
        points: nominal_and_random(scene, scene.study.seed, arguments.samples - 1),
    };
    // Every task carries its own accuracy.
    let accuracy = NamedAccuracy { name: "tradeoff".into(), ..NamedAccuracy::default() };
    let campaign = of_mechanism(&source, accuracy, &format!("tradeoff {plan:?}"));
    let mut farm = WorkerFarm::start(campaign, &arguments.farm, verbosity.quiet)?;
    let (measurement, end) = plan.measure(&mut farm.evaluator, &mut |text| verbosity.say(text));
    if end.is_ok() {
        farm.close();
    }
    // What is complete is written even if the rest is missing.
    if !measurement.reference.is_empty() {
        let rows = compare(scene, &plan.settings, &measurement);
        let reference = reference_row(scene, &plan.reference, &measurement);
        let answer = answer(scene, &rows, &reference, measurement.reference.len());
        if let Some(folder) = &arguments.out {
            let values = values_csv(scene, &plan.settings, &measurement);
            write_text(&folder.join("values.csv"), &values)?;
            answer.write(folder)?;
        }
        print(&answer.text())?;
    }
    end.map_err(CommandError::Evaluate)
}

/// The settings that the arguments select.
fn chosen(arguments: &TradeoffArguments) -> Vec<NamedAccuracy> {
    if !arguments.setting.is_empty() {
        return arguments.setting.clone();
    }
    let names: Vec<&str> = match arguments.settings {
        SettingsGrid::Quick => QUICK.to_vec(),
        SettingsGrid::Full => full().collect(),
    };
    settings(names).expect("every name of the grid is a setting")
}
