//! Figures of the rates of failure over life: failure density and hazard, and beside them the probability papers.

use super::papers::papers;
use super::{LifeAxis, ink_of, span};
use crate::presentation::report::format::percent;
use crate::presentation::report::life::rows_that_matter;
use crate::presentation::report::{Axis, Band, Figure, Plot, Points, Series, Shape};
use crate::results::life_summary::LifeCurveRow;
use crate::results::summary::StudySummary;
use crate::statistics::design::{Stream, open_stream};
use crate::statistics::replacement::{CurveBand, SurvivalCurve};

/// Rates are stated per this many cycles.
const PER: f64 = 1000.0;

/// Share of survivors below which a hazard is not drawn: it would be that of few [1].
const FEW: f64 = 0.01;

/// Least number of intervals over which rates are means: those between the checkpoints, or equal parts of them.
const INTERVALS: usize = 12;

/// Failure density and hazard over intervals of life, and the probability papers; no figure for a study without curves, or where
/// nothing fails.
pub fn failure_rates(summary: &StudySummary) -> Vec<Figure> {
    let falls =
        summary.reliability.last().is_some_and(|row| row.reliability.get("total") < Some(&(1.0 - FEW)));
    if summary.is_static() || summary.curves.is_empty() || !falls {
        return vec![];
    }
    let curves: Vec<(&str, &LifeCurveRow)> = summary
        .curve_names()
        .filter_map(|name| Some((name, summary.curves.iter().find(|curve| curve.limit_state == name)?)))
        .collect();
    let density = |curve: &SurvivalCurve, from: f64, to: f64| Some(PER * curve.rate(from, to).density);
    let hazard = |curve: &SurvivalCurve, from: f64, to: f64| {
        let rate = (curve.at(to) > FEW).then(|| curve.rate(from, to))?;
        rate.hazard.map(|h| PER * h)
    };
    let mut figures = vec![
        over_life(summary, &curves, ["failure-density", "Failure density"], density),
        over_life(summary, &curves, ["hazard", "Hazard rate"], hazard),
    ];
    figures.extend(papers(summary, &curves));
    figures
}

/// A rate of failures between two lives of a curve, over life; with the `name` and the `title` of its figure.
fn over_life(
    summary: &StudySummary,
    curves: &[(&str, &LifeCurveRow)],
    [figure, title]: [&str; 2],
    rate: impl Fn(&SurvivalCurve, f64, f64) -> Option<f64>,
) -> Figure {
    let axis = LifeAxis::new(summary);
    let rows = rows_that_matter(summary, 1);
    let from = rows.first().map_or(0, |first| first.cycles);
    let mut ends: Vec<f64> = rows.iter().map(|row| f64::from(row.cycles)).collect();
    // A first checkpoint with failures has its interval before it.
    if summary.reliability.first().is_some_and(|first| first.cycles == from) {
        ends.insert(0, 0.0);
    }
    let parts = INTERVALS.div_ceil(ends.len().saturating_sub(1).max(1));
    let within = |pair: &[f64], k: usize| pair[0] + (pair[1] - pair[0]) * k as f64 / parts as f64;
    let last = ends[ends.len() - 1];
    let mut ends: Vec<f64> =
        ends.windows(2).flat_map(|pair| (0..parts).map(move |k| within(pair, k))).collect();
    ends.push(last);
    let mut series = Vec::new();
    let mut most = 0.0f64;
    for (k, (name, row)) in curves.iter().enumerate() {
        let curve = SurvivalCurve::new(&row.cycles, &row.reliability);
        // The band of the whole system alone: several on top of each other cannot be told apart.
        let band = (k + 1 == curves.len()).then(|| {
            let mut rng = open_stream(summary.seed, Stream::Curve);
            CurveBand::new(&row.cycles, &row.reliability, row.limits(), summary.population, &mut rng)
        });
        let (mut line, mut area): (Points, Band) = (vec![], vec![]);
        for pair in ends.windows(2) {
            let value = |curve: &SurvivalCurve| rate(curve, pair[0], pair[1]);
            let Some(best) = value(&curve) else { continue };
            let [left, right] = [pair[0], pair[1]].map(|time| axis.place_time(time));
            line.extend([(left, best), (right, best)]);
            most = most.max(best);
            if let Some(interval) = band.as_ref().and_then(|band| band.interval(value)) {
                let [lower, upper] = [interval.lower, interval.upper];
                area.extend([(left, lower, upper), (right, lower, upper)]);
                most = most.max(upper);
            }
        }
        let ink = ink_of(summary, name);
        if band.is_some() {
            series.insert(0, Series::unlisted(format!("{name}, band"), ink, Shape::Band(area)));
        }
        let shape = if *name == "total" { Shape::Dashed(line) } else { Shape::Line(line) };
        series.push(Series::new(*name, ink, shape));
    }
    let label = format!("{} [1/1000 cycles]", title.to_lowercase());
    let x = Axis::linear(axis.label, span(summary, &axis));
    let y = Axis::linear(&label, (0.0, 1.05 * most.max(1e-12)));
    let what = if figure == "hazard" {
        format!(
            "Failures per 1000 cycles of those that still work, −d ln R/dn, as means over the intervals shown; not drawn where \
             fewer than {} survive.",
            percent(FEW)
        )
    } else {
        "Failures per 1000 cycles of all that began, −dR/dn, as means over the intervals shown.".to_owned()
    };
    let band =
        format!("95 % interval of the whole {} with every error that the study states", summary.subject());
    Plot { figure, x, y, series: &series }.figure(title, &format!("{what} Band: {band}."))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_study;

    #[test]
    fn the_density_contains_all_failures_and_the_hazard_is_larger() {
        let summary = test_study::study().summary;
        let figures = failure_rates(&summary);
        let names: Vec<&str> = figures.iter().map(|figure| figure.name.as_str()).collect();
        assert_eq!(names, ["failure-density", "hazard", "weibull-paper", "lognormal-paper"]);
        // Rows of the CSV of the total, (life, rate) in pairs of equal rates.
        let steps = |figure: &Figure| -> Vec<(f64, f64)> {
            let cells = |line: &str| line.split(',').map(str::to_owned).collect::<Vec<_>>();
            let rows = figure.csv.lines().map(cells).filter(|row| row[0] == "total");
            rows.map(|row| (row[1].parse().unwrap(), row[2].parse().unwrap())).collect()
        };
        let (density, hazard) = (steps(&figures[0]), steps(&figures[1]));
        // The life axis is in 1000 cycles, the rate per 1000 cycles.
        let failed: f64 = density.chunks(2).map(|pair| (pair[1].0 - pair[0].0) * pair[0].1).sum();
        let last = 1.0 - summary.reliability.last().unwrap().reliability["total"];
        assert!((failed - last).abs() < 1e-3, "{failed} of {last}");
        assert!(hazard.iter().zip(&density).all(|(h, d)| h.1 >= d.1 - 1e-12));
    }

    #[test]
    fn nothing_that_fails_has_no_rates() {
        let mut summary = test_study::study().summary;
        summary.reliability.iter_mut().for_each(|row| row.reliability.values_mut().for_each(|r| *r = 1.0));
        assert!(failure_rates(&summary).is_empty());
    }
}
