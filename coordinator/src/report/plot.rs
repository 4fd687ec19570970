//! One kind of chart for all curves of the report: lines, bands, steps, points and thresholds over two linear
//! axes with a legend above, drawn by plotters as SVG.

use super::palette::Ink;
use plotters::coord::Shift;
use plotters::prelude::*;
use thiserror::Error;

/// A figure that could not be drawn.
#[derive(Debug, Error)]
#[error("figure {figure}: {reason}")]
pub struct PlotError {
    /// Its name.
    pub figure: String,
    /// plotters' message.
    pub reason: String,
}

/// plotters works in whole pixels: figures are drawn this much larger and shown smaller, for smooth lines.
pub(super) const SCALE: f64 = 4.0;

/// Width a figure is designed for [CSS pixels].
const WIDTH: f64 = 480.0;

/// Size of lettering at that width [CSS pixels].
const LETTERS: f64 = 13.5;

/// plotters states font sizes by line height: this times the SVG font size.
const PLOTTERS_FONT: f64 = 1.24;

type Area<'a> = DrawingArea<SVGBackend<'a>, Shift>;
type DrawError = DrawingAreaErrorKind<std::io::Error>;

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
    /// Entry in the legend; empty for none.
    pub label: String,
    /// Colour.
    pub ink: Ink,
    /// Shape.
    pub shape: Shape,
}

impl Series {
    /// A series with an entry in the legend (none if `label` is empty).
    pub fn new(label: impl Into<String>, ink: Ink, shape: Shape) -> Self {
        Self { label: label.into(), ink, shape }
    }
}

/// A chart.
pub struct Plot<'a> {
    /// Name, for messages.
    pub figure: &'a str,
    /// Label of the horizontal axis.
    pub x_label: &'a str,
    /// Label of the vertical axis.
    pub y_label: &'a str,
    /// Range of the horizontal axis.
    pub x: (f64, f64),
    /// Range of the vertical axis.
    pub y: (f64, f64),
    /// Text of a value on the horizontal axis.
    pub x_text: &'a dyn Fn(f64) -> String,
    /// Text of a value on the vertical axis.
    pub y_text: &'a dyn Fn(f64) -> String,
    /// What is drawn, from back to front.
    pub series: &'a [Series],
}

