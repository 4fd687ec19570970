//! The still picture: bodies in true proportions, and the joints with clearance magnified under them.

use super::{Shown, short};
use crate::presentation::report::format::escape;
use crate::presentation::report::mechanism::{Mechanism, Pose};
use crate::presentation::report::palette::Ink;
use common::scene::{JointKind, Motion};
use std::f64::consts::TAU;
use std::fmt::Write;

/// Width of the picture.
const WIDTH: f64 = 640.0;

/// Greatest height of the mechanism.
const HEIGHT: f64 = 400.0;

/// Around the mechanism.
const MARGIN: f64 = 34.0;

/// Edge of the cell of a magnified joint.
const CELL: f64 = 160.0;

/// Radius of an unworn bore there.
const BORE: f64 = 44.0;

/// What the largest clearance with its wear is magnified to.
pub const ROOM: f64 = 26.0;

/// Where things are drawn.
pub struct Layout {
    /// Lower left corner of what is drawn [m].
    from: [f64; 2],
    /// Upper end of it [m].
    top: f64,
    /// Drawing units per metre of the mechanism.
    scale: f64,
    /// Left of the mechanism, which is centred.
    left: f64,
    /// Height of the mechanism with its margins.
    height: f64,
    /// Drawing units per metre of clearance and wear.
    magnified: f64,
}

