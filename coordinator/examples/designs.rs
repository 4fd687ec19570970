//! One study of all designs against a study of each: lives at five values of a design variable, and the simulations that
//! both took.
//!
//! ```sh
//! cargo run --release -p coordinator --example designs -- --scene four-bar --design 'parameters.clearance=18 um..30 um'
//! ```
//!
//! The study of all designs is refined until every one of the five reaches the target error of a study. Two lives agree if
//! they differ by at most the root of the sum of squares of the halves of their 95 % intervals on the sides that face each
//! other.

use clap::Parser;
use common::failure::SimulationFailure;
use common::scene::{Faults, SceneSource};
use coordinator::analyses::designs::{DesignSpace, DesignStudy, answers, refine};
use coordinator::analyses::error::AnalysisError;
use coordinator::farm::evaluate::{Finished, Request, local::LocalEvaluator};
use coordinator::results::journal::InMemoryJournal;
use coordinator::results::life_summary::LifeRow;
use coordinator::results::progress::Silent;
use coordinator::study::{
    FinerLevels, FurtherLearning, Observed, Settings, StoredOutcome, StudyAccuracy, run,
};
use std::error::Error;
use worker::simulate::{SimulateOptions, simulate};

/// Compare one study of all designs with a study of each
#[derive(Debug, Parser)]
struct Arguments {
    /// Scene file, or name of a built-in scene
    #[arg(long, default_value = "four-bar")]
    scene: String,
    /// Design variable, KEY=LOWER..UPPER; repeatable
    #[arg(long, default_value = "parameters.clearance=18 um..30 um")]
    design: Vec<String>,
    /// Designs per variable that are compared
    #[arg(long, default_value = "5")]
    points: usize,
    /// Accuracy of the simulations
    #[arg(long, default_value = "draft")]
    accuracy: String,
    /// Seed of the study of all designs; the separate ones have the next ones
    #[arg(long, default_value = "101")]
    seed: u64,
    /// Threads that simulate
    #[arg(long, default_value = "2")]
    threads: usize,
}

type Outcome = Result<common::outputs::Evaluation, SimulationFailure>;

/// The simulation of a scene's samples.
fn simulation(
    source: &SceneSource,
    settings: &Settings,
) -> impl Fn(&Request) -> Outcome + Send + Sync + 'static {
    let (source, accuracy) = (source.clone(), settings.accuracy.setting.accuracy);
    let invalid = |faults: Faults| SimulationFailure::InvalidSample { faults: faults.to_string() };
    move |request| {
        let scene = source.resolve_sample(&request.sample).map_err(invalid)?;
        simulate(&scene, &request.accuracy.unwrap_or(accuracy), SimulateOptions::default())
    }
}

fn known(journal: &InMemoryJournal) -> Vec<StoredOutcome> {
    let stored = |(sample, finished): &(Vec<f64>, Finished)| StoredOutcome {
        sample: sample.clone(),
        outcome: finished.outcome.clone().map(Observed::from_evaluation),
    };
    journal.outcomes().values().map(stored).collect()
}

/// Difference of two lives [cycles] and the difference within which they agree; `None` if both lie beyond the life studied.
fn difference(a: &LifeRow, b: &LifeRow) -> Option<(f64, f64)> {
    let (life_a, life_b) = (a.cycles?, b.cycles?);
    let reach = |of: &LifeRow, life: f64, up: bool| {
        if up {
            of.interval.upper.map_or(f64::INFINITY, |upper| upper - life)
        } else {
            life - of.interval.lower
        }
    };
    let up = life_b > life_a;
    Some((life_b - life_a, reach(a, life_a, up).hypot(reach(b, life_b, !up))))
}

fn main() -> Result<(), Box<dyn Error>> {
    let arguments = Arguments::parse();
    let base = SceneSource::load(&arguments.scene)?;
    let space = DesignSpace::new(base, &arguments.design)?;
    let augmented = space.augmented()?;
    let scene = augmented.nominal();
    let accuracy = StudyAccuracy { setting: arguments.accuracy.parse()?, max_error: None };
    // Both answers are at the same accuracy.
    let levels = FinerLevels::None;
    let settings = Settings { seed: arguments.seed, accuracy, levels, ..Settings::from(scene) };

    let mut evaluator = LocalEvaluator::new(arguments.threads, simulation(&augmented, &settings));
    let mut journal = InMemoryJournal::default();
    run(scene, &settings, &mut evaluator, &mut journal, &mut Silent)?;
    let first = known(&journal);
    let at_first = first.len();
    let grid = space.grid(arguments.points);
    let study = DesignStudy { space: &space, augmented: scene, settings: &settings };
    let mut more = |learning: &FurtherLearning<'_>| -> Result<Vec<StoredOutcome>, AnalysisError> {
        learning.learn(&mut evaluator, &mut journal, &mut Silent)?;
        Ok(known(&journal))
    };
    let refined = refine(&study, &grid, first, settings.max_evaluations, &mut more, &mut |_, _| {})?;
    let outcomes = known(&journal);
    println!(
        "all designs in one study: {} simulations and {} for single designs; largest surrogate error {:.4}",
        at_first, refined.added, refined.largest_error
    );

    let (mut total, mut compared, mut agreeing) = (0, 0, 0);
    for (k, answer) in answers(&study, &grid, &outcomes)?.iter().enumerate() {
        let source = space.source_at(&answer.values)?;
        let own = Settings { seed: arguments.seed + 1 + k as u64, ..settings.clone() };
        let mut evaluator = LocalEvaluator::new(arguments.threads, simulation(&source, &own));
        let mut journal = InMemoryJournal::default();
        let separate = run(source.nominal(), &own, &mut evaluator, &mut journal, &mut Silent)?.summary;
        total += separate.evaluations.total;
        println!(
            "{}: a study of its own takes {} simulations",
            space.in_words(&answer.values),
            separate.evaluations.total
        );
        for (a, b) in answer.summary.lives.iter().zip(&separate.lives) {
            // With one limit state the system has the same lives.
            let is_double = separate.limit_states.len() == 1 && a.limit_state != "total";
            let Some((found, allowed)) = difference(a, b).filter(|_| !is_double) else { continue };
            compared += 1;
            agreeing += usize::from(found.abs() <= allowed);
            println!(
                "  {} R = {}: {:.0} and {:.0} cycles, difference {:+.0}, within +- {:.0}",
                a.limit_state,
                a.reliability,
                a.cycles.unwrap_or(f64::NAN),
                b.cycles.unwrap_or(f64::NAN),
                found,
                allowed
            );
        }
    }
    println!(
        "\n{agreeing} of {compared} lives within the stated errors; {} simulations against {total}, {:.2} of them",
        outcomes.len(),
        outcomes.len() as f64 / total as f64
    );
    Ok(())
}
