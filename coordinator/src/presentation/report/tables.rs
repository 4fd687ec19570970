//! The tables of the report.

use super::figures::words;
use super::format::{UNKNOWN, count, duration, fixed, percent, three_digits, with_unit};
use super::input::{GroovedJoint, ReportInput};
use super::life::{self, LEVELS, errors_in_intervals, life_and_limits, life_at};
use crate::results::summary::{ReliabilityRow, Round, ScaleRow, WorkerShare};
use common::outputs::COUNTERS;
use common::scene::{OutputUnit, Units};
use maud::{Markup, Render, html};

/// Cells of one row.
type Row = Vec<Markup>;

/// A table whose last column holds text that may break into lines.
pub fn table_of_text<R: IntoIterator<Item: Render>>(
    head: &[&str],
    rows: impl IntoIterator<Item = R>,
) -> Markup {
    scrolling_table(Some("text"), head, rows)
}

/// A table of numbers; on a narrow screen it scrolls sideways.
pub fn table<H: AsRef<str>, R: IntoIterator<Item: Render>>(
    head: &[H],
    rows: impl IntoIterator<Item = R>,
) -> Markup {
    scrolling_table(None, head, rows)
}

/// A column of a table: its name, and the text of its cell in the row of an item.
pub type TableColumn<'a, T> = (&'a str, &'a dyn Fn(&T) -> String);

