//! `coordinator tradeoff`: time against error of the accuracy settings of a scene.

use super::arguments::{Talk, TradeoffArguments};
use super::error::CommandError;
use super::output::print;
use super::scenes::check_linkage;
use super::signals::interruption;
use common::accuracy::Accuracy;
use common::scene::{Scene, SceneSource};
use coordinator::design::Population;
use coordinator::evaluate::local::LocalEvaluator;
use coordinator::evaluate::{Evaluator, Finished, Request};
use coordinator::report::ReportError;
use coordinator::result_files::write_text;
use coordinator::tradeoff::{Measured, compare, csv, figures, settings, table};

/// Runs the command.
pub fn tradeoff(arguments: &TradeoffArguments, talk: Talk) -> Result<(), CommandError> {
    let source = SceneSource::load(&arguments.scene)?;
    let scene = source.nominal();
    check_linkage(source.origin(), scene)?;
    std::fs::create_dir_all(&arguments.out)
        .map_err(|error| CommandError::Folder { path: arguments.out.clone(), error })?;
    let points = points(&source, arguments.points)?;
    let settings = settings();
    // The reference first, as it takes longest; then every setting at every point.
    let mut accuracies = vec![Accuracy::reference()];
    accuracies.extend(settings.iter().map(|setting| setting.accuracy));
    let jobs: Vec<Request> = (0..accuracies.len() * points.len())
        .map(|k| Request { id: k as u64, sample: vec![], with_first_cycle: false })
        .collect();
    let job = |request: &Request| {
        let k = request.id as usize;
        worker::simulate::simulate(&points[k % points.len()], &accuracies[k / points.len()], false)
    };
    let threads = std::thread::available_parallelism().map_or(1, usize::from);
    let mut measured: Vec<Option<Measured>> = vec![None; jobs.len()];
    let mut done = 0;
    LocalEvaluator::new(threads, job)
        .interrupted_by(interruption().map_err(CommandError::Signals)?)
        .evaluate(&jobs, &mut |finished: Finished| {
            done += 1;
            if !talk.quiet {
                eprintln!("{done}/{} evaluations", jobs.len());
            }
            measured[finished.id as usize] =
                Some(Measured { seconds: finished.wall, outcome: finished.outcome });
            Ok(())
        })
        .map_err(CommandError::Evaluate)?;
    let measured: Vec<Measured> = measured.into_iter().flatten().collect();
    let mut by_setting = measured.chunks(points.len()).map(<[Measured]>::to_vec);
    let reference = by_setting.next().unwrap_or_default();
    let rows = compare(scene, settings, &by_setting.collect::<Vec<_>>(), &reference);
    let text = table(scene, &rows, points.len());
    write_text(&arguments.out.join("tradeoff.md"), &text)?;
    write_text(&arguments.out.join("tradeoff.csv"), &csv(scene, &rows))?;
    for (name, svg) in figures(scene, &rows).map_err(ReportError::from)? {
        write_text(&arguments.out.join(format!("{name}.svg")), &svg)?;
    }
    print(&text)
}

/// The nominal scene, then samples of its variables under the scene's own seed.
fn points(source: &SceneSource, count: usize) -> Result<Vec<Scene>, CommandError> {
    let scene = source.nominal();
    let mut points = vec![scene.clone()];
    if count > 1 && !scene.variables.is_empty() {
        let variables: Vec<_> = scene.variables.iter().map(|variable| variable.distribution).collect();
        let population = Population::draw(&variables, count - 1, scene.study.seed);
        for j in 0..count - 1 {
            points.push(source.resolve_sample(&population.physical(j))?);
        }
    }
    Ok(points)
}
