//! The chart of all curves of the report: lines, bands, steps, points and thresholds over two linear axes with a legend
//! above, drawn by plotters as SVG; and its numbers as CSV.

mod axis;
mod shapes;

pub use axis::{Axis, Scale, tick_label};
pub use shapes::{
    Area, Band, DrawError, LETTERS, LegendEntry, Points, Series, Shape, draw, draw_legend, legend,
    legend_height, letters, px, stroke,
};

use super::{Drawing, Figure, Ink};
use axis::{TickedAxis, ticks};
use plotters::prelude::*;
use shapes::{Frame, SeriesPainter};
use std::ops::Range;

/// Height of what is above and below the plot, without the legend [CSS pixels].
const AROUND: f64 = 60.0;

/// Mean width of a letter [CSS pixels].
const LETTER_WIDTH: f64 = 0.57 * LETTERS;

/// A chart of series over two axes.
pub struct Plot<'a> {
    /// Name of the figure and of its files.
    pub figure: &'a str,
    /// Label, range and ticks of the horizontal axis.
    pub x: Axis<'a>,
    /// Label, range and ticks of the vertical axis.
    pub y: Axis<'a>,
    /// Series from back to front.
    pub series: &'a [Series],
}

impl<'a> Plot<'a> {
    /// A plot of reliabilities.
    pub fn of_reliability(figure: &'a str, x: Axis<'a>, series: &'a [Series]) -> Self {
        Self { figure, x, y: Axis::linear("reliability R", (0.0, 1.0)), series }
    }

    /// The chart with its numbers as CSV.
    pub fn figure(&self, title: &str, caption: &str) -> Figure {
        let [name, title, caption] = [self.figure, title, caption].map(str::to_owned);
        let csv = shapes::csv(self.series, &self.x, &self.y);
        Figure { name, title, caption, drawing: self.drawing(), csv }
    }

    /// The chart. Points that are not finite are left out, as are those outside the range of the
    /// horizontal axis; values are clamped to the vertical range.
    pub fn drawing(&self) -> Drawing {
        let legend = legend(self.series);
        // Room for the label of the vertical axis.
        let plot = (LETTER_WIDTH * self.y.label.chars().count() as f64).max(230.0);
        let height = plot + legend_height(&legend) + AROUND;
        let mut axes = None;
        let drawing = draw(height, |root| {
            axes = Some(self.axes(&self.draw_on(root, &legend)?));
            Ok(())
        });
        Drawing { axes, ..drawing }
    }

    /// What a script needs to find the values at a place of the drawing, JSON: per axis its label, its scale, and first and last
    /// place [drawing units] with the numbers drawn there; and the names of the series by their colours.
    fn axes(&self, (across, down): &DrawnArea) -> String {
        let frame = Frame::new(self.x.range, self.y.range);
        let axis = |axis: &Axis<'_>, (from, to): (i32, i32), (first, last): (f64, f64)| {
            serde_json::json!({ "label": axis.label, "scale": axis.scale.name(), "from": from, "to": to, "first": first,
                "last": last })
        };
        let names: std::collections::BTreeMap<String, &str> =
            self.series.iter().rev().map(|series| (series.ink.hex(), series.label.as_str())).collect();
        let x = axis(&self.x, (across.start, across.end), frame.x);
        let y = axis(&self.y, (down.end, down.start), frame.y);
        serde_json::json!({ "x": x, "y": y, "names": names }).to_string()
    }

    /// Width of the label and the ticks of the vertical axis [CSS pixels].
    fn left_width(&self, ticks: &[f64]) -> f64 {
        let longest = ticks.iter().map(|tick| (self.y.text)(*tick).chars().count()).max().unwrap_or(0);
        (1.35 * LETTERS + LETTER_WIDTH * longest as f64 + 12.0).max(66.0)
    }

    fn draw_on(&self, root: &Area<'_>, legend: &[LegendEntry<'_>]) -> Result<DrawnArea, DrawError> {
        let frame = Frame::new(self.x.range, self.y.range);
        let [across, upward] = [ticks(self.x.scale, frame.x), ticks(self.y.scale, frame.y)];
        let mut chart = ChartBuilder::on(root)
            .margin_top(px(10.0 + legend_height(legend)))
            .margin_right(px(34.0))
            .margin_bottom(px(4.0))
            .margin_left(px(4.0))
            .x_label_area_size(px(46.0))
            .y_label_area_size(px(self.left_width(&upward)))
            .build_cartesian_2d(TickedAxis::new(frame.x, across), TickedAxis::new(frame.y, upward))?;
        chart
            .configure_mesh()
            .max_light_lines(0)
            .bold_line_style(stroke(Ink::Grid, 1.0))
            .axis_style(stroke(Ink::Muted, 1.0))
            .label_style(letters(Ink::Muted))
            .axis_desc_style(letters(Ink::Ink))
            .set_all_tick_mark_size(px(4.0))
            .x_label_formatter(&|value| (self.x.text)(*value))
            .y_label_formatter(&|value| (self.y.text)(*value))
            .x_desc(self.x.label)
            .y_desc(self.y.label)
            .draw()?;
        for series in self.series {
            SeriesPainter { chart: &mut chart, frame: &frame, series }.draw()?;
        }
        draw_legend(legend, root)?;
        Ok(chart.plotting_area().get_pixel_range())
    }
}

/// Where the curves of a chart are drawn: across and downward [drawing units].
type DrawnArea = (Range<i32>, Range<i32>);

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
        .drawing()
        .document(&maud::html! {})
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
    fn issue_long_labels_of_the_vertical_axis_ran_into_the_legend() {
        let height = |label: &str| {
            let (x, y) = (Axis::linear("x", (0.0, 1.0)), Axis::linear(label, (0.0, 1.0)));
            let view = Plot { figure: "test", x, y, series: &[] }.drawing().view;
            view.split(' ').next_back().unwrap().parse::<f64>().unwrap() / f64::from(px(1.0))
        };
        assert_eq!(height("R"), 290.0);
        assert!(height(&"x".repeat(40)) > 40.0 * LETTER_WIDTH + AROUND - 1.0);
    }

    #[test]
    fn empty_series_and_empty_ranges_are_drawn_as_nothing() {
        let shapes = [
            Shape::Line(vec![]),
            Shape::Dashed(vec![]),
            Shape::Dotted(vec![]),
            Shape::Marked(vec![((0.5, f64::NAN), "nowhere".into())]),
            Shape::Measured(vec![]),
            Shape::Measured(vec![[0.5, f64::NAN, 0.0, 1.0]]),
            Shape::Band(vec![]),
            Shape::Steps(vec![]),
            Shape::Level(f64::NAN),
        ];
        let series: Vec<_> = shapes.into_iter().map(|shape| Series::new("", Ink::Ink, shape)).collect();
        assert!(roxmltree::Document::parse(&plot(&series)).is_ok());
    }
}
