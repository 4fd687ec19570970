//! Figures of the stated numerical errors: their effect on R, and their size over life.

use super::{LifeAxis, band, capital, curves_with_bands, file_name, ink_of, span};
use crate::presentation::report::figure::Figure;
use crate::presentation::report::input::ReportInput;
use crate::presentation::report::life::rows_that_matter;
use crate::presentation::report::palette::Ink;
use crate::presentation::report::plot::{Axis, Band, Plot, PlotError, Points, Series, Shape};
use crate::presentation::report::stated_errors::StatedAt;
use crate::results::summary::{ReliabilityRow, StudySummary};

/// The range of R under the stated errors per limit state and in total, and per limit state the size of the errors
/// over life.
///
/// # Errors
/// [`PlotError`].
pub fn numerical(input: &ReportInput) -> Result<Vec<Figure>, PlotError> {
    Ok(range_of_reliability(input)?.into_iter().chain(sizes(input)?).collect())
}

fn range_of_reliability(input: &ReportInput) -> Result<Option<Figure>, PlotError> {
    if input.summary.is_static() {
        return Ok(None);
    }
    let rows = rows_that_matter(&input.summary, 1);
    if rows.is_empty() {
        return Ok(None);
    }
    let axis = LifeAxis::new(&input.summary);
    let range = |name: &str| numerical_band(&input.summary, rows, name, &axis);
    if input.summary.curve_names().any(|name| range(name).is_empty()) {
        return Ok(None);
    }
    let series = curves_with_bands(&input.summary, &axis, "range", range);
    let plot = Plot {
        figure: "reliability-numerical",
        x: Axis::linear(axis.label, span(&input.summary, &axis)),
        y: Axis::linear("reliability R", (0.0, 1.0)),
        series: &series,
    };
    let caption = "Bands: 95 % interval with, in addition, all responses shifted by their stated errors to the unsafe and to the \
                   safe side. These shifts are extreme cases, not standard errors.";
    plot.figure("Reliability under numerical errors", caption).map(Some)
}

/// The 95 % band of R with the stated errors; at the checkpoints of a study by an earlier version the range of R under them.
fn numerical_band(summary: &StudySummary, rows: &[ReliabilityRow], name: &str, axis: &LifeAxis) -> Band {
    if let Some(curve) = summary.curves.iter().find(|curve| curve.limit_state == name) {
        if curve.numerical_lower.is_empty() {
            return vec![];
        }
        return band(summary, curve, axis, [&curve.numerical_lower, &curve.numerical_upper]);
    }
    let range = |row: &ReliabilityRow| {
        let range = row.numerical.get(name)?;
        Some((axis.place(row.cycles), range.lower, range.upper))
    };
    rows.iter().filter_map(range).collect()
}

fn sizes(input: &ReportInput) -> Result<Vec<Figure>, PlotError> {
    if input.summary.is_static() {
        return Ok(vec![]);
    }
    let axis = LifeAxis::new(&input.summary);
    let mut figures = Vec::new();
    // Relative to a limit of zero an error has no size.
    for state in input.scene.limit_states.iter().filter(|state| state.scale() != 0.0) {
        let stated = input.stated.get(state.output).map_or(&[][..], Vec::as_slice);
        let Some(last) = stated.last() else { continue };
        let of_limit = |error: f64| 100.0 * error.abs() / state.scale();
        let line = |error: fn(&StatedAt) -> f64| -> Points {
            stated.iter().map(|row| (axis.place(row.cycles), of_limit(error(row)))).collect()
        };
        let (typical, largest) = (line(|row| row.typical), line(|row| row.largest));
        let top = largest.iter().map(|p| p.1).filter(|y| y.is_finite()).fold(0.0, f64::max);
        let series = [
            Series::new("typical (median)", ink_of(&input.summary, &state.name), Shape::Line(typical)),
            Series::new("largest", Ink::Ink, Shape::Dashed(largest)),
        ];
        let name = format!("stated-error-{}", file_name(&state.name));
        let output = input.output_of(state);
        let plot = Plot {
            figure: &name,
            x: Axis::linear(axis.label, (0.0, axis.place(last.cycles))),
            y: Axis::linear("stated error [% of the limit]", (0.0, if top > 0.0 { 1.1 * top } else { 1.0 })),
            series: &series,
        };
        let caption = "Median and maximum over all simulations of the study, as a share of the limit state's threshold, or of half the distance \
                       between two.";
        figures.push(plot.figure(&capital(&format!("stated error of {output}")), caption)?);
    }
    Ok(figures)
}
