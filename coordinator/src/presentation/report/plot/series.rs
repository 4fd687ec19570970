//! The series of a chart, and their numbers as CSV.

use super::axis::Axis;
use crate::presentation::report::palette::Ink;
use crate::results::csv_table::{self, number};

/// Points of a curve.
pub type Points = Vec<(f64, f64)>;

/// Points of a band: (x, lower, upper).
pub type Band = Vec<(f64, f64, f64)>;

/// How a series is drawn.
#[derive(Debug, Clone, PartialEq)]
pub enum Shape {
    /// Straight lines from point to point.
    Line(Points),
    /// Dashed straight lines from point to point.
    Dashed(Points),
    /// Lines with a dot at each point.
    Dotted(Points),
    /// Dots without lines, each with a word next to it (none if empty).
    Marked(Vec<((f64, f64), String)>),
    /// Small dots without lines.
    Cloud(Points),
    /// Dots with vertical error bars: [x, y, lower, upper].
    Measured(Vec<[f64; 4]>),
    /// Area between a lower and an upper value: (x, lower, upper).
    Band(Band),
    /// Bars side by side from zero: (left, right, height).
    Steps(Vec<(f64, f64, f64)>),
    /// A horizontal line over the whole width.
    Level(f64),
    /// A vertical line over the whole height.
    Upright(f64),
}

/// A named set of numbers in one colour and shape.
#[derive(Debug, Clone, PartialEq)]
pub struct Series {
    /// Name in the legend and in the CSV.
    pub label: String,
    /// Whether it has an entry in the legend.
    pub listed: bool,
    /// Colour of lines, dots and fill.
    pub ink: Ink,
    /// Opacity of its area, where it has one [1].
    pub fill: f64,
    /// Numbers and how they are drawn.
    pub shape: Shape,
}

/// Opacity of areas, unless stated otherwise [1].
const FILL: f64 = 0.22;

impl Series {
    /// A series with an entry in the legend.
    pub fn new(label: impl Into<String>, ink: Ink, shape: Shape) -> Self {
        Self { label: label.into(), listed: true, ink, fill: FILL, shape }
    }

    /// A series without an entry in the legend.
    pub fn unlisted(label: impl Into<String>, ink: Ink, shape: Shape) -> Self {
        Self { listed: false, ..Self::new(label, ink, shape) }
    }

    /// This series with an area of the opacity `fill` [1].
    #[must_use]
    pub fn filled(self, fill: f64) -> Self {
        Self { fill, ..self }
    }
}

/// A row of the CSV: x, y, the upper end of a band, the right end of a bar, where the shape defines them, and a mark.
type CsvRow<'a> = ([Option<f64>; 4], &'a str);

/// Rows of one series: a row per point, or one row for a level or an upright line.
fn rows(shape: &Shape) -> Vec<CsvRow<'_>> {
    let point = |(x, y): &(f64, f64)| ([Some(*x), Some(*y), None, None], "");
    match shape {
        Shape::Line(points) | Shape::Dashed(points) | Shape::Dotted(points) | Shape::Cloud(points) => {
            points.iter().map(point).collect()
        }
        Shape::Measured(points) => points.iter().map(|[x, y, _, _]| point(&(*x, *y))).collect(),
        Shape::Marked(marks) => marks.iter().map(|(at, mark)| (point(at).0, mark.as_str())).collect(),
        Shape::Band(points) => {
            points.iter().map(|(x, low, high)| ([Some(*x), Some(*low), Some(*high), None], "")).collect()
        }
        Shape::Steps(bars) => {
            let row =
                |(left, right, height): &(f64, f64, f64)| [Some(*left), Some(*height), None, Some(*right)];
            bars.iter().map(|bar| (row(bar), "")).collect()
        }
        Shape::Level(y) => vec![([None, Some(*y), None, None], "")],
        Shape::Upright(x) => vec![([Some(*x), None, None, None], "")],
    }
}

/// One row per point: `series`, x and y under the labels of the axes; for bands the upper ends in `<y label> to`; for bars
/// the right ends in `<x label> to`; for labelled points `mark`. Coordinates that a level or an upright line leaves open
/// and values that are not finite are empty.
pub(super) fn csv(series: &[Series], x: &Axis<'_>, y: &Axis<'_>) -> String {
    let rows: Vec<(&str, CsvRow<'_>)> = series
        .iter()
        .flat_map(|series| rows(&series.shape).into_iter().map(|row| (series.label.as_str(), row)))
        .collect();
    let columns =
        [x.label.to_owned(), y.label.to_owned(), format!("{} to", y.label), format!("{} to", x.label)];
    let is_used = |k: usize| k < 2 || rows.iter().any(|(_, (numbers, _))| numbers[k].is_some());
    let used: Vec<usize> = (0..4).filter(|k| is_used(*k)).collect();
    let has_marks = rows.iter().any(|(_, (_, mark))| !mark.is_empty());
    let mut head = vec!["series"];
    head.extend(used.iter().map(|k| columns[*k].as_str()).chain(has_marks.then_some("mark")));
    let scales = [x, y, y, x].map(|axis| axis.scale);
    csv_table::csv(
        &head,
        rows.iter().map(|(label, (numbers, mark))| {
            let value =
                |k: &usize| numbers[*k].map_or(String::new(), |drawn| number(scales[*k].value(drawn)));
            let numbers: Vec<String> = used.iter().map(value).collect();
            [(*label).to_owned()].into_iter().chain(numbers).chain(has_marks.then(|| (*mark).to_owned()))
        }),
    )
}

#[cfg(test)]
mod tests {
    use super::super::axis::Scale;
    use super::*;

    #[test]
    fn the_data_are_rows_under_the_labels_of_the_axes() {
        let series = [
            Series::new("a", Ink::Ink, Shape::Line(vec![(1.0, 0.5), (2.0, f64::NAN)])),
            Series::unlisted("a, band", Ink::Ink, Shape::Band(vec![(1.0, 0.4, 0.6)])),
            Series::new("limit", Ink::Limit, Shape::Upright(3.0)),
        ];
        let (x, y) = (Axis::linear("life [cycles]", (0.0, 3.0)), Axis::linear("R, total", (0.0, 1.0)));
        let lines = "series,life [cycles],\"R, total\",\"R, total to\"\na,1.0,0.5,\na,2.0,,\n\"a, band\",1.0,0.4,0.6\nlimit,3.0,,\n";
        assert_eq!(csv(&series, &x, &y), lines);
        let logarithmic = Axis { scale: Scale::Logarithm, ..y };
        let bars = [Series::new("b", Ink::Ink, Shape::Steps(vec![(0.0, 1.0, 2.0)]))];
        let text = csv(&bars, &x, &logarithmic);
        assert!(text.ends_with("life [cycles] to\nb,0.0,100.0,1.0\n"), "{text}");
    }
}
