//! Figures of the rates of failure over life: failure density and hazard, and beside them the probability papers.

use super::{LifeAxis, ink_of, range, span};
use crate::presentation::report::format::{percent, seven_digits, three_digits, whole};
use crate::presentation::report::life::rows_that_matter;
use crate::presentation::report::{Axis, Band, Figure, Ink, Plot, Points, Scale, Series, Shape, tick_label};
use crate::results::life_summary::LifeCurveRow;
use crate::results::summary::StudySummary;
use crate::statistics::design::{Stream, open_stream};
use crate::statistics::replacement::{CurveBand, SurvivalCurve};
use common::random::standard_normal_cdf;

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
    let curve = |name| Some((name, summary.curves.iter().find(|curve| curve.limit_state == name)?));
    let curves: Vec<(&str, &LifeCurveRow)> = summary.curve_names().filter_map(curve).collect();
    let density = |curve: &SurvivalCurve, from: f64, to: f64| Some(PER * curve.rate(from, to).0);
    let hazard = |curve: &SurvivalCurve, from: f64, to: f64| {
        let rate = (curve.at(to) > FEW).then(|| curve.rate(from, to))?;
        rate.1.map(|h| PER * h)
    };
    let density = over_life(summary, &curves, ["failure-density", "Failure density"], density);
    let hazard = over_life(summary, &curves, ["hazard", "Hazard rate"], hazard);
    [density, hazard].into_iter().chain(papers(summary, &curves)).collect()
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
    let parted = ends.windows(2).flat_map(|pair| (0..parts).map(move |k| within(pair, k)));
    let ends: Vec<f64> = parted.chain([last]).collect();
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
            let [left, right] = [pair[0], pair[1]].map(|time| axis.place(time));
            line.extend([(left, best), (right, best)]);
            most = most.max(best);
            if let Some([lower, upper]) = band.as_ref().and_then(|band| band.interval(value)) {
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
    let shown = "as means over the intervals shown";
    let what = if figure == "hazard" {
        let few = percent(FEW);
        format!("of those that still work, −d ln R/dn, {shown}; not drawn where fewer than {few} survive")
    } else {
        format!("of all that began, −dR/dn, {shown}")
    };
    let caption = format!(
        "Failures per 1000 cycles {what}. Band: 95 % interval of the whole {} with every error that the study states.",
        summary.subject()
    );
    Plot { figure, x, y, series: &series }.figure(title, &caption)
}

/// Shares of failures between which the line is fitted, and drawn points [1].
const FITTED: (f64, f64) = (0.01, 0.99);
const DRAWN: (f64, f64) = (1e-4, 0.9999);

/// A straight line on a paper, y = slope (ln t - ln centre).
///
/// Weibull: y = ln(-ln(1 - F)), slope and centre are shape and scale of F = 1 - exp(-(t / scale)^shape). Lognormal: y = Phi^-1(F), the
/// centre is the median and 1 / slope the standard deviation of ln t.
///
/// # Source
/// Weibull (1951), A statistical distribution function of wide applicability, Journal of Applied Mechanics 18, 293-297;
/// Nelson (1982), Applied Life Data Analysis, chapter 3.
#[derive(Debug, Clone, Copy, PartialEq)]
struct PaperLine {
    scale: Scale,
    slope: f64,
    centre: f64,
}

impl PaperLine {
    /// The line with the least squares through points (t, F); `None` for fewer than three points or lives that are all equal.
    fn through(scale: Scale, points: &[(f64, f64)]) -> Option<Self> {
        let n = points.len() as f64;
        let (x, y): (Vec<f64>, Vec<f64>) = points.iter().map(|(t, f)| (t.ln(), scale.of_share(*f))).unzip();
        let (mx, my) = (x.iter().sum::<f64>() / n, y.iter().sum::<f64>() / n);
        let spread: f64 = x.iter().map(|x| (x - mx).powi(2)).sum();
        let slope = x.iter().zip(&y).map(|(x, y)| (x - mx) * (y - my)).sum::<f64>() / spread;
        let fits = points.len() > 2 && slope.is_finite() && slope > 0.0;
        fits.then(|| Self { scale, slope, centre: (mx - my / slope).exp() })
    }