impl Layout {
    /// For all that happens in these cycles; `None` if nothing has any extent.
    pub fn new(mechanism: &Mechanism, shown: &[Shown<'_>], wear: &[&[f64]]) -> Option<Self> {
        let (mut low, mut high) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
        for Shown { cycle, .. } in shown {
            for (body, k) in
                (0..mechanism.bodies.len()).flat_map(|b| super::frames(cycle).map(move |k| (b, k)))
            {
                let Some(([x, y], angle)) = mechanism.pose(cycle, body, k) else { continue };
                let (sin, cos) = angle.sin_cos();
                for [a, b] in mechanism.outline(body) {
                    for (axis, value) in
                        [x + cos * a - sin * b, y + sin * a + cos * b].into_iter().enumerate()
                    {
                        low[axis] = low[axis].min(value);
                        high[axis] = high[axis].max(value);
                    }
                }
            }
        }
        let (wide, tall) = (high[0] - low[0], high[1] - low[1]);
        let room = (WIDTH - 2.0 * MARGIN, HEIGHT - 2.0 * MARGIN);
        let scale = (room.0 / wide).min(room.1 / tall);
        let reach = |(index, joint): (usize, &common::scene::Joint)| match &joint.kind {
            JointKind::Clearance(clearance) => wear
                .get(index)
                .map_or(&[][..], |depth| depth)
                .iter()
                .fold(clearance.radial_clearance(), |reach, depth| {
                    reach.max(clearance.radial_clearance() + depth)
                }),
            _ => 0.0,
        };
        let largest = mechanism.joints.iter().enumerate().map(reach).fold(0.0, f64::max);
        let layout = Self {
            from: low,
            top: high[1],
            scale,
            left: 0.5 * (WIDTH - wide * scale),
            height: tall * scale + 2.0 * MARGIN,
            magnified: if largest > 0.0 { ROOM / largest } else { scale },
        };
        (layout.scale.is_finite() && layout.height.is_finite()).then_some(layout)
    }

    /// How much larger clearances are drawn than the mechanism [1].
    pub fn magnification(&self) -> f64 {
        self.magnified / self.scale
    }

    /// Place in the drawing of a place of the mechanism.
    pub fn at(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        [self.left + (x - self.from[0]) * self.scale, MARGIN + (self.top - y) * self.scale]
    }

    /// A vector of a clearance in the drawing of its bore.
    pub fn magnify(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        [x * self.magnified, -y * self.magnified]
    }
}

/// Attribute that puts a body where it stands.
fn transform(layout: &Layout, (at, angle): Pose) -> String {
    let [x, y] = layout.at(at);
    format!("translate({} {}) rotate({})", short(x), short(y), short(-angle.to_degrees()))
}

/// The picture at the first instant of a cycle.
pub fn picture(mechanism: &Mechanism, layout: &Layout, shown: &Shown<'_>, wear: &[&[f64]]) -> String {
    let joints: Vec<usize> = with_clearance(mechanism).collect();
    let columns = (WIDTH / CELL) as usize;
    let height = layout.height + CELL * joints.len().div_ceil(columns) as f64;
    let mut svg = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {WIDTH} {height:.0}\" font-family=\"sans-serif\" font-size=\"17\">\n\
         <rect width=\"{WIDTH}\" height=\"{height:.0}\" fill=\"{}\"/>\n",
        Ink::Paper.hex()
    );
    let mut put = |text: String| {
        svg += &text;
        svg.push('\n');
    };
    for (body, of) in mechanism.bodies.iter().enumerate() {
        let Some(pose) = mechanism.pose(shown.cycle, body, 0) else { continue };
        let fixed = match of.motion {
            Motion::Fixed => mechanism.outline(body),
            Motion::Driven { .. } => vec![pose.0],
            Motion::Free { .. } => vec![],
        };
        fixed.into_iter().for_each(|at| put(ground(layout.at(at))));
        if of.motion != Motion::Fixed {
            put(format!(
                "<g data-body=\"{body}\" transform=\"{}\">{}</g>",
                transform(layout, pose),
                link(&mechanism.outline(body), layout.scale, Ink::Series(body))
            ));
        }
    }
    let mut named: Vec<[f64; 2]> = Vec::new();
    for (index, joint) in mechanism.joints.iter().enumerate() {
        let Some(at) = mechanism.place(shown.cycle, &joint.journal, 0) else { continue };
        let [x, y] = layout.at(at);
        // Names of joints in one place stand beside each other.
        let beside = named.iter().filter(|[u, v]| (u - x).hypot(v - y) < 4.0).count();
        named.push([x, y]);
        let (paper, ink) = (Ink::Paper.hex(), Ink::Ink.hex());
        put(format!(
            "<g data-joint=\"{index}\" transform=\"translate({} {})\"><circle r=\"4.5\" fill=\"{paper}\" stroke=\"{ink}\" \
             stroke-width=\"2\"/><text x=\"{}\" y=\"-8\" fill=\"{ink}\" stroke=\"{paper}\" stroke-width=\"3\" \
             paint-order=\"stroke\">{}</text></g>",
            short(x),
            short(y),
            8 + 14 * beside,
            escape(&joint.name)
        ));
    }
    for (place, index) in joints.iter().copied().enumerate() {
        let (column, row) = (place % columns, place / columns);
        // Each row is centred.
        let in_row = columns.min(joints.len() - columns * row);
        let left = 0.5 * (WIDTH - CELL * in_row as f64);
        let centre = [left + CELL * (column as f64 + 0.5), layout.height + CELL * (row as f64 + 0.5)];
        let depth = wear.get(index).copied().unwrap_or_default();
        put(magnified(mechanism, layout, shown, index, depth, centre));
    }
    svg + "</svg>\n"
}

/// Joints with clearance, by the scene's numbering.
pub fn with_clearance(mechanism: &Mechanism) -> impl Iterator<Item = usize> {
    let all = mechanism.joints.iter().enumerate();
    all.filter(|(_, joint)| matches!(joint.kind, JointKind::Clearance(_))).map(|(index, _)| index)
}

/// A place fixed to the ground.
fn ground([x, y]: [f64; 2]) -> String {
    format!(
        "<path d=\"M{0} {1}l-9 15h18z\" fill=\"{2}\" stroke=\"{3}\" stroke-width=\"1.5\"/>",
        short(x),
        short(y),
        Ink::Grid.hex(),
        Ink::Muted.hex()
    )
}

