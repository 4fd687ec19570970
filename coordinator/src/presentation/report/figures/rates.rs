//! Figures of the rates of failure over life: failure density, hazard, and the distribution of lives on Weibull paper.

use super::{LifeAxis, ink_of, range};
use crate::presentation::report::figure::Figure;
use crate::presentation::report::format::{percent, three_digits, whole};
use crate::presentation::report::life::rows_that_matter;
use crate::presentation::report::palette::Ink;
use crate::presentation::report::plot::{Axis, Band, Plot, PlotError, Points, Series, Shape};
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

/// Shares of failures between which the Weibull line is fitted, and drawn points [1].
const FITTED: (f64, f64) = (0.01, 0.99);
const DRAWN: (f64, f64) = (1e-4, 0.9999);

/// Failure density and hazard over intervals of life, and Weibull paper; no figure for a study without curves, or where
/// nothing fails.
///
/// # Errors
/// [`PlotError`].
pub fn failure_rates(summary: &StudySummary) -> Result<Vec<Figure>, PlotError> {
    let falls =
        summary.reliability.last().is_some_and(|row| row.reliability.get("total") < Some(&(1.0 - FEW)));
    if summary.is_static() || summary.curves.is_empty() || !falls {
        return Ok(vec![]);
    }
    let mut names: Vec<&str> = summary.limit_states.iter().map(String::as_str).collect();
    if names.len() != 1 {
        names.push("total");
    }
    let curves: Vec<(&str, &LifeCurveRow)> = names
        .iter()
        .filter_map(|name| Some((*name, summary.curves.iter().find(|curve| curve.limit_state == *name)?)))
        .collect();
    let density = |curve: &SurvivalCurve, from: f64, to: f64| Some(PER * curve.rate(from, to).density);
    let hazard = |curve: &SurvivalCurve, from: f64, to: f64| {
        let rate = (curve.at(to) > FEW).then(|| curve.rate(from, to))?;
        rate.hazard.map(|h| PER * h)
    };
    let mut figures = vec![
        over_life(
            summary,
            &curves,
            DrawnRate { name: "failure-density", title: "Failure density", of: density },
        )?,
        over_life(summary, &curves, DrawnRate { name: "hazard", title: "Hazard rate", of: hazard })?,
    ];
    figures.extend(weibull_paper(summary, &curves)?);
    Ok(figures)
}

/// A rate of failures that is drawn over life.
struct DrawnRate<F> {
    name: &'static str,
    title: &'static str,
    of: F,
}

fn over_life(
    summary: &StudySummary,
    curves: &[(&str, &LifeCurveRow)],
    rate: DrawnRate<impl Fn(&SurvivalCurve, f64, f64) -> Option<f64>>,
) -> Result<Figure, PlotError> {
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
            CurveBand::new(&row.cycles, &row.reliability, limits(row), summary.population, &mut rng)
        });
        let (mut line, mut area): (Points, Band) = (vec![], vec![]);
        for pair in ends.windows(2) {
            let value = |curve: &SurvivalCurve| (rate.of)(curve, pair[0], pair[1]);
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
    let label = format!("{} [1/1000 cycles]", rate.title.to_lowercase());
    let plot = Plot {
        figure: rate.name,
        x: Axis::linear(axis.label, (axis.place_time(ends[0]), axis.place_time(ends[ends.len() - 1]))),
        y: Axis::linear(&label, (0.0, 1.05 * most.max(1e-12))),
        series: &series,
    };
    let what = if rate.name == "hazard" {
        format!(
            "Failures per 1000 cycles of those that still work, −d ln R/dn, as means over the intervals shown; not drawn where \
             fewer than {} survive.",
            percent(FEW)
        )
    } else {
        "Failures per 1000 cycles of all that began, −dR/dn, as means over the intervals shown.".to_owned()
    };
    plot.figure(
        rate.title,
        &format!(
            "{what} Band: 95 % interval of the whole {} with every error that the study states.",
            summary.subject()
        ),
    )
}

/// Limits of a curve with every error that is known.
fn limits(row: &LifeCurveRow) -> [&[f64]; 2] {
    if row.numerical_lower.is_empty() {
        [&row.lower, &row.upper]
    } else {
        [&row.numerical_lower, &row.numerical_upper]
    }
}

/// Weibull's coordinate of a share that has failed: ln(-ln(1 - F)).
fn weibull(failed: f64) -> f64 {
    (-(-failed).ln_1p()).ln()
}

/// A Weibull distribution of lives, F = 1 - exp(-(t / scale)^shape).
///
/// # Source
/// Weibull (1951), A statistical distribution function of wide applicability, Journal of Applied Mechanics 18, 293-297.
#[derive(Debug, Clone, Copy, PartialEq)]
struct WeibullLine {
    shape: f64,
    scale: f64,
}

