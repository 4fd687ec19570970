//! `coordinator tradeoff`: time against error of the accuracy settings of a scene, with the workers of a study.

use super::error::CommandError;
use super::farm::WorkerFarm;
use super::output::print;
use super::scenes::check_linkage;
use super::shared::{DEFAULT_SCENE, FarmArguments, Verbosity, positive};
use clap::{Args, ValueEnum};
use common::accuracy::NamedAccuracy;
use common::evaluation_shape::EvaluationShape;
use common::scene::SceneSource;
use coordinator::analyses::tradeoff::{
    Measurement, QUICK, TradeoffPlan, TradeoffProgress, compare, csv, figures, full, reference_row, settings,
    table, values_csv,
};
use coordinator::farm::dispatch::CampaignSpec;
use coordinator::presentation::report::ReportError;
use coordinator::presentation::terminal::print_message;
use coordinator::results::result_files::write_text;
use coordinator::statistics::design::nominal_and_random;
use std::path::{Path, PathBuf};

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
    /// Scene file, or name of a built-in scene
    #[arg(long, default_value = DEFAULT_SCENE, value_name = "NAME-or-FILE")]
    pub scene: String,
    #[command(flatten)]
    pub farm: FarmArguments,
    /// Number of points of the variables, the nominal one included
    #[arg(long, default_value = "3", value_name = "N", value_parser = positive, help_heading = "Method")]
    pub points: usize,
    /// Settings to measure
    #[arg(long, value_enum, default_value = "full", help_heading = "Method")]
    pub settings: SettingsGrid,
    /// Measure this setting, and others by repeating the option: a preset, or one with changed parameters, e.g.
    /// draft+step-x0.71+jump-4000
    #[arg(long, value_name = "NAME", conflicts_with = "settings", help_heading = "Method")]
    pub setting: Vec<NamedAccuracy>,
    /// Folder for the results, created if missing
    #[arg(long, value_name = "DIR", help_heading = "Output")]
    pub out: PathBuf,
}

/// Runs the command.
///
/// # Errors
/// [`CommandError`].
pub fn tradeoff(arguments: &TradeoffArguments, verbosity: Verbosity) -> Result<(), CommandError> {
    let source = SceneSource::load(&arguments.scene)?;
    let scene = source.nominal();
    check_linkage(source.origin(), &source, scene)?;
    std::fs::create_dir_all(&arguments.out)
        .map_err(|error| CommandError::Folder { path: arguments.out.clone(), error })?;
    let plan = TradeoffPlan {
        settings: chosen(arguments),
        points: nominal_and_random(scene, scene.study.seed, arguments.points - 1),
    };
    let mut farm = WorkerFarm::start(announced(&source, &plan), &arguments.farm)?;
    if !verbosity.quiet {
        farm.print_endpoints();
    }
    let (measurement, end) =
        plan.measure(&mut farm.evaluator, &mut |TradeoffProgress { done, all, setting, point, seconds }| {
            if !verbosity.quiet {
                print_message(format_args!(
                    "{done}/{all} evaluations: {setting} at point {point}, {seconds:.2} s"
                ));
            }
        });
    if end.is_ok() {
        farm.close();
    }
    // What is complete is written even if the rest is missing.
    if measurement.points > 0 {
        let text = write(&arguments.out, &source, &plan.settings, &measurement)?;
        print(&text)?;
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

/// The campaign as announced to workers: every task carries its own accuracy; the id is a digest of the plan.
fn announced(source: &SceneSource, plan: &TradeoffPlan) -> CampaignSpec {
    let NamedAccuracy { accuracy, .. } = NamedAccuracy::default();
    let digest = common::scene::source::digest(&format!("tradeoff {plan:?}\n{}", source.text()));
    // The low half of a 128-bit hash is a 64-bit hash.
    CampaignSpec {
        id: digest as u64,
        scene: source.text().to_owned(),
        accuracy,
        accuracy_name: "tradeoff".into(),
        build: Some(worker::BUILD),
        shape: Some(EvaluationShape::of(source.nominal())),
        simulator: None,
        cross_check: None,
        resumed: false,
    }
}

/// Writes the files; returns the text of the page.
fn write(
    dir: &Path,
    source: &SceneSource,
    settings: &[NamedAccuracy],
    measurement: &Measurement,
) -> Result<String, CommandError> {
    let scene = source.nominal();
    let rows = compare(scene, settings, measurement);
    let text = table(scene, &rows, &reference_row(scene, measurement), measurement.points);
    write_text(&dir.join("tradeoff.md"), &text)?;
    write_text(&dir.join("tradeoff.csv"), &csv(scene, &rows))?;
    write_text(&dir.join("values.csv"), &values_csv(scene, settings, measurement))?;
    for (name, svg) in figures(scene, &rows).map_err(ReportError::from)? {
        write_text(&dir.join(format!("{name}.svg")), &svg)?;
    }
    Ok(text)
}
