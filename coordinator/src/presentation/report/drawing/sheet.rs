//! The drawing of a mechanism as SVG: bodies with their names, joints, supports, sliders on rails, drives, loads and a scale.

use super::geometry::{
    CLEARANCE, DrawnBody, DrawnDrive, DrawnJoint, DrawnLoad, DrawnMechanism, FIXED, LENGTH_UNIT, LoadSymbol,
    middle_of,
};
use super::labels::{Label, LabelArea, LetterSize, PlacedLabel, place_labels};
use super::symbols::{self, arrow, coordinate, path_along};
use crate::presentation::report::format::{three_digits, unit_scale, without_zeros};
use crate::presentation::report::mechanism::extent;
use crate::presentation::report::{Drawing, Ink};
use maud::{Markup, html};

/// Largest width and height of the mechanism [drawing units].
const ROOM: [f64; 2] = [390.0, 300.0];

/// Width of the drawing, so that letters have one size in all drawings [drawing units]: the mechanism is drawn smaller where its labels
/// need more room.
const SHEET_WIDTH: f64 = 480.0;

/// Factor on the size of a mechanism whose labels do not fit, and how often it is applied at most.
const SMALLER: f64 = 0.9;
const ATTEMPTS: usize = 10;

/// Margin around what is drawn [drawing units].
const MARGIN: f64 = 14.0;

/// Length of the arrow of a force [drawing units].
pub const FORCE: f64 = 52.0;

/// Shortest spring that is drawn [drawing units].
const LEAST_COIL: f64 = 40.0;

/// Radii of the curved arrows of drives and of torques [drawing units].
pub const TURNS: [f64; 2] = [27.0, 19.0];

/// Size of the letters [drawing units]; the width is that of a wide sans-serif font.
pub const LETTERS: LetterSize = LetterSize { width: 8.6, height: 19.0, step: 6.0, whole: false };

/// Font size of the labels [drawing units].
pub const FONT: f64 = 15.2;

/// A drawing of a mechanism.
#[derive(Debug, Clone, PartialEq)]
pub struct MechanismSheet {
    /// What is drawn.
    pub drawing: Drawing,
    /// Labels with their places.
    pub labels: Vec<PlacedLabel>,
    /// Rectangle of the whole drawing [drawing units].
    pub area: LabelArea,
    /// Scale of the drawing.
    pub scale: SheetScale,
}

/// Drawing units per metre, and the point of the mechanism at the origin of the drawing.
#[derive(Debug, Clone, PartialEq)]
pub struct SheetScale {
    /// Drawing units per metre.
    pub units: f64,
    origin: [f64; 2],
}

impl SheetScale {
    /// Place on the drawing [drawing units] of a point of the mechanism [m].
    pub fn place(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        [(x - self.origin[0]) * self.units, (self.origin[1] - y) * self.units]
    }

    /// Point of the mechanism [m] at a place on the drawing [drawing units].
    pub fn point(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        [self.origin[0] + x / self.units, self.origin[1] - y / self.units]
    }
}

/// Draws the mechanism.
pub fn sheet(drawn: &DrawnMechanism) -> MechanismSheet {
    let fits = |sheet: &MechanismSheet| sheet.area.to[0] - sheet.area.from[0] <= SHEET_WIDTH + 1.0;
    let mut room = ROOM;
    let mut made = sheet_within(drawn, room);
    for _ in 0..ATTEMPTS {
        if fits(&made) {
            break;
        }
        room = room.map(|edge| SMALLER * edge);
        made = sheet_within(drawn, room);
    }
    made
}

