//! `coordinator update`: reliability and remaining life of single units from what was measured of them.

use super::error::CommandError;
use super::output::{print, to_json};
use super::replace::life_model;
use super::shared::positive;
use super::stored_study::{StoredStudy, summary_of};
use clap::Args;
use coordinator::analyses::update::{
    FleetReport, FleetSettings, csv, read_units, text, update as update_fleet,
};
use coordinator::presentation::report::ReportError;
use coordinator::presentation::report::fleet::{DrawnUnit, FleetPage, html};
use coordinator::results::result_files::write_text;
use std::path::{Path, PathBuf};

pub const EXAMPLES: &str = "\
The file has one observation a line: unit, cycles, quantity, value, standard deviation of its error. The quantity is an output \
or a random variable of the scene with a unit, or `survived` or `failed`, which have no value:

  unit, cycles, quantity,       value,    error
  A7,   30000,  max_wear_depth, 15.2 um,  0.5 um
  A7,   0,      rod_length,     40.05 mm, 2 um
  A7,   34000,  survived
  A8,   28000,  failed

Nothing is simulated: the surrogates of the study answer, which must be one of --method ak.

Examples:
  coordinator update study --measured units.csv
  coordinator update study --measured units.csv --json
  coordinator update study --measured units.csv --out fleet --particles 10000";

/// Arguments of `coordinator update`.
#[derive(Debug, Clone, Args)]
pub struct UpdateArguments {
    /// Folder of the study
    pub dir: PathBuf,
    /// Observations of the units, CSV
    #[arg(long, value_name = "FILE.csv")]
    pub measured: PathBuf,
    /// Points of the population that are weighted; an effective sample size below a fortieth of it starts sequential Monte Carlo
    #[arg(long, value_name = "N", default_value = "20000", value_parser = many)]
    pub points: usize,
    /// Particles of sequential Monte Carlo
    #[arg(long, value_name = "N", default_value = "2000", value_parser = many)]
    pub particles: usize,
    /// Write update.html, update.json and units.csv to this folder, created if missing
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
}

/// Least number of points or particles.
const LEAST: usize = 500;
/// Share of the points that the effective sample size must keep [1].
const KEPT: f64 = 0.025;

/// Reads a number of points.
fn many(text: &str) -> Result<usize, String> {
    let found = positive(text).ok().filter(|n| (LEAST..=1_000_000).contains(n));
    found.ok_or_else(|| format!("allowed: a whole number from {LEAST} to 1000000"))
}

/// Runs the command.
///
/// # Errors
/// [`CommandError`].
pub fn update(arguments: &UpdateArguments, as_json: bool) -> Result<(), CommandError> {
    let study = StoredStudy::look(&arguments.dir)?;
    let summary = summary_of(&study.campaign)?;
    let model = life_model(&study)?;
    let units = read_units(&arguments.measured, &study.source, &model)?;
    let mut settings = FleetSettings::new(study.settings.seed);
    settings.population = arguments.points;
    settings.monte_carlo.particles = arguments.particles;
    settings.monte_carlo.least = KEPT * arguments.points as f64;
    let report = update_fleet(study.scene(), &summary, &model, &units, &settings);
    if let Some(out) = &arguments.out {
        write_files(&report, out)?;
    }
    if as_json { print(&to_json(&report)?) } else { print(&text(&report)) }
}

fn write_files(report: &FleetReport, out: &Path) -> Result<(), CommandError> {
    std::fs::create_dir_all(out).map_err(|error| CommandError::Folder { path: out.to_path_buf(), error })?;
    let unit = |unit: &coordinator::analyses::update::UnitReport| DrawnUnit {
        name: unit.unit.clone(),
        observed_until: unit.observed_until,
        failed: unit.failed_by.is_some() || !unit.resolved,
        remaining: [unit.remaining.p5, unit.remaining.p50, unit.remaining.p95],
        curve: unit.reliability.iter().map(|row| (f64::from(row.cycles), row.reliability["total"])).collect(),
        effective_size: unit.effective_size,
        warning: unit.warning.clone(),
    };
    let page = FleetPage {
        scene: report.scene.clone(),
        end: report.end,
        before: report
            .reliability
            .iter()
            .map(|row| (f64::from(row.cycles), row.reliability["total"]))
            .collect(),
        units: report.units.iter().map(unit).collect(),
    };
    write_text(&out.join("update.html"), &html(&page).map_err(ReportError::from)?)?;
    write_text(&out.join("update.json"), &to_json(report)?)?;
    Ok(write_text(&out.join("units.csv"), &csv(report))?)
}
