//! Symbols of mechanisms as SVG: links, supports, sliders on rails, arrows, springs. Points are in drawing units, y downward.

use super::geometry::middle_of;
use crate::presentation::report::format::plain;
use crate::presentation::report::palette::Ink;
use maud::{Markup, html};

/// Length and height of the block of a slider [drawing units].
pub const BLOCK: [f64; 2] = [34.0, 20.0];

/// Height of the symbol of a support below its point [drawing units].
pub const SUPPORT: f64 = 22.0;

/// Distance of two hatching lines [drawing units].
const HATCH: f64 = 7.0;

/// A number of the drawing, with two decimals at most.
pub fn coordinate(value: f64) -> String {
    plain(value, 2).replace('\u{2212}', "-")
}

/// Both coordinates of a place.
pub fn pair([x, y]: [f64; 2]) -> String {
    format!("{} {}", coordinate(x), coordinate(y))
}

/// A `transform` that moves to a place and turns by an angle [deg, clockwise].
pub fn placed(at: [f64; 2], degrees: f64) -> String {
    format!("translate({}) rotate({})", pair(at), coordinate(degrees))
}

/// `M`, `L`, ... commands along points.
pub fn path_along(points: &[[f64; 2]]) -> String {
    let command = |(k, at): (usize, &[f64; 2])| format!("{}{}", if k == 0 { 'M' } else { 'L' }, pair(*at));
    points.iter().enumerate().map(command).collect()
}

/// A body: a bar between two points, a plate between more.
pub fn link(corners: &[[f64; 2]], ink: Ink) -> Markup {
    let path = path_along(&around(corners)) + "Z";
    let colour = ink.hex();
    html! {
        path d=(path) fill=(colour) fill-opacity="0.25" stroke=(colour) stroke-width="6" stroke-opacity="0.85"
            stroke-linejoin="round" stroke-linecap="round" {}
    }
}

/// The corners sorted by direction from their middle, so that the edges of a plate do not cross.
pub fn around(corners: &[[f64; 2]]) -> Vec<[f64; 2]> {
    let mut sorted = corners.to_vec();
    let middle = middle_of(corners);
    let direction = |p: &[f64; 2]| (middle[1] - p[1]).atan2(p[0] - middle[0]);
    sorted.sort_by(|a, b| direction(a).total_cmp(&direction(b)));
    sorted
}

/// The support of a point on the ground, hatched.
pub fn ground([x, y]: [f64; 2]) -> Markup {
    let floor = y + 15.0;
    html! {
        path d=(format!("M{}l-9 15h18z", pair([x, y]))) fill=(Ink::Grid.hex()) stroke=(Ink::Muted.hex()) stroke-width="1.5" {}
        (hatched([x + 14.0, floor], [x - 14.0, floor]))
    }
}

/// Direction from a point to another [1], and their distance.
pub fn direction(from: [f64; 2], to: [f64; 2]) -> ([f64; 2], f64) {
    let (dx, dy) = (to[0] - from[0], to[1] - from[1]);
    let length = dx.hypot(dy).max(1e-9);
    ([dx / length, dy / length], length)
}

/// An edge of the frame: a line with hatching on its left side, seen from `from` to `to`.
pub fn hatched(from: [f64; 2], to: [f64; 2]) -> Markup {
    let ([dx, dy], length) = direction(from, to);
    let mut path = path_along(&[from, to]);
    let mut way = 0.5 * HATCH;
    while way < length {
        let foot = [from[0] + way * dx, from[1] + way * dy];
        path += &path_along(&[foot, [foot[0] + 6.0 * (0.6 * dx + dy), foot[1] + 6.0 * (0.6 * dy - dx)]]);
        way += HATCH;
    }
    html! { path d=(path) fill="none" stroke=(Ink::Muted.hex()) stroke-width="1.5" {} }
}

/// The block of a slider, turned by an angle [deg, clockwise].
pub fn block(at: [f64; 2], degrees: f64, ink: Ink) -> Markup {
    let [length, height] = BLOCK;
    html! {
        g transform=(placed(at, degrees)) {
            rect x=(-0.5 * length) y=(-0.5 * height) width=(length) height=(height) rx="2" fill=(Ink::Paper.hex()) {}
            rect x=(-0.5 * length) y=(-0.5 * height) width=(length) height=(height) rx="2" fill=(ink.hex())
                fill-opacity="0.25" stroke=(ink.hex()) stroke-width="2.5" {}
        }
    }
}

/// Ends of the rail below a block that goes from one point to another: left and right end, seen from the block.
pub fn rail_ends([from, to]: [[f64; 2]; 2]) -> [[f64; 2]; 2] {
    let (dx, dy) = (to[0] - from[0], to[1] - from[1]);
    let length = dx.hypot(dy);
    let direction = if length > 1e-6 { [dx / length, dy / length] } else { [1.0, 0.0] };
    // The rail lies below: right of a direction to the right.
    let sign =
        if direction[0] < -1e-9 || (direction[0].abs() <= 1e-9 && direction[1] > 0.0) { -1.0 } else { 1.0 };
    let [dx, dy] = direction.map(|d| sign * d);
    let (from, to) = if sign > 0.0 { (from, to) } else { (to, from) };
    let (beyond, below) = (0.5 * BLOCK[0] + 12.0, 0.5 * BLOCK[1] + 2.0);
    [
        [from[0] - beyond * dx - below * dy, from[1] - beyond * dy + below * dx],
        [to[0] + beyond * dx - below * dy, to[1] + beyond * dy + below * dx],
    ]
}