/// A body in its own frame: a bar between two places, a plate between more.
fn link(outline: &[[f64; 2]], scale: f64, ink: Ink) -> String {
    let mut outline = outline.to_vec();
    // Around their middle, so that a plate's edges do not cross.
    let n = outline.len().max(1) as f64;
    let middle = outline.iter().fold([0.0; 2], |m, p| [m[0] + p[0] / n, m[1] + p[1] / n]);
    let direction = |p: &[f64; 2]| (p[1] - middle[1]).atan2(p[0] - middle[0]);
    outline.sort_by(|a, b| direction(a).total_cmp(&direction(b)));
    let mut path = String::new();
    for (k, [x, y]) in outline.iter().enumerate() {
        let _ = write!(path, "{}{} {}", if k == 0 { 'M' } else { 'L' }, short(x * scale), short(-y * scale));
    }
    let colour = ink.hex();
    format!(
        "<path d=\"{path}Z\" fill=\"{colour}\" fill-opacity=\"0.25\" stroke=\"{colour}\" stroke-width=\"6\" \
         stroke-opacity=\"0.85\" stroke-linejoin=\"round\" stroke-linecap=\"round\"/>"
    )
}

/// A journal in its bore: unworn bore, worn bore and journal turn with the body of the bushing.
fn magnified(
    mechanism: &Mechanism,
    layout: &Layout,
    shown: &Shown<'_>,
    index: usize,
    depth: &[f64],
    [x, y]: [f64; 2],
) -> String {
    let joint = &mechanism.joints[index];
    let JointKind::Clearance(clearance) = &joint.kind else { return String::new() };
    let journal = BORE - clearance.radial_clearance() * layout.magnified;
    let turned = |body: usize| mechanism.pose(shown.cycle, body, 0).map_or(0.0, |pose| pose.1);
    let (bushing, pin) = (turned(joint.bushing.body), turned(joint.journal.body));
    let [ex, ey] = mechanism.orbit_at(shown.cycle, joint, 0).map_or([0.0; 2], |e| layout.magnify(e));
    let worn = bore(depth, layout.magnified);
    let (paper, muted, ink) = (Ink::Paper.hex(), Ink::Muted.hex(), Ink::Ink.hex());
    format!(
        "<g transform=\"translate({} {})\"><g data-bore=\"{index}\" transform=\"rotate({})\">\
         <path data-worn=\"\" d=\"{worn}\" fill=\"{}\" fill-opacity=\"0.2\" stroke=\"{}\" stroke-width=\"2\"{}/>\
         <circle r=\"{BORE}\" fill=\"{paper}\" stroke=\"{muted}\" stroke-width=\"1\"/>\
         <g data-journal=\"\" transform=\"translate({} {}) rotate({})\"><circle r=\"{}\" fill=\"{}\" stroke=\"{ink}\" \
         stroke-width=\"1.5\"/><path d=\"M0 0H{}\" stroke=\"{ink}\" stroke-width=\"1.5\"/></g></g>\
         <text y=\"{}\" text-anchor=\"middle\" fill=\"{ink}\">{}</text></g>",
        short(x),
        short(y - 6.0),
        short(-bushing.to_degrees()),
        Ink::Series(0).hex(),
        Ink::Series(0).hex(),
        if shown.worn { "" } else { " visibility=\"hidden\"" },
        short(ex),
        short(ey),
        short((bushing - pin).to_degrees()),
        short(journal),
        Ink::Grid.hex(),
        short(journal),
        short(0.5 * CELL),
        escape(&joint.name)
    )
}

/// Outline of a worn bore, from depths at equal angles, straight between a few points each.
fn bore(depth: &[f64], magnified: f64) -> String {
    let n = depth.len();
    let (mut path, steps) = (String::new(), 4 * n);
    for step in 0..steps {
        let (k, share) = (step / 4, (step % 4) as f64 / 4.0);
        let between = depth[k] * (1.0 - share) + depth[(k + 1) % n] * share;
        let radius = BORE + if between.is_finite() { between * magnified } else { 0.0 };
        let (sin, cos) = (TAU * step as f64 / steps as f64).sin_cos();
        let _ = write!(
            path,
            "{}{} {}",
            if step == 0 { 'M' } else { 'L' },
            short(radius * cos),
            short(-radius * sin)
        );
    }
    if path.is_empty() { path } else { path + "Z" }
}
