//! The series of a chart, their numbers as CSV, and how plotters' SVG backend draws them and their legend: sizes, pens and lettering in CSS
//! pixels.

use super::axis::{Axis, TickedAxis};
use crate::presentation::report::{Drawing, Ink};
use crate::results::csv_table::{self, number};
use plotters::coord::Shift;
use plotters::prelude::*;

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

/// A chart over two linear axes.
pub(super) type Chart<'a, 'b> = ChartContext<'a, SVGBackend<'b>, Cartesian2d<TickedAxis, TickedAxis>>;

/// Dash and gap of broken curves, and of thresholds [CSS pixels].
const CURVE_DASH: (f64, f64) = (7.0, 4.0);
const THRESHOLD_DASH: (f64, f64) = (5.0, 4.0);

/// Ranges of the two axes, in the numbers drawn.
pub(super) struct Frame {
    pub x: (f64, f64),
    pub y: (f64, f64),
}

impl Frame {
    /// A frame of these ranges; an empty range is widened.
    pub fn new(x: (f64, f64), y: (f64, f64)) -> Self {
        let widened = |(low, high): (f64, f64)| if high > low { (low, high) } else { (low - 0.5, low + 0.5) };
        Self { x: widened(x), y: widened(y) }
    }

    /// The finite points within the horizontal range, their vertical coordinates clamped to the vertical range.
    fn inside(&self, points: impl IntoIterator<Item = (f64, f64)>) -> Points {
        let is_inside =
            |(x, y): &(f64, f64)| x.is_finite() && y.is_finite() && *x >= self.x.0 && *x <= self.x.1;
        points.into_iter().filter(is_inside).map(|(x, y)| (x, y.clamp(self.y.0, self.y.1))).collect()
    }
}

/// Draws one series into a chart.
pub(super) struct SeriesPainter<'c, 'a, 'b> {
    pub chart: &'c mut Chart<'a, 'b>,
    pub frame: &'c Frame,
    pub series: &'c Series,
}