impl Plot<'_> {
    /// The chart as an SVG document. Points that are not finite are left out, as is what lies outside the range
    /// of the horizontal axis; the vertical range cuts values off.
    ///
    /// # Errors
    /// [`PlotError`].
    pub fn svg(&self) -> Result<String, PlotError> {
        let legend = legend(self.series);
        let height = 290.0 + 20.0 * legend.rows as f64;
        draw(self.figure, height, |root| self.draw_on(root, &legend))
    }

    fn draw_on(&self, root: &Area<'_>, legend: &Legend<'_>) -> Result<(), DrawError> {
        let (x0, x1) = widened(self.x);
        let (y0, y1) = widened(self.y);
        let mut chart = ChartBuilder::on(root)
            .margin_top(px(10.0 + 20.0 * legend.rows as f64))
            .margin_right(px(34.0))
            .margin_bottom(px(4.0))
            .margin_left(px(4.0))
            .x_label_area_size(px(44.0))
            .y_label_area_size(px(62.0))
            .build_cartesian_2d(x0..x1, y0..y1)?;
        chart
            .configure_mesh()
            .x_labels(7)
            .y_labels(6)
            .max_light_lines(0)
            .bold_line_style(stroke(Ink::Grid, 1.0))
            .axis_style(stroke(Ink::Muted, 1.0))
            .label_style(letters(LETTERS, Ink::Muted))
            .axis_desc_style(letters(LETTERS, Ink::Ink))
            .set_all_tick_mark_size(px(4.0))
            .x_label_formatter(&|value| (self.x_text)(*value))
            .y_label_formatter(&|value| (self.y_text)(*value))
            .x_desc(self.x_label)
            .y_desc(self.y_label)
            .draw()?;
        let inside = |points: &[(f64, f64)]| -> Vec<(f64, f64)> {
            points
                .iter()
                .filter(|(x, y)| x.is_finite() && y.is_finite() && *x >= x0 && *x <= x1)
                .map(|(x, y)| (*x, y.clamp(y0, y1)))
                .collect()
        };
        for series in self.series {
            let ink = series.ink;
            match &series.shape {
                Shape::Line(points) => {
                    chart.draw_series(LineSeries::new(inside(points), stroke(ink, 2.0)))?;
                }
                Shape::Dashed(points) => {
                    let (dash, gap) = (px(7.0), px(4.0));
                    chart.draw_series(DashedLineSeries::new(inside(points), dash, gap, stroke(ink, 2.0)))?;
                }
                Shape::Dotted(points) => {
                    let points = inside(points);
                    chart.draw_series(LineSeries::new(points.clone(), stroke(ink, 1.5)))?;
                    chart.draw_series(
                        points.into_iter().map(|at| Circle::new(at, px(3.0), ink.rgb().filled())),
                    )?;
                }
                Shape::Marked(marks) => {
                    let dot = |at| Circle::new(at, px(3.0), ink.rgb().filled());
                    let points: Vec<_> = marks.iter().map(|(at, _)| *at).collect();
                    chart.draw_series(inside(&points).into_iter().map(dot))?;
                    let words = marks.iter().filter(|(_, word)| !word.is_empty());
                    chart.draw_series(words.flat_map(|(at, word)| {
                        let beside = (px(6.0), -px(LETTERS));
                        inside(&[*at]).into_iter().map(move |at| {
                            EmptyElement::at(at) + Text::new(word.clone(), beside, letters(LETTERS, ink))
                        })
                    }))?;
                }
                Shape::Band(points) => {
                    let lower: Vec<_> = points.iter().map(|(x, low, _)| (*x, *low)).collect();
                    let upper: Vec<_> = points.iter().map(|(x, _, high)| (*x, *high)).collect();
                    let mut outline = inside(&lower);
                    outline.extend(inside(&upper).into_iter().rev());
                    if outline.len() > 2 {
                        chart.draw_series([Polygon::new(outline, ink.rgb().mix(0.22))])?;
                    }
                }
                Shape::Steps(bars) => {
                    let outline: Vec<_> = std::iter::once(bars.first().map(|(left, _, _)| (*left, 0.0)))
                        .chain(
                            bars.iter().flat_map(|(left, right, h)| [Some((*left, *h)), Some((*right, *h))]),
                        )
                        .chain([bars.last().map(|(_, right, _)| (*right, 0.0))])
                        .flatten()
                        .collect();
                    let outline = inside(&outline);
                    if outline.len() > 2 {
                        chart.draw_series([Polygon::new(outline.clone(), ink.rgb().mix(0.22))])?;
                        chart.draw_series(LineSeries::new(outline, stroke(ink, 1.5)))?;
                    }
                }
                Shape::Level(y) => {
                    chart.draw_series(DashedLineSeries::new(
                        inside(&[(x0, *y), (x1, *y)]),
                        px(5.0),
                        px(4.0),
                        stroke(ink, 1.5),
                    ))?;
                }
                Shape::Upright(x) => {
                    let ends = inside(&[(*x, y0), (*x, y1)]);
                    chart.draw_series(DashedLineSeries::new(ends, px(5.0), px(4.0), stroke(ink, 1.5)))?;
                }
            }
        }
        legend.draw_on(root)
    }
}

/// A drawing of the standard width and this height [CSS pixels] on paper, as an SVG document.
pub(super) fn draw(
    figure: &str,
    height: f64,
    paint: impl FnOnce(&Area<'_>) -> Result<(), DrawError>,
) -> Result<String, PlotError> {
    let mut svg = String::new();
    let painted = {
        let root =
            SVGBackend::with_string(&mut svg, (px(WIDTH) as u32, px(height) as u32)).into_drawing_area();
        root.fill(&Ink::Paper.rgb()).and_then(|()| paint(&root)).and_then(|()| root.present())
    };
    painted.map_err(|error| PlotError { figure: figure.into(), reason: error.to_string() })?;
    Ok(svg)
}

/// CSS pixels in the pixels of the drawing.
pub(super) fn px(css: f64) -> i32 {
    (css * SCALE).round() as i32
}

/// A line of this colour and width [CSS pixels].
pub(super) fn stroke(ink: Ink, width: f64) -> ShapeStyle {
    ink.rgb().stroke_width(px(width) as u32)
}

/// Lettering of this size [CSS pixels].
pub(super) fn letters(size: f64, ink: Ink) -> TextStyle<'static> {
    ("sans-serif", size * SCALE * PLOTTERS_FONT).into_font().color(&ink.rgb())
}

/// A range that is not empty.
fn widened((low, high): (f64, f64)) -> (f64, f64) {
    if high > low { (low, high) } else { (low - 0.5, low + 0.5) }
}

/// A tick's value without digits that say nothing.
pub(super) fn short(value: f64) -> String {
    let text = format!("{value:.3}");
    let text = text.trim_end_matches('0').trim_end_matches('.');
    if text == "-0" { "0".into() } else { text.replace('-', "\u{2212}") }
}

