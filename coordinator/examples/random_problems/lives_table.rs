//! Lives of the runs as columns of a line, and by class as rows of a table.

use super::known_lives::LifeComparison;
use super::learn::{INTERVAL, Run};
use super::problem::Class;
use super::table::{FAR, compared, median};
use coordinator::study::LEVELS;
use std::fmt::Write;

/// Header of [`columns`], as CSV: true life and limits of the interval per level, empty where the checkpoints do not
/// resolve the true life.
pub const HEADER: &str = ",life_99,lower_99,upper_99,life_90,lower_90,upper_90,life_50,lower_50,upper_50";

fn at_level(run: &Run, level: f64) -> Option<&LifeComparison> {
    run.lives.iter().find(|life| life.level == level)
}

/// True lives and their intervals, to follow a line of CSV.
pub fn columns(run: &Run) -> String {
    let of_level = |level| match at_level(run, level) {
        Some(LifeComparison { truth, lower, upper, .. }) => format!(",{truth:.3},{lower:.3},{upper:.3}"),
        None => ",,,".to_owned(),
    };
    LEVELS.map(of_level).concat()
}

/// The row of some runs: checkpoints and lives each count once.
fn row<'a>(name: &str, runs: impl Iterator<Item = &'a Run>) -> String {
    let runs: Vec<&Run> = runs.collect();
    let distances: Vec<f64> =
        runs.iter().flat_map(|run| compared(run)).map(|checkpoint| checkpoint.distance().abs()).collect();
    let within = distances.iter().filter(|distance| **distance <= INTERVAL).count();
    let far = distances.iter().filter(|distance| **distance > FAR).count();
    let lives = LEVELS.map(|level| {
        let lives: Vec<&LifeComparison> = runs.iter().filter_map(|run| at_level(run, level)).collect();
        let within = lives.iter().filter(|life| life.is_within()).count();
        format!("{within} of {}", lives.len())
    });
    let calls: Vec<f64> = runs.iter().map(|run| run.calls as f64).collect();
    let most = calls.iter().copied().fold(0.0, f64::max);
    format!(
        "| {name} | {} | {} | {:.1} % | {far} | {} | {:.0} | {most:.0} |",
        runs.len(),
        distances.len(),
        100.0 * within as f64 / distances.len() as f64,
        lives.join(" | "),
        median(calls)
    )
}

/// The table of all classes that occur, Markdown.
pub fn markdown(runs: &[Run]) -> String {
    let mut text = String::from(
        "| class | problems | checkpoints | within the 95 % interval | beyond 4 standard errors | lives at 0.99 within | at 0.9 | at 0.5 | median calls | most calls |\n\
         |---|---|---|---|---|---|---|---|---|---|\n",
    );
    for class in Class::ALL.into_iter().filter(|class| runs.iter().any(|run| run.class == *class)) {
        let _ = writeln!(text, "{}", row(class.name(), runs.iter().filter(|run| run.class == class)));
    }
    let _ = writeln!(text, "{}", row("all", runs.iter()));
    text
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::learn::Comparison;

    #[test]
    fn checkpoints_and_lives_count_once_each() {
        let at = |pf: f64, truth: f64| Comparison {
            pf,
            standard_error: 1e-3,
            interval: (pf, pf),
            truth,
            truth_error: 0.0,
        };
        let life = |level: f64, truth: f64| LifeComparison { level, truth, lower: 2.0, upper: 3.0 };
        let run = |calls, checkpoints, lives| Run {
            index: 1,
            class: Class::Wear,
            shape: (2, 1),
            truth: (0.01, 0.0),
            checkpoints,
            lives,
            surrogate_error: 1e-4,
            on_population: 0.01,
            calls,
            population: 1000,
            stop: None,
            seconds: 1.0,
            largest_gap: 0.02,
        };
        // The first checkpoint is nearly certain survival and does not count.
        let first = vec![at(0.1, 1e-5), at(0.1, 0.101), at(0.2, 0.203), at(0.3, 0.305)];
        let second = vec![at(0.0, 1e-5), at(0.5, 0.5)];
        let runs = [
            run(40, first, vec![life(0.9, 2.5), life(0.5, 3.1)]),
            run(90, second, vec![life(0.9, 1.9), life(0.5, 3.0)]),
        ];
        let table = markdown(&runs);
        for name in ["wear", "all"] {
            let row = format!("| {name} | 2 | 4 | 50.0 % | 1 | 0 of 0 | 1 of 2 | 1 of 2 | 90 | 90 |");
            assert!(table.contains(&row), "{table}");
        }
        assert_eq!(columns(&runs[0]), ",,,,2.500,2.000,3.000,3.100,2.000,3.000");
    }
}