impl SeriesPainter<'_, '_, '_> {
    /// Draws the shape of the series.
    pub fn draw(&mut self) -> Result<(), DrawError> {
        let (frame, ink) = (self.frame, self.series.ink);
        match &self.series.shape {
            Shape::Line(points) => self.line(points.clone(), 2.0),
            Shape::Dashed(points) => self.dashed(points.clone(), CURVE_DASH, 2.0),
            Shape::Dotted(points) => {
                self.line(points.clone(), 1.5)?;
                self.dots(points.clone(), 3.0)
            }
            Shape::Marked(marks) => self.marks(marks, ink),
            Shape::Measured(points) => self.measured(points),
            Shape::Cloud(points) => self.dots(points.clone(), 1.8),
            Shape::Band(band) => {
                let mut outline: Points = band.iter().map(|(x, low, _)| (*x, *low)).collect();
                outline.extend(band.iter().rev().map(|(x, _, high)| (*x, *high)));
                self.area(&frame.inside(outline))
            }
            Shape::Steps(bars) => self.steps(bars),
            Shape::Level(y) => self.dashed(vec![(frame.x.0, *y), (frame.x.1, *y)], THRESHOLD_DASH, 1.5),
            Shape::Upright(x) => self.dashed(vec![(*x, frame.y.0), (*x, frame.y.1)], THRESHOLD_DASH, 1.5),
        }
    }

    fn line(&mut self, points: Points, width: f64) -> Result<(), DrawError> {
        let (points, pen) = (self.frame.inside(points), stroke(self.series.ink, width));
        self.chart.draw_series(LineSeries::new(points, pen)).map(|_| ())
    }

    fn dashed(&mut self, points: Points, dash: (f64, f64), width: f64) -> Result<(), DrawError> {
        let (points, pen) = (self.frame.inside(points), stroke(self.series.ink, width));
        self.chart.draw_series(DashedLineSeries::new(points, px(dash.0), px(dash.1), pen)).map(|_| ())
    }

    fn dots(&mut self, points: Points, radius: f64) -> Result<(), DrawError> {
        let dot = |centre| Circle::new(centre, px(radius), self.series.ink.rgb().filled());
        self.chart.draw_series(self.frame.inside(points).into_iter().map(dot)).map(|_| ())
    }

    /// Dots with a word next to each.
    fn marks(&mut self, marks: &[((f64, f64), String)], ink: Ink) -> Result<(), DrawError> {
        let frame = self.frame;
        self.dots(marks.iter().map(|(point, _)| *point).collect(), 3.0)?;
        let words = marks.iter().filter(|(_, word)| !word.is_empty());
        let labels = words.flat_map(|(point, word)| {
            let offset = (px(6.0), -px(LETTERS));
            frame
                .inside([*point])
                .into_iter()
                .map(move |place| EmptyElement::at(place) + Text::new(word.clone(), offset, letters(ink)))
        });
        self.chart.draw_series(labels).map(|_| ())
    }

    /// Dots with vertical error bars, smaller the more there are.
    fn measured(&mut self, points: &[[f64; 4]]) -> Result<(), DrawError> {
        for [x, _, lower, upper] in points {
            self.line(vec![(*x, *lower), (*x, *upper)], 1.2)?;
        }
        let centres = self.frame.inside(points.iter().map(|[x, y, ..]| (*x, *y)));
        let radius = if centres.len() > 30 { 1.8 } else { 2.8 };
        self.dots(centres, radius)
    }

    /// The area within an outline.
    fn area(&mut self, outline: &Points) -> Result<(), DrawError> {
        if outline.len() > 2 {
            let fill = self.series.ink.rgb().mix(self.series.fill);
            self.chart.draw_series([Polygon::new(outline.clone(), fill)])?;
        }
        Ok(())
    }

    /// The outline of bars side by side from zero, filled.
    fn steps(&mut self, bars: &[(f64, f64, f64)]) -> Result<(), DrawError> {
        let (Some(first), Some(last)) = (bars.first(), bars.last()) else { return Ok(()) };
        let tops = bars.iter().flat_map(|(left, right, height)| [(*left, *height), (*right, *height)]);
        let outline = [(first.0, 0.0)].into_iter().chain(tops).chain([(last.1, 0.0)]);
        let outline = self.frame.inside(outline);
        self.area(&outline)?;
        if outline.len() > 2 { self.line(outline, 1.5) } else { Ok(()) }
    }
}

/// An entry above a plot: its left end [CSS pixels], its row, and its series.
pub type LegendEntry<'a> = (f64, usize, &'a Series);

/// The entries of listed series, in as many rows as they need.
pub fn legend(series: &[Series]) -> Vec<LegendEntry<'_>> {
    let (mut x, mut row) = (10.0, 0);
    let mut entries = Vec::new();
    for series in series.iter().filter(|series| series.listed) {
        // A sans-serif letter is 0.55 of its size wide on average, blanks between entries included.
        let width = 40.0 + 0.57 * LETTERS * series.label.chars().count() as f64;
        if x + width > WIDTH && x > 10.0 {
            (x, row) = (10.0, row + 1);
        }
        entries.push((x, row, series));
        x += width;
    }
    entries
}

