//! The paper of a drawing: sizes, pens and lettering in CSS pixels for plotters' SVG backend.

use crate::presentation::report::figure::Drawing;
use crate::presentation::report::palette::Ink;
use plotters::coord::Shift;
use plotters::prelude::*;

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

/// Lettering of this size [CSS pixels].
pub fn letters(size: f64, ink: Ink) -> TextStyle<'static> {
    ("sans-serif", size * SCALE * PLOTTERS_FONT).into_font().color(&ink.rgb())
}
