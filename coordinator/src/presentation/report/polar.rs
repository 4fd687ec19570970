//! Drawings in polar coordinates: rings of equal value, spokes every 30 degrees, and curves. Written as SVG elements, since
//! plotters has no polar coordinates.
//!
//! # Source
//! Catmull, Rom (1974), A class of local interpolating splines: the spline of closed curves.

use super::format::with_unit;
use super::{Drawing, Ink};
use common::scene::OutputUnit;
use maud::{Markup, html};
use std::f64::consts::TAU;

/// Radius of the outermost ring [drawing units].
const OUTER: f64 = 124.0;

/// Half the edge of the drawing [drawing units].
const HALF: f64 = 160.0;

/// Value at the outermost ring [m]: the next round number of the unit not below `largest` [m], at least a micrometre.
pub fn full_scale(unit: &OutputUnit, largest: f64) -> f64 {
    if !(largest.is_finite() && largest > 1e-6) {
        return 1e-6;
    }
    let largest = unit.to_shown(largest);
    let decade = 10f64.powf(largest.log10().floor());
    let scales = [1.0, 1.5, 2.0, 3.0, 4.0, 5.0, 6.0, 8.0, 10.0].map(|factor| factor * decade);
    let found = scales.into_iter().find(|scale| *scale >= largest * (1.0 - 1e-9));
    found.unwrap_or(10.0 * decade) / unit.to_shown(1.0)
}

/// How a curve is drawn.
#[derive(Debug, Clone, Copy)]
pub struct Stroke {
    /// Colour of the line.
    pub ink: Ink,
    /// Width [drawing units].
    pub width: f64,
    /// Opacity from 0 (invisible) to 1.
    pub opacity: f64,
}

/// A drawing under construction.
pub struct Polar {
    /// Radius of the circle of zero [drawing units].
    inner: f64,
    /// Value at the outermost ring [m].
    full: f64,
    /// Elements so far, from back to front.
    elements: Vec<Markup>,
}

impl Polar {
    /// Rings and spokes. Values up to `full` [m] lie between the radius `inner`, as a share of the outermost ring's, and
    /// that ring.
    pub fn new(inner: f64, full: f64) -> Self {
        let mut polar = Self { inner: inner * OUTER, full, elements: Vec::new() };
        let grid = Ink::Grid.hex();
        for ring in 1..=4 {
            let radius = format!("{:.1}", polar.radius(full * f64::from(ring) / 4.0));
            polar.elements.push(html! { circle r=(radius) fill="none" stroke=(grid) stroke-width="1" {} });
        }
        for spoke in 0..12 {
            let place = |value| polar.place(spoke_angle(spoke), value).map(|place| format!("{place:.1}"));
            let ([x, y], [to_x, to_y]) = (place(0.0), place(full));
            let line = html! { line x1=(x) y1=(y) x2=(to_x) y2=(to_y) stroke=(grid) stroke-width="1" {} };
            polar.elements.push(line);
        }
        polar
    }

    fn radius(&self, value: f64) -> f64 {
        let share = if value.is_finite() { (value / self.full).clamp(0.0, 1.0) } else { 0.0 };
        self.inner + share * (OUTER - self.inner)
    }

    /// Point of a value at an angle [rad]; a value that is not finite counts as zero.
    fn place(&self, angle: f64, value: f64) -> [f64; 2] {
        let (sin, cos) = angle.sin_cos();
        let radius = self.radius(value);
        // No negative zero.
        [radius * cos, 0.0 - radius * sin]
    }

    /// A circle of one value [m].
    pub fn circle(&mut self, value: f64, stroke: Stroke) {
        let radius = format!("{:.2}", self.radius(value));
        self.elements.push(html! {
            circle r=(radius) fill="none" stroke=(stroke.ink.hex()) stroke-width=(stroke.width)
                stroke-opacity=(stroke.opacity) {}
        });
    }

    /// A closed Catmull-Rom spline through values at equal angles from zero, counter-clockwise `(n,)` [m].
    pub fn closed(&mut self, values: &[f64], stroke: Stroke) {
        if let Some(path) = self.spline(values) {
            self.path(path + "Z", stroke, None);
        }
    }

    fn path(&mut self, path: String, stroke: Stroke, cap: Option<&str>) {
        self.elements.push(html! {
            path d=(path) fill="none" stroke=(stroke.ink.hex()) stroke-width=(stroke.width)
                stroke-opacity=(stroke.opacity) stroke-linecap=[cap] stroke-linejoin="round" {}
        });
    }

    /// The area between the circle of zero and the spline of [`Polar::closed`], filled by the even-odd rule.
    pub fn filled(&mut self, values: &[f64], ink: Ink) {
        if let Some(path) = self.spline(values) {
            let r = self.radius(0.0);
            let ring = format!("{path}ZM{r} 0A{r} {r} 0 1 0 {0} 0A{r} {r} 0 1 0 {r} 0Z", -r);
            let area = html! { path d=(ring) fill=(ink.hex()) fill-opacity="0.2" fill-rule="evenodd" {} };
            self.elements.push(area);
        }
    }