impl WeibullLine {
    /// The straight line ln(-ln(1 - F)) = shape (ln t - ln scale) with the least squares through points (t, F); `None` for
    /// fewer than three points or lives that are all equal.
    fn through(points: &[(f64, f64)]) -> Option<Self> {
        let n = points.len() as f64;
        let (x, y): (Vec<f64>, Vec<f64>) = points.iter().map(|(t, f)| (t.ln(), weibull(*f))).unzip();
        let (mx, my) = (x.iter().sum::<f64>() / n, y.iter().sum::<f64>() / n);
        let spread: f64 = x.iter().map(|x| (x - mx).powi(2)).sum();
        let shape = x.iter().zip(&y).map(|(x, y)| (x - mx) * (y - my)).sum::<f64>() / spread;
        let fits = points.len() > 2 && shape.is_finite() && shape > 0.0;
        fits.then(|| Self { shape, scale: (mx - my / shape).exp() })
    }

    fn failed(&self, time: f64) -> f64 {
        -(-(time / self.scale).powf(self.shape)).exp_m1()
    }
}

fn weibull_paper(
    summary: &StudySummary,
    curves: &[(&str, &LifeCurveRow)],
) -> Result<Option<Figure>, PlotError> {
    let within = |(low, high): (f64, f64), row: &LifeCurveRow| -> Vec<(f64, f64)> {
        let points = row.cycles.iter().zip(&row.reliability).map(|(t, r)| (*t, 1.0 - r));
        points.filter(|(t, f)| *t > 0.0 && (low..=high).contains(f)).collect()
    };
    let mut series = Vec::new();
    let (mut lives, mut shares) = (Vec::new(), Vec::new());
    let paper =
        |points: &[(f64, f64)]| -> Points { points.iter().map(|(t, f)| (t.log10(), weibull(*f))).collect() };
    let mut fit = String::new();
    for (k, (name, row)) in curves.iter().enumerate() {
        let drawn = within(DRAWN, row);
        lives.extend(drawn.iter().map(|point| point.0.log10()));
        shares.extend(drawn.iter().map(|point| weibull(point.1)));
        let ink = ink_of(summary, name);
        series.push(Series::new(*name, ink, Shape::Line(paper(&drawn))));
        let fitted = within(FITTED, row);
        // The last curve is that of the whole system.
        let Some(line) = WeibullLine::through(&fitted).filter(|_| k + 1 == curves.len()) else { continue };
        let along: Vec<(f64, f64)> = drawn.iter().map(|(t, _)| (*t, line.failed(*t))).collect();
        let on_paper = along.into_iter().filter(|(_, f)| (DRAWN.0..=DRAWN.1).contains(f)).collect::<Vec<_>>();
        series.push(Series::new(
            format!("Weibull fit to {name}"),
            Ink::Muted,
            Shape::Dashed(paper(&on_paper)),
        ));
        let off = fitted.iter().map(|(t, f)| (f - line.failed(*t)).abs()).fold(0.0, f64::max);
        fit = format!(
            " Fit to {name} between {} and {} by least squares: shape {}, scale {} cycles; its F is off by at most {}.",
            percent(FITTED.0),
            percent(FITTED.1),
            three_digits(line.shape),
            whole(line.scale),
            percent(off)
        );
    }
    if lives.len() < 3 {
        return Ok(None);
    }
    let text = |y: f64| three_digits(-100.0 * (-y.exp()).exp_m1());
    let plot = Plot {
        figure: "weibull-paper",
        x: Axis {
            text: |power| whole(10f64.powf(power)),
            value: |power| 10f64.powf(power),
            ..Axis::linear("life [cycles]", range(lives.into_iter()))
        },
        y: Axis {
            text,
            value: |y| -100.0 * (-y.exp()).exp_m1(),
            ..Axis::linear("failed F [%]", range(shares.into_iter()))
        },
        series: &series,
    };
    let caption = format!(
        "Shares that have failed over ln(−ln(1 − F)) and the logarithm of life: lives of a Weibull distribution are a straight \
         line.{fit}"
    );
    plot.figure("Lives on Weibull paper", &caption).map(Some)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_study;

    #[test]
    fn a_weibull_distribution_is_its_own_fit() {
        let line = WeibullLine { shape: 2.5, scale: 3000.0 };
        let points: Vec<(f64, f64)> =
            (1..9).map(|k| 500.0 * f64::from(k)).map(|t| (t, line.failed(t))).collect();
        let found = WeibullLine::through(&points).unwrap();
        assert!((found.shape - 2.5).abs() < 1e-9 && (found.scale - 3000.0).abs() < 1e-6, "{found:?}");
        assert_eq!(WeibullLine::through(&points[..2]), None);
        assert_eq!(WeibullLine::through(&[(5.0, 0.1); 4]), None);
    }

    #[test]
    fn the_density_contains_all_failures_and_the_hazard_is_larger() {
        let summary = test_study::study().summary;
        let figures = failure_rates(&summary).unwrap();
        let names: Vec<&str> = figures.iter().map(|figure| figure.name.as_str()).collect();
        assert_eq!(names, ["failure-density", "hazard", "weibull-paper"]);
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
        assert!(failure_rates(&summary).unwrap().is_empty());
    }
}