    /// Share that has failed by a time [1].
    fn failed(&self, time: f64) -> f64 {
        let y = self.slope * (time / self.centre).ln();
        if self.scale == Scale::Weibull { -(-y.exp()).exp_m1() } else { standard_normal_cdf(y) }
    }

    /// Life by which a share has failed [cycles].
    fn life(&self, failed: f64) -> f64 {
        self.centre * (self.scale.of_share(failed) / self.slope).exp()
    }

    /// Parameters and B-lives in words.
    fn in_words(&self) -> String {
        let (centre, slope) = (whole(self.centre), self.slope);
        let parameters = if self.scale == Scale::Weibull {
            format!("shape {}, scale {centre} cycles", three_digits(slope))
        } else {
            let deviation = three_digits(1.0 / slope);
            format!("median {centre} cycles, standard deviation of the logarithm {deviation}")
        };
        let lives = B_LIVES.map(|(name, failed)| format!("{name} {}", whole(self.life(failed))));
        format!("{parameters}; {} cycles", lives.join(", "))
    }
}

/// Lives by which a share has failed, by their usual names.
const B_LIVES: [(&str, f64); 3] = [("B1", 0.01), ("B10", 0.1), ("B50", 0.5)];

/// Time at which a curve has fallen by this share [cycles].
fn life_on(row: &LifeCurveRow, failed: f64) -> Option<f64> {
    let at = row.reliability.iter().position(|r| 1.0 - r >= failed)?;
    let before = at.checked_sub(1)?;
    let share = |k: usize| 1.0 - row.reliability[k];
    let along = (failed - share(before)) / (share(at) - share(before));
    Some(row.cycles[before] + along * (row.cycles[at] - row.cycles[before])).filter(|life| *life > 0.0)
}

/// A life at a tick of a logarithmic axis: whole cycles, or decimals where lives are a few cycles.
fn life_tick(power: f64) -> String {
    let life = 10f64.powf(power);
    if life < 9.5 { tick_label(life) } else { whole(life) }
}

/// Both papers for these curves, the last of which is that of the whole system; none with fewer than three points.
pub fn papers(summary: &StudySummary, curves: &[(&str, &LifeCurveRow)]) -> Vec<Figure> {
    [Scale::Weibull, Scale::Normal].into_iter().filter_map(|scale| figure(scale, summary, curves)).collect()
}

/// Points (t, F) of a curve with shares between two.
fn within((low, high): (f64, f64), row: &LifeCurveRow) -> Vec<(f64, f64)> {
    let points = row.cycles.iter().zip(&row.reliability).map(|(t, r)| (*t, 1.0 - r));
    points.filter(|(t, f)| *t > 0.0 && (low..=high).contains(f)).collect()
}

