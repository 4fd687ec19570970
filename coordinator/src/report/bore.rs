//! The worn bore of a joint in polar form: the unworn bore as a circle, wear depth outward from it, magnified.
//! Drawn by hand, since plotters has no polar coordinates.

use super::palette::Ink;
use std::f64::consts::TAU;
use std::fmt::Write;

/// Radius of the unworn bore in the drawing.
const BORE: f64 = 62.0;

/// Room for wear outside the bore in the drawing.
const DEPTH: f64 = 62.0;

/// Half the edge of the drawing.
const HALF: f64 = 160.0;

/// Depth that fills the room for wear: the next 1, 2 or 5 times a power of ten, which makes one scale for all
/// joints. One micrometre if nothing is worn.
pub fn full_scale(largest: f64) -> f64 {
    if !(largest.is_finite() && largest > 0.0) {
        return 1e-6;
    }
    let decade = 10f64.powf(largest.log10().floor());
    [1.0, 2.0, 3.0, 4.0, 5.0, 10.0]
        .map(|factor| factor * decade)
        .into_iter()
        .find(|scale| *scale >= largest * (1.0 - 1e-9))
        .unwrap_or(10.0 * decade)
}

/// Polar drawing of one bore as an SVG document.
///
/// `wear` holds the depth at control points at equal angles from zero, counter-clockwise in the bushing body's
/// frame [m]; `full` is the depth at the outer ring [m]. The curve through the points is a closed Catmull-Rom
/// spline. Depths that are not finite count as zero.
pub fn svg(joint: &str, wear: &[f64], full: f64) -> String {
    let depth = |value: f64| if value.is_finite() { (value / full).clamp(0.0, 1.0) * DEPTH } else { 0.0 };
    let at = |k: usize| -> (f64, f64) {
        let k = k % wear.len();
        let (sin, cos) = (TAU * k as f64 / wear.len() as f64).sin_cos();
        let radius = BORE + depth(wear[k]);
        (radius * cos, -radius * sin)
    };
    let mut svg = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"{0} {0} {1} {1}\" font-family=\"sans-serif\" font-size=\"13\">\n",
        -HALF,
        2.0 * HALF
    );
    let (paper, grid, muted, ink) =
        (Ink::Paper.hex(), Ink::Grid.hex(), Ink::Muted.hex(), Ink::Series(0).hex());
    let mut put = |text: std::fmt::Arguments<'_>| {
        svg.write_fmt(text).expect("writing to a string cannot fail");
        svg.push('\n');
    };
    put(format_args!(
        "<rect x=\"{0}\" y=\"{0}\" width=\"{1}\" height=\"{1}\" fill=\"{paper}\"/>",
        -HALF,
        2.0 * HALF
    ));
    // Rings of equal depth and spokes every 30 degrees.
    for ring in 1..=4 {
        let radius = BORE + DEPTH * f64::from(ring) / 4.0;
        put(format_args!("<circle r=\"{radius:.1}\" fill=\"none\" stroke=\"{grid}\" stroke-width=\"1\"/>"));
    }
    for spoke in 0..12 {
        let (sin, cos) = (TAU * f64::from(spoke) / 12.0).sin_cos();
        put(format_args!(
            "<line x1=\"{:.1}\" y1=\"{:.1}\" x2=\"{:.1}\" y2=\"{:.1}\" stroke=\"{grid}\" stroke-width=\"1\"/>",
            BORE * cos,
            -BORE * sin,
            (BORE + DEPTH) * cos,
            -(BORE + DEPTH) * sin
        ));
    }
    if wear.len() >= 3 {
        // Between the unworn circle and the worn curve, by the even-odd rule.
        let mut path = format!("M{:.2} {:.2}", at(0).0, at(0).1);
        for k in 0..wear.len() {
            let (before, from, to, after) = (at(k + wear.len() - 1), at(k), at(k + 1), at(k + 2));
            let handle = |p: (f64, f64), tip: (f64, f64), tail: (f64, f64)| {
                (p.0 + (tip.0 - tail.0) / 6.0, p.1 + (tip.1 - tail.1) / 6.0)
            };
            let (a, b) = (handle(from, to, before), handle(to, from, after));
            let _ = write!(path, "C{:.2} {:.2} {:.2} {:.2} {:.2} {:.2}", a.0, a.1, b.0, b.1, to.0, to.1);
        }
        put(format_args!(
            "<path d=\"{path}ZM{BORE} 0A{BORE} {BORE} 0 1 0 {0} 0A{BORE} {BORE} 0 1 0 {BORE} 0Z\" fill=\"{ink}\" \
             fill-opacity=\"0.22\" fill-rule=\"evenodd\"/>",
            -BORE
        ));
        put(format_args!(
            "<path d=\"{path}Z\" fill=\"none\" stroke=\"{ink}\" stroke-width=\"2\" stroke-linejoin=\"round\"/>"
        ));
        for k in 0..wear.len() {
            let (x, y) = at(k);
            put(format_args!("<circle cx=\"{x:.2}\" cy=\"{y:.2}\" r=\"1.8\" fill=\"{ink}\"/>"));
        }
    }
    put(format_args!("<circle r=\"{BORE}\" fill=\"none\" stroke=\"{muted}\" stroke-width=\"1.2\"/>"));
    for (degrees, x, y, anchor) in [
        (0, BORE + DEPTH + 5.0, 4.5, "start"),
        (90, 0.0, -BORE - DEPTH - 6.0, "middle"),
        (180, -BORE - DEPTH - 5.0, 4.5, "end"),
        (270, 0.0, BORE + DEPTH + 16.0, "middle"),
    ] {
        put(format_args!(
            "<text x=\"{x}\" y=\"{y}\" text-anchor=\"{anchor}\" fill=\"{muted}\">{degrees}°</text>"
        ));
    }
    // Two of the rings named, between two spokes where bores seldom wear deepest and letters stay clear.
    for ring in [2, 4] {
        let share = f64::from(ring) / 4.0;
        let (sin, cos) = (TAU * 75.0 / 360.0).sin_cos();
        let radius = BORE + DEPTH * share;
        put(format_args!(
            "<text x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"middle\" font-size=\"11\" fill=\"{muted}\">{} µm</text>",
            radius * cos,
            -radius * sin + 4.0,
            super::plot::short(full * share * 1e6)
        ));
    }
    let ink = Ink::Ink.hex();
    let name = super::format::escape(joint);
    put(format_args!(
        "<text x=\"0\" y=\"5\" text-anchor=\"middle\" font-size=\"15\" fill=\"{ink}\">joint {name}</text>"
    ));
    svg.push_str("</svg>\n");
    svg
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_scale_is_a_round_number_above_the_largest_depth() {
        for (largest, scale) in [(3.1e-5, 4e-5), (4e-5, 4e-5), (9.9e-6, 1e-5), (1e-6, 1e-6), (0.0, 1e-6)] {
            assert!((full_scale(largest) / scale - 1.0).abs() < 1e-9, "{largest}");
        }
    }

    #[test]
    fn a_point_worn_to_full_scale_lies_on_the_outer_ring() {
        let mut wear = vec![0.0; 36];
        wear[9] = 2e-5;
        let svg = svg("A & B", &wear, 2e-5);
        let document = roxmltree::Document::parse(&svg).unwrap();
        let top = document
            .descendants()
            .filter(|node| node.has_tag_name("circle") && node.has_attribute("cy"))
            .map(|node| node.attribute("cy").unwrap().parse::<f64>().unwrap())
            .fold(f64::INFINITY, f64::min);
        assert!((top + BORE + DEPTH).abs() < 0.01, "{top}");
    }

    #[test]
    fn depths_that_are_no_numbers_do_not_reach_the_page() {
        let svg = svg("1", &[f64::NAN; 8], 1e-5);
        assert!(!svg.contains("NaN") && roxmltree::Document::parse(&svg).is_ok());
    }
}
