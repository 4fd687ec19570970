//! The drawing of a mechanism as SVG: bodies with their names, joints, supports, sliders on rails, drives, loads and a scale.

use super::geometry::{DrawnLoad, DrawnMechanism, DrawnMotion, LoadSymbol, middle_of};
use super::labels::{Label, LabelArea, LabelOf, LetterSize, PlacedLabel, place_labels};
use super::symbols::{self, arrow, coordinate, path_along};
use crate::presentation::report::figure::Drawing;
use crate::presentation::report::format::three_digits;
use crate::presentation::report::palette::Ink;
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
const FORCE: f64 = 52.0;

/// Shortest spring that is drawn [drawing units].
const LEAST_COIL: f64 = 40.0;

/// Radii of the curved arrows of drives and of torques [drawing units].
const TURNS: [f64; 2] = [27.0, 19.0];

/// Size of the letters [drawing units]; the width is that of a wide sans-serif font.
pub const LETTERS: LetterSize = LetterSize { width: 8.6, height: 19.0, step: 6.0, whole: false };

/// Font size of the labels [drawing units].
const FONT: f64 = 15.2;

/// A drawing of a mechanism.
#[derive(Debug, Clone, PartialEq)]
pub struct MechanismSheet {
    /// What is drawn.
    pub drawing: Drawing,
    /// Labels with their places.
    pub labels: Vec<PlacedLabel>,
    /// Rectangle of the whole drawing [drawing units].
    pub area: LabelArea,
}

/// Drawing units per metre, and the point of the mechanism at the origin of the drawing.
struct SheetScale {
    units: f64,
    origin: [f64; 2],
}

