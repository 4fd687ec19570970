//! Runs as lines, and by class as rows of a table.

use super::learn::{Comparison, INTERVAL, Run};
use super::problem::Class;
use coordinator::study::StopReason;
use std::fmt::Write;

/// Stated errors beyond which a run counts as wrong.
pub const FAR: f64 = 4.0;
/// True probabilities outside of which a checkpoint of a history is not compared [1].
const COMPARED: (f64, f64) = (1e-4, 0.9999);

/// Header of [`line`], as CSV.
pub const HEADER: &str = "problem,class,variables,limit_states,truth,truth_error,pf,lower,upper,standard_error,distance,\
                          surrogate_error,on_population,calls,population,stop,seconds,largest_gap";

/// Name of a reason to stop.
fn stop_name(stop: Option<StopReason>) -> &'static str {
    match stop {
        Some(StopReason::Budget) => "budget",
        Some(_) => "rule",
        None => "failures",
    }
}

/// Result at the end of life as a line of CSV.
pub fn line(run: &Run) -> String {
    let (d, modes) = run.shape;
    let (truth, truth_error) = run.truth;
    let (pf, standard_error) = (f64::NAN, f64::NAN);
    let nothing = Comparison { pf, standard_error, interval: (pf, pf), truth, truth_error };
    let last = run.checkpoints.last().copied().unwrap_or(nothing);
    let (lower, upper) = last.interval;
    format!(
        "{},{},{d},{modes},{:.4e},{:.1e},{:.4e},{:.4e},{:.4e},{:.2e},{:.2},{:.2e},{:.4e},{},{},{},{:.1},{:.4}",
        run.index,
        run.class.name(),
        last.truth,
        last.truth_error,
        last.pf,
        lower,
        upper,
        last.standard_error,
        last.distance(),
        run.surrogate_error,
        run.on_population,
        run.calls,
        run.population,
        stop_name(run.stop),
        run.seconds,
        run.largest_gap
    )
}

/// All runs of one class, or of all.
#[derive(Debug, Clone, PartialEq)]
pub struct Row {
    /// Name of the class.
    pub name: &'static str,
    /// Number of runs with a result.
    pub runs: usize,
    /// Share of the checkpoints within the stated 95 % interval, the mean over the runs [1].
    pub coverage: f64,
    /// Runs with a checkpoint beyond [`FAR`] standard errors.
    pub far: usize,
    /// Root mean square of the distance in standard errors.
    pub rms: f64,
    /// Median of the relative error at the end of life [1].
    pub error: f64,
    /// Median of the stated relative standard error at the end of life [1].
    pub stated: f64,
    /// Mean number of evaluations.
    pub calls: f64,
    /// Runs ended by the budget, and by too many failed simulations.
    pub ended: [usize; 2],
}

/// Checkpoints of a run that are compared: all that are neither certain survival nor certain failure.
pub fn compared(run: &Run) -> Vec<Comparison> {
    let open = |c: &&Comparison| c.truth >= COMPARED.0 && c.truth <= COMPARED.1;
    if run.checkpoints.len() > 1 {
        run.checkpoints.iter().filter(open).copied().collect()
    } else {
        run.checkpoints.clone()
    }
}

/// The middle of some values, the upper one of two; NaN of none.
pub fn median(mut values: Vec<f64>) -> f64 {
    values.sort_unstable_by(f64::total_cmp);
    values.get(values.len() / 2).copied().unwrap_or(f64::NAN)
}

/// The row of some runs.
pub fn row<'a>(name: &'static str, runs: impl Iterator<Item = &'a Run>) -> Row {
    let runs: Vec<&Run> = runs.collect();
    let with: Vec<Vec<Comparison>> =
        runs.iter().map(|run| compared(run)).filter(|checkpoints| !checkpoints.is_empty()).collect();
    let mean =
        |value: &dyn Fn(&Vec<Comparison>) -> f64| with.iter().map(value).sum::<f64>() / with.len() as f64;
    let over = |checkpoints: &Vec<Comparison>, value: fn(f64) -> f64| {
        checkpoints.iter().map(|c| value(c.distance())).sum::<f64>() / checkpoints.len() as f64
    };
    let last = |value: fn(&Comparison) -> f64| {
        median(with.iter().filter_map(|checkpoints| checkpoints.last().map(value)).collect())
    };
    let ended = |name: &str| runs.iter().filter(|run| stop_name(run.stop) == name).count();
    Row {
        name,
        runs: with.len(),
        coverage: mean(&|checkpoints| over(checkpoints, |z| f64::from(u8::from(z.abs() <= INTERVAL)))),
        far: with.iter().filter(|checkpoints| checkpoints.iter().any(|c| c.distance().abs() > FAR)).count(),
        rms: mean(&|checkpoints| over(checkpoints, |z| z * z)).sqrt(),
        error: last(|c| (c.pf / c.truth - 1.0).abs()),
        stated: last(|c| c.standard_error / c.pf.max(f64::MIN_POSITIVE)),
        calls: runs.iter().map(|run| run.calls as f64).sum::<f64>() / runs.len() as f64,
        ended: [ended("budget"), ended("failures")],
    }
}

