//! The tables of the report as HTML.

use super::figures::{rows_at_governing, words};
use super::format::{UNKNOWN, count, duration, escape, fixed, three_digits};
use super::input::ReportInput;
use super::life::{LifeAt, life_at, numerical_lives};
use super::words::LEVELS;
use crate::results::summary::{NumericalRange, ReliabilityRow};
use std::fmt::Write;

/// A table whose last column is text that may break into lines. Cells are HTML.
pub fn table_of_text(head: &[String], rows: impl Iterator<Item = Vec<String>>) -> String {
    table(head, rows).replace("<table>", "<table class=\"text\">")
}

/// A table that scrolls sideways in itself on a narrow screen. Cells are HTML.
pub fn table(head: &[String], rows: impl Iterator<Item = Vec<String>>) -> String {
    let cells = |cells: &[String], tag: &str| {
        cells.iter().fold(String::new(), |mut line, cell| {
            let _ = write!(line, "<{tag}>{cell}</{tag}>");
            line
        })
    };
    let mut html =
        format!("<div class=\"wide\"><table><thead><tr>{}</tr></thead><tbody>\n", cells(head, "th"));
    for row in rows {
        let _ = writeln!(html, "<tr>{}</tr>", cells(&row, "td"));
    }
    html + "</tbody></table></div>\n"
}

/// Reliability with standard errors, for these rows; beside them, where the study has it, R with all responses moved
/// by their numerical errors.
pub fn reliability(input: &ReportInput, rows: &[ReliabilityRow]) -> String {
    let names: Vec<&str> =
        input.limit_states.iter().map(|state| state.name.as_str()).chain(["total"]).collect();
    let numerical = rows.iter().any(|row| !row.numerical.is_empty());
    let head: Vec<String> = std::iter::once("cycles".to_string())
        .chain(names.iter().flat_map(|name| {
            let beside = numerical.then(|| "numerical".to_string());
            std::iter::once(format!("R {}", escape(name))).chain(beside)
        }))
        .collect();
    let number = |value: Option<&f64>| value.map_or(f64::NAN, |value| *value);
    table(
        &head,
        rows.iter().map(|row| {
            std::iter::once(count(row.cycles.into()))
                .chain(names.iter().flat_map(|name| {
                    let r = format!(
                        "{} <small>± {}</small>",
                        fixed(number(row.reliability.get(*name)), 4),
                        fixed(number(row.standard_error.get(*name)), 4)
                    );
                    let range = |range: &NumericalRange| {
                        format!("<small>{}–{}</small>", fixed(range.lower, 2), fixed(range.upper, 2))
                    };
                    let beside = row.numerical.get(*name).map_or_else(|| UNKNOWN.to_string(), range);
                    std::iter::once(r).chain(numerical.then_some(beside))
                }))
                .collect()
        }),
    )
}

/// Lives at the levels of reliability that decisions ask for, in total and per limit state, with their 95 % intervals; in
/// the last column the range under the stated numerical errors.
pub fn lives(input: &ReportInput) -> String {
    let summary = &input.summary;
    let mut names = vec!["total"];
    if summary.limit_states.len() > 1 {
        names.extend(summary.limit_states.iter().map(String::as_str));
    }
    let numerical = summary.reliability.iter().any(|row| !row.numerical.is_empty());
    let title = |name: &&str| if *name == "total" { input.subject().to_string() } else { escape(name) };
    let head = std::iter::once("life [cycles] at".to_string())
        .chain(names.iter().map(title))
        .chain(numerical.then(|| "under numerical errors".to_string()));
    let last = summary.reliability.last().map_or(0, |row| row.cycles);
    let rows = LEVELS.iter().map(|level| {
        let cell = |name: &&str| match life_at(summary, name, *level) {
            LifeAt::Beyond(last) => format!("beyond {}", count(last.into())),
            LifeAt::Cycles { life, lower, upper } => {
                format!("{} <small>{} to {}</small>", whole(life), whole(lower), whole(upper))
            }
        };
        let range = || {
            let end = |life: Option<f64>| life.map_or(format!("beyond {}", count(last.into())), whole);
            let [worst, best] = numerical_lives(summary, "total", *level)?;
            Some(format!("<small>{} to {}</small>", end(worst), end(best)))
        };
        std::iter::once(format!("R = {level}"))
            .chain(names.iter().map(cell))
            .chain(numerical.then(|| range().unwrap_or_else(|| UNKNOWN.to_string())))
            .collect()
    });
    table(&head.collect::<Vec<_>>(), rows)
}

/// A life in whole cycles.
pub fn whole(life: f64) -> String {
    count(life.round().max(0.0) as u64)
}