impl SheetScale {
    fn place(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        [(x - self.origin[0]) * self.units, (self.origin[1] - y) * self.units]
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
    let loads: Vec<DrawnSymbol> = drawn.loads.iter().map(|load| load_symbol(load, &scale)).collect();
    let mut covered = obstacles(drawn, &scale);
    covered.extend(loads.iter().flat_map(|load| load.covers.iter().copied()));
    let labels = place_labels(&labels(drawn, &scale, &loads), &covered, LETTERS);
    let mut area = bounds(&covered, &labels);
    let bar = scale_bar(units);
    area = widened(area, 44.0);
    let size = [area.to[0] - area.from[0], area.to[1] - area.from[1]];
    let [x, y, width, height] = [area.from[0], area.from[1], size[0], size[1]].map(coordinate);
    let content = html! {
        rect x=(x) y=(y) width=(width) height=(height) fill=(Ink::Paper.hex()) {}
        (bodies(drawn, &scale))
        @for load in &loads { (load.markup) }
        (joints(drawn, &scale))
        (drives(drawn, &scale))
        @for label in &labels { (text(label)) }
        (foot(drawn, area, bar, bar * units))
    };
    let view = format!("{x} {y} {width} {height}");
    let drawing = Drawing { view, letters: Some(FONT), axes: None, content: content.into_string() };
    MechanismSheet { drawing, labels, area }
}

/// The rectangle around points and labels with a margin, at least as wide as a drawing is.
fn bounds(points: &[[f64; 2]], labels: &[PlacedLabel]) -> LabelArea {
    let corners = labels.iter().flat_map(|label| [label.area.from, label.area.to]);
    let (mut from, mut to) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
    for point in points.iter().copied().chain(corners) {
        for axis in 0..2 {
            from[axis] = from[axis].min(point[axis] - MARGIN);
            to[axis] = to[axis].max(point[axis] + MARGIN);
        }
    }
    let missing = 0.5 * (SHEET_WIDTH - (to[0] - from[0])).max(0.0);
    LabelArea { from: [from[0] - missing, from[1]], to: [to[0] + missing, to[1]] }
}

/// The rectangle with a strip of this height below it.
fn widened(area: LabelArea, height: f64) -> LabelArea {
    LabelArea { to: [area.to[0], area.to[1] + height], ..area }
}

/// Length of the scale bar [m]: 1, 2 or 5 times a power of ten, about a sixth of the drawing.
fn scale_bar(units: f64) -> f64 {
    let most = 0.25 * ROOM[0] / units;
    let power = 10f64.powf(most.log10().floor());
    [5.0, 2.0, 1.0].map(|digit| digit * power).into_iter().find(|length| *length <= most).unwrap_or(power)
}

/// A length as the scale bar names it.
pub fn length_in_words(length: f64) -> String {
    let (value, unit) = match length {
        l if l >= 0.9995 => (l, "m"),
        l if l >= 0.9995e-3 => (1e3 * l, "mm"),
        l => (1e6 * l, "µm"),
    };
    // The digits of three, without trailing zeros.
    let digits = three_digits(value);
    let short =
        if digits.contains('.') { digits.trim_end_matches('0').trim_end_matches('.') } else { &digits };
    format!("{short}\u{a0}{unit}")
}

/// Points along a line, close enough that no letter fits between two.
fn along(points: &[[f64; 2]]) -> Vec<[f64; 2]> {
    let mut covered = Vec::new();
    for pair in points.windows(2) {
        let (dx, dy) = (pair[1][0] - pair[0][0], pair[1][1] - pair[0][1]);
        let parts = (dx.hypot(dy) / 6.0).ceil().max(1.0);
        covered.extend((0..=parts as usize).map(|k| {
            let share = k as f64 / parts;
            [pair[0][0] + share * dx, pair[0][1] + share * dy]
        }));
    }
    covered
}

/// Points around a circle.
fn circle([x, y]: [f64; 2], radius: f64) -> Vec<[f64; 2]> {
    let corner = |k: i32| {
        let (sin, cos) = f64::from(30 * k).to_radians().sin_cos();
        [x + radius * cos, y + radius * sin]
    };
    (0..12).map(corner).collect()
}

/// Points of everything drawn but loads and labels.
fn obstacles(drawn: &DrawnMechanism, scale: &SheetScale) -> Vec<[f64; 2]> {
    let mut covered = Vec::new();
    for body in &drawn.bodies {
        if body.motion != DrawnMotion::Fixed {
            let mut corners = symbols::around(&places(&body.outline_m, scale));
            corners.extend(corners.first().copied());
            covered.extend(along(&corners));
        }
        for [x, y] in places(&body.supports_m, scale) {
            let floor = y + symbols::SUPPORT;
            covered.extend(along(&[[x, y], [x + 16.0, floor], [x - 18.0, floor], [x, y]]));
        }
    }
    for joint in &drawn.joints {
        covered.extend(circle(scale.place(joint.at_m), 6.0));
        let Some(ends) = joint.rail_m else { continue };
        let [left, right] = rail(ends, scale);
        covered.extend(along(&[left, right]));
        covered.extend(along(&[[left[0], left[1] + 7.0], [right[0], right[1] + 7.0]]));
        let block = scale.place(joint.at_m);
        covered.extend(along(&[[block[0] - 17.0, block[1]], [block[0] + 17.0, block[1]]]));
        covered.extend(circle(block, 12.0));
    }
    for drive in &drawn.drives {
        covered.extend(circle(scale.place(drive.pivot_m), TURNS[0]));
    }
    covered
}

fn places(points: &[[f64; 2]], scale: &SheetScale) -> Vec<[f64; 2]> {
    points.iter().map(|point| scale.place(*point)).collect()
}

fn rail(ends: [[f64; 2]; 2], scale: &SheetScale) -> [[f64; 2]; 2] {
    symbols::rail_ends(ends.map(|end| scale.place(end)))
}

/// Names of joints, bodies, drives and loads at their points; those with the least choice first.
fn labels(drawn: &DrawnMechanism, scale: &SheetScale, loads: &[DrawnSymbol]) -> Vec<Label> {
    let mut labels = Vec::new();
    for joint in &drawn.joints {
        let clear = if joint.rail_m.is_some() { 14.0 } else { 10.0 };
        let at = scale.place(joint.at_m);
        labels.push(Label { text: joint.name.clone(), at, clear, of: LabelOf::Joint });
    }
    for (index, body) in drawn.bodies.iter().enumerate() {
        let points = places(&body.outline_m, scale);
        let of = LabelOf::Body(index);
        // A single point is that of a joint; the frame is named at a support or a rail.
        let (at, clear) = match (body.motion, points.as_slice()) {
            (_, []) => continue,
            (DrawnMotion::Fixed, points) => {
                let support = body.supports_m.first().map(|p| scale.place(*p));
                (support.map_or(points[0], |[x, y]| [x, y + 16.0]), 20.0)
            }
            (_, [only]) => (*only, 16.0),
            (_, points) => (middle_of(points), 6.0),
        };
        labels.push(Label { text: body.name.clone(), at, clear, of });
    }
    for drive in &drawn.drives {
        let text = format!("{}, {} at {:.0}°", drive.body, drive.speed, drive.angle_deg);
        labels.push(Label { text, at: scale.place(drive.pivot_m), clear: TURNS[0] + 6.0, of: LabelOf::Load });
    }
    for (load, symbol) in drawn.loads.iter().zip(loads) {
        let text = format!("{} {}", load.name, load.size);
        labels.push(Label { text, at: symbol.label_at, clear: symbol.clear, of: LabelOf::Load });
    }
    labels
}

fn bodies(drawn: &DrawnMechanism, scale: &SheetScale) -> Markup {
    html! {
        @for (index, body) in drawn.bodies.iter().enumerate() {
            @for support in &body.supports_m { (symbols::ground(scale.place(*support))) }
            @if body.motion != DrawnMotion::Fixed {
                (symbols::link(&places(&body.outline_m, scale), Ink::Series(index)))
            }
        }
    }
}

/// Circles of hinges, filled without clearance; squares of welds; blocks of sliders on their rails.
fn joints(drawn: &DrawnMechanism, scale: &SheetScale) -> Markup {
    let (paper, ink) = (Ink::Paper.hex(), Ink::Ink.hex());
    html! {
        @for joint in drawn.joints.iter().filter(|joint| joint.rail_m.is_some()) {
            @let [left, right] = rail(joint.rail_m.unwrap_or_default(), scale);
            (symbols::rail([left, right], joint.on_ground, Ink::Muted))
            @let turned = (right[1] - left[1]).atan2(right[0] - left[0]).to_degrees();
            (symbols::block(scale.place(joint.at_m), turned, Ink::Ink))
        }
        @for joint in drawn.joints.iter().filter(|joint| joint.rail_m.is_none()) {
            @let [x, y] = scale.place(joint.at_m).map(coordinate);
            @match joint.kind {
                "fixed" => rect x=(x) y=(y) width="10" height="10" transform="translate(-5 -5)" fill=(ink) {},
                "clearance" => {
                    circle cx=(x) cy=(y) r="6" fill=(paper) stroke=(ink) stroke-width="2" {}
                    circle cx=(x) cy=(y) r="2.2" fill=(ink) {}
                }
                _ => circle cx=(x) cy=(y) r="5" fill=(paper) stroke=(ink) stroke-width="2" {},
            }
        }
    }
}

fn drives(drawn: &DrawnMechanism, scale: &SheetScale) -> Markup {
    html! {
        @for drive in &drawn.drives {
            (symbols::turn(scale.place(drive.pivot_m), TURNS[0], drive.counter_clockwise, Ink::Ink))
        }
    }
}

/// The symbol of a load with what it covers and the place of its label.
struct DrawnSymbol {
    markup: Markup,
    covers: Vec<[f64; 2]>,
    label_at: [f64; 2],
    clear: f64,
}

fn load_symbol(load: &DrawnLoad, scale: &SheetScale) -> DrawnSymbol {
    let ink = Ink::Limit;
    match load.symbol {
        LoadSymbol::Arrow(at, [x, y]) => {
            let (from, length) = (scale.place(at), x.hypot(y).max(1e-300));
            let to = [from[0] + FORCE * x / length, from[1] - FORCE * y / length];
            let covers = along(&[from, to]);
            DrawnSymbol { markup: arrow(from, to, ink), covers, label_at: to, clear: 5.0 }
        }
        LoadSymbol::Turn(at, counter_clockwise) => {
            let at = scale.place(at);
            let markup = symbols::turn(at, TURNS[1], counter_clockwise, ink);
            DrawnSymbol { markup, covers: circle(at, TURNS[1]), label_at: at, clear: TURNS[1] + 5.0 }
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
            let label_at = [0.5 * (from[0] + to[0]), 0.5 * (from[1] + to[1])];
            DrawnSymbol { markup, covers: along(&[from, to]), label_at, clear: 12.0 }
        }
        LoadSymbol::Spiral(at) => {
            let at = scale.place(at);
            let path = path_along(&symbols::spiral(at));
            let markup = html! { path d=(path) fill="none" stroke=(ink.hex()) stroke-width="2" {} };
            DrawnSymbol { markup, covers: circle(at, 20.0), label_at: at, clear: 26.0 }
        }
    }
}

/// A label, with a line to its point where it is not next to it.
fn text(placed: &PlacedLabel) -> Markup {
    let ([x, y], near) = (placed.label.at, placed.area.nearest(placed.label.at));
    let (ink, style, weight) = match placed.label.of {
        LabelOf::Body(index) => (Ink::Series(index), "italic", "600"),
        LabelOf::Joint => (Ink::Ink, "normal", "400"),
        LabelOf::Load => (Ink::Ink, "normal", "400"),
    };
    let far = placed.distance > placed.label.clear + 16.0;
    let left = coordinate(placed.area.from[0]);
    let middle = 0.5 * (placed.area.from[0] + placed.area.to[0]);
    let base = coordinate(placed.area.to[1] - 5.0);
    // Next to its point a label begins or ends there, whatever the width of the reader's letters.
    let (at, anchor) = match () {
        () if placed.area.from[0] >= x => (left, "start"),
        () if placed.area.to[0] <= x => (coordinate(placed.area.to[0]), "end"),
        () => (coordinate(middle), "middle"),
    };
    html! {
        @if far {
            path d=(path_along(&[[x, y], near])) stroke=(Ink::Muted.hex()) stroke-width="0.8" fill="none" {}
        }
        text x=(at) y=(base) text-anchor=(anchor) fill=(ink.hex()) stroke=(Ink::Paper.hex()) stroke-width="4"
            paint-order="stroke" font-style=(style) font-weight=(weight) { (placed.label.text) }
    }
}

/// The strip below the mechanism: scale bar, and the direction of gravity.
fn foot(drawn: &DrawnMechanism, area: LabelArea, length: f64, units: f64) -> Markup {
    let (x, y) = (area.from[0] + MARGIN, area.to[1] - 18.0);
    let ink = Ink::Ink.hex();
    let bar = path_along(&[
        [x, y - 5.0],
        [x, y + 5.0],
        [x, y],
        [x + units, y],
        [x + units, y - 5.0],
        [x + units, y + 5.0],
    ]);
    let [gx, gy] = drawn.gravity_m_s2;
    let size = gx.hypot(gy);
    let from = [area.to[0] - 150.0, y - 12.0 * f64::from(gy < 0.0)];
    html! {
        path d=(bar) fill="none" stroke=(ink) stroke-width="2" {}
        text x=(coordinate(x + units + 9.0)) y=(coordinate(y + 5.0)) fill=(ink) { (length_in_words(length)) }
        @if size > 0.0 {
            (arrow(from, [from[0] + 24.0 * gx / size, from[1] - 24.0 * gy / size], Ink::Ink))
            text x=(coordinate(from[0] + 30.0)) y=(coordinate(y + 5.0)) fill=(ink) {
                "g = " (three_digits(size)) "\u{a0}m/s²"
            }
        }
    }
}
