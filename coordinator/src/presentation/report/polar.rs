//! Drawings in polar form: rings of equal value, spokes every 30 degrees, curves around them. Drawn by hand, since
//! plotters has no polar coordinates.

use super::format::escape;
use super::palette::Ink;
use super::plot::short;
use std::f64::consts::TAU;
use std::fmt::Write;

/// Radius of the outermost ring in the drawing.
const OUTER: f64 = 124.0;

/// Half the edge of the drawing.
const HALF: f64 = 160.0;

/// Value at the outermost ring: the next round number, so that several drawings share a scale. `least` if nothing is
/// larger.
pub fn full_scale(largest: f64, least: f64) -> f64 {
    if !(largest.is_finite() && largest > least) {
        return least;
    }
    let decade = 10f64.powf(largest.log10().floor());
    [1.0, 1.5, 2.0, 3.0, 4.0, 5.0, 6.0, 8.0, 10.0]
        .map(|factor| factor * decade)
        .into_iter()
        .find(|scale| *scale >= largest * (1.0 - 1e-9))
        .unwrap_or(10.0 * decade)
}

/// How a curve is drawn.
#[derive(Debug, Clone, Copy)]
pub struct Stroke {
    /// Colour.
    pub ink: Ink,
    /// Width.
    pub width: f64,
    /// From 0, not there, to 1.
    pub opacity: f64,
}

/// A drawing under way.
pub struct Polar {
    /// Radius that stands for zero.
    inner: f64,
    /// Value at the outermost ring [m].
    full: f64,
    svg: String,
}

