//! The drawing of a mechanism in letters: lines of Braille dots, joints and loads as signs, names beside them.

use super::geometry::{DrawnDrive, DrawnMechanism, FIXED, LoadSymbol, SYMBOLS, middle_of};
use super::labels::{Label, LetterSize, place_labels};
use super::symbols::around;
use crate::presentation::report::format::joined;
use std::collections::BTreeMap;
use std::fmt::Write;

/// Largest width and height of the mechanism [letters].
const ROOM: [f64; 2] = [44.0, 18.0];

/// Letters of labels: one cell each.
const LETTERS: LetterSize = LetterSize { width: 1.0, height: 1.0, step: 1.0, whole: true };

/// Dots of a Braille letter, in columns and rows.
const DOTS: [i64; 2] = [2, 4];

/// Bits of the dots of a Braille letter, by column and row.
const BITS: [[u8; 4]; 2] = [[0x01, 0x02, 0x04, 0x40], [0x08, 0x10, 0x20, 0x80]];

/// Arrows by direction, counter-clockwise from the right in steps of 45 degrees.
const ARROWS: [char; 8] = ['→', '↗', '↑', '↖', '←', '↙', '↓', '↘'];

/// Cells of the sketch by row and column.
#[derive(Default)]
struct Canvas {
    dots: BTreeMap<(i64, i64), u8>,
    signs: BTreeMap<(i64, i64), char>,
}

impl Canvas {
    /// A line of dots between two points [letters].
    fn line(&mut self, from: [f64; 2], to: [f64; 2]) {
        let [a, b] = [from, to].map(|[x, y]| [x * DOTS[0] as f64, y * DOTS[1] as f64]);
        let steps = (b[0] - a[0]).abs().max((b[1] - a[1]).abs()).ceil().max(1.0);
        for k in 0..=steps as usize {
            let share = k as f64 / steps;
            let [x, y] = [0, 1].map(|axis: usize| (a[axis] + share * (b[axis] - a[axis])).floor() as i64);
            let cell = (y.div_euclid(DOTS[1]), x.div_euclid(DOTS[0]));
            let bit = BITS[x.rem_euclid(DOTS[0]) as usize][y.rem_euclid(DOTS[1]) as usize];
            *self.dots.entry(cell).or_default() |= bit;
        }
    }

    fn sign(&mut self, [x, y]: [f64; 2], sign: char) {
        self.signs.insert((y.floor() as i64, x.floor() as i64), sign);
    }

    /// Middles of all cells in use.
    fn used(&self) -> Vec<[f64; 2]> {
        let cells = self.dots.keys().chain(self.signs.keys());
        cells.map(|(row, column)| [*column as f64 + 0.5, *row as f64 + 0.5]).collect()
    }

    fn text(&self) -> String {
        let cells = || self.dots.keys().chain(self.signs.keys());
        let (Some(top), Some(bottom)) = (cells().map(|c| c.0).min(), cells().map(|c| c.0).max()) else {
            return String::new();
        };
        let left = cells().map(|c| c.1).min().unwrap_or(0);
        let right = cells().map(|c| c.1).max().unwrap_or(0);
        let letter = |cell: (i64, i64)| match (self.signs.get(&cell), self.dots.get(&cell)) {
            (Some(sign), _) => *sign,
            (None, Some(bits)) => char::from_u32(0x2800 + u32::from(*bits)).unwrap_or(' '),
            (None, None) => ' ',
        };
        let line = |row: i64| {
            let line: String = (left..=right).map(|column| letter((row, column))).collect();
            format!("  {}\n", line.trim_end()).trim_end_matches(' ').to_owned()
        };
        (top..=bottom).map(line).collect()
    }
}