fn figure(scale: Scale, summary: &StudySummary, curves: &[(&str, &LifeCurveRow)]) -> Option<Figure> {
    let (word, text, what): (_, fn(f64) -> String, _) = if scale == Scale::Weibull {
        ("Weibull", |y| seven_digits(Scale::Weibull.value(y)), "ln(−ln(1 − F))")
    } else {
        ("lognormal", |y| seven_digits(Scale::Normal.value(y)), "the standard normal quantile of F")
    };
    let on_paper = |points: &[(f64, f64)]| -> Points {
        points.iter().map(|(t, f)| (t.log10(), scale.of_share(*f))).collect()
    };
    let (mut series, mut all, mut fit) = (Vec::new(), Points::new(), String::new());
    for (name, row) in curves {
        let drawn = on_paper(&within(DRAWN, row));
        all.extend(&drawn);
        series.push(Series::new(*name, ink_of(summary, name), Shape::Line(drawn)));
    }
    if let Some((name, row)) = curves.last() {
        let fitted = within(FITTED, row);
        if let Some(line) = PaperLine::through(scale, &fitted) {
            let along = within(DRAWN, row).into_iter().map(|(t, _)| (t, line.failed(t)));
            let along: Vec<(f64, f64)> = along.filter(|(_, f)| (DRAWN.0..=DRAWN.1).contains(f)).collect();
            let label = format!("{word} fit to {name}");
            series.push(Series::new(label, Ink::Muted, Shape::Dashed(on_paper(&along))));
            let off = fitted.iter().map(|(t, f)| (f - line.failed(*t)).abs()).fold(0.0, f64::max);
            fit = format!(
                " Fit to {name} between {} and {} by least squares: {}; its F is off by at most {}.",
                percent(FITTED.0),
                percent(FITTED.1),
                line.in_words(),
                percent(off)
            );
        }
        let marks = B_LIVES.iter().filter_map(|(mark, failed)| {
            Some(((life_on(row, *failed)?.log10(), scale.of_share(*failed)), (*mark).to_owned()))
        });
        series.push(Series::unlisted(format!("B-lives of {name}"), Ink::Ink, Shape::Marked(marks.collect())));
    }
    if all.len() < 3 {
        return None;
    }
    let lives = Axis::linear("life [cycles]", range(all.iter().map(|point| point.0)));
    let shares = Axis::linear("failed F [%]", range(all.iter().map(|point| point.1)));
    let plot = Plot {
        figure: &format!("{}-paper", word.to_lowercase()),
        x: Axis { text: life_tick, scale: Scale::Logarithm, ..lives },
        y: Axis { text, scale, ..shares },
        series: &series,
    };
    let caption = format!(
        "Shares that have failed over {what} and the logarithm of life: lives of a {word} distribution are a straight line. Dots: lives by \
         which 1 %, 10 % and 50 % have failed (B1, B10, B50).{fit}"
    );
    Some(plot.figure(&format!("Lives on {word} paper"), &caption))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tests::test_study;

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

    #[test]
    fn a_distribution_is_its_own_fit() {
        for scale in [Scale::Weibull, Scale::Normal] {
            let line = PaperLine { scale, slope: 2.5, centre: 3000.0 };
            let points: Vec<(f64, f64)> =
                (1..9).map(|k| 500.0 * f64::from(k)).map(|t| (t, line.failed(t))).collect();
            let found = PaperLine::through(scale, &points).unwrap();
            assert!((found.slope - 2.5).abs() < 1e-6 && (found.centre - 3000.0).abs() < 1e-3, "{found:?}");
            for (t, f) in &points {
                assert!((line.life(*f) / t - 1.0).abs() < 1e-6, "{scale:?} {t}");
            }
            assert_eq!(PaperLine::through(scale, &points[..2]), None);
            assert_eq!(PaperLine::through(scale, &[(5.0, 0.1); 4]), None);
        }
        // Closed forms: F(scale) = 1 - 1/e, F(median) = 1/2.
        let [weibull, lognormal] = [Scale::Weibull, Scale::Normal]
            .map(|scale| PaperLine { scale, slope: 3.0, centre: 70.0 }.failed(70.0));
        assert!((weibull - 0.632_120_558_828_557_7).abs() < 1e-12 && (lognormal - 0.5).abs() < 1e-12);
    }

    #[test]
    fn the_marks_are_the_lives_of_the_summary() {
        let summary = test_study::study().summary;
        let row = summary.curves.iter().find(|curve| curve.limit_state == "total").unwrap();
        for (_, failed) in B_LIVES {
            let life = summary.lives.iter().find(|life| {
                life.limit_state == "total" && (life.reliability - (1.0 - failed)).abs() < 1e-12
            });
            let expected = life.unwrap().cycles.unwrap();
            assert!((life_on(row, failed).unwrap() - expected).abs() < 1e-6 * expected, "{failed}");
        }
        let figures = papers(&summary, &[("total", row)]);
        assert_eq!(figures.len(), 2);
        for figure in figures {
            for mark in ["B1,", "B10", "B50"] {
                assert!(
                    figure.csv.contains(&mark.replace(',', "\n")) && figure.caption.contains(mark),
                    "{mark}"
                );
            }
        }
    }
}
