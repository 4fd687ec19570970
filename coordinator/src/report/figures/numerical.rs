//! Figures of the numerical errors: R under them, and their size over life.

use super::{Figure, LifeAxis, capital, figure, file_name, ink_of, words};
use crate::report::input::ReportInput;
use crate::report::life::rows_that_matter;
use crate::report::palette::Ink;
use crate::report::plot::{Plot, PlotError, Series, Shape, short};

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
    let rows = rows_that_matter(&input.summary, 6);
    let (Some(first), Some(last)) = (rows.first(), rows.last()) else { return Ok(None) };
    let axis = LifeAxis::of(input);
    let (mut bands, mut lines) = (Vec::new(), Vec::new());
    for state in &input.limit_states {
        let name = state.name.as_str();
        let ink = ink_of(input, name);
        let band: Vec<_> = rows
            .iter()
            .filter_map(|row| {
                let range = row.numerical.get(name)?;
                Some((axis.at(row.cycles), range.lower, range.upper))
            })
            .collect();
        if band.is_empty() {
            return Ok(None);
        }
        bands.push(Series::new("", ink, Shape::Band(band)));
        let r =
            |row: &crate::summary::ReliabilityRow| Some((axis.at(row.cycles), *row.reliability.get(name)?));
        lines.push(Series::new(name, ink, Shape::Line(rows.iter().filter_map(r).collect())));
    }
    let svg = Plot {
        figure: "reliability-numerical",
        x_label: axis.label,
        y_label: "reliability R",
        x: (axis.at(first.cycles), axis.at(last.cycles)),
        y: (0.0, 1.0),
        x_text: &short,
        y_text: &short,
        series: &[bands, lines].concat(),
    }
    .svg()?;
    let caption = "R with every response larger, and with every one smaller, by the error its simulation states. The \
                   worst and the best direction for all at once, not a standard error.";
    Ok(Some(figure("reliability-numerical", "Reliability under numerical errors", caption, svg)))
}

fn sizes(input: &ReportInput) -> Result<Vec<Figure>, PlotError> {
    if input.summary.is_static() {
        return Ok(vec![]);
    }
    let axis = LifeAxis::of(input);
    let mut figures = Vec::new();
    // Of a limit at zero nothing is a share.
    for state in input.limit_states.iter().filter(|state| state.threshold != 0.0) {
        let stated = input.stated.get(state.output).map_or(&[][..], Vec::as_slice);
        let Some(last) = stated.last() else { continue };
        let of_limit = |error: f64| 100.0 * (error / state.threshold).abs();
        let line = |of: &dyn Fn(&crate::report::stated::StatedAt) -> f64| -> Vec<(f64, f64)> {
            stated.iter().map(|at| (axis.at(at.cycles), of_limit(of(at)))).collect()
        };
        let (typical, largest) = (line(&|at| at.typical), line(&|at| at.largest));
        let top = largest.iter().map(|p| p.1).filter(|y| y.is_finite()).fold(0.0, f64::max);
        let series = [
            Series::new("typical (median)", ink_of(input, &state.name), Shape::Line(typical)),
            Series::new("largest", Ink::Ink, Shape::Dashed(largest)),
        ];
        let name = format!("stated-error-{}", file_name(&state.name));
        let output = words(&input.outputs[state.output].name);
        let svg = Plot {
            figure: &name,
            x_label: axis.label,
            y_label: "stated error [% of the limit]",
            x: (0.0, axis.at(last.cycles)),
            y: (0.0, if top > 0.0 { 1.1 * top } else { 1.0 }),
            x_text: &short,
            y_text: &short,
            series: &series,
        }
        .svg()?;
        let caption = "Over all simulations of the study, as a share of the limit that means failure.";
        figures.push(figure(&name, &capital(&format!("stated error of {output}")), caption, svg));
    }
    Ok(figures)
}
