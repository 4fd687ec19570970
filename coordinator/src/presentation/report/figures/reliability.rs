//! Figures of the failures over life: R with its bands, the shares of first failures, and R of several studies.

use super::{LifeAxis, file_name, ink_of, span, stacked};
use crate::presentation::report::format::{joined, percent};
use crate::presentation::report::life::{errors_in_intervals, rows_that_matter};
use crate::presentation::report::{Axis, Band, Figure, Ink, Plot, Points, ReportInput, Series, Shape};
use crate::results::life_summary::LifeCurveRow;
use crate::results::summary::{ReliabilityRow, StudySummary};

/// R of a curve with its 95 % band, as points and (x, lower, upper): the curve from which the lives are read. A study by an
/// earlier version has straight lines between the checkpoints.
pub fn curve(summary: &StudySummary, name: &str, axis: &LifeAxis) -> (Points, Band) {
    let Some(curve) = summary.curves.iter().find(|curve| curve.limit_state == name) else {
        let all = checkpoints(&summary.reliability, name, axis).into_iter();
        return all.map(|[x, r, lower, upper]| ((x, r), (x, lower, upper))).unzip();
    };
    let [lower, upper] = curve.limits().map(|limit| along(summary, curve, axis, limit));
    let band = lower.into_iter().zip(upper).map(|((x, lower), (_, upper))| (x, lower, upper)).collect();
    (along(summary, curve, axis, &curve.reliability), band)
}

/// Values of a curve at its own points and at the checkpoints, between which it is straight.
fn along(summary: &StudySummary, curve: &LifeCurveRow, axis: &LifeAxis, values: &[f64]) -> Points {
    let checkpoints = summary.reliability.iter().map(|row| f64::from(row.cycles));
    let mut times: Vec<f64> = curve.cycles.iter().copied().chain(checkpoints).collect();
    times.sort_unstable_by(f64::total_cmp);
    times.dedup();
    let last = curve.cycles.len().saturating_sub(1);
    let value = |time: f64| {
        let next = curve.cycles.partition_point(|t| *t < time).clamp(1, last.max(1));
        let (t0, t1) = (curve.cycles[next - 1], curve.cycles[next]);
        values[next - 1] + (time - t0) / (t1 - t0) * (values[next] - values[next - 1])
    };
    times.into_iter().map(|time| (axis.place(time), value(time))).collect()
}

/// R of a curve at the checkpoints with its 95 % interval: [x, R, lower, upper].
fn checkpoints(rows: &[ReliabilityRow], name: &str, axis: &LifeAxis) -> Vec<[f64; 4]> {
    let point = |row: &ReliabilityRow| {
        let (r, range) = (*row.reliability.get(name)?, row.interval_of(name)?);
        Some([axis.place(row.cycles), r, range.lower, range.upper])
    };
    rows.iter().filter_map(point).collect()
}

/// Beginning of the figures of R [cycles]: the first of these rows, or the start of life if some have failed by the first
/// checkpoint.
pub fn beginning(summary: &StudySummary, rows: &[ReliabilityRow]) -> Option<u32> {
    let (first, of_all) = (rows.first()?, summary.reliability.first()?);
    let failed = of_all.reliability.values().any(|r| *r < 0.9995);
    Some(if failed { 0 } else { first.cycles })
}

/// Reliability over life per limit state and in total, with 95 % bands; the checkpoints as dots with error bars.
pub fn reliability(summary: &StudySummary) -> Option<Figure> {
    let rows = rows_that_matter(summary, 1);
    if summary.is_static() || rows.is_empty() {
        return None;
    }
    let axis = LifeAxis::new(summary);
    let (mut series, mut lines) = (Vec::new(), Vec::new());
    for name in summary.curve_names() {
        let ((points, band), ink) = (curve(summary, name, &axis), ink_of(summary, name));
        series.push(Series::unlisted(format!("{name}, band"), ink, Shape::Band(band)));
        // That of the whole system is broken.
        let shape = if name == "total" { Shape::Dashed(points) } else { Shape::Line(points) };
        lines.push(Series::new(name, ink, shape));
    }
    series.extend(lines);
    // Straight lines between checkpoints show these by their corners.
    for name in summary.curve_names().filter(|_| !summary.curves.is_empty()) {
        let (label, ink) = (format!("{name}, checkpoints"), ink_of(summary, name));
        series.push(Series::unlisted(label, ink, Shape::Measured(checkpoints(rows, name, &axis))));
    }
    let x = Axis::linear(axis.label, span(summary, &axis));
    let caption = format!(
        "Probability of no failure up to this life, per limit state and for the whole {0}, which fails with its first limit \
         state. Dots: checkpoints; lines between them: crossing times interpolated for every {0}. Bands and bars: 95 % interval \
         of {1}.",
        summary.subject(),
        errors_in_intervals(summary)
    );
    Some(Plot::of_reliability("reliability", x, &series).figure("Reliability over life", &caption))
}