/// Draws the mechanism in a room of this width and height [drawing units].
fn sheet_within(drawn: &DrawnMechanism, room: [f64; 2]) -> MechanismSheet {
    let [low, high] = drawn.extent();
    let units = (0..2).map(|k| room[k] / (high[k] - low[k])).fold(f64::INFINITY, f64::min);
    let scale = SheetScale { units, origin: [low[0], high[1]] };
    let bodies: Vec<Symbol> =
        drawn.bodies.iter().enumerate().map(|(index, body)| body_symbol(index, body, &scale)).collect();
    let loads: Vec<Symbol> = drawn.loads.iter().map(|load| load_symbol(load, &scale)).collect();
    let joints: Vec<Symbol> = drawn.joints.iter().map(|joint| joint_symbol(joint, &scale)).collect();
    let drives: Vec<Symbol> = drawn.drives.iter().map(|drive| drive_symbol(drive, &scale)).collect();
    // Those with the least choice of places have the first.
    let named = [&joints, &bodies, &drives, &loads].into_iter().flatten();
    let covered: Vec<[f64; 2]> = named.clone().flat_map(|(_, covers, _)| covers).copied().collect();
    let names: Vec<Label> = named.filter_map(|(.., label)| label.clone()).collect();
    let labels = place_labels(&names, &covered, LETTERS);
    // A hinge lies on the block that it turns on.
    let (on_rails, others): (Vec<_>, Vec<_>) =
        drawn.joints.iter().zip(&joints).partition(|(joint, _)| joint.rail_m.is_some());
    let joints = on_rails.into_iter().chain(others).map(|(_, symbol)| symbol);
    let mut area = bounds(&covered, &labels);
    let bar = scale_bar(units, &drawn.length_unit);
    area.to[1] += 44.0;
    let [width, height] = [0, 1].map(|axis: usize| coordinate(area.to[axis] - area.from[axis]));
    let [x, y] = area.from.map(coordinate);
    let content = html! {
        rect x=(x) y=(y) width=(width) height=(height) fill=(Ink::Paper.hex()) {}
        @for (markup, ..) in bodies.iter().chain(&loads).chain(joints).chain(&drives) { (markup) }
        @for label in &labels { (text(label)) }
        (foot(drawn, area, bar, bar * units))
    };
    let view = format!("{x} {y} {width} {height}");
    let drawing = Drawing { view, letters: Some(FONT), axes: None, content: content.into_string() };
    MechanismSheet { drawing, labels, area, scale }
}

/// The rectangle around points and labels with a margin, at least as wide as a drawing is.
fn bounds(points: &[[f64; 2]], labels: &[PlacedLabel]) -> LabelArea {
    let corners = labels.iter().flat_map(|label| [label.area.from, label.area.to]);
    let [from, to] = extent(points.iter().copied().chain(corners));
    let missing = 0.5 * (SHEET_WIDTH - (to[0] - from[0] + 2.0 * MARGIN)).max(0.0);
    LabelArea {
        from: [from[0] - MARGIN - missing, from[1] - MARGIN],
        to: [to[0] + MARGIN + missing, to[1] + MARGIN],
    }
}

/// Length of the scale bar [m]: 1, 2 or 5 times a power of ten of the unit, about a sixth of the drawing.
fn scale_bar(units: f64, unit: &str) -> f64 {
    let one = if unit == LENGTH_UNIT { 1.0 } else { unit_scale(unit) };
    let most = 0.25 * ROOM[0] / units / one;
    let power = 10f64.powf(most.log10().floor());
    let lengths = [5.0, 2.0, 1.0].map(|digit| digit * power);
    one * lengths.into_iter().find(|length| *length <= most).unwrap_or(power)
}

/// A length as the scale bar names it.
pub fn length_in_words(length: f64, unit: &str) -> String {
    let (value, unit) = match length {
        _ if unit != LENGTH_UNIT => (length / unit_scale(unit), unit),
        l if l >= 0.9995 => (l, "m"),
        l if l >= 0.9995e-3 => (1e3 * l, "mm"),
        l => (1e6 * l, "µm"),
    };
    format!("{}\u{a0}{unit}", without_zeros(&three_digits(value)))
}

/// Points along a line, close enough that no letter fits between two.
fn along(points: &[[f64; 2]]) -> Vec<[f64; 2]> {
    let between = |pair: &[[f64; 2]]| {
        let ([x, y], [to_x, to_y]) = (pair[0], pair[1]);
        let (dx, dy) = (to_x - x, to_y - y);
        let parts = (dx.hypot(dy) / 6.0).ceil().max(1.0);
        let shares = (0..=parts as usize).map(move |k| k as f64 / parts);
        shares.map(move |share| [x + share * dx, y + share * dy])
    };
    points.windows(2).flat_map(between).collect()
}

/// Points around a circle.
fn circle([x, y]: [f64; 2], radius: f64) -> Vec<[f64; 2]> {
    let corner = |k: i32| {
        let (sin, cos) = f64::from(30 * k).to_radians().sin_cos();
        [x + radius * cos, y + radius * sin]
    };
    (0..12).map(corner).collect()
}

/// Places on the drawing [drawing units] of points of the mechanism [m].
pub fn places(points: &[[f64; 2]], scale: &SheetScale) -> Vec<[f64; 2]> {
    points.iter().map(|point| scale.place(*point)).collect()
}

