//! A chart of pairs of horizontal bars with their errors, one pair per variable.

use super::plot::{DrawError, draw, draw_legend, legend, legend_height, letters, px, stroke};
use super::{Drawing, Figure, Ink, Series, Shape, csv, tick_label};
use crate::results::csv_table::number;
use plotters::coord::types::RangedCoordf64;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};
use std::ops::Range;

/// Height of one variable's two bars [CSS pixels].
const ROW: f64 = 26.0;

/// Height of the axis below [CSS pixels].
const AXIS: f64 = 48.0;

/// Width of the column of names [CSS pixels].
const NAMES: f64 = 178.0;

/// Number of letters that fit into it.
const LONGEST: usize = 21;

/// Half-length of the error lines [standard errors].
const REACH: f64 = 1.96;

/// The two bars of one variable: its name, their lengths, and the standard errors of these.
pub type BarPair = (String, [f64; 2], [f64; 2]);

/// A chart of pairs of bars.
pub struct Bars<'a> {
    /// Name of the figure.
    pub figure: &'a str,
    /// Meaning of the first and of the second bar of each pair.
    pub labels: [&'a str; 2],
    /// Label of the axis of their lengths.
    pub axis: &'a str,
    /// True if lengths can be negative.
    pub signed: bool,
    /// The pairs from top to bottom.
    pub all: Vec<BarPair>,
    /// Number of pairs drawn; the CSV contains all.
    pub shown: usize,
}

impl Bars<'_> {
    /// The chart with its numbers.
    pub fn figure(&self, title: &str, caption: &str) -> Figure {
        let [first, second] = self.labels;
        let errors = self.labels.map(|label| format!("{label}, standard error"));
        let row = |(name, values, errors): &BarPair| {
            let ([a, b], [da, db]) = (values.map(number), errors.map(number));
            [name.clone(), a, da, b, db]
        };
        let csv = csv(&["variable", first, &errors[0], second, &errors[1]], self.all.iter().map(row));
        let [name, title, caption] = [self.figure, title, caption].map(str::to_owned);
        Figure { name, title, caption, drawing: self.drawing(), csv }
    }

    fn drawing(&self) -> Drawing {
        let rows = &self.all[..self.shown.min(self.all.len())];
        let longest =
            rows.iter().flat_map(|(_, values, _)| values).map(|value| value.abs()).fold(0.0, f64::max);
        let longest = if longest > 0.0 { 1.12 * longest } else { 1.0 };
        let inks = [Ink::Series(0), Ink::Series(1)];
        let names: Vec<String> = rows.iter().map(|(name, ..)| name.clone()).collect();
        let meaning =
            |bar: usize| Series::new(self.labels[bar], inks[bar], Shape::Steps(vec![])).filled(0.75);
        let (range, legend) = (if self.signed { -longest } else { 0.0 }..longest, &[0, 1].map(meaning));
        let chart =
            NamedRows { names: &names, row: ROW, legend, axis: self.axis, range: range.clone(), ticks: 6 };
        chart.draw(|chart| {
            for (k, (_, values, errors)) in rows.iter().enumerate() {
                let top = (rows.len() - k) as f64;
                for (bar, ink) in inks.into_iter().enumerate() {
                    let (from, to) = (top - 0.12 - 0.4 * bar as f64, top - 0.46 - 0.4 * bar as f64);
                    let (value, reach) = (values[bar], REACH * errors[bar]);
                    chart.draw_series([Rectangle::new([(0.0, from), (value, to)], ink.rgb().filled())])?;
                    let ends = [value - reach, value + reach].map(|x| x.clamp(range.start, longest));
                    let line = ends.map(|x| (x, 0.5 * (from + to)));
                    chart.draw_series([PathElement::new(line, stroke(Ink::Ink, 1.0))])?;
                }
            }
            let zero = [(0.0, 0.0), (0.0, rows.len() as f64)];
            chart.draw_series([PathElement::new(zero, stroke(Ink::Muted, 1.0))])?;
            Ok(())
        })
    }
}