impl Polar {
    /// Paper, rings and spokes. Values up to `full` [m] lie between the radius `inner`, as a share of the outermost
    /// ring's, and that ring.
    pub fn new(inner: f64, full: f64) -> Self {
        let mut svg = format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"{0} {0} {1} {1}\" font-family=\"sans-serif\" font-size=\"13\">\n",
            -HALF,
            2.0 * HALF
        );
        let _ = writeln!(
            svg,
            "<rect x=\"{0}\" y=\"{0}\" width=\"{1}\" height=\"{1}\" fill=\"{2}\"/>",
            -HALF,
            2.0 * HALF,
            Ink::Paper.hex()
        );
        let mut polar = Self { inner: inner * OUTER, full, svg };
        let grid = Ink::Grid.hex();
        for ring in 1..=4 {
            let radius = polar.radius(full * f64::from(ring) / 4.0);
            polar.put(format_args!(
                "<circle r=\"{radius:.1}\" fill=\"none\" stroke=\"{grid}\" stroke-width=\"1\"/>"
            ));
        }
        for spoke in 0..12 {
            let ([x, y], [to_x, to_y]) =
                (polar.at(spoke_angle(spoke), 0.0), polar.at(spoke_angle(spoke), full));
            polar.put(format_args!(
                "<line x1=\"{x:.1}\" y1=\"{y:.1}\" x2=\"{to_x:.1}\" y2=\"{to_y:.1}\" stroke=\"{grid}\" stroke-width=\"1\"/>"
            ));
        }
        polar
    }

    fn put(&mut self, text: std::fmt::Arguments<'_>) {
        // Writing to a string cannot fail.
        let _ = self.svg.write_fmt(text);
        self.svg.push('\n');
    }

    fn radius(&self, value: f64) -> f64 {
        let share = if value.is_finite() { (value / self.full).clamp(0.0, 1.0) } else { 0.0 };
        self.inner + share * (OUTER - self.inner)
    }

    /// Place of a value at an angle [rad]; a value that is not finite counts as zero.
    fn at(&self, angle: f64, value: f64) -> [f64; 2] {
        let (sin, cos) = angle.sin_cos();
        let radius = self.radius(value);
        // No negative zero.
        [radius * cos, 0.0 - radius * sin]
    }

    /// A circle of one value [m].
    pub fn circle(&mut self, value: f64, stroke: Stroke) {
        let radius = self.radius(value);
        let (ink, Stroke { width, opacity, .. }) = (stroke.ink.hex(), stroke);
        self.put(format_args!(
            "<circle r=\"{radius:.2}\" fill=\"none\" stroke=\"{ink}\" stroke-width=\"{width}\" stroke-opacity=\"{opacity}\"/>"
        ));
    }

    /// A closed Catmull-Rom spline through values at equal angles from zero, counter-clockwise `(n,)` [m]; between it
    /// and the circle of zero filled, if wished.
    pub fn closed(&mut self, values: &[f64], stroke: Stroke, filled: bool) {
        let n = values.len();
        if n < 3 {
            return;
        }
        let at = |k: usize| self.at(TAU * (k % n) as f64 / n as f64, values[k % n]);
        let mut path = format!("M{:.2} {:.2}", at(0)[0], at(0)[1]);
        for k in 0..n {
            let (before, from, to, after) = (at(k + n - 1), at(k), at(k + 1), at(k + 2));
            let handle = |p: [f64; 2], tip: [f64; 2], tail: [f64; 2]| {
                [p[0] + (tip[0] - tail[0]) / 6.0, p[1] + (tip[1] - tail[1]) / 6.0]
            };
            let (a, b) = (handle(from, to, before), handle(to, from, after));
            let _ =
                write!(path, "C{:.2} {:.2} {:.2} {:.2} {:.2} {:.2}", a[0], a[1], b[0], b[1], to[0], to[1]);
        }
        let (ink, Stroke { width, opacity, .. }) = (stroke.ink.hex(), stroke);
        if filled {
            // By the even-odd rule.
            let r = self.radius(0.0);
            self.put(format_args!(
                "<path d=\"{path}ZM{r} 0A{r} {r} 0 1 0 {0} 0A{r} {r} 0 1 0 {r} 0Z\" fill=\"{ink}\" \
                 fill-opacity=\"0.2\" fill-rule=\"evenodd\"/>",
                -r
            ));
        }
        self.put(format_args!(
            "<path d=\"{path}Z\" fill=\"none\" stroke=\"{ink}\" stroke-width=\"{width}\" stroke-opacity=\"{opacity}\" \
             stroke-linejoin=\"round\"/>"
        ));
    }

    /// A curve through places given by x and y, those that are not finite left out `(n, 2)` [m].
    pub fn curve(&mut self, points: &[[f64; 2]], stroke: Stroke) {
        let at = |[x, y]: &[f64; 2]| self.at(y.atan2(*x), x.hypot(*y));
        let mut path = String::new();
        let known = points.iter().filter(|[x, y]| x.is_finite() && y.is_finite());
        for (k, point) in known.enumerate() {
            let [x, y] = at(point);
            let _ = write!(path, "{}{x:.1} {y:.1}", if k == 0 { 'M' } else { 'L' });
        }
        let (ink, Stroke { width, opacity, .. }) = (stroke.ink.hex(), stroke);
        self.put(format_args!(
            "<path d=\"{path}\" fill=\"none\" stroke=\"{ink}\" stroke-width=\"{width}\" stroke-opacity=\"{opacity}\" \
             stroke-linecap=\"round\" stroke-linejoin=\"round\"/>"
        ));
    }

    /// The document, with a word above, and the values of two rings [um] where `free` tells that least is drawn: by
    /// the direction of a spoke, from 0 to 11.
    pub fn finish(mut self, word: &str, free: usize) -> String {
        let muted = Ink::Muted.hex();
        for (degrees, x, y, anchor) in [
            (0, OUTER + 5.0, 4.5, "start"),
            (90, 0.0, -OUTER - 6.0, "middle"),
            (180, -OUTER - 5.0, 4.5, "end"),
            (270, 0.0, OUTER + 16.0, "middle"),
        ] {
            self.put(format_args!(
                "<text x=\"{x}\" y=\"{y}\" text-anchor=\"{anchor}\" fill=\"{muted}\">{degrees}°</text>"
            ));
        }
        for ring in [2, 4] {
            let value = self.full * f64::from(ring) / 4.0;
            // Between two spokes.
            let [x, y] = self.at(spoke_angle(free) + TAU / 24.0, value);
            self.put(format_args!(
                "<text x=\"{x:.1}\" y=\"{:.1}\" text-anchor=\"middle\" font-size=\"11\" fill=\"{muted}\">{} µm</text>",
                y + 4.0,
                short(value * 1e6)
            ));
        }
        let (ink, word) = (Ink::Ink.hex(), escape(word));
        self.put(format_args!(
            "<text x=\"{}\" y=\"{}\" font-size=\"15\" fill=\"{ink}\">{word}</text>",
            6.0 - HALF,
            18.0 - HALF
        ));
        self.svg + "</svg>\n"
    }
}