/// A symbol, points that it covers `(n, 2)` [drawing units], and its label.
type Symbol = (Markup, Vec<[f64; 2]>, Option<Label>);

fn body_symbol(index: usize, body: &DrawnBody, scale: &SheetScale) -> Symbol {
    let (outline, supports) = (places(&body.outline_m, scale), places(&body.supports_m, scale));
    let is_fixed = body.motion == FIXED;
    let mut covers = Vec::new();
    if !is_fixed {
        let mut corners = symbols::around(&outline);
        corners.extend(corners.first().copied());
        covers.extend(along(&corners));
    }
    for [x, y] in supports.iter().copied() {
        let floor = y + symbols::SUPPORT;
        covers.extend(along(&[[x, y], [x + 16.0, floor], [x - 18.0, floor], [x, y]]));
    }
    // A single point is that of a joint; the frame is named at a support or a rail.
    let place = match outline.as_slice() {
        [] => None,
        points if is_fixed => Some((supports.first().map_or(points[0], |[x, y]| [*x, y + 16.0]), 20.0)),
        [only] => Some((*only, 16.0)),
        points => Some((middle_of(points), 6.0)),
    };
    let label = place.map(|(at, clear)| Label { text: body.name.clone(), at, clear, body: Some(index) });
    let markup = html! {
        @for support in &supports { (symbols::ground(*support)) }
        @if !is_fixed { (symbols::link(&outline, Ink::Series(index))) }
    };
    (markup, covers, label)
}

/// Circle of a hinge, filled without clearance; square of a weld; block of a slider on its rail.
fn joint_symbol(joint: &DrawnJoint, scale: &SheetScale) -> Symbol {
    let (paper, ink) = (Ink::Paper.hex(), Ink::Ink.hex());
    let at = scale.place(joint.at_m);
    let ([x, y], [left_text, top_text]) = (at, at.map(coordinate));
    let mut covers = circle(at, 6.0);
    let symbol = match (joint.rail_m, joint.kind) {
        (Some(ends), _) => {
            let [left, right] = symbols::rail_ends(ends.map(|end| scale.place(end)));
            covers.extend(along(&[left, right]));
            covers.extend(along(&[[left[0], left[1] + 7.0], [right[0], right[1] + 7.0]]));
            covers.extend(along(&[[x - 17.0, y], [x + 17.0, y]]));
            covers.extend(circle(at, 12.0));
            let turned = (right[1] - left[1]).atan2(right[0] - left[0]).to_degrees();
            let rail = symbols::rail([left, right], joint.on_ground, Ink::Muted);
            html! { (rail) (symbols::block(at, turned, Ink::Ink)) }
        }
        (None, "fixed") => html! {
            rect x=(left_text) y=(top_text) width="10" height="10" transform="translate(-5 -5)" fill=(ink) {}
        },
        (None, CLEARANCE) => html! {
            circle cx=(left_text) cy=(top_text) r="6" fill=(paper) stroke=(ink) stroke-width="2" {}
            circle cx=(left_text) cy=(top_text) r="2.2" fill=(ink) {}
        },
        _ => {
            html! { circle cx=(left_text) cy=(top_text) r="5" fill=(paper) stroke=(ink) stroke-width="2" {} }
        }
    };
    let clear = if joint.rail_m.is_some() { 14.0 } else { 10.0 };
    let shapes: Vec<Vec<[f64; 2]>> = joint.lines().iter().map(|line| places(line, scale)).collect();
    covers.extend(shapes.iter().flat_map(|line| along(line)));
    let label = Some(Label { text: joint.name.clone(), at, clear, body: None });
    let markup = html! {
        @for line in &shapes {
            path d=(path_along(line)) fill="none" stroke=(Ink::Muted.hex()) stroke-width="1.5" stroke-dasharray="6 2" {}
        }
        (symbol)
    };
    (markup, covers, label)
}

fn drive_symbol(drive: &DrawnDrive, scale: &SheetScale) -> Symbol {
    let at = scale.place(drive.pivot_m);
    let text = format!("{}, {} at {:.0}°", drive.body, drive.speed, drive.angle_deg);
    let label = Some(Label { text, at, clear: TURNS[0] + 6.0, body: None });
    let markup = symbols::turn(at, TURNS[0], drive.counter_clockwise, Ink::Ink);
    (markup, circle(at, TURNS[0]), label)
}