/// The mechanism in letters, at most 100 columns for names of usual length, followed by its drives and loads.
pub fn sketch(drawn: &DrawnMechanism) -> String {
    let [low, high] = drawn.extent();
    // A letter is twice as high as wide.
    let units = (ROOM[0] / (high[0] - low[0])).min(2.0 * ROOM[1] / (high[1] - low[1]));
    let place = |[x, y]: [f64; 2]| [(x - low[0]) * units + 0.5, 0.5 * (high[1] - y) * units + 0.5];
    let mut canvas = Canvas::default();
    for body in drawn.bodies.iter().filter(|body| body.motion != FIXED) {
        let mut corners = around(&body.outline_m.iter().map(|p| place(*p)).collect::<Vec<_>>());
        corners.extend(corners.first().copied());
        corners.windows(2).for_each(|pair| canvas.line(pair[0], pair[1]));
    }
    for joint in &drawn.joints {
        if let Some([from, to]) = joint.rail_m {
            canvas.line(place(from), place(to));
        }
        for line in joint.lines() {
            line.windows(2).for_each(|pair| canvas.line(place(pair[0]), place(pair[1])));
        }
    }
    for load in &drawn.loads {
        match load.symbol {
            LoadSymbol::Arrow(at, [x, y]) => {
                let eighth = (y.atan2(x) / std::f64::consts::FRAC_PI_4).round().rem_euclid(8.0) as usize;
                let [cx, cy] = place(at);
                let [dx, dy] = [x, y].map(|way: f64| way.signum() * f64::from(way.abs() > 1e-9));
                canvas.sign([cx + 2.0 * dx, cy - dy], ARROWS[eighth]);
            }
            LoadSymbol::Turn(at, counter_clockwise) => {
                canvas.sign(place(at), if counter_clockwise { '↺' } else { '↻' });
            }
            LoadSymbol::Coil(from, to) => {
                let [a, b] = [place(from), place(to)];
                canvas.line(a, b);
                canvas.sign([0.5 * (a[0] + b[0]), 0.5 * (a[1] + b[1])], '⌇');
            }
            LoadSymbol::Spiral(at) => {
                let [x, y] = place(at);
                canvas.sign([x, y + 1.0], '@');
            }
        }
    }
    for support in drawn.bodies.iter().flat_map(|body| &body.supports_m) {
        let [x, y] = place(*support);
        canvas.sign([x, y + 1.0], '▲');
        canvas.sign([x, y], '·');
    }
    for joint in &drawn.joints {
        let [x, y] = place(joint.at_m);
        let known = SYMBOLS.iter().find(|(known, ..)| *known == joint.kind);
        let sign = known.and_then(|(_, _, sign, _)| *sign).unwrap_or('o');
        if joint.rail_m.is_some() {
            // As wide as a block, so that a hinge on it does not hide it.
            canvas.sign([x - 1.0, y], sign);
            canvas.sign([x + 1.0, y], sign);
        }
        canvas.sign([x, y], sign);
    }
    let joints = drawn.joints.iter().map(|joint| {
        let at = place(joint.at_m).map(|v| v.floor() + 0.5);
        Label { text: joint.name.clone(), at, clear: 1.0, body: None }
    });
    let bodies = drawn.bodies.iter().enumerate();
    let named = bodies.filter(|(_, body)| body.motion != FIXED && !body.outline_m.is_empty());
    let bodies = named.map(|(index, body)| {
        let (text, at) = (format!("[{}]", body.name), place(middle_of(&body.outline_m)));
        Label { text, at, clear: 1.0, body: Some(index) }
    });
    let labels: Vec<Label> = joints.chain(bodies).collect();
    for placed in place_labels(&labels, &canvas.used(), LETTERS) {
        let [x, y] = placed.area.from;
        for (k, letter) in placed.label.text.chars().enumerate() {
            canvas.sign([x + k as f64 + 0.5, y + 0.5], letter);
        }
    }
    let mut out = canvas.text();
    // Writing to a String cannot fail.
    let _ = writeln!(out, "\n  {}", legend(drawn));
    for drive in &drawn.drives {
        let way = if drive.counter_clockwise { "counter-clockwise" } else { "clockwise" };
        let DrawnDrive { body, speed, angle_deg, .. } = drive;
        let _ = writeln!(out, "  {body}: driven {way}, {speed}; here at {angle_deg:.1} deg");
    }
    for load in &drawn.loads {
        let _ = writeln!(out, "  {}: {}", load.name, load.size);
    }
    out
}

/// The meaning of the signs that appear.
fn legend(drawn: &DrawnMechanism) -> String {
    let shown = SYMBOLS.iter().filter(|(kind, ..)| drawn.has(kind));
    let signs = shown.filter_map(|(_, _, sign, meaning)| Some(format!("{} {meaning}", (*sign)?)));
    let frame = drawn.has_supports().then(|| "▲ frame".to_owned());
    joined(signs.chain(frame).chain(["[name] body".to_owned()]), "   ")
}
