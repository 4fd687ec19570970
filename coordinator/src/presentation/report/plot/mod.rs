//! One kind of chart for all curves of the report: lines, bands, steps, points and thresholds over two linear
//! axes with a legend above, drawn by plotters as SVG, and the same as CSV.

mod legend;
mod series;

pub use series::{Band, Points, Series, Shape};

use super::figure::Figure;
use super::palette::Ink;
use legend::{Legend, legend};
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

/// One axis.
#[derive(Clone, Copy)]
pub struct Axis<'a> {
    /// What it shows, with the unit.
    pub label: &'a str,
    /// From where to where it is drawn.
    pub range: (f64, f64),
    /// Text of a tick.
    pub text: fn(f64) -> String,
    /// The value that a drawn number stands for: the number itself, or the power of ten whose logarithm is drawn.
    pub value: fn(f64) -> f64,
}

impl<'a> Axis<'a> {
    /// An axis of the numbers themselves.
    pub fn linear(label: &'a str, range: (f64, f64)) -> Self {
        Self { label, range, text: short, value: |number| number }
    }
}

/// A chart.
pub struct Plot<'a> {
    /// Name, of the figure's file too.
    pub figure: &'a str,
    /// Horizontal axis.
    pub x: Axis<'a>,
    /// Vertical axis.
    pub y: Axis<'a>,
    /// What is drawn, from back to front.
    pub series: &'a [Series],
}

impl Plot<'_> {
    /// The chart with what it shows as CSV.
    ///
    /// # Errors
    /// [`PlotError`].
    pub fn figure(&self, title: &str, caption: &str) -> Result<Figure, PlotError> {
        Ok(Figure {
            name: self.figure.into(),
            title: title.into(),
            caption: caption.into(),
            svg: self.svg()?,
            csv: series::csv(self),
        })
    }

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
        let (x0, x1) = widened(self.x.range);
        let (y0, y1) = widened(self.y.range);
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
            .x_label_formatter(&|value| (self.x.text)(*value))
            .y_label_formatter(&|value| (self.y.text)(*value))
            .x_desc(self.x.label)
            .y_desc(self.y.label)
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

#[cfg(test)]
mod tests {
    use super::*;

    fn plot(series: &[Series]) -> String {
        Plot {
            figure: "test",
            x: Axis::linear("x", (0.0, 1.0)),
            y: Axis::linear("y & more", (0.0, 1.0)),
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
}