    /// Path of the closed Catmull-Rom spline without its end; `None` for fewer than three values.
    fn spline(&self, values: &[f64]) -> Option<String> {
        let n = values.len();
        if n < 3 {
            return None;
        }
        let point = |k: usize| self.place(TAU * (k % n) as f64 / n as f64, values[k % n]);
        let handle = |p: [f64; 2], tip: [f64; 2], tail: [f64; 2]| {
            [p[0] + (tip[0] - tail[0]) / 6.0, p[1] + (tip[1] - tail[1]) / 6.0]
        };
        let curves = (0..n).map(|k| {
            let (before, from, [x, y], after) = (point(k + n - 1), point(k), point(k + 1), point(k + 2));
            let ([ax, ay], [bx, by]) = (handle(from, [x, y], before), handle([x, y], from, after));
            format!("C{ax:.2} {ay:.2} {bx:.2} {by:.2} {x:.2} {y:.2}")
        });
        let [x, y] = point(0);
        Some(std::iter::once(format!("M{x:.2} {y:.2}")).chain(curves).collect())
    }

    /// A curve through points given by x and y, those that are not finite left out `(n, 2)` [m].
    pub fn curve(&mut self, points: &[[f64; 2]], stroke: Stroke) {
        let known = points.iter().filter(|[x, y]| x.is_finite() && y.is_finite()).enumerate();
        let commands = known.map(|(k, [x, y])| {
            let [x, y] = self.place(y.atan2(*x), x.hypot(*y));
            format!("{}{x:.1} {y:.1}", if k == 0 { 'M' } else { 'L' })
        });
        self.path(commands.collect(), stroke, Some("round"));
    }

    /// The drawing with a title in its corner, and the values of two rings in this unit between spoke `free`, from 0 to 11, and
    /// the next.
    pub fn finish(self, title: &str, free: usize, unit: &OutputUnit) -> Drawing {
        let muted = Ink::Muted.hex();
        let directions = [
            (0, OUTER + 5.0, 4.5, "start"),
            (90, 0.0, -OUTER - 6.0, "middle"),
            (180, -OUTER - 5.0, 4.5, "end"),
            (270, 0.0, OUTER + 16.0, "middle"),
        ];
        let rings = [2, 4].map(|ring| {
            let value = self.full * f64::from(ring) / 4.0;
            let [x, y] = self.place(spoke_angle(free) + TAU / 24.0, value);
            (format!("{x:.1}"), format!("{:.1}", y + 4.0), with_unit(unit, value))
        });
        let content = html! {
            rect x=(-HALF) y=(-HALF) width=(2.0 * HALF) height=(2.0 * HALF) fill=(Ink::Paper.hex()) {}
            @for element in &self.elements { (element) }
            @for (degrees, x, y, anchor) in directions {
                text x=(x) y=(y) text-anchor=(anchor) fill=(muted) { (degrees) "°" }
            }
            @for (x, y, value) in rings {
                text x=(x) y=(y) text-anchor="middle" fill=(muted) { (value) }
            }
            text x=(6.0 - HALF) y=(18.0 - HALF) fill=(Ink::Ink.hex()) { (title) }
        };
        let view = format!("{0} {0} {1} {1}", -HALF, 2.0 * HALF);
        Drawing { view, letters: Some(13.0), axes: None, content: content.into_string() }
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
    // The labels at 0, 90, 180 and 270 degrees take the other spaces.
    [1, 4, 7, 10].into_iter().min_by(|a, b| largest(*a).total_cmp(&largest(*b))).unwrap_or(1)
}

#[cfg(test)]
mod tests {
    use super::*;

    const LINE: Stroke = Stroke { ink: Ink::Series(0), width: 2.0, opacity: 1.0 };

    #[test]
    fn the_scale_is_a_round_number_above_the_largest_value() {
        for (largest, scale) in [(3.1e-5, 4e-5), (4e-5, 4e-5), (9.9e-6, 1e-5), (1e-6, 1e-6), (0.0, 1e-6)] {
            assert!((full_scale(&OutputUnit::Length, largest) / scale - 1.0).abs() < 1e-9, "{largest}");
        }
    }

    #[test]
    fn a_point_worn_to_full_scale_lies_on_the_outer_ring() {
        let mut wear = vec![0.0; 36];
        wear[9] = 2e-5;
        let mut polar = Polar::new(0.5, 2e-5);
        polar.filled(&wear, Ink::Series(0));
        polar.closed(&wear, LINE);
        let svg = polar.finish("A & B", freest(&wear), &OutputUnit::Length).document(&html! {});
        let document = roxmltree::Document::parse(&svg).unwrap();
        let path = document.descendants().filter_map(|node| node.attribute("d")).next_back().unwrap();
        assert!(path.contains(&format!(" 0.00 -{OUTER:.2}C")), "{path}");
        assert_ne!(freest(&wear), 2);
    }

    #[test]
    fn places_lie_at_their_distance_and_angle() {
        let mut polar = Polar::new(0.0, 2e-5);
        polar.curve(&[[1e-5, 0.0], [0.0, -2e-5]], LINE);
        let svg = polar.finish("1", 1, &OutputUnit::Length).content;
        assert!(svg.contains("d=\"M62.0 0.0L0.0 124.0\""), "{svg}");
    }

    #[test]
    fn values_that_are_no_numbers_do_not_reach_the_page() {
        let mut polar = Polar::new(0.5, 1e-5);
        polar.closed(&[f64::NAN; 8], LINE);
        polar.curve(&[[f64::NAN, 0.0]], LINE);
        let svg = polar.finish("1", freest(&[f64::NAN; 8]), &OutputUnit::Length).document(&html! {});
        assert!(!svg.contains("NaN") && roxmltree::Document::parse(&svg).is_ok());
    }
}