/// Height of the rows of a legend [CSS pixels].
pub fn legend_height(entries: &[LegendEntry<'_>]) -> f64 {
    entries.last().map_or(0.0, |(_, row, _)| 20.0 * (row + 1) as f64)
}

/// Draws the entries of a legend.
pub fn draw_legend(entries: &[LegendEntry<'_>], root: &Area<'_>) -> Result<(), DrawError> {
    for (x, row, series) in entries {
        let y = 15.0 + 20.0 * *row as f64;
        match series.shape {
            Shape::Band(_) | Shape::Steps(_) => {
                let corners = [(px(*x), px(y - 5.0)), (px(x + 18.0), px(y + 5.0))];
                root.draw(&Rectangle::new(corners, series.ink.rgb().mix(1.3 * series.fill).filled()))?;
                root.draw(&Rectangle::new(corners, stroke(series.ink, 1.0)))?;
            }
            Shape::Dashed(_) | Shape::Level(_) | Shape::Upright(_) => {
                for (from, to) in [(0.0, 7.0), (11.0, 18.0)] {
                    let dash = [(px(x + from), px(y)), (px(x + to), px(y))];
                    root.draw(&PathElement::new(dash, stroke(series.ink, 2.0)))?;
                }
            }
            Shape::Marked(_) | Shape::Measured(_) | Shape::Cloud(_) => {
                root.draw(&Circle::new((px(x + 9.0), px(y)), px(3.0), series.ink.rgb().filled()))?;
            }
            Shape::Line(_) | Shape::Dotted(_) => {
                let ends = [(px(*x), px(y)), (px(x + 18.0), px(y))];
                root.draw(&PathElement::new(ends, stroke(series.ink, 2.5)))?;
            }
        }
        let place = (px(x + 23.0), px(y - 0.5 * LETTERS));
        root.draw(&Text::new(series.label.clone(), place, letters(Ink::Ink)))?;
    }
    Ok(())
}

/// plotters works in whole pixels: figures are drawn this much larger and shown smaller, for smooth lines.
const SCALE: f64 = 4.0;

/// Width a figure is designed for [CSS pixels].
pub(super) const WIDTH: f64 = 480.0;

/// Size of lettering at that width [CSS pixels]: 11 pixels where a page of 400 pixels shows the figure smaller.
pub const LETTERS: f64 = 15.2;

/// plotters states font sizes by line height: this times the SVG font size.
const PLOTTERS_FONT: f64 = 1.24;

/// Drawing area of a whole figure.
pub type Area<'a> = DrawingArea<SVGBackend<'a>, Shift>;

/// Error of plotters' SVG backend.
pub type DrawError = DrawingAreaErrorKind<std::io::Error>;

/// A drawing of the standard width and this height [CSS pixels] on paper.
pub fn draw(height: f64, paint: impl FnOnce(&Area<'_>) -> Result<(), DrawError>) -> Drawing {
    let (mut svg, [width, height]) = (String::new(), [WIDTH, height].map(|size| px(size) as u32));
    let painted = {
        let root = SVGBackend::with_string(&mut svg, (width, height)).into_drawing_area();
        root.fill(&Ink::Paper.rgb()).and_then(|()| paint(&root)).and_then(|()| root.present())
    };
    painted.expect("an SVG in memory is written without files and fonts, the sources of plotters' errors");
    // What plotters writes is a document.
    let content = svg.split_once('>').map_or("", |(_, content)| content.trim().trim_end_matches("</svg>"));
    Drawing { view: format!("0 0 {width} {height}"), letters: None, axes: None, content: content.to_owned() }
}

/// CSS pixels in the pixels of the drawing.
pub fn px(css: f64) -> i32 {
    (css * SCALE).round() as i32
}

/// A line of this colour and width [CSS pixels].
pub fn stroke(ink: Ink, width: f64) -> ShapeStyle {
    ink.rgb().stroke_width(px(width) as u32)
}

/// Lettering in this colour.
pub fn letters(ink: Ink) -> TextStyle<'static> {
    ("sans-serif", LETTERS * SCALE * PLOTTERS_FONT).into_font().color(&ink.rgb())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::presentation::report::Scale;

    #[test]
    fn a_legend_too_long_for_one_row_takes_two() {
        let long = || Series::new("x".repeat(40), Ink::Ink, Shape::Line(vec![]));
        assert_eq!(legend_height(&legend(&[long(), long()])), 40.0);
        assert_eq!(legend_height(&legend(&[])), 0.0);
    }

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
