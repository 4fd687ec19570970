//! The lives on probability papers.

use super::{ink_of, range};
use crate::presentation::report::format::{percent, seven_digits, three_digits, whole};
use crate::presentation::report::{Axis, Figure, Ink, Plot, Points, Scale, Series, Shape, tick_label};
use crate::results::life_summary::LifeCurveRow;
use crate::results::summary::StudySummary;
use common::random::standard_normal_cdf;

/// Share of failures below which lives have no paper [1].
const FEW: f64 = 0.01;

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

/// Both papers for the curves of a study, the last of which is that of the whole system; none for a study without curves, or where nothing
/// fails, and none with fewer than three points.
pub fn papers(summary: &StudySummary) -> Vec<Figure> {
    let falls =
        summary.reliability.last().is_some_and(|row| row.reliability.get("total") < Some(&(1.0 - FEW)));
    if summary.is_static() || !falls {
        return vec![];
    }
    let curve = |name| Some((name, summary.curves.iter().find(|curve| curve.limit_state == name)?));
    let curves: Vec<(&str, &LifeCurveRow)> = summary.curve_names().filter_map(curve).collect();
    let figure = |scale| figure(scale, summary, &curves);
    [Scale::Weibull, Scale::Normal].into_iter().filter_map(figure).collect()
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
    fn nothing_that_fails_has_no_papers() {
        let mut summary = test_study::study().summary;
        summary.reliability.iter_mut().for_each(|row| row.reliability.values_mut().for_each(|r| *r = 1.0));
        assert!(papers(&summary).is_empty());
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
        let figures = papers(&summary);
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