/// Stacked shares of the population that have failed, by the limit state that failed first.
pub fn first_failure(input: &ReportInput) -> Option<Figure> {
    let summary = &input.summary;
    let matter = rows_that_matter(summary, 1);
    let (from, to) = (matter.first()?, matter.last()?);
    let rows: Vec<_> =
        summary.first_failure.iter().filter(|row| (from.cycles..=to.cycles).contains(&row.cycles)).collect();
    if summary.is_static() || summary.limit_states.len() < 2 || rows.len() < 2 {
        return None;
    }
    let axis = LifeAxis::new(summary);
    let layer = |name: &String| {
        let shares: Vec<f64> = rows.iter().map(|row| row.first.get(name).copied().unwrap_or(0.0)).collect();
        (format!("{name} first"), ink_of(summary, name), shares)
    };
    let mut layers: Vec<_> = summary.limit_states.iter().map(layer).collect();
    if rows.iter().any(|row| row.together > 0.0) {
        let together = rows.iter().map(|row| row.together).collect();
        layers.push(("several at once".to_owned(), Ink::Muted, together));
    }
    let places: Vec<f64> = rows.iter().map(|row| axis.place(row.cycles)).collect();
    let series = stacked(&places, layers);
    let x = Axis::linear(axis.label, span(summary, &axis));
    let y = Axis::linear("share that has failed", (0.0, 1.0));
    let caption = format!(
        "Stacked shares: limit state by which each {} failed first. Several at once: at the same interpolated time, or \
         between two checkpoints that do not resolve it.",
        summary.subject()
    );
    Some(Plot { figure: "first-failure", x, y, series: &series }.figure("What fails first", &caption))
}

/// First causes of the failures up to a checkpoint, as shares of them, e.g. `53.4 % by wear`; `None` if nothing has
/// failed.
pub fn shares_of_failures(summary: &StudySummary, cycles: u32) -> Option<String> {
    let row = summary.first_failure.iter().find(|row| row.cycles == cycles)?;
    let all = row.first.values().sum::<f64>() + row.together;
    if all <= 0.0 {
        return None;
    }
    let by = |name: &String| Some(format!("{} by {name}", percent(row.first.get(name)? / all)));
    let parts = summary.limit_states.iter().filter_map(by);
    let at_once = (row.together > 0.0).then(|| format!("{} by several at once", percent(row.together / all)));
    Some(joined(parts.chain(at_once), ", "))
}

/// A study to compare.
#[derive(Debug, Clone, PartialEq)]
pub struct ComparedStudy {
    /// Name in the comparison, unique.
    pub name: String,
    /// Result of the study.
    pub summary: StudySummary,
}

/// One figure per limit state and one of the whole system, each with the curves and bands of all studies.
pub fn compared(studies: &[ComparedStudy]) -> Vec<Figure> {
    if studies[0].summary.is_static() {
        return vec![];
    }
    // From the first failure in any study to the last survivor in any.
    let matter = studies.iter().map(|study| rows_that_matter(&study.summary, 1));
    let ends = matter.filter_map(|rows| Some((rows.first()?.cycles, rows.last()?.cycles)));
    let Some((from, to)) = ends.reduce(|a, b| (a.0.min(b.0), a.1.max(b.1))) else { return vec![] };
    let axis = LifeAxis::new(&studies[0].summary);
    let figure = |name: &str| {
        let (mut bands, mut lines) = (Vec::new(), Vec::new());
        for (k, ComparedStudy { name: study, summary }) in studies.iter().enumerate() {
            let (points, band) = curve(summary, name, &axis);
            bands.push(Series::unlisted(format!("{study}, band"), Ink::Series(k), Shape::Band(band)));
            // Every second curve is dashed, so that coinciding curves stay visible.
            let shape = if k % 2 == 1 { Shape::Dashed(points) } else { Shape::Line(points) };
            lines.push(Series::new(study, Ink::Series(k), shape));
        }
        let by = format!("No failure by {name}");
        let title = if name == "total" { "No failure of any kind" } else { &by };
        let caption = &format!("Bands: 95 % interval of {}.", errors_in_intervals(&studies[0].summary));
        let (figure, series) = (&format!("reliability-{}", file_name(name)), &[bands, lines].concat());
        let x = Axis::linear(axis.label, (axis.place(from), axis.place(to)));
        Plot::of_reliability(figure, x, series).figure(title, caption)
    };
    studies[0].summary.curve_names().map(figure).collect()
}
