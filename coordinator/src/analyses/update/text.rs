//! Updated units as text and as CSV.

use super::result::{FleetReport, UnitReport, UpdatedVariable};
use crate::presentation::text_table::in_columns;
use crate::results::csv_table::{CsvTable, number};
use std::fmt::Write;

/// Units whose variables are printed: with more, only the table of units is.
const DETAILED: usize = 3;
/// Variables that are printed.
const SHOWN: usize = 8;
/// Change of a mean or a standard deviation from which a variable is printed [standard deviations of the study].
const CHANGED: f64 = 0.1;

/// The units as a table; of a few units the variables that changed.
pub fn text(report: &FleetReport) -> String {
    let mut out = String::new();
    // Writing to a String cannot fail.
    let _ = write_report(&mut out, report);
    out
}

/// The number of units with its noun.
fn counted(units: usize) -> String {
    format!("{units} {}", if units == 1 { "unit" } else { "units" })
}

fn write_report(out: &mut String, report: &FleetReport) -> std::fmt::Result {
    writeln!(
        out,
        "{} of {}: remaining life after the last observation, all lives in cycles; no simulation was made\n",
        counted(report.units.len()),
        report.scene
    )?;
    let head = ["unit", "observed until", "R up to then", "5 %", "50 %", "95 %", "sample size", "method"];
    let rows = report.units.iter().map(|unit| unit_row(unit, report.end));
    let table: Vec<Vec<String>> = std::iter::once(head.map(str::to_owned).to_vec()).chain(rows).collect();
    out.push_str(&in_columns(&table, &[0, 7]));
    writeln!(
        out,
        "\n5 %, 50 %, 95 %: remaining life that the unit exceeds with a probability of 95 %, 50 %, 5 % (quantiles). R up to then: \
         probability that the unit had not failed by its last observation, with its standard error by the sample size. The quantiles \
         contain the errors of measurement and surrogates. The numerical error of the simulations widens the likelihood of a \
         measurement but does not shift the lives. Sample size: effective number of points of the population."
    )?;
    if report.units.len() <= DETAILED {
        for unit in report.units.iter().filter(|unit| !unit.variables.is_empty()) {
            write_variables(out, unit)?;
        }
    }
    let mut warned =
        report.units.iter().filter_map(|unit| Some((&unit.unit, unit.warning.as_ref()?))).peekable();
    if warned.peek().is_some() {
        writeln!(out)?;
    }
    for (unit, warning) in warned {
        writeln!(out, "warning: unit {unit}: {warning}")?;
    }
    Ok(())
}

/// The cells of a unit in the table.
fn unit_row(unit: &UnitReport, end: f64) -> Vec<String> {
    let now = unit.observed_until;
    if unit.reliability.is_empty() {
        let nothing = ["–"; 5].map(str::to_owned);
        let start = [unit.unit.clone(), format!("{now:.0}")];
        let why = "no point of the model agrees, see below".to_owned();
        return start.into_iter().chain(nothing).chain([why]).collect();
    }
    let there = &unit.reliability[0];
    let r = format!("{:.3} ± {:.3}", there.reliability["total"], there.standard_error["total"]);
    let left = |life: Option<f64>| life.map_or(format!("> {:.0}", end - now), |life| format!("{life:.0}"));
    let method = if unit.stages == 0 {
        "weights".to_owned()
    } else {
        format!("sequential Monte Carlo, {} stages", unit.stages)
    };
    let [low, median, high] = match unit.failed_by {
        Some(_) => ["failed", "failed", "failed"].map(str::to_owned),
        None if !unit.resolved => ["not resolved"; 3].map(str::to_owned),
        None => [unit.remaining.p5, unit.remaining.p50, unit.remaining.p95].map(left),
    };
    let size = if unit.resolved {
        format!("{:.0}", unit.effective_size)
    } else {
        format!("{:.2}", unit.effective_size)
    };
    vec![unit.unit.clone(), format!("{now:.0}"), r, low, median, high, size, method]
}

/// The variables of which the observations say most.
fn write_variables(out: &mut String, unit: &UnitReport) -> std::fmt::Result {
    let change = |v: &UpdatedVariable| {
        if v.prior_std > 0.0 {
            ((v.mean - v.prior_mean).abs() / v.prior_std).max((v.std / v.prior_std - 1.0).abs())
        } else {
            0.0
        }
    };
    let mut changed: Vec<&UpdatedVariable> = unit.variables.iter().filter(|v| change(v) > CHANGED).collect();
    changed.sort_by(|a, b| change(b).total_cmp(&change(a)));
    if changed.is_empty() {
        return writeln!(
            out,
            "\n{}: no variable's mean or standard deviation changes by more than {CHANGED} standard deviations",
            unit.unit
        );
    }
    writeln!(out, "\n{}: variables in standard deviations of the study", unit.unit)?;
    let head = ["variable", "change of mean", "standard deviation"];
    let rows = changed.iter().take(SHOWN).map(|v| {
        let (mean, std) = ((v.mean - v.prior_mean) / v.prior_std, v.std / v.prior_std);
        vec![v.name.clone(), format!("{mean:+.2}"), format!("{std:.2}")]
    });
    let table: Vec<Vec<String>> = std::iter::once(head.map(str::to_owned).to_vec()).chain(rows).collect();
    out.push_str(&in_columns(&table, &[0]));
    Ok(())
}

/// One row per unit: `unit, observed_until, R, R_standard_error, remaining_5, remaining_50, remaining_95, effective_size,
/// stages, least_probability, warning`; lives beyond the study are empty. The least probability is at least what the number of
/// points resolves.
pub fn csv(report: &FleetReport) -> String {
    let mut table = CsvTable::new([
        "unit",
        "observed_until",
        "R",
        "R_standard_error",
        "remaining_5",
        "remaining_50",
        "remaining_95",
        "effective_size",
        "stages",
        "least_probability",
        "warning",
    ]);
    for unit in &report.units {
        let or_empty = |value: Option<f64>| value.map_or(String::new(), number);
        let there = unit.reliability.first();
        let least =
            unit.observations.iter().map(|o| o.probability.max(o.resolution)).fold(f64::INFINITY, f64::min);
        table.push([
            unit.unit.clone(),
            number(unit.observed_until),
            or_empty(there.map(|row| row.reliability["total"])),
            or_empty(there.map(|row| row.standard_error["total"])),
            or_empty(unit.remaining.p5),
            or_empty(unit.remaining.p50),
            or_empty(unit.remaining.p95),
            number(unit.effective_size),
            unit.stages.to_string(),
            number(least),
            unit.warning.clone().unwrap_or_default(),
        ]);
    }
    table.into_text()
}
