//! Figures of the stated numerical errors: their size over life.

use super::{LifeAxis, capital, file_name, ink_of};
use crate::presentation::report::figure::Figure;
use crate::presentation::report::input::ReportInput;
use crate::presentation::report::palette::Ink;
use crate::presentation::report::plot::{Axis, Plot, PlotError, Points, Series, Shape};
use crate::presentation::report::stated_errors::StatedAt;

/// Size of the stated errors over life, per limit state.
///
/// # Errors
/// [`PlotError`].
pub fn numerical(input: &ReportInput) -> Result<Vec<Figure>, PlotError> {
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