fn load_symbol(load: &DrawnLoad, scale: &SheetScale) -> Symbol {
    let ink = Ink::Limit;
    let (markup, covers, at, clear) = match load.symbol {
        LoadSymbol::Arrow(at, [x, y]) => {
            let (from, length) = (scale.place(at), x.hypot(y).max(1e-300));
            let to = [from[0] + FORCE * x / length, from[1] - FORCE * y / length];
            (arrow(from, to, ink), along(&[from, to]), to, 5.0)
        }
        LoadSymbol::Turn(at, counter_clockwise) => {
            let at = scale.place(at);
            let markup = symbols::turn(at, TURNS[1], counter_clockwise, ink);
            (markup, circle(at, TURNS[1]), at, TURNS[1] + 5.0)
        }
        LoadSymbol::Coil(a, b) => {
            let (from, mut to) = (scale.place(a), scale.place(b));
            let (dx, dy) = (to[0] - from[0], to[1] - from[1]);
            let length = dx.hypot(dy);
            if length < LEAST_COIL {
                let direction = if length > 1.0 { [dx / length, dy / length] } else { [0.0, 1.0] };
                to = [from[0] + LEAST_COIL * direction[0], from[1] + LEAST_COIL * direction[1]];
            }
            let path = path_along(&symbols::coil(from, to));
            let markup = html! {
                path d=(path) fill="none" stroke=(ink.hex()) stroke-width="2" stroke-linejoin="round" {}
                circle cx=(coordinate(to[0])) cy=(coordinate(to[1])) r="3" fill=(ink.hex()) {}
            };
            (markup, along(&[from, to]), [0.5 * (from[0] + to[0]), 0.5 * (from[1] + to[1])], 12.0)
        }
        LoadSymbol::Spiral(at) => {
            let at = scale.place(at);
            let path = path_along(&symbols::spiral(at));
            let markup = html! { path d=(path) fill="none" stroke=(ink.hex()) stroke-width="2" {} };
            (markup, circle(at, 20.0), at, 26.0)
        }
    };
    let text = format!("{} {}", load.name, load.size);
    (markup, covers, Some(Label { text, at, clear, body: None }))
}

/// A label, with a line to its point where it is not next to it.
fn text(placed: &PlacedLabel) -> Markup {
    let ([x, y], near) = (placed.label.at, placed.area.nearest(placed.label.at));
    let (ink, style, weight) = match placed.label.body {
        Some(index) => (Ink::Series(index), "italic", "600"),
        None => (Ink::Ink, "normal", "400"),
    };
    let far = placed.distance > placed.label.clear + 16.0;
    let LabelArea { from: [left, _], to: [right, bottom] } = placed.area;
    // Next to its point a label begins or ends there, whatever the width of the reader's letters.
    let (at, anchor) = match () {
        () if left >= x => (left, "start"),
        () if right <= x => (right, "end"),
        () => (0.5 * (left + right), "middle"),
    };
    html! {
        @if far {
            path d=(path_along(&[[x, y], near])) stroke=(Ink::Muted.hex()) stroke-width="0.8" fill="none" {}
        }
        text x=(coordinate(at)) y=(coordinate(bottom - 5.0)) text-anchor=(anchor) fill=(ink.hex()) stroke=(Ink::Paper.hex()) stroke-width="4"
            paint-order="stroke" font-style=(style) font-weight=(weight) { (placed.label.text) }
    }
}

/// The strip below the mechanism: scale bar, and the direction of gravity.
fn foot(drawn: &DrawnMechanism, area: LabelArea, length: f64, units: f64) -> Markup {
    let (x, y) = (area.from[0] + MARGIN, area.to[1] - 18.0);
    let ink = Ink::Ink.hex();
    let right = x + units;
    let bar =
        path_along(&[[x, y - 5.0], [x, y + 5.0], [x, y], [right, y], [right, y - 5.0], [right, y + 5.0]]);
    let [gx, gy] = drawn.gravity_m_s2;
    let size = gx.hypot(gy);
    let from = [area.to[0] - 150.0, y - 12.0 * f64::from(gy < 0.0)];
    html! {
        path d=(bar) fill="none" stroke=(ink) stroke-width="2" {}
        text x=(coordinate(x + units + 9.0)) y=(coordinate(y + 5.0)) fill=(ink) { (length_in_words(length, &drawn.length_unit)) }
        @if size > 0.0 {
            (arrow(from, [from[0] + 24.0 * gx / size, from[1] - 24.0 * gy / size], Ink::Ink))
            text x=(coordinate(from[0] + 30.0)) y=(coordinate(y + 5.0)) fill=(ink) {
                "g = " (three_digits(size)) "\u{a0}m/s²"
            }
        }
    }
}
