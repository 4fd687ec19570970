//! The runs of a problem as one row of a table.

use super::learn::Run;
use super::problems::PublishedProblem;
use common::random::standard_normal_quantile;
use coordinator::study::StopReason;
use serde::Serialize;
use std::fmt::Write;

/// Combined standard errors within which a failure probability must lie.
const WITHIN: f64 = 3.0;
/// Relative error beyond which a stop that was no budget's end counts as false.
const FALSE: f64 = 0.1;

/// All runs of one problem.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Row {
    /// Name of the problem.
    pub problem: &'static str,
    /// Number of random variables d.
    pub dimension: usize,
    /// Number of runs, one per seed.
    pub runs: usize,
    /// Least, median and largest number of evaluations.
    pub calls: [usize; 3],
    /// Mean of the failure probabilities.
    pub pf: f64,
    /// Published failure probability.
    pub reference: f64,
    /// Median error of the reliability index beta = -Phi^-1(P_f), over its reference [1].
    pub beta_error: f64,
    /// Largest distance to it in combined standard errors (stated, and of the reference).
    pub worst: f64,
    /// Runs within three combined standard errors.
    pub within: usize,
    /// Runs that a rule ended although they are off by more than three combined standard errors and a tenth of the value.
    pub false_stops: usize,
    /// Runs that the budget ended.
    pub budget_ended: usize,
    /// Median coefficient of variation stated: standard error over the value.
    pub stated: f64,
    /// Median of the misclassified points.
    pub misclassified: usize,
    /// Median size of the population.
    pub population: usize,
    /// Median time of a run [s].
    pub seconds: f64,
}

/// The row of a problem's runs, at least one.
pub fn row(problem: &PublishedProblem, runs: &[Run]) -> Row {
    let median = |value: &dyn Fn(&Run) -> f64| {
        let mut values: Vec<f64> = runs.iter().map(value).collect();
        values.sort_unstable_by(f64::total_cmp);
        // The upper one of an even number.
        values[values.len() / 2]
    };
    let distance = |run: &Run| {
        let combined = run.standard_error.hypot(problem.pf_error * problem.pf);
        (run.pf - problem.pf).abs() / combined
    };
    let is_false = |run: &&Run| {
        run.stop != StopReason::Budget && distance(run) > WITHIN && (run.pf / problem.pf - 1.0).abs() > FALSE
    };
    Row {
        problem: problem.name,
        dimension: problem.variables.len(),
        runs: runs.len(),
        calls: [
            runs.iter().map(|run| run.calls).min().unwrap_or(0),
            median(&|run| run.calls as f64) as usize,
            runs.iter().map(|run| run.calls).max().unwrap_or(0),
        ],
        pf: runs.iter().map(|run| run.pf).sum::<f64>() / runs.len() as f64,
        reference: problem.pf,
        beta_error: median(&|run| (beta(run.pf) / beta(problem.pf) - 1.0).abs()),
        worst: runs.iter().map(distance).fold(0.0, f64::max),
        within: runs.iter().filter(|run| distance(run) <= WITHIN).count(),
        false_stops: runs.iter().filter(is_false).count(),
        budget_ended: runs.iter().filter(|run| run.stop == StopReason::Budget).count(),
        stated: median(&|run| run.standard_error / run.pf.max(f64::MIN_POSITIVE)),
        misclassified: median(&|run| run.misclassified as f64) as usize,
        population: median(&|run| run.population as f64) as usize,
        seconds: median(&|run| run.seconds),
    }
}

/// Reliability index of a failure probability.
fn beta(pf: f64) -> f64 {
    -standard_normal_quantile(pf)
}

/// The table, Markdown.
pub fn markdown(rows: &[Row]) -> String {
    let mut text = String::from(
        "| problem | d | calls: least, median, most | mean Pf | reference | error of beta | stated error | worst distance | within 3 | false stops | ended by budget | misclassified | population | time |\n\
         |---|---|---|---|---|---|---|---|---|---|---|---|---|---|\n",
    );
    for row in rows {
        let [least, median, most] = row.calls;
        let _ = writeln!(
            text,
            "| {} | {} | {least}, {median}, {most} | {:.4e} | {:.4e} | {:.2} % | {:.1} % | {:.1} | {} of {} | {} | {} | {} | {} | {:.2} s |",
            row.problem,
            row.dimension,
            row.pf,
            row.reference,
            100.0 * row.beta_error,
            100.0 * row.stated,
            row.worst,
            row.within,
            row.runs,
            row.false_stops,
            row.budget_ended,
            row.misclassified,
            row.population,
            row.seconds
        );
    }
    let (within, runs) = rows.iter().fold((0, 0), |(w, n), row| (w + row.within, n + row.runs));
    let false_stops: usize = rows.iter().map(|row| row.false_stops).sum();
    let _ = writeln!(
        text,
        "\n{within} of {runs} runs ({:.1} %) within three combined standard errors, {false_stops} false stops.",
        100.0 * within as f64 / runs.max(1) as f64
    );
    text
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::problems::published_problems;
    use coordinator::statistics::learning::Rule;

    fn with(calls: usize, pf: f64, stop: StopReason) -> Run {
        Run { calls, pf, standard_error: 1e-4, population: 1000, misclassified: calls, stop, seconds: 1.0 }
    }

    #[test]
    fn a_rule_that_stops_far_off_is_a_false_stop_and_a_spent_budget_is_not() {
        let problems = published_problems();
        let problem = problems.iter().find(|p| p.name == "four-branch-7").unwrap();
        let rule = StopReason::Rule(Rule::Learning);
        let runs = [with(60, 2.23e-3, rule), with(90, 0.0, rule), with(70, 1e-3, StopReason::Budget)];
        let row = row(problem, &runs);
        assert_eq!((row.calls, row.within, row.false_stops, row.budget_ended), ([60, 70, 90], 1, 1, 1));
        assert!((row.worst - 22.227_95).abs() < 1e-4, "{}", row.worst);
        let text = markdown(&[row]);
        assert!(text.contains("1 of 3 runs (33.3 %)") && text.contains("1 false stops"), "{text}");
    }
}
