//! The first frame of the animation: bodies in true proportions, and below them the joints with clearance, magnified.

use super::frames::{AnimatedCycle, frames};
use crate::presentation::report::drawing::symbols::{block, coordinate, ground, link, rail, rail_ends};
use crate::presentation::report::mechanism::{Mechanism, Pose};
use crate::presentation::report::palette::Ink;
use common::scene::{Joint, JointKind, Motion};
use maud::{Markup, html};
use std::f64::consts::TAU;
use std::fmt::Write;

/// Width of the drawing [drawing units].
const WIDTH: f64 = 640.0;

/// Largest height of the mechanism [drawing units].
const HEIGHT: f64 = 400.0;

/// Margin around the mechanism [drawing units].
const MARGIN: f64 = 34.0;

/// Edge of the square cell of a magnified joint [drawing units].
const CELL: f64 = 160.0;

/// Radius of an unworn bore in its cell [drawing units].
const BORE: f64 = 44.0;

/// Size to which the largest clearance with its wear is magnified [drawing units].
pub const LARGEST_CLEARANCE: f64 = 26.0;

/// Scales and positions of the drawing.
pub struct Layout {
    /// Lower left corner of what is drawn [m].
    from: [f64; 2],
    /// Largest vertical coordinate of what is drawn [m].
    top: f64,
    /// Drawing units per metre of the mechanism.
    scale: f64,
    /// Left end of the mechanism, which is centred [drawing units].
    left: f64,
    /// Height of the mechanism with its margins [drawing units].
    height: f64,
    /// Drawing units per metre of clearance and wear.
    magnified: f64,
}