/// A chart of one row per name, the names on its left, over one horizontal axis.
pub(super) struct NamedRows<'a> {
    /// Names from top to bottom.
    pub names: &'a [String],
    /// Height of a row [CSS pixels].
    pub row: f64,
    /// Series whose entries of the legend are above the first row.
    pub legend: &'a [Series],
    /// Label, range and number of ticks of the axis.
    pub axis: &'a str,
    pub range: Range<f64>,
    pub ticks: usize,
}

/// Its coordinates: the number on the axis, and the number of rows from the bottom.
type RowChart<'a, 'b> = ChartContext<'a, SVGBackend<'b>, Cartesian2d<RangedCoordf64, RangedCoordf64>>;

impl NamedRows<'_> {
    /// The chart with what `paint` draws.
    pub fn draw(&self, paint: impl FnOnce(&mut RowChart<'_, '_>) -> Result<(), DrawError>) -> Drawing {
        let count = self.names.len() as f64;
        let legend = legend(self.legend);
        // A tick that is the sum of steps misses 0 by their rounding.
        let rounding = 1e-9 * (self.range.end - self.range.start);
        let tick = |value: &f64| tick_label(if value.abs() < rounding { 0.0 } else { *value });
        let top = 10.0 + legend_height(&legend);
        draw(self.row * count + top + AXIS, |root| {
            let mut chart = ChartBuilder::on(root)
                .margin_top(px(top))
                .margin_right(px(18.0))
                .margin_left(px(NAMES))
                .x_label_area_size(px(AXIS))
                .build_cartesian_2d(self.range.clone(), 0.0..count)?;
            chart
                .configure_mesh()
                .disable_y_mesh()
                .disable_y_axis()
                .x_labels(self.ticks)
                .max_light_lines(0)
                .bold_line_style(stroke(Ink::Grid, 1.0))
                .axis_style(stroke(Ink::Muted, 1.0))
                .label_style(letters(Ink::Muted))
                .axis_desc_style(letters(Ink::Ink))
                .set_all_tick_mark_size(px(4.0))
                .x_label_formatter(&tick)
                .x_desc(self.axis)
                .draw()?;
            paint(&mut chart)?;
            let right = letters(Ink::Ink).pos(Pos::new(HPos::Right, VPos::Center));
            for (k, name) in self.names.iter().enumerate() {
                let middle = px(top + self.row * (k as f64 + 0.5));
                root.draw(&Text::new(shortened(name), (px(NAMES - 7.0), middle), right.clone()))?;
            }
            draw_legend(&legend, root)
        })
    }
}

/// A name cut to what fits, with a mark where something was left out.
pub(super) fn shortened(name: &str) -> String {
    let cut = || name.chars().take(LONGEST - 1).chain(['…']).collect();
    if name.chars().count() <= LONGEST { name.to_owned() } else { cut() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_numbers_hold_all_and_the_drawing_the_first() {
        let name = |k: usize| format!("variable {k}, {}", "long".repeat(k));
        let pair = |k: usize| (name(k), [0.1 / (k + 1) as f64, -0.2], [0.01, 0.0]);
        let bars = Bars {
            figure: "f",
            labels: ["a", "b"],
            axis: "x",
            signed: true,
            all: (0..5).map(pair).collect(),
            shown: 3,
        };
        let figure = bars.figure("t", "c");
        assert_eq!(figure.csv.lines().count(), 6);
        assert!(figure.csv.contains("\"variable 1, long\",0.05,0.01,-0.2,0.0\n"), "{}", figure.csv);
        let svg = figure.drawing.document(&maud::html! {});
        let document = roxmltree::Document::parse(&svg).unwrap();
        let text: Vec<&str> = document.descendants().filter_map(|node| node.text()).map(str::trim).collect();
        assert!(text.contains(&"variable 2, longlong") && !text.iter().any(|t| t.contains("variable 3")));
        assert_eq!(shortened("a name that is far too long").chars().count(), LONGEST);
    }
}