/// Entries above the plot, in as many rows as they need.
struct Legend<'a> {
    entries: Vec<(f64, usize, &'a Series)>,
    rows: usize,
}

fn legend(series: &[Series]) -> Legend<'_> {
    let (mut x, mut row) = (10.0, 0);
    let mut entries = Vec::new();
    for series in series.iter().filter(|series| !series.label.is_empty()) {
        // A sans-serif letter is 0.55 of its size wide on average, blanks between entries included.
        let width = 40.0 + 0.57 * LETTERS * series.label.chars().count() as f64;
        if x + width > WIDTH && x > 10.0 {
            (x, row) = (10.0, row + 1);
        }
        entries.push((x, row, series));
        x += width;
    }
    let rows = if entries.is_empty() { 0 } else { row + 1 };
    Legend { entries, rows }
}

impl Legend<'_> {
    fn draw_on(&self, root: &Area<'_>) -> Result<(), DrawError> {
        for (x, row, series) in &self.entries {
            let y = 15.0 + 20.0 * *row as f64;
            let ends = [(px(*x), px(y)), (px(x + 18.0), px(y))];
            match series.shape {
                Shape::Band(_) | Shape::Steps(_) => {
                    let corners = [(px(*x), px(y - 5.0)), (px(x + 18.0), px(y + 5.0))];
                    root.draw(&Rectangle::new(corners, series.ink.rgb().mix(0.3).filled()))?;
                    root.draw(&Rectangle::new(corners, stroke(series.ink, 1.0)))?;
                }
                Shape::Dashed(_) | Shape::Level(_) | Shape::Upright(_) => {
                    for (from, to) in [(0.0, 7.0), (11.0, 18.0)] {
                        let dash = [(px(x + from), px(y)), (px(x + to), px(y))];
                        root.draw(&PathElement::new(dash, stroke(series.ink, 2.0)))?;
                    }
                }
                Shape::Marked(_) => {
                    root.draw(&Circle::new((px(x + 9.0), px(y)), px(3.0), series.ink.rgb().filled()))?;
                }
                Shape::Line(_) | Shape::Dotted(_) => {
                    root.draw(&PathElement::new(ends, stroke(series.ink, 2.5)))?;
                }
            }
            root.draw(&Text::new(
                series.label.clone(),
                (px(x + 23.0), px(y - 0.5 * LETTERS)),
                letters(LETTERS, Ink::Ink),
            ))?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn plot(series: &[Series]) -> String {
        Plot {
            figure: "test",
            x_label: "x",
            y_label: "y & more",
            x: (0.0, 1.0),
            y: (0.0, 1.0),
            x_text: &short,
            y_text: &short,
            series,
        }
        .svg()
        .unwrap()
    }

    #[test]
    fn values_that_are_no_numbers_are_left_out() {
        let points = vec![(0.0, 0.5), (0.5, f64::NAN), (f64::INFINITY, 0.2), (1.0, 0.5)];
        let svg = plot(&[Series::new("a < b", Ink::Series(0), Shape::Line(points))]);
        let document = roxmltree::Document::parse(&svg).unwrap();
        assert!(!svg.contains("NaN") && !svg.contains("inf"));
        assert!(document.descendants().any(|node| node.text().is_some_and(|t| t.contains("a < b"))));
    }

    #[test]
    fn empty_series_and_empty_ranges_are_drawn_as_nothing() {
        let shapes = [
            Shape::Line(vec![]),
            Shape::Dashed(vec![]),
            Shape::Dotted(vec![]),
            Shape::Marked(vec![((0.5, f64::NAN), "nowhere".into())]),
            Shape::Band(vec![]),
            Shape::Steps(vec![]),
            Shape::Level(f64::NAN),
        ];
        let series: Vec<_> = shapes.into_iter().map(|shape| Series::new("", Ink::Ink, shape)).collect();
        assert!(roxmltree::Document::parse(&plot(&series)).is_ok());
    }

    #[test]
    fn ticks_have_no_idle_digits() {
        assert_eq!([short(0.5), short(-0.0), short(20.0), short(-1.25)], ["0.5", "0", "20", "\u{2212}1.25"]);
    }

    #[test]
    fn a_legend_too_long_for_one_row_takes_two() {
        let long = || Series::new("x".repeat(40), Ink::Ink, Shape::Line(vec![]));
        assert_eq!(legend(&[long(), long()]).rows, 2);
        assert_eq!(legend(&[]).rows, 0);
    }
}