/// The rail between two ends: hatched on the ground, a line on a body that moves.
pub fn rail([left, right]: [[f64; 2]; 2], on_ground: bool, ink: Ink) -> Markup {
    if on_ground {
        return hatched(right, left);
    }
    html! { path d=(path_along(&[left, right])) fill="none" stroke=(ink.hex()) stroke-width="4" {} }
}

/// A triangle with its tip at a point, towards a direction.
pub fn head([x, y]: [f64; 2], [dx, dy]: [f64; 2]) -> [[f64; 2]; 3] {
    let base = [x - 9.0 * dx, y - 9.0 * dy];
    [[x, y], [base[0] - 4.5 * dy, base[1] + 4.5 * dx], [base[0] + 4.5 * dy, base[1] - 4.5 * dx]]
}

/// A straight arrow.
pub fn arrow(from: [f64; 2], to: [f64; 2], ink: Ink) -> Markup {
    let (direction, _) = direction(from, to);
    let shaft = [to[0] - 7.0 * direction[0], to[1] - 7.0 * direction[1]];
    html! {
        path d=(path_along(&[from, shaft])) fill="none" stroke=(ink.hex()) stroke-width="2.5" {}
        path d=(path_along(&head(to, direction)) + "Z") fill=(ink.hex()) {}
    }
}

/// A curved arrow of 240 degrees around a point.
pub fn turn([x, y]: [f64; 2], radius: f64, counter_clockwise: bool, ink: Ink) -> Markup {
    let sign = if counter_clockwise { 1.0 } else { -1.0 };
    let at = |degrees: f64| {
        let (sin, cos) = f64::to_radians(90.0 + sign * degrees).sin_cos();
        ([x + radius * cos, y - radius * sin], [-sign * sin, -sign * cos])
    };
    let ((start, _), (end, direction)) = (at(-120.0), at(120.0));
    let (shaft, _) = at(110.0);
    let (start, shaft, sweep) = (pair(start), pair(shaft), u8::from(!counter_clockwise));
    let arc = format!("M{start}A{radius} {radius} 0 1 {sweep} {shaft}");
    html! {
        path d=(arc) fill="none" stroke=(ink.hex()) stroke-width="2.5" {}
        path d=(path_along(&head(end, direction)) + "Z") fill=(ink.hex()) {}
    }
}

/// Corners of a helical spring between two points.
pub fn coil(from: [f64; 2], to: [f64; 2]) -> Vec<[f64; 2]> {
    let ([dx, dy], length) = direction(from, to);
    let turns = ((length / 12.0) as usize).clamp(4, 14);
    let corner = |k: usize| {
        let along = (0.15 + 0.7 * (k as f64 + 0.5) / turns as f64) * length;
        let side = if k.is_multiple_of(2) { 7.0 } else { -7.0 };
        [from[0] + along * dx - side * dy, from[1] + along * dy + side * dx]
    };
    let [low, high] =
        [0.15, 0.85].map(|share| share * length).map(|along| [from[0] + along * dx, from[1] + along * dy]);
    [from, low].into_iter().chain((0..turns).map(corner)).chain([high, to]).collect()
}

/// Corners of a spiral spring around a point.
pub fn spiral([x, y]: [f64; 2]) -> Vec<[f64; 2]> {
    let corner = |k: i32| {
        let (sin, cos) = f64::from(12 * k).to_radians().sin_cos();
        let radius = 7.0 + 0.16 * f64::from(k);
        [x + radius * cos, y - radius * sin]
    };
    (0..76).map(corner).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_short_and_whole_tens_stay() {
        assert_eq!([10.0, 0.5, -0.0001, -3.256].map(coordinate), ["10", "0.5", "0", "-3.26"]);
    }

    #[test]
    fn a_rail_lies_below_its_block() {
        for direction in [[1.0, 0.0], [-1.0, 0.0]] {
            let ends = rail_ends([[0.0, 0.0], [100.0 * direction[0], 0.0]]);
            assert!(ends.iter().all(|end| end[1] > 0.5 * BLOCK[1]), "{ends:?}");
            assert!(ends[0][0] < ends[1][0], "{ends:?}");
        }
    }

    #[test]
    fn a_coil_begins_and_ends_at_its_points() {
        let points = coil([1.0, 2.0], [31.0, 42.0]);
        assert_eq!((points[0], *points.last().unwrap()), ([1.0, 2.0], [31.0, 42.0]));
        assert!(points.len() > 6);
    }
}