/// A table of one row per item.
pub fn table_of<T>(columns: &[TableColumn<'_, T>], items: impl IntoIterator<Item = T>) -> Markup {
    let head: Vec<&str> = columns.iter().map(|(name, _)| *name).collect();
    let row = |item: T| columns.iter().map(|(_, cell)| cell(&item)).collect::<Vec<String>>();
    table(&head, items.into_iter().map(row))
}

fn scrolling_table<H: AsRef<str>, R: IntoIterator<Item: Render>>(
    class: Option<&str>,
    head: &[H],
    rows: impl IntoIterator<Item = R>,
) -> Markup {
    let rows: Vec<Row> =
        rows.into_iter().map(|cells| cells.into_iter().map(|cell| cell.render()).collect()).collect();
    // The last column of a table with text holds no numbers.
    let numbers = head.len() - usize::from(class.is_some());
    let columns: Vec<Vec<Option<String>>> = (0..numbers).map(|k| missing_digits(&rows, k)).collect();
    let pad = |row: usize, column: usize| columns.get(column).and_then(|pads| pads.get(row)?.clone());
    html! {
        div.wide {
            table class=[class] {
                thead { tr { @for name in head { th { (name.as_ref()) } } } }
                tbody {
                    @for (r, row) in rows.iter().enumerate() {
                        tr { @for (c, cell) in row.iter().enumerate() { td data-pad=[pad(r, c)] { (cell) } } }
                    }
                }
            }
        }
    }
}

/// Digits before the decimal point of a cell: sign, digits and their separators at its beginning; `None` if it does not begin
/// with a number.
fn whole_part(cell: &str) -> Option<&str> {
    let end =
        cell.find(|c: char| !(c.is_ascii_digit() || c == '\u{2212}' || c == '\u{a0}')).unwrap_or(cell.len());
    // A number is followed by its decimals, its unit or its error, not by letters.
    let whole = cell[..end].trim_end_matches('\u{a0}');
    let ends = cell[end..].chars().next().is_none_or(|c| ".e% \u{a0}<".contains(c));
    (whole.bytes().any(|c| c.is_ascii_digit()) && ends).then_some(whole)
}

/// Per row the digits that a number of this column lacks before its decimal point, which a style sheet shows as empty space: so
/// the points stand below each other.
fn missing_digits(rows: &[Row], column: usize) -> Vec<Option<String>> {
    let wholes: Vec<Option<&str>> =
        rows.iter().map(|row| row.get(column).and_then(|cell| whole_part(&cell.0))).collect();
    let Some(longest) = wholes.iter().flatten().max_by_key(|whole| whole.chars().count()) else {
        return vec![];
    };
    let missing = |whole: &str| {
        let lacks = longest.chars().count() - whole.chars().count();
        (lacks > 0).then(|| longest.chars().take(lacks).collect())
    };
    wholes.iter().map(|whole| whole.and_then(missing)).collect()
}

/// Reliability with its 95 % interval at these checkpoints.
pub fn reliability(input: &ReportInput, rows: &[ReliabilityRow]) -> Markup {
    let cells = life::reliability_table(&input.summary, rows);
    table(&cells[0], &cells[1..])
}

/// Lives at the usual levels of reliability, in total and per limit state, with their 95 % intervals.
pub fn lives(input: &ReportInput) -> Markup {
    let summary = &input.summary;
    let states = summary.limit_states.iter().map(String::as_str).filter(|_| summary.limit_states.len() > 1);
    let names: Vec<&str> = ["total"].into_iter().chain(states).collect();
    let titles = names.iter().map(|name| if *name == "total" { input.subject() } else { name });
    let titles = titles.map(|title| format!("{title} (95 %)"));
    let head: Vec<String> = std::iter::once("life [cycles] at".to_owned()).chain(titles).collect();
    let cells = |level: &f64| -> Vec<Markup> {
        let lives = names.iter().map(|name| {
            let (life, limits) = life_and_limits(life_at(summary, name, *level));
            html! { (life) @if !limits.is_empty() { " " small { (limits) } } }
        });
        std::iter::once(html! { "R = " (level) }).chain(lives).collect()
    };
    html! {
        (table(&head, LEVELS.iter().map(cells)))
        p.none { "95 %: interval of " (errors_in_intervals(summary)) "." }
    }
}

/// Rounds of learning.
pub fn rounds(input: &ReportInput) -> Markup {
    let or_unknown = |value: Option<f64>| value.map_or(UNKNOWN.to_string(), three_digits);
    table_of::<&Round>(
        &[
            ("round", &|round| round.round.to_string()),
            ("evaluations", &|round| round.evaluations.to_string()),
            ("min U", &|round| three_digits(round.min_u)),
            ("uncertain", &|round| percent(round.share_uncertain)),
            ("change of R", &|round| or_unknown(round.change_of_r)),
            ("surrogate error", &|round| three_digits(round.surrogate_error)),
            ("cov of Pf", &|round| percent(round.cov_pf)),
            ("k", &|round| or_unknown(round.dominance)),
            ("at cycles", &|round| count(round.cycles.into())),
            ("R", &|round| fixed(round.reliability_total, 4)),
            ("repairs", &|round| round.repairs.to_string()),
        ],
        &input.summary.convergence.rounds,
    )
}

/// Numerical work, over all evaluations and per evaluation; share of free flight of every joint; grooves narrower than their journals.
pub fn diagnostics(input: &ReportInput) -> Markup {
    let work = &input.work;
    let per = |sum: u64| three_digits(sum as f64 / work.evaluations.max(1) as f64);
    let flight = input.nominal.as_ref().map_or(&[][..], |nominal| &nominal.diagnostics.free_flight_fraction);
    // A program has time steps of its own.
    let is_counted = |sum: u64| sum > 0 || input.scene.simulator.is_none();
    let sums = COUNTERS.into_iter().zip(work.counts).filter(|(_, sum)| is_counted(*sum));
    let sums = sums.map(|((_, name, _), sum)| [name.to_owned(), count(sum), per(sum)]);
    let shares = flight.iter().map(|(name, share)| [name.clone(), percent(*share)]);
    html! {
        (table(&["work", "all evaluations", "per evaluation"], sums))
        @if !flight.is_empty() { (table(&["joint", "share of the first cycle in free flight"], shares)) }
        @if !work.grooved.is_empty() { (grooves(&work.grooved, &input.scene.units)) }
    }
}

/// The joints with such grooves.
fn grooves(grooved: &[GroovedJoint], units: &Units) -> Markup {
    let [depth, turn] = [OutputUnit::Length, OutputUnit::Angle].map(|usual| units.of(usual));
    table_of::<&GroovedJoint>(
        &[
            ("groove narrower than the journal", &|(_, groove)| format!("joint {}", groove.joint)),
            ("evaluations", &|(evaluations, _)| count(*evaluations)),
            ("first at cycle", &|(_, groove)| count(groove.since.into())),
            (&units.head("angle [deg]"), &|(_, groove)| three_digits(turn.to_shown(groove.angle))),
            (&units.head("width [deg]"), &|(_, groove)| three_digits(turn.to_shown(groove.width))),
            (&units.head("stays open [µm]"), &|(_, groove)| three_digits(depth.to_shown(groove.open))),
        ],
        grooved,
    )
}

/// Every output of the nominal mechanism at its last checkpoint, also those without a limit state, with its stated
/// numerical error; `None` without a nominal evaluation.
pub fn stated_errors(input: &ReportInput) -> Option<Markup> {
    let nominal = input.nominal.as_ref()?;
    let cycles = nominal.cycles.last()?;
    let outputs = input.scene.outputs.iter().zip(&nominal.histories).enumerate();
    let rows = outputs.map(|(k, (output, history))| {
        let unit = input.scene.unit_of(output);
        let last = |row: &[f64]| with_unit(&unit, row.last().copied().unwrap_or(f64::NAN));
        let error = nominal.errors.get(k).map_or(UNKNOWN.to_owned(), |errors| last(errors));
        [words(&output.name), last(history), error]
    });
    let subject = format!("nominal at {} cycles", count((*cycles).into()));
    Some(table(&[subject.as_str(), "value", "numerical error"], rows))
}

/// Times of the study, and the share of every worker.
pub fn timing(input: &ReportInput) -> Markup {
    let time = input.summary.timing_s;
    let whole = match time.runs {
        0 | 1 => "whole study".to_owned(),
        runs => format!("whole study, {runs} runs"),
    };
    let times = [
        (whole.as_str(), time.total),
        ("simulation, sum over all workers", time.simulation),
        ("longest simulation", input.work.longest),
        ("surrogates: fitting, prediction, selection", time.surrogate),
        ("idle time of worker slots", time.idle),
    ];
    let workers = &input.summary.workers;
    let shares = workers.iter().map(|WorkerShare { name, evaluations, simulation_s }| {
        [name.clone(), count(*evaluations as u64), duration(*simulation_s)]
    });
    html! {
        (table(&["time", ""], times.map(|(name, seconds)| [name.to_owned(), duration(seconds)])))
        @if !workers.is_empty() { (table(&["worker", "evaluations", "simulation time"], shares)) }
        @if let Some(ScaleRow { system, most, asked, failed }) = &input.summary.scale {
            p { (system) " was asked for " (count(*asked)) " jobs, at most " (count(*most)) " at a time; " (count(*failed)) " of them failed." }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn decimal_points_stand_below_each_other() {
        let rows = ["1\u{a0}000.5", "20.25", "\u{2212}3", "–", "0.5 ± 0.1", "3 of 4"];
        let rows: Vec<Row> = rows.iter().map(|cell| vec![cell.render()]).collect();
        let pads = missing_digits(&rows, 0);
        let pads: Vec<Option<&str>> = pads.iter().map(Option::as_deref).collect();
        assert_eq!(
            pads,
            [None, Some("1\u{a0}0"), Some("1\u{a0}0"), None, Some("1\u{a0}00"), Some("1\u{a0}00")]
        );
        assert!(missing_digits(&rows, 1).is_empty());
        assert_eq!([whole_part("3a"), whole_part("R = 1"), whole_part("")], [None; 3]);
    }

    #[test]
    fn joints_with_grooves_narrower_than_their_journals_have_a_row() {
        let widest = common::outputs::NarrowGroove {
            joint: "a".into(),
            since: 2000,
            angle: 1.0,
            width: 0.2,
            open: 2e-6,
        };
        let page = grooves(&[(3, widest)], &Units::default()).into_string();
        for part in ["joint a", ">3<", "2\u{a0}000", "57", "11", "2.00"] {
            assert!(page.contains(part), "{part}: {page}");
        }
    }
}