/// Rows of all classes that occur, and of all runs.
pub fn rows(runs: &[Run]) -> Vec<Row> {
    let classes = Class::ALL.into_iter().filter(|class| runs.iter().any(|run| run.class == *class));
    let mut rows: Vec<Row> =
        classes.map(|class| row(class.name(), runs.iter().filter(|run| run.class == class))).collect();
    rows.push(row("all", runs.iter()));
    rows
}

/// The table, Markdown.
pub fn markdown(rows: &[Row]) -> String {
    let mut text = String::from(
        "| class | runs | within the 95 % interval | beyond 4 standard errors | rms distance | median error | median stated error | mean calls | ended by budget | by failures |\n\
         |---|---|---|---|---|---|---|---|---|---|\n",
    );
    for row in rows {
        let _ = writeln!(
            text,
            "| {} | {} | {:.1} % | {} | {:.2} | {:.1} % | {:.1} % | {:.0} | {} | {} |",
            row.name,
            row.runs,
            100.0 * row.coverage,
            row.far,
            row.rms,
            100.0 * row.error,
            100.0 * row.stated,
            row.calls,
            row.ended[0],
            row.ended[1]
        );
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::course::Course;
    use crate::family::Family;
    use crate::truth::truth;
    use common::random::standard_normal_cdf;
    use coordinator::statistics::learning::Rule;

    #[test]
    fn a_row_weighs_runs_alike_and_counts_the_far_ones() {
        let at = |pf: f64| Comparison {
            pf,
            standard_error: 1e-3,
            interval: (pf - 1.96e-3, pf + 1.96e-3),
            truth: 0.01,
            truth_error: 0.0,
        };
        let run = |checkpoints| Run {
            index: 1,
            class: Class::Kink,
            shape: (2, 1),
            truth: (0.01, 0.0),
            checkpoints,
            lives: vec![],
            surrogate_error: 1e-4,
            on_population: 0.01,
            calls: 50,
            population: 1000,
            stop: Some(StopReason::Rule(Rule::Error)),
            seconds: 1.0,
            largest_gap: 0.02,
        };
        let runs = [run(vec![at(0.011)]), run(vec![at(0.01), at(0.015)]), run(vec![])];
        let row = row("kink", runs.iter());
        assert_eq!((row.runs, row.far, row.coverage), (2, 1, 0.75));
        assert!((row.rms - (0.5 * (1.0 + 12.5_f64)).sqrt()).abs() < 1e-9, "{}", row.rms);
        assert!(
            line(&runs[0])
                .starts_with("1,kink,2,1,1.0000e-2,0.0e0,1.1000e-2,9.0400e-3,1.2960e-2,1.00e-3,1.00,")
        );
        assert!(markdown(&[row]).contains("| kink | 2 | 75.0 % | 1 | 2.60 |"));
    }

    #[test]
    fn half_of_either_half_is_hard_and_truths_agree_with_closed_forms() {
        let hard = |index: &u64| matches!(Family::First.class_of(*index), Class::Islands | Class::Kink);
        for half in 0..2 {
            assert_eq!((0..48).filter(|index| index % 2 == half).filter(hard).count(), 12);
        }
        let mut plane = Family::First.problem(1, 0);
        let response = crate::response::Term::Plane(vec![0.6, 0.8]);
        let d = 2;
        plane.variables.truncate(d);
        plane.variables.resize(d, plane.variables[0].clone());
        plane.modes = vec![crate::response::Response::Sum(vec![response])];
        plane.course = Course::Once;
        for (wanted, centres) in [(0.02, vec![vec![0.0; d]]), (1e-6, vec![vec![0.0; d], vec![2.85, 3.8]])] {
            (plane.wanted, plane.centres) = (wanted, centres);
            let truth = truth(&plane);
            let exact = standard_normal_cdf(-truth.limit);
            assert!((exact / wanted - 1.0).abs() < 5e-3, "{exact} {wanted}");
            assert!(truth.standard_error[0] < 3e-3 * wanted, "{}", truth.standard_error[0]);
        }
    }
}