impl Layout {
    /// The layout that contains every frame of these cycles; `None` if the mechanism has no extent.
    pub fn new(mechanism: &Mechanism, shown: &[AnimatedCycle<'_>], wear: &[&[f64]]) -> Option<Self> {
        let (mut low, mut high) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
        for AnimatedCycle { cycle, .. } in shown {
            for (body, k) in (0..mechanism.bodies.len()).flat_map(|b| frames(cycle).map(move |k| (b, k))) {
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
        let reach = |(index, joint): (usize, &Joint)| match &joint.kind {
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
            magnified: if largest > 0.0 { LARGEST_CLEARANCE / largest } else { scale },
        };
        (layout.scale.is_finite() && layout.height.is_finite()).then_some(layout)
    }

    /// Scale of the clearances relative to that of the mechanism [1].
    pub fn magnification(&self) -> f64 {
        self.magnified / self.scale
    }

    /// Point of the drawing that shows a point of the mechanism [m].
    pub fn place(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        [self.left + (x - self.from[0]) * self.scale, MARGIN + (self.top - y) * self.scale]
    }

    /// Vector in a magnified bore that shows a vector of the clearance [m].
    pub fn magnify(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        [x * self.magnified, -y * self.magnified]
    }
}

/// `transform` attribute of a body in a pose.
fn transform(layout: &Layout, (at, angle): Pose) -> String {
    let [x, y] = layout.place(at);
    format!("translate({} {}) rotate({})", coordinate(x), coordinate(y), coordinate(-angle.to_degrees()))
}

/// The drawing at the first instant of a cycle; `wear`: depth per joint at equal angles `(joints)(control_points,)` [m].
pub fn picture(mechanism: &Mechanism, layout: &Layout, shown: &AnimatedCycle<'_>, wear: &[&[f64]]) -> String {
    let joints: Vec<usize> = with_clearance(mechanism).collect();
    let columns = (WIDTH / CELL) as usize;
    let height = format!("{:.0}", layout.height + CELL * joints.len().div_ceil(columns) as f64);
    let drawing = html! {
        svg xmlns="http://www.w3.org/2000/svg" viewBox=(format!("0 0 {WIDTH} {height}")) font-family="sans-serif"
            font-size="17" {
            rect width=(WIDTH) height=(height) fill=(Ink::Paper.hex()) {}
            (bodies(mechanism, layout, shown))
            (joint_marks(mechanism, layout, shown))
            @for (cell, index) in joints.iter().copied().enumerate() {
                @let (column, row) = (cell % columns, cell / columns);
                // Each row is centred.
                @let left = 0.5 * (WIDTH - CELL * columns.min(joints.len() - columns * row) as f64);
                @let centre = [left + CELL * (column as f64 + 0.5), layout.height + CELL * (row as f64 + 0.5)];
                (magnified(mechanism, layout, shown, index, wear.get(index).copied().unwrap_or_default(), centre))
            }
        }
    };
    drawing.into_string() + "\n"
}

/// Bodies and their supports on the ground; sliders as blocks, rails of the frame in their place.
fn bodies(mechanism: &Mechanism, layout: &Layout, shown: &AnimatedCycle<'_>) -> Markup {
    let scale = layout.scale;
    let local = |[x, y]: [f64; 2]| [x * scale, -y * scale];
    let cycle = mechanism.poses(shown.cycle).unwrap_or_default();
    html! {
        @for (index, body) in mechanism.bodies.iter().enumerate() {
            @if let Some(pose) = mechanism.pose(shown.cycle, index, 0) {
                @for support in mechanism.supports(index) {
                    (ground(layout.place([pose.0[0] + support[0], pose.0[1] + support[1]])))
                }
                @if body.motion == Motion::Fixed {
                    @for ends in rails(mechanism, index, &cycle) { (rail(rail_ends(ends.map(|end| layout.place(end))), true, Ink::Muted)) }
                } @else {
                    g data-body=(index) transform=(transform(layout, pose)) {
                        (link(&mechanism.outline(index).into_iter().map(local).collect::<Vec<_>>(), Ink::Series(index)))
                        @for ends in rails(mechanism, index, &cycle) {
                            (rail(rail_ends(ends.map(local)), false, Ink::Series(index)))
                        }
                        @for joint in &mechanism.joints {
                            @if let (JointKind::Prismatic { axis, angle }, true) = (&joint.kind, joint.journal.body == index) {
                                (block(local(joint.journal.position), -(axis - angle).to_degrees(), Ink::Series(index)))
                            }
                        }
                    }
                }
            }
        }
    }
}

/// Ends of the rails of a body in its own frame [m].
fn rails(mechanism: &Mechanism, body: usize, cycle: &[Vec<Pose>]) -> Vec<[[f64; 2]; 2]> {
    let own = mechanism.joints.iter().filter(|joint| joint.bushing.body == body);
    own.filter_map(|joint| mechanism.rail(joint, cycle)).collect()
}

/// A circle and the name of every joint; names of joints at one point stand side by side.
fn joint_marks(mechanism: &Mechanism, layout: &Layout, shown: &AnimatedCycle<'_>) -> Markup {
    let marked = mechanism.joints.iter().enumerate().filter_map(|(index, joint)| {
        Some((index, joint, layout.place(mechanism.place(shown.cycle, &joint.journal, 0)?)))
    });
    let marked: Vec<(usize, &Joint, [f64; 2])> = marked.collect();
    let (paper, ink) = (Ink::Paper.hex(), Ink::Ink.hex());
    html! {
        @for (k, (index, joint, [x, y])) in marked.iter().enumerate() {
            @let before = marked[..k].iter().filter(|(.., [u, v])| (u - x).hypot(v - y) < 4.0).count();
            g data-joint=(index) transform=(format!("translate({} {})", coordinate(*x), coordinate(*y))) {
                circle r="4.5" fill=(paper) stroke=(ink) stroke-width="2" {}
                text x=(8 + 14 * before) y="-8" fill=(ink) stroke=(paper) stroke-width="3" paint-order="stroke" {
                    (joint.name)
                }
            }
        }
    }
}

/// Joints with clearance, by the scene's numbering.
pub fn with_clearance(mechanism: &Mechanism) -> impl Iterator<Item = usize> {
    let all = mechanism.joints.iter().enumerate();
    all.filter(|(_, joint)| matches!(joint.kind, JointKind::Clearance(_))).map(|(index, _)| index)
}

/// A journal in its bore: unworn bore, worn bore and journal turn with the body of the bushing.
fn magnified(
    mechanism: &Mechanism,
    layout: &Layout,
    shown: &AnimatedCycle<'_>,
    index: usize,
    depth: &[f64],
    [x, y]: [f64; 2],
) -> Markup {
    let joint = &mechanism.joints[index];
    let JointKind::Clearance(clearance) = &joint.kind else { return html! {} };
    let journal = BORE - clearance.radial_clearance() * layout.magnified;
    let turned = |body: usize| mechanism.pose(shown.cycle, body, 0).map_or(0.0, |pose| pose.1);
    let (bushing, pin) = (turned(joint.bushing.body), turned(joint.journal.body));
    let [ex, ey] = mechanism.orbit_at(shown.cycle, joint, 0).map_or([0.0; 2], |e| layout.magnify(e));
    let (paper, muted, ink, wear) =
        (Ink::Paper.hex(), Ink::Muted.hex(), Ink::Ink.hex(), Ink::Series(0).hex());
    let cell = format!("translate({} {})", coordinate(x), coordinate(y - 6.0));
    let turned_bore = format!("rotate({})", coordinate(-bushing.to_degrees()));
    let moved_journal = format!(
        "translate({} {}) rotate({})",
        coordinate(ex),
        coordinate(ey),
        coordinate((bushing - pin).to_degrees())
    );
    html! {
        g transform=(cell) {
            g data-bore=(index) transform=(turned_bore) {
                path data-worn="" d=(bore(depth, layout.magnified)) fill=(wear) fill-opacity="0.2" stroke=(wear)
                    stroke-width="2" visibility=[(!shown.worn).then_some("hidden")] {}
                circle r=(BORE) fill=(paper) stroke=(muted) stroke-width="1" {}
                g data-journal="" transform=(moved_journal) {
                    circle r=(coordinate(journal)) fill=(Ink::Grid.hex()) stroke=(ink) stroke-width="1.5" {}
                    path d=(format!("M0 0H{}", coordinate(journal))) stroke=(ink) stroke-width="1.5" {}
                }
            }
            text y=(coordinate(0.5 * CELL)) text-anchor="middle" fill=(ink) { (joint.name) }
        }
    }
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
            coordinate(radius * cos),
            coordinate(-radius * sin)
        );
    }
    if path.is_empty() { path } else { path + "Z" }
}
