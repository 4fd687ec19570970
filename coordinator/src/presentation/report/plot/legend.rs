//! The legend above a chart.

use super::canvas::{Area, DrawError, LETTERS, WIDTH, letters, px, stroke};
use super::series::{Series, Shape};
use crate::presentation::report::palette::Ink;
use plotters::prelude::*;

/// Entries above the plot, in as many rows as they need.
pub struct Legend<'a> {
    entries: Vec<(f64, usize, &'a Series)>,
    pub rows: usize,
}

pub fn legend(series: &[Series]) -> Legend<'_> {
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
    let rows = if entries.is_empty() { 0 } else { row + 1 };
    Legend { entries, rows }
}

impl Legend<'_> {
    pub fn draw_on(&self, root: &Area<'_>) -> Result<(), DrawError> {
        for (x, row, series) in &self.entries {
            let y = 15.0 + 20.0 * *row as f64;
            let ends = [(px(*x), px(y)), (px(x + 18.0), px(y))];
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

    #[test]
    fn a_legend_too_long_for_one_row_takes_two() {
        let long = || Series::new("x".repeat(40), Ink::Ink, Shape::Line(vec![]));
        assert_eq!(legend(&[long(), long()]).rows, 2);
        assert_eq!(legend(&[]).rows, 0);
    }
}
