//! Updated units with their tables and figures, and as CSV.

use super::result::{FleetReport, RemainingLife, UnitReport, UpdatedVariable};
use crate::presentation::format::rounded_cycles;
use crate::presentation::report::{
    Answer, AnswerPart, Axis, Figure, Ink, Plot, Points, SERIES, Series, Shape, Table, csv,
};
use crate::results::csv_table::number;
use crate::results::summary::ReliabilityRow;

/// Units whose variables are listed: with more, only the table of units is.
const DETAILED: usize = 3;
/// Variables that are listed.
const SHOWN: usize = 8;
/// Change of a mean or a standard deviation from which a variable is listed [standard deviations of the study].
const CHANGED: f64 = 0.1;

/// The units as a table with figures; of a few units the variables that changed.
pub fn answer(report: &FleetReport) -> Answer {
    let units = &report.units;
    let head = ["unit", "observed until", "R up to then", "5 %", "50 %", "95 %", "sample size", "method"];
    let rows = units.iter().map(|unit| unit_row(unit, report.end));
    let meaning = "5 %, 50 %, 95 %: remaining life that the unit exceeds with a probability of 95 %, 50 %, 5 % (quantiles). R up to then: \
         probability that the unit had not failed by its last observation, with its standard error by the sample size. The quantiles \
         contain the errors of measurement and surrogates. The numerical error of the simulations widens the likelihood of a \
         measurement; it is not in the quantiles. Sample size: effective number of points of the population.";
    let mut parts = vec![
        AnswerPart::Figures,
        AnswerPart::Table(Table::new("", head, rows).with_left(&[0, 7])),
        AnswerPart::Text(meaning.to_owned()),
    ];
    parts.splice(0..0, report.caution.clone().map(AnswerPart::Text));
    if units.len() <= DETAILED {
        parts.extend(units.iter().filter(|unit| !unit.variables.is_empty()).map(variables));
    }
    let warned = units.iter().filter_map(|unit| Some((&unit.unit, unit.warning.as_ref()?)));
    let warnings: Vec<_> = warned.map(|(unit, warning)| format!("warning: unit {unit}: {warning}")).collect();
    if !warnings.is_empty() {
        parts.push(AnswerPart::Notes("To be checked", warnings));
    }
    Answer {
        name: "update".to_owned(),
        title: format!("{} of {}", counted_units(units.len()), report.scene),
        subtitle: "Remaining life after the last observation, all lives in cycles; no simulation was made"
            .to_owned(),
        parts,
        figures: figures(report),
        files: vec![("units.csv".to_owned(), units_csv(report))],
        ..Answer::default()
    }
}

/// A number of units in words.
pub(in crate::analyses) fn counted_units(n: usize) -> String {
    format!("{n} {}", if n == 1 { "unit" } else { "units" })
}

/// The cells of a unit in the table.
fn unit_row(unit: &UnitReport, end: f64) -> Vec<String> {
    let UnitReport { observed_until: now, stages, effective_size: size, resolved, .. } = unit;
    let (name, until) = (unit.unit.clone(), format!("{now:.0}"));
    let Some(there) = unit.reliability.first() else {
        let nothing = ["–"; 5].map(str::to_owned);
        let why = "no point of the model agrees, see below".to_owned();
        return [name, until].into_iter().chain(nothing).chain([why]).collect();
    };
    let r = format!("{:.3} ± {:.3}", there.reliability["total"], there.standard_error["total"]);
    let RemainingLife { p5, p50, p95, .. } = unit.remaining;
    let width = 0.5 * (p95.unwrap_or(end - now) - p5.unwrap_or(0.0));
    // Whole cycles but for lives that these would not tell apart.
    let cycles = |life| if width < 10.0 { rounded_cycles(life, width) } else { format!("{life:.0}") };
    let left = |life: Option<f64>| life.map_or_else(|| format!("> {}", cycles(end - now)), cycles);
    let monte_carlo = || format!("sequential Monte Carlo, {stages} stages");
    let method = if *stages == 0 { "weights".to_owned() } else { monte_carlo() };
    let [low, median, high] = match unit.failed_by {
        Some(_) => ["failed"; 3].map(str::to_owned),
        None if !resolved => ["not resolved"; 3].map(str::to_owned),
        None => [p5, p50, p95].map(left),
    };
    let size = if *resolved { format!("{size:.0}") } else { format!("{size:.2}") };
    vec![name, until, r, low, median, high, size, method]
}

