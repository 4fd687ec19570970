//! `coordinator learn`: parameters of a population from what was observed of its units, and R at a confidence.

use super::shared::within;
use super::{
    CommandError, Destination, Done, FarmArguments, OpenedStudy, Verbosity, answer_with, positive, share,
};
use clap::Args;
use coordinator::analyses::designs::DesignSpace;
use coordinator::analyses::learn::{
    LearnReport, LearnSettings, answer, hold_known, learn as learn_fleet, scene_of_units,
};
use coordinator::analyses::update::read_fleet;
use coordinator::statistics::design::{InputModel, fixed_bounds};
use std::path::PathBuf;

pub const EXAMPLES: &str = "\
The file has one observation a line, as that of `update`: unit, cycles, quantity, value, standard deviation of its error. A failure has \
as value the limit state and as error that of its life, where they are known. Rows of the unit `population` name what is not known: \
VARIABLE.mean, VARIABLE.std, correlation(A B) or a design variable of the study, with value and standard deviation of its prior, or \
without both for a flat one. Rows of the unit `price` have as value what one more unit run to failure (`failed`), or one measured value, costs:

  unit,       cycles, quantity,       value,    error
  population, ,       friction.mean,  0.05,     0.01
  population, ,       friction.std
  A7,         61200,  failed,         wear,     100
  A8,         40000,  survived
  A9,         30000,  max_wear_depth, 15.2 um,  0.5 um
  A9,         0,      rod_length,     40.05 mm, 2 um
  A9,         50000,  survived
  A9,         55000,  failed
  price,      ,       failed,         1200

The surrogates of the study answer, which must be one of --method ak. Without --max-evaluations nothing is simulated.

Examples:
  coordinator learn study --data fleet.csv
  coordinator learn study --data fleet.csv --confidence 95% --json
  coordinator learn study --data fleet.csv --max-evaluations 20 --workers auto --out population";

/// Arguments of `coordinator learn`.
#[derive(Debug, Clone, Args)]
pub struct LearnArguments {
    /// Folder of the study
    pub dir: PathBuf,
    /// Observations of the units, CSV
    #[arg(long, value_name = "FILE.csv")]
    pub data: PathBuf,
    /// Confidence of the bounds
    #[arg(long, value_name = "SHARE", default_value = "90%", value_parser = confidence)]
    pub confidence: f64,
    /// Sets of parameters of sequential Monte Carlo
    #[arg(long, value_name = "N", default_value = "500", value_parser = within::<usize>(200, 20_000))]
    pub sets: usize,
    /// Most evaluations to add where the population that was learned leaves those of the study
    #[arg(long, alias = "refine", value_name = "N", value_parser = positive)]
    pub max_evaluations: Option<usize>,
    /// Write learn.html, learn.md, learn.json, reliability.csv and figures/ to this folder, created if missing
    #[arg(long, value_name = "DIR")]
    pub out: Option<Destination>,
    #[command(flatten)]
    pub farm: FarmArguments,
}

/// Reads a confidence.
pub fn confidence(text: &str) -> Result<f64, String> {
    let read = share(text).ok().filter(|c| (0.5..=0.999).contains(c));
    read.ok_or_else(|| "allowed: a confidence from 50% to 99.9%, e.g. 90%".to_owned())
}

/// Runs the command.
///
/// # Errors
/// [`CommandError`].
pub fn learn(arguments: &LearnArguments, verbosity: Verbosity) -> Done {
    let mut opened = OpenedStudy::open(&arguments.dir, arguments.max_evaluations.is_some())?;
    let mut report = learned(&opened, arguments)?;
    if let Some(further) = arguments.max_evaluations {
        let before = report.confident.clone();
        let mut evaluator = opened.evaluator(&arguments.farm, verbosity.quiet)?;
        let mut added = 0;
        // What is learned moves with the simulations.
        while added < further {
            let scene = report.scene_of_one_more(opened.study.scene());
            let new = opened.refine(&scene, further - added, &mut evaluator, verbosity.quiet)?;
            if new == 0 {
                break;
            }
            added += new;
            report = learned(&opened, arguments)?;
            (report.evaluations, report.before) = (added, Some(before.clone()));
        }
        evaluator.close();
    }
    answer_with(&answer(&report), &report, arguments.out.as_ref(), verbosity.json)
}

/// What the data say by all simulations that the study has.
fn learned(opened: &OpenedStudy, arguments: &LearnArguments) -> Done<LearnReport> {
    let present = opened.present()?;
    let model = opened.life_model()?;
    let (studied, summary) = (opened.study.scene(), &opened.summary);
    let (mut scene, designs) = scene_of_units(studied, present.nominal());
    let mut model = model.redistributed(InputModel::from_scene(&scene));
    let data = read_fleet(&arguments.data, &opened.study.source, &model, Some(&designs))?;
    let unknown = hold_known(&mut scene, present.nominal(), &designs, &data.unknown);
    let followers = opened.space.as_ref().map_or(Ok(vec![]), DesignSpace::followers)?;
    if let Some(follower) = followers.iter().find(|follower| unknown.contains(&follower.leader)) {
        let [follower, leader] = [follower.variable, follower.leader].map(|k| &scene.variables[k].name);
        let fault = format!(
            "{follower} follows {leader}, which cannot be unknown then; name others in rows of the unit `population`, and it has the value \
             of the scene"
        );
        return Err(CommandError::refused(arguments.data.display(), fault));
    }
    model = model.redistributed(InputModel::from_scene(&scene));
    let mut settings = LearnSettings::new(opened.study.settings.seed);
    settings.sets = arguments.sets;
    settings.confidence = arguments.confidence;
    learn_fleet(&scene, summary, model, &data, &designs, &fixed_bounds(&opened.study.source), &settings)
        .map_err(|error| CommandError::refused(arguments.data.display(), error.to_string()))
}
