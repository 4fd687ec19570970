//! Updated units with their tables and figures, and as CSV.

use super::result::{FleetReport, RemainingLife, UnitReport, UpdatedVariable};
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
    let counted = format!("{} {}", units.len(), if units.len() == 1 { "unit" } else { "units" });
    let head = ["unit", "observed until", "R up to then", "5 %", "50 %", "95 %", "sample size", "method"];
    let rows = units.iter().map(|unit| unit_row(unit, report.end));
    let meaning = "5 %, 50 %, 95 %: remaining life that the unit exceeds with a probability of 95 %, 50 %, 5 % (quantiles). R up to then: \
         probability that the unit had not failed by its last observation, with its standard error by the sample size. The quantiles \
         contain the errors of measurement and surrogates. The numerical error of the simulations widens the likelihood of a \
         measurement but does not shift the lives. Sample size: effective number of points of the population.";
    let mut parts = vec![
        AnswerPart::Figures,
        AnswerPart::Table(Table::new("", head, rows).with_left(&[0, 7])),
        AnswerPart::Text(meaning.to_owned()),
    ];
    if units.len() <= DETAILED {
        parts.extend(units.iter().filter(|unit| !unit.variables.is_empty()).map(variables));
    }
    let warning = |unit: &UnitReport| {
        unit.warning.as_ref().map(|warning| format!("warning: unit {}: {warning}", unit.unit))
    };
    let warnings: Vec<String> = units.iter().filter_map(warning).collect();
    if !warnings.is_empty() {
        parts.push(AnswerPart::Notes("To be checked", warnings));
    }
    Answer {
        name: "update".to_owned(),
        title: format!("{counted} of {}", report.scene),
        subtitle: "Remaining life after the last observation, all lives in cycles; no simulation was made"
            .to_owned(),
        parts,
        figures: figures(report),
        files: vec![("units.csv".to_owned(), units_csv(report))],
        ..Answer::default()
    }
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
fn variables(unit: &UnitReport) -> AnswerPart {
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
        let least =
            unit.observations.iter().map(|o| o.probability.max(o.resolution)).fold(f64::INFINITY, f64::min);
        [
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
        ]
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
    let points: Vec<[f64; 4]> = (1..)
        .zip(&units)
        .map(|(place, [median, low, high])| [f64::from(place), *median, *low, *high])
        .collect();
    let most = points.iter().map(|point| point[3]).fold(1.0, f64::max);
    let series = [Series::new("median, 5 to 95 %", Ink::Series(0), Shape::Measured(points))];
    let x = Axis::linear("unit, in order of its remaining life", (0.0, units.len() as f64 + 1.0));
    let y = Axis::linear("remaining life [cycles]", (0.0, 1.05 * most));
    Plot { figure: "remaining-life", x, y, series: &series }.figure(
        "Remaining life",
        "Dot: median; bar: 5 to 95 %. Lives beyond the end of the study are drawn at its end.",
    )
}

/// R of every unit from the life up to which it was observed, and of a unit of which nothing is known.
fn curves(fleet: &FleetReport) -> Figure {
    let points = |rows: &[ReliabilityRow]| -> Points {
        rows.iter().map(|row| (f64::from(row.cycles), row.reliability["total"])).collect()
    };
    let before = Shape::Dashed(points(&fleet.reliability));
    let mut series = vec![Series::new("nothing measured", Ink::Muted, before)];
    for (k, unit) in fleet.units.iter().enumerate() {
        series.push(Series::new(&unit.unit, Ink::Series(k), Shape::Line(points(&unit.reliability))));
    }
    let x = Axis::linear("life [cycles]", (0.0, fleet.end));
    Plot::of_reliability("updated-reliability", x, &series).figure(
        "Reliability",
        "Probability of no failure up to this life, given what was observed of each unit.",
    )
}
