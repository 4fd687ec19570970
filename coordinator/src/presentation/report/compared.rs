//! Studies or answers side by side: the figures with the curves and bands of all.

use super::figure::Figure;
use super::figures::{LifeAxis, curve, file_name};
use super::life::rows_that_matter;
use super::palette::Ink;
use super::plot::{Axis, Plot, Series, Shape};
use crate::results::summary::StudySummary;

/// A study to compare.
#[derive(Debug, Clone, PartialEq)]
pub struct ComparedStudy {
    /// Name in the comparison, unique.
    pub name: String,
    /// Result of the study.
    pub summary: StudySummary,
}

/// One figure per limit state and one of the whole system, each with the curves and bands of all studies.
pub fn figures(studies: &[ComparedStudy]) -> Vec<Figure> {
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
        let title = if name == "total" {
            "No failure of any kind".to_string()
        } else {
            format!("No failure by {name}")
        };
        Plot {
            figure: &format!("reliability-{}", file_name(name)),
            x: Axis::linear(axis.label, (axis.place(from), axis.place(to))),
            y: Axis::linear("reliability R", (0.0, 1.0)),
            series: &[bands, lines].concat(),
        }
        .figure(&title, "Bands: 95 % interval of sampling, surrogate and interpolation between the checkpoints, without numerical errors.")
    };
    studies[0].summary.curve_names().map(figure).collect()
}
