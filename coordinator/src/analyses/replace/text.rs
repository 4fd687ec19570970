//! The answer of `coordinator replace` as text.

use super::{RateRow, ReplacementReport, Stated};
use crate::presentation::report::format::short_percent;
use crate::presentation::text_table::in_columns;
use crate::results::life_summary::LifeRow;
use common::scene::Scene;
use std::fmt::Write;

/// Rows of the table of rates.
const ROWS: usize = 24;

/// The answer as text; the scene has the units of its outputs.
pub fn text(report: &ReplacementReport, scene: &Scene) -> String {
    let mut out = String::new();
    // Writing to a String cannot fail.
    let _ = write_report(&mut out, report, scene);
    out
}

fn write_report(out: &mut String, report: &ReplacementReport, scene: &Scene) -> std::fmt::Result {
    let ReplacementReport { planned_cost, failure_cost, end, .. } = *report;
    let subject = if report.curve == "total" { "the whole system".to_owned() } else { report.curve.clone() };
    writeln!(
        out,
        "Age replacement for failures of {subject}: planned replacement {planned_cost}, failure {failure_cost} \
         (95 % intervals)\n"
    )?;
    write_age(out, report)?;
    let at_least = if report.mean_life_is_bound { "at least " } else { "" };
    let at_most = if report.mean_life_is_bound { "at most " } else { "" };
    writeln!(out, "run to failure       {at_most}{} per cycle", digits(&report.run_to_failure))?;
    writeln!(out, "replacement saves    {at_most}{}", percent(&report.gain))?;
    writeln!(out, "mean life            {at_least}{} cycles", cycles(&report.mean_life, end))?;
    if report.mean_life_is_bound {
        writeln!(
            out,
            "                     units outlive the study, which ends at {end:.0} cycles: the mean life is that up to there"
        )?;
    }
    for row in &report.lives {
        writeln!(out, "{:<21}{}", format!("B{:.0}", 100.0 * (1.0 - row.reliability)), life_text(row, end))?;
    }
    write_rates(out, &report.rates)?;
    write_inspections(out, report, scene)
}

fn write_age(out: &mut String, report: &ReplacementReport) -> std::fmt::Result {
    let ReplacementReport { age, end, .. } = report;
    if report.no_minimum {
        writeln!(
            out,
            "no best age          run to failure: the hazard does not rise enough for a replacement to pay, and the cost per cycle falls \
             up to the end of the study, {end:.0} cycles"
        )?;
        if age.lower < *end {
            writeln!(
                out,
                "                     within the limits of R there may be a minimum, not before {} cycles",
                life(age.lower, *end)
            )?;
        }
        writeln!(out, "R at the end         {}", of_r(&report.reliability_at_age))?;
        writeln!(out, "cost at the end      {} per cycle", digits(&report.cost_rate))?;
    } else {
        let later = if age.upper >= *end { " or later" } else { "" };
        writeln!(
            out,
            "replace at           {} cycles ({} to {}{later}), where R = {}",
            life(age.value, *end),
            life(age.lower, *end),
            life(age.upper, *end),
            of_r(&report.reliability_at_age)
        )?;
        writeln!(out, "cost                 {} per cycle", digits(&report.cost_rate))?;
    }
    if let Some(first) = report.constant_hazard_before {
        let cycles = if first == 1 { "cycle" } else { "cycles" };
        writeln!(
            out,
            "caution              the fall of R before the first checkpoint, {first} {cycles}, is not resolved: the hazard is taken as \
             constant there, the intervals contain any other fall; limits may be exceeded unworn, in the first cycle"
        )?;
    }
    Ok(())
}

fn of_r(stated: &Stated) -> String {
    format!("{:.4} ({:.4} to {:.4})", stated.value, stated.lower, stated.upper)
}

fn digits(stated: &Stated) -> String {
    format!("{:.4e} ({:.4e} to {:.4e})", stated.value, stated.lower, stated.upper)
}

fn percent(stated: &Stated) -> String {
    format!(
        "{:.1} % ({:.1} to {:.1} %) of that",
        100.0 * stated.value,
        100.0 * stated.lower,
        100.0 * stated.upper
    )
}

/// A life with three digits of the length of the study at least, whole cycles from 1000 on.
fn life(cycles: f64, end: f64) -> String {
    let decimals = (3.0 - end.max(1.0).log10().ceil()).clamp(0.0, 3.0) as usize;
    format!("{cycles:.decimals$}")
}

fn cycles(stated: &Stated, end: f64) -> String {
    format!("{} ({} to {})", life(stated.value, end), life(stated.lower, end), life(stated.upper, end))
}