fn spoke_angle(spoke: usize) -> f64 {
    TAU * spoke as f64 / 12.0
}

/// The direction between two spokes, from 0 to 11, where values at equal angles from zero `(n,)` are least: the first
/// such.
pub fn freest(values: &[f64]) -> usize {
    let n = values.len();
    let largest = |spoke: usize| {
        let near = |k: &usize| {
            let away = (12.0 * *k as f64 / n as f64 - spoke as f64 - 0.5).rem_euclid(12.0);
            away.min(12.0 - away) <= 1.0
        };
        (0..n).filter(near).map(|k| values[k]).fold(0.0, f64::max)
    };
    // Beside the words at 0, 90, 180 and 270 degrees there is no room.
    [1, 4, 7, 10].into_iter().min_by(|a, b| largest(*a).total_cmp(&largest(*b))).unwrap_or(1)
}

#[cfg(test)]
mod tests {
    use super::*;

    const LINE: Stroke = Stroke { ink: Ink::Series(0), width: 2.0, opacity: 1.0 };

    #[test]
    fn the_scale_is_a_round_number_above_the_largest_value() {
        for (largest, scale) in [(3.1e-5, 4e-5), (4e-5, 4e-5), (9.9e-6, 1e-5), (1e-6, 1e-6), (0.0, 1e-6)] {
            assert!((full_scale(largest, 1e-6) / scale - 1.0).abs() < 1e-9, "{largest}");
        }
    }

    #[test]
    fn a_point_worn_to_full_scale_lies_on_the_outer_ring() {
        let mut wear = vec![0.0; 36];
        wear[9] = 2e-5;
        let mut polar = Polar::new(0.5, 2e-5);
        polar.closed(&wear, LINE, true);
        let svg = polar.finish("A & B", freest(&wear));
        let document = roxmltree::Document::parse(&svg).unwrap();
        let path = document.descendants().filter_map(|node| node.attribute("d")).next_back().unwrap();
        assert!(path.contains(&format!(" 0.00 -{OUTER:.2}C")), "{path}");
        assert_ne!(freest(&wear), 2);
    }

    #[test]
    fn places_lie_at_their_distance_and_angle() {
        let mut polar = Polar::new(0.0, 2e-5);
        polar.curve(&[[1e-5, 0.0], [0.0, -2e-5]], LINE);
        assert!(polar.svg.contains("d=\"M62.0 0.0L0.0 124.0\""), "{}", polar.svg);
    }

    #[test]
    fn values_that_are_no_numbers_do_not_reach_the_page() {
        let mut polar = Polar::new(0.5, 1e-5);
        polar.closed(&[f64::NAN; 8], LINE, true);
        polar.curve(&[[f64::NAN, 0.0]], LINE);
        let svg = polar.finish("1", freest(&[f64::NAN; 8]));
        assert!(!svg.contains("NaN") && roxmltree::Document::parse(&svg).is_ok());
    }
}