/// The variables of which the observations say most.
fn variables(unit: &UnitReport) -> AnswerPart {
    let change = |v: &UpdatedVariable| {
        ((v.mean - v.prior_mean).abs() / v.prior_std).max((v.std / v.prior_std - 1.0).abs())
    };
    let varying = unit.variables.iter().filter(|v| v.prior_std > 0.0);
    let mut changed: Vec<&UpdatedVariable> = varying.filter(|v| change(v) > CHANGED).collect();
    changed.sort_by(|a, b| change(b).total_cmp(&change(a)));
    if changed.is_empty() {
        return AnswerPart::Text(format!(
            "{}: no variable's mean or standard deviation changes by more than {CHANGED} standard deviations",
            unit.unit
        ));
    }
    let heading = format!("{}: variables in standard deviations of the study", unit.unit);
    let rows = changed.iter().take(SHOWN).map(|v| {
        let (mean, std) = ((v.mean - v.prior_mean) / v.prior_std, v.std / v.prior_std);
        vec![v.name.clone(), format!("{mean:+.2}"), format!("{std:.2}")]
    });
    AnswerPart::Table(Table::new(heading, ["variable", "change of mean", "standard deviation"], rows))
}

/// One row per unit: `unit, observed_until, R, R_standard_error, remaining_5, remaining_50, remaining_95, effective_size,
/// stages, least_probability, warning`; lives beyond the study are empty. The least probability is at least what the number of
/// points resolves.
fn units_csv(report: &FleetReport) -> String {
    let head = "unit,observed_until,R,R_standard_error,remaining_5,remaining_50,remaining_95,effective_size,stages,least_probability,\
                warning";
    let or_empty = |value: Option<f64>| value.map_or(String::new(), number);
    let row = |unit: &UnitReport| {
        let there = unit.reliability.first();
        let [r, error] =
            [there.map(|row| row.reliability["total"]), there.map(|row| row.standard_error["total"])];
        let RemainingLife { p5, p50, p95, .. } = unit.remaining;
        let [r, error, p5, p50, p95] = [r, error, p5, p50, p95].map(or_empty);
        let least = unit.observations.iter().map(|o| o.probability.max(o.resolution));
        let least = least.fold(f64::INFINITY, f64::min);
        let [until, size, least] = [unit.observed_until, unit.effective_size, least].map(number);
        let (name, stages) = (unit.unit.clone(), unit.stages.to_string());
        let warning = unit.warning.clone().unwrap_or_default();
        [name, until, r, error, p5, p50, p95, size, stages, least, warning]
    };
    csv(head.split(','), report.units.iter().map(row))
}

/// The remaining lives, and of as many units as there are colours the curves.
fn figures(fleet: &FleetReport) -> Vec<Figure> {
    let curves = (fleet.units.len() <= SERIES).then(|| curves(fleet));
    std::iter::once(remaining(fleet)).chain(curves).collect()
}

/// Median and 5 to 95 % of the remaining life of every unit, in order of the median.
fn remaining(fleet: &FleetReport) -> Figure {
    let living = fleet.units.iter().filter(|unit| unit.failed_by.is_none() && unit.resolved);
    let lives = |unit: &UnitReport| {
        let end = fleet.end - unit.observed_until;
        let RemainingLife { p5, p50, p95, .. } = unit.remaining;
        [p50, p5, p95].map(|life| life.unwrap_or(end))
    };
    let mut units: Vec<[f64; 3]> = living.map(lives).collect();
    units.sort_by(|a, b| a[0].total_cmp(&b[0]));
    let most = units.iter().map(|[_, _, high]| *high).fold(1.0, f64::max);
    let points =
        (1..).zip(&units).map(|(place, [median, low, high])| [f64::from(place), *median, *low, *high]);
    let series = [Series::new("median, 5 to 95 %", Ink::Series(0), Shape::Measured(points.collect()))];
    let x = Axis::linear("unit, in order of its remaining life", (0.0, units.len() as f64 + 1.0));
    let y = Axis::linear("remaining life [cycles]", (0.0, 1.05 * most));
    let caption = "Dot: median; bar: 5 to 95 %. Lives beyond the end of the study are drawn at its end.";
    Plot { figure: "remaining-life", x, y, series: &series }.figure("Remaining life", caption)
}

/// R of every unit from the life up to which it was observed, and of a unit of which nothing is known.
fn curves(fleet: &FleetReport) -> Figure {
    let points = |rows: &[ReliabilityRow]| -> Points {
        rows.iter().map(|row| (f64::from(row.cycles), row.reliability["total"])).collect()
    };
    let before = Series::new("nothing measured", Ink::Muted, Shape::Dashed(points(&fleet.reliability)));
    let units = fleet
        .units
        .iter()
        .enumerate()
        .map(|(k, unit)| Series::new(&unit.unit, Ink::Series(k), Shape::Line(points(&unit.reliability))));
    let series: Vec<Series> = [before].into_iter().chain(units).collect();
    let x = Axis::linear("life [cycles]", (0.0, fleet.end));
    let caption = "Probability of no failure up to this life, given what was observed of each unit.";
    Plot::of_reliability("updated-reliability", x, &series).figure("Reliability", caption)
}