/// Life of a level with its interval, or its bound.
fn life_text(row: &LifeRow, end: f64) -> String {
    let range = row.whole_interval();
    let shown = |cycles: f64| life(cycles, end);
    match (row.cycles, range.upper) {
        (None, Some(0.0)) => "0 cycles: more units than that exceed a limit unworn".to_owned(),
        (Some(cycles), Some(upper)) => {
            format!("{} cycles ({} to {})", shown(cycles), shown(range.lower), shown(upper))
        }
        (Some(cycles), None) => {
            format!("{} cycles ({} to beyond {end:.0})", shown(cycles), shown(range.lower))
        }
        (None, Some(upper)) => format!("between {} and {} cycles", shown(range.lower), shown(upper)),
        (None, None) => format!("beyond {} cycles", shown(range.lower)),
    }
}

/// Density and hazard where units fail, at most [`ROWS`] rows.
fn write_rates(out: &mut String, rates: &[RateRow]) -> std::fmt::Result {
    let failing: Vec<&RateRow> = rates.iter().filter(|row| row.density.value > 0.0).collect();
    if failing.is_empty() {
        return writeln!(out, "\nNo failure was found up to the end of the study: no density and no hazard.");
    }
    let head = ["cycles", "failure density [1/cycle] (95 %)", "hazard [1/cycle] (95 %)"];
    let mut table = vec![head.map(str::to_owned).to_vec()];
    let step = failing.len().div_ceil(ROWS);
    for row in failing.iter().step_by(step) {
        let hazard = row.hazard.as_ref().map_or("too few survivors".to_owned(), short);
        let span = format!("{:.0} to {:.0}", row.from, row.to);
        table.push(vec![span, short(&row.density), hazard]);
    }
    write!(out, "\n{}", in_columns(&table, &[]))?;
    if step > 1 {
        writeln!(out, "(every {step} intervals; --json has all)")?;
    }
    Ok(())
}

fn short(stated: &Stated) -> String {
    format!("{:.2e} ({:.2e} to {:.2e})", stated.value, stated.lower, stated.upper)
}

fn write_inspections(out: &mut String, report: &ReplacementReport, scene: &Scene) -> std::fmt::Result {
    let Some(first) = report.inspections.first() else { return Ok(()) };
    let output = scene.outputs.iter().find(|output| output.name == first.output);
    let unit = output.map(|output| output.kind.unit());
    writeln!(
        out,
        "\nReplacement above a measured {}, at a last age in any case; lives and ages in cycles, cost with 95 % limits by the number \
         of units, the upper one with failures that none of them shows",
        first.output
    )?;
    let head = [
        "inspected every",
        "replaced from",
        "last age",
        "cost per cycle (95 %)",
        "failed",
        "replaced by level",
        "mean life",
        "inspections of a unit",
    ];
    let mut table = vec![head.map(str::to_owned).to_vec()];
    table.extend(report.inspections.iter().map(|row| {
        let shown =
            |level: f64| unit.as_ref().map(|unit| unit.after(&format!("{:.4}", unit.to_shown(level))));
        let levels: Vec<String> = row.lower_level.into_iter().chain(row.level).filter_map(shown).collect();
        vec![
            row.every.map_or("given".to_owned(), |every| every.to_string()),
            if levels.is_empty() { "the age only".to_owned() } else { levels.join(", ") },
            life(row.age, report.end),
            format!("{:.4e} ({:.4e} to {:.4e})", row.cost_rate, row.lower, row.upper),
            short_percent(row.failed),
            format!("{:.1} %", 100.0 * row.by_level),
            life(row.mean_life, report.end),
            format!("{:.1}", row.inspections),
        ]
    }));
    out.push_str(&in_columns(&table, &[]));
    let least = report.inspections.iter().min_by(|a, b| a.cost_rate.total_cmp(&b.cost_rate));
    if let Some(best) = least {
        let saved = 100.0 * (1.0 - best.cost_rate / report.cost_rate.value);
        writeln!(
            out,
            "{} costs {:.1} % {} than age replacement without inspections.",
            if report.inspections.len() > 1 { "The best of these" } else { "This" },
            saved.abs(),
            if saved >= 0.0 { "less" } else { "more" }
        )?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::results::life_summary::CyclesRange;

    #[test]
    fn issue_short_lives_had_no_decimals_and_bounds_no_sense() {
        let row = |cycles: Option<f64>, lower: f64, upper: Option<f64>| LifeRow {
            limit_state: "total".to_owned(),
            reliability: 0.9,
            cycles,
            interval: CyclesRange { lower, upper },
            with_numerical_error: None,
        };
        assert_eq!(life_text(&row(Some(7.4823), 7.1, Some(7.9)), 10.0), "7.48 cycles (7.10 to 7.90)");
        assert_eq!(life_text(&row(Some(7482.3), 7100.0, None), 1e4), "7482 cycles (7100 to beyond 10000)");
        assert_eq!(life_text(&row(None, 10.0, None), 10.0), "beyond 10.00 cycles");
        assert_eq!(life_text(&row(None, 0.0, Some(3.0)), 100.0), "between 0.0 and 3.0 cycles");
        let unworn = life_text(&row(None, 0.0, Some(0.0)), 10.0);
        assert_eq!(unworn, "0 cycles: more units than that exceed a limit unworn");
    }
}
