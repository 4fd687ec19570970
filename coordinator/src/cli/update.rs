//! `coordinator update`: reliability and remaining life of single units from what was measured of them.

use super::shared::within;
use super::{Destination, Done, OpenedStudy, answer_with};
use clap::Args;
use coordinator::analyses::update::{FleetSettings, answer, read_fleet, update as update_fleet};
use std::path::PathBuf;

pub const EXAMPLES: &str = "\
The file has one observation a line: unit, cycles, quantity, value, standard deviation of its error. The quantity is an output \
or a random variable of the scene with a unit, or `survived`, which has no value, or `failed`, which may have the limit state and the \
error of the life:

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
    #[arg(long, alias = "points", value_name = "N", default_value = "20000", value_parser = within(LEAST, 1_000_000))]
    pub samples: usize,
    /// Particles of sequential Monte Carlo
    #[arg(long, value_name = "N", default_value = "2000", value_parser = within(LEAST, 1_000_000))]
    pub particles: usize,
    /// Write update.html, update.md, update.json, units.csv and figures/ to this folder, created if missing
    #[arg(long, value_name = "DIR")]
    pub out: Option<Destination>,
}

/// Least number of points or particles.
const LEAST: usize = 500;
/// Share of the points that the effective sample size must keep [1].
const KEPT: f64 = 0.025;

/// Runs the command.
///
/// # Errors
/// [`super::CommandError`].
pub fn update(arguments: &UpdateArguments, as_json: bool) -> Done {
    let opened = OpenedStudy::of_units(&arguments.dir)?;
    let model = opened.model_of_units()?;
    let OpenedStudy { study, summary, .. } = &opened;
    let units = read_fleet(&arguments.measured, &study.source, &model, None)?.units;
    let mut settings = FleetSettings::new(study.settings.seed);
    settings.population = arguments.samples;
    settings.monte_carlo.particles = arguments.particles;
    settings.monte_carlo.least = KEPT * arguments.samples as f64;
    let report = update_fleet(study.scene(), summary, &model, &units, &settings);
    answer_with(&answer(&report), &report, arguments.out.as_ref(), as_json)
}