/// Sensitivities of one limit state at the governing checkpoint, all variables; empty if there are none.
pub fn sensitivity(input: &ReportInput, limit_state: &str) -> String {
    let rows = rows_at_governing(input, limit_state);
    if rows.is_empty() {
        return String::new();
    }
    let head = [
        "variable",
        "mean (SI)",
        "std (SI)",
        "dPf/dmean",
        "± error",
        "dPf/dstd",
        "± error",
        "scaled, mean",
        "scaled, std",
    ]
    .map(String::from);
    table(
        &head,
        rows.iter().map(|row| {
            let variable = input.variables.iter().find(|variable| variable.name == row.variable);
            let mut cells = vec![escape(&words(&row.variable))];
            cells.extend(
                [
                    variable.map_or(f64::NAN, |variable| variable.mean),
                    variable.map_or(f64::NAN, |variable| variable.std),
                    row.d_pf_d_mean,
                    row.standard_error.d_pf_d_mean,
                    row.d_pf_d_std,
                    row.standard_error.d_pf_d_std,
                ]
                .map(three_digits),
            );
            cells.extend([row.scaled.d_pf_d_mean, row.scaled.d_pf_d_std].map(|value| fixed(value, 4)));
            cells
        }),
    )
}

/// Rounds of learning.
pub fn rounds(input: &ReportInput) -> String {
    let head = [
        "round",
        "evaluations",
        "min U",
        "uncertain",
        "change of R",
        "surrogate error",
        "cov of Pf",
        "k",
        "at cycles",
        "R",
        "repairs",
    ]
    .map(String::from);
    table(
        &head,
        input.summary.convergence.rounds.iter().map(|round| {
            vec![
                round.round.to_string(),
                round.evaluations.to_string(),
                three_digits(round.min_u),
                super::format::percent(round.share_uncertain),
                round.change_of_r.map_or(super::format::UNKNOWN.to_string(), three_digits),
                three_digits(round.surrogate_error),
                super::format::percent(round.cov_pf),
                round.dominance.map_or(super::format::UNKNOWN.to_string(), three_digits),
                count(round.cycles.into()),
                fixed(round.reliability_total, 4),
                round.repairs.to_string(),
            ]
        }),
    )
}

/// Work of the numerics, over all evaluations and per evaluation.
pub fn diagnostics(input: &ReportInput) -> String {
    let work = &input.work;
    let per = |sum: u64| three_digits(sum as f64 / work.evaluations.max(1) as f64);
    let rows = [
        ("time steps", work.sum.steps),
        ("time steps refused and repeated", work.sum.rejected_steps),
        ("Newton iterations", work.sum.newton_iterations),
        ("force evaluations", work.sum.force_evaluations),
        ("cycles simulated", work.sum.simulated_cycles),
        ("stages of the wear step", work.sum.wear_stages),
        ("wear steps refused and repeated", work.sum.rejected_wear_steps),
    ];
    let mut html = table(
        &["work".into(), "all evaluations".into(), "per evaluation".into()],
        rows.iter().map(|(name, sum)| vec![name.to_string(), count(*sum), per(*sum)]),
    );
    let flight = input.nominal.as_ref().map_or(&[][..], |nominal| &nominal.diagnostics.free_flight_fraction);
    if !flight.is_empty() {
        html += &table(
            &["joint".into(), "share of the first cycle in free flight".into()],
            flight.iter().map(|(name, share)| vec![escape(name), super::format::percent(*share)]),
        );
    }
    html
}

/// Every output of the nominal mechanism at its last checkpoint, those without a limit state too, with the numerical
/// error that its evaluation states; empty without a nominal evaluation.
pub fn stated_errors(input: &ReportInput) -> String {
    let Some(nominal) = &input.nominal else { return String::new() };
    let Some(cycles) = nominal.cycles.last() else { return String::new() };
    let rows = input.outputs.iter().zip(&nominal.histories).enumerate().map(|(k, (output, history))| {
        let last = |row: &[f64]| {
            let value = row.last().map_or(f64::NAN, |si| output.unit.to_shown(*si));
            escape(&output.unit.after(&three_digits(value)))
        };
        let error = nominal.errors.get(k).map_or(UNKNOWN.to_owned(), |errors| last(errors));
        vec![escape(&words(&output.name)), last(history), error]
    });
    let at = format!("nominal at {} cycles", count((*cycles).into()));
    table(&[at, "value".into(), "numerical error".into()], rows)
}

/// Where the time went and who worked.
pub fn timing(input: &ReportInput) -> String {
    let time = input.summary.timing_s;
    let mut html = table(
        &["time".into(), String::new()],
        [
            ("whole study", time.total),
            ("simulations, summed over workers", time.simulation),
            ("longest simulation", input.work.longest),
            ("surrogates: fitting, prediction, selection", time.surrogate),
            ("worker slots waiting for the coordinator", time.idle),
        ]
        .iter()
        .map(|(name, seconds)| vec![name.to_string(), duration(*seconds)]),
    );
    if !input.summary.workers.is_empty() {
        html += &table(
            &["worker".into(), "evaluations".into(), "simulation time".into()],
            input.summary.workers.iter().map(|worker| {
                vec![escape(&worker.name), count(worker.evaluations as u64), duration(worker.simulation_s)]
            }),
        );
    }
    html
}
