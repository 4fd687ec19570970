//! Figures of the failures over life: R with its bands, and the shares of first failures.

use super::{LifeAxis, ink_of};
use crate::presentation::report::figure::Figure;
use crate::presentation::report::format::{count, percent};
use crate::presentation::report::input::ReportInput;
use crate::presentation::report::life::{governing, rows_that_matter};
use crate::presentation::report::palette::Ink;
use crate::presentation::report::plot::{Axis, Band, Plot, PlotError, Points, Series, Shape};
use crate::results::summary::{ReliabilityRow, StudySummary};

/// Standard errors to either side that a band shows.
pub const BAND: f64 = 1.96;

/// R of a curve with its band at these rows, as points and (x, lower, upper).
pub fn curve(rows: &[ReliabilityRow], name: &str, x: impl Fn(u32) -> f64) -> (Points, Band) {
    let points = rows.iter().filter_map(|row| Some((x(row.cycles), *row.reliability.get(name)?)));
    let band = rows.iter().filter_map(|row| {
        let r = *row.reliability.get(name)?;
        let reach = BAND * row.standard_error.get(name).copied().unwrap_or(0.0);
        Some((x(row.cycles), (r - reach).max(0.0), (r + reach).min(1.0)))
    });
    (points.collect(), band.collect())
}

/// Reliability over life per limit state and in total, with bands of 1.96 standard errors.
///
/// # Errors
/// [`PlotError`].
pub fn reliability(summary: &StudySummary) -> Result<Option<Figure>, PlotError> {
    if summary.is_static() {
        return Ok(None);
    }
    let rows = rows_that_matter(summary, 3);
    let (Some(first), Some(last)) = (rows.first(), rows.last()) else { return Ok(None) };
    let axis = LifeAxis::new(summary);
    let mut names: Vec<&str> = summary.limit_states.iter().map(String::as_str).collect();
    if names.len() != 1 {
        names.push("total");
    }
    let (mut bands, mut lines) = (Vec::new(), Vec::new());
    for name in names {
        let (points, band) = curve(rows, name, |cycles| axis.place(cycles));
        let ink = ink_of(summary, name);
        bands.push(Series::unlisted(format!("{name}, band"), ink, Shape::Band(band)));
        let shape = if name == "total" { Shape::Dashed(points) } else { Shape::Line(points) };
        lines.push(Series::new(name, ink, shape));
    }
    let plot = Plot {
        figure: "reliability",
        x: Axis::linear(axis.label, (axis.place(first.cycles), axis.place(last.cycles))),
        y: Axis::linear("reliability R", (0.0, 1.0)),
        series: &[bands, lines].concat(),
    };
    let caption = format!(
        "Probability of no failure up to this life, per limit state and for the whole {}, which fails with its first limit \
         state. Bands: 1.96 standard errors, sampling and surrogate together; the effect of numerical errors of the \
         simulations is shown further below.",
        summary.subject()
    );
    plot.figure("Reliability over life", &caption).map(Some)
}

/// Stacked shares of the population that have failed, by the limit state that failed first.
///
/// # Errors
/// [`PlotError`].
pub fn first_failure(input: &ReportInput) -> Result<Option<Figure>, PlotError> {
    let summary = &input.summary;
    let matter = rows_that_matter(summary, 1);
    let (Some(from), Some(to)) = (matter.first(), matter.last()) else { return Ok(None) };
    let rows: Vec<_> =
        summary.first_failure.iter().filter(|row| (from.cycles..=to.cycles).contains(&row.cycles)).collect();
    if summary.is_static() || summary.limit_states.len() < 2 || rows.len() < 2 {
        return Ok(None);
    }
    let axis = LifeAxis::new(summary);
    let mut below = vec![0.0; rows.len()];
    let mut series = Vec::new();
    let mut stack = |label: &str, ink: Ink, shares: Vec<f64>| {
        let band = rows.iter().zip(&mut below).zip(shares).map(|((row, below), share)| {
            let low = *below;
            *below += share;
            (axis.place(row.cycles), low, *below)
        });
        let band: Vec<_> = band.collect();
        let edge = band.iter().map(|(x, _, high)| (*x, *high)).collect();
        series.push(Series::new(label, ink, Shape::Band(band)));
        series.push(Series::unlisted(format!("{label}, upper edge"), ink, Shape::Line(edge)));
    };
    for name in &summary.limit_states {
        let shares = rows.iter().map(|row| row.first.get(name).copied().unwrap_or(0.0)).collect();
        stack(&format!("{name} first"), ink_of(summary, name), shares);
    }
    if rows.iter().any(|row| row.together > 0.0) {
        stack("several at once", Ink::Muted, rows.iter().map(|row| row.together).collect());
    }
    let plot = Plot {
        figure: "first-failure",
        x: Axis::linear(axis.label, (axis.place(from.cycles), axis.place(to.cycles))),
        y: Axis::linear("share that has failed", (0.0, 1.0)),
        series: &series,
    };
    let shares =
        governing(summary).and_then(|row| Some((row.cycles, shares_of_failures(summary, row.cycles)?)));
    let caption = format!(
        "Stacked shares: limit state by which each {} failed first. Several at once: between the same two \
         checkpoints.{}",
        summary.subject(),
        shares.map_or(String::new(), |(cycles, shares)| format!(
            " First causes of the failures up to {} cycles: {}.",
            count(cycles.into()),
            shares.join(", ")
        ))
    );
    plot.figure("What fails first", &caption).map(Some)
}

/// First causes of the failures up to a checkpoint, as shares of them, e.g. `53.4 % by wear`; `None` if nothing has
/// failed.
pub fn shares_of_failures(summary: &StudySummary, cycles: u32) -> Option<Vec<String>> {
    let row = summary.first_failure.iter().find(|row| row.cycles == cycles)?;
    let all = row.first.values().sum::<f64>() + row.together;
    if all <= 0.0 {
        return None;
    }
    let by = |name: &String| Some(format!("{} by {name}", percent(row.first.get(name)? / all)));
    let mut parts: Vec<String> = summary.limit_states.iter().filter_map(by).collect();
    if row.together > 0.0 {
        parts.push(format!("{} by several between the same two checkpoints", percent(row.together / all)));
    }
    Some(parts)
}
