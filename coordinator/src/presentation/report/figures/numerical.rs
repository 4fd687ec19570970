//! Figures of the errors of a study: parts of its interval, and the stated numerical errors, over life.

use super::{LifeAxis, capital, file_name, ink_of, rows_that_matter, span, stacked};
use crate::presentation::report::figure::Figure;
use crate::presentation::report::input::ReportInput;
use crate::presentation::report::levels::{PARTS, half_widths};
use crate::presentation::report::palette::Ink;
use crate::presentation::report::plot::{Axis, Plot, Points, Series, Shape};
use crate::presentation::report::stated_errors::StatedAt;
use crate::results::summary::StudySummary;

/// Half width of the 95 % interval of R of the system over life, stacked by the shares of its parts in the variance; no figure for a study
/// without parts.
pub fn parts_of_interval(summary: &StudySummary) -> Option<Figure> {
    let rows = rows_that_matter(summary, 1).iter();
    let rows: Vec<(u32, [f64; 3])> =
        rows.filter_map(|row| Some((row.cycles, half_widths(row.parts.get("total")?)))).collect();
    if summary.is_static() || rows.len() < 2 {
        return None;
    }
    let axis = LifeAxis::new(summary);
    let whole = |widths: &[f64; 3]| widths.iter().map(|width| width * width).sum::<f64>().sqrt();
    let height = |(_, widths): &(u32, [f64; 3]), part: usize| match whole(widths) {
        0.0 => 0.0,
        whole => widths[part].powi(2) / whole,
    };
    let layer = |(part, (name, _)): (usize, &(&str, &str))| {
        let heights = rows.iter().map(|row| height(row, part)).collect();
        (capital(name), Ink::Series(part), heights)
    };
    let is_drawn = |(part, _): &(usize, _)| !(summary.is_direct() && *part == 1);
    let places: Vec<f64> = rows.iter().map(|(cycles, _)| axis.place(*cycles)).collect();
    let series = stacked(&places, PARTS.iter().enumerate().filter(is_drawn).map(layer));
    let top = rows.iter().map(|(_, widths)| whole(widths)).fold(0.0, f64::max);
    let plot = Plot {
        figure: "parts-of-interval",
        x: Axis::linear(axis.label, span(summary, &axis)),
        y: Axis::linear("half width of the 95 % interval of R", (0.0, 1.05 * top.max(1e-6))),
        series: &series,
    };
    let caption = "The half width of R of the system, divided by the shares of samples, surrogates and numerical error in its square.";
    Some(plot.figure("Parts of the interval", caption))
}

/// Size of the stated errors over life, per limit state.
pub fn numerical(input: &ReportInput) -> Vec<Figure> {
    if input.summary.is_static() {
        return vec![];
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
        figures.push(plot.figure(&capital(&format!("stated error of {output}")), caption));
    }
    figures
}
