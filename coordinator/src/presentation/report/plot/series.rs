//! What a chart shows, and the same as CSV.

use super::Plot;
use crate::presentation::report::palette::Ink;
use crate::results::result_files::{field, number};

/// Points of a curve.
pub type Points = Vec<(f64, f64)>;

/// Points of a band: (x, lower, upper).
pub type Band = Vec<(f64, f64, f64)>;

/// How a series is drawn.
#[derive(Debug, Clone, PartialEq)]
pub enum Shape {
    /// Straight lines from point to point.
    Line(Vec<(f64, f64)>),
    /// The same, broken.
    Dashed(Vec<(f64, f64)>),
    /// Lines with a dot at each point.
    Dotted(Vec<(f64, f64)>),
    /// Dots alone, each with a word beside it (none if empty).
    Marked(Vec<((f64, f64), String)>),
    /// Area between a lower and an upper value: (x, lower, upper).
    Band(Vec<(f64, f64, f64)>),
    /// Bars side by side from zero: (left, right, height).
    Steps(Vec<(f64, f64, f64)>),
    /// A horizontal line over the whole width.
    Level(f64),
    /// A vertical line over the whole height.
    Upright(f64),
}

/// One series.
#[derive(Debug, Clone, PartialEq)]
pub struct Series {
    /// What it is, in the legend and in the CSV.
    pub label: String,
    /// Whether it has an entry in the legend.
    pub listed: bool,
    /// Colour.
    pub ink: Ink,
    /// Shape.
    pub shape: Shape,
}

impl Series {
    /// A series with an entry in the legend.
    pub fn new(label: impl Into<String>, ink: Ink, shape: Shape) -> Self {
        Self { label: label.into(), listed: true, ink, shape }
    }

    /// A series without one.
    pub fn unlisted(label: impl Into<String>, ink: Ink, shape: Shape) -> Self {
        Self { label: label.into(), listed: false, ink, shape }
    }
}

/// What one row of the CSV holds: series, x, y, upper y, right x, word.
type Row<'a> = (&'a str, Option<f64>, Option<f64>, Option<f64>, Option<f64>, &'a str);

/// One row per point: `series`, x and y under the labels of the axes; where there are bands, their upper ends in
/// `... to`; where there are bars, their right ends likewise; where points have words beside them, `mark`. What a
/// level or an upright line leaves open is empty, as is what is not finite.
pub(super) fn csv(plot: &Plot<'_>) -> String {
    let mut rows: Vec<Row<'_>> = Vec::new();
    for series in plot.series {
        let label = series.label.as_str();
        match &series.shape {
            Shape::Line(points) | Shape::Dashed(points) | Shape::Dotted(points) => {
                rows.extend(points.iter().map(|(x, y)| (label, Some(*x), Some(*y), None, None, "")));
            }
            Shape::Marked(marks) => {
                rows.extend(
                    marks.iter().map(|((x, y), word)| (label, Some(*x), Some(*y), None, None, word.as_str())),
                );
            }
            Shape::Band(points) => {
                rows.extend(
                    points.iter().map(|(x, low, high)| (label, Some(*x), Some(*low), Some(*high), None, "")),
                );
            }
            Shape::Steps(bars) => {
                rows.extend(
                    bars.iter()
                        .map(|(left, right, h)| (label, Some(*left), Some(*h), None, Some(*right), "")),
                );
            }
            Shape::Level(y) => rows.push((label, None, Some(*y), None, None, "")),
            Shape::Upright(x) => rows.push((label, Some(*x), None, None, None, "")),
        }
    }
    let bands = rows.iter().any(|row| row.3.is_some());
    let bars = rows.iter().any(|row| row.4.is_some());
    let words = rows.iter().any(|row| !row.5.is_empty());
    let (x, y) = (plot.x.label, plot.y.label);
    let mut text = format!("series,{},{}", field(x), field(y));
    if bands {
        text += &format!(",{}", field(&format!("{y} to")));
    }
    if bars {
        text += &format!(",{}", field(&format!("{x} to")));
    }
    text += if words { ",mark\n" } else { "\n" };
    let value = |of: Option<f64>, value: fn(f64) -> f64| of.map_or(String::new(), |v| number(value(v)));
    for (label, left, low, high, right, word) in rows {
        text += &format!("{},{},{}", field(label), value(left, plot.x.value), value(low, plot.y.value));
        if bands {
            text += &format!(",{}", value(high, plot.y.value));
        }
        if bars {
            text += &format!(",{}", value(right, plot.x.value));
        }
        if words {
            text += &format!(",{}", field(word));
        }
        text.push('\n');
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::presentation::report::plot::Axis;

    #[test]
    fn the_data_are_rows_under_the_labels_of_the_axes() {
        let series = [
            Series::new("a", Ink::Ink, Shape::Line(vec![(1.0, 0.5), (2.0, f64::NAN)])),
            Series::unlisted("a, band", Ink::Ink, Shape::Band(vec![(1.0, 0.4, 0.6)])),
            Series::new("limit", Ink::Limit, Shape::Upright(3.0)),
        ];
        let x = Axis::linear("life [cycles]", (0.0, 3.0));
        let plot = Plot { figure: "f", x, y: Axis::linear("R, total", (0.0, 1.0)), series: &series };
        let lines = "series,life [cycles],\"R, total\",\"R, total to\"\na,1.0,0.5,\na,2.0,,\n\"a, band\",1.0,0.4,0.6\nlimit,3.0,,\n";
        assert_eq!(csv(&plot), lines);
        let logarithmic = Axis { value: |v| 10f64.powf(v), ..plot.y };
        let bars = [Series::new("b", Ink::Ink, Shape::Steps(vec![(0.0, 1.0, 2.0)]))];
        let text = csv(&Plot { y: logarithmic, series: &bars, ..plot });
        assert!(text.ends_with("life [cycles] to\nb,0.0,100.0,1.0\n"), "{text}");
    }
}
