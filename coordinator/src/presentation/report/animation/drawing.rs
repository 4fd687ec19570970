//! The first frame of the animation: bodies in true proportions, and below them the joints with clearance, magnified.

use crate::presentation::report::drawing::labels::LabelArea;
use crate::presentation::report::drawing::symbols::{
    block, coordinate, ground, link, pair, path_along, placed, rail, rail_ends,
};
use crate::presentation::report::mechanism::{self, Pose, eccentricity, of_body, place};
use crate::presentation::report::{Drawing, Ink};
use common::outputs::CycleHistory;
use common::scene::{GuideClearance, Joint, JointKind, Motion, Scene};
use maud::{Markup, html};
use std::f64::consts::TAU;

/// Width of the drawing [drawing units].
const WIDTH: f64 = 480.0;

/// Largest height of the mechanism [drawing units].
const HEIGHT: f64 = 320.0;

/// Margin around the mechanism [drawing units].
const MARGIN: f64 = 34.0;

/// Size of the letters, and the width of one in a wide sans-serif font [drawing units].
const FONT: f64 = 15.2;
const LETTER: f64 = 9.0;

/// Edge of the square cell of a magnified joint [drawing units].
const CELL: f64 = 120.0;

/// Radius of an unworn bore in its cell [drawing units].
pub const BORE: f64 = 33.0;

/// Size to which the largest clearance with its wear is magnified [drawing units].
pub const LARGEST_CLEARANCE: f64 = 19.0;

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
    pub fn new(scene: &Scene, shown: &[AnimatedCycle<'_>], wear: &[&[f64]]) -> Option<Self> {
        let outlines: Vec<Vec<[f64; 2]>> =
            (0..scene.bodies.len()).map(|body| mechanism::outline(scene, body)).collect();
        let placed = |(pose, outline): (&Pose, &Vec<[f64; 2]>)| -> Vec<[f64; 2]> {
            outline.iter().map(|point| of_body(pose, *point)).collect()
        };
        let frames = shown.iter().flat_map(AnimatedCycle::frames);
        let [low, high] = mechanism::extent(
            frames.flat_map(|poses| poses.iter().zip(&outlines).flat_map(placed).collect::<Vec<_>>()),
        );
        let (wide, tall) = (high[0] - low[0], high[1] - low[1]);
        let room = (WIDTH - 2.0 * MARGIN, HEIGHT - 2.0 * MARGIN);
        let scale = (room.0 / wide).min(room.1 / tall);
        let reach = |(index, joint): (usize, &Joint)| {
            let JointKind::Clearance(clearance) = &joint.kind else { return 0.0 };
            let depths = wear.get(index).copied().unwrap_or_default();
            clearance.radial_clearance() + depths.iter().copied().fold(0.0, f64::max)
        };
        let largest = scene.joints.iter().enumerate().map(reach).fold(0.0, f64::max);
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

/// The drawing at the first instant of a cycle; `wear`: depth per joint at equal angles `(joints)(control_points,)` [m].
pub fn picture(scene: &Scene, layout: &Layout, shown: &AnimatedCycle<'_>, wear: &[&[f64]]) -> Drawing {
    let joints: Vec<usize> = with_clearance(scene).collect();
    let columns = (WIDTH / CELL) as usize;
    let height = format!("{:.0}", layout.height + CELL * joints.len().div_ceil(columns) as f64);
    let content = html! {
        rect width=(WIDTH) height=(height) fill=(Ink::Paper.hex()) {}
        (bodies(scene, layout, shown))
        (joint_marks(scene, layout, shown))
        @for (cell, index) in joints.iter().copied().enumerate() {
            @let (column, row) = (cell % columns, cell / columns);
            // Each row is centred.
            @let left = 0.5 * (WIDTH - CELL * columns.min(joints.len() - columns * row) as f64);
            @let centre = [left + CELL * (column as f64 + 0.5), layout.height + CELL * (row as f64 + 0.5)];
            (magnified(scene, layout, shown, index, wear.get(index).copied().unwrap_or_default(), centre))
        }
    };
    let view = format!("0 0 {WIDTH} {height}");
    Drawing { view, letters: Some(FONT), axes: None, content: content.into_string() }
}

/// Bodies and their supports on the ground; sliders as blocks, rails of the frame in their place.
fn bodies(scene: &Scene, layout: &Layout, shown: &AnimatedCycle<'_>) -> Markup {
    let scale = layout.scale;
    let local = |[x, y]: [f64; 2]| [x * scale, -y * scale];
    html! {
        @for (index, (body, pose)) in scene.bodies.iter().zip(&shown.poses[0]).enumerate() {
            @for support in mechanism::supports(scene, index) {
                (ground(layout.place([pose.0[0] + support[0], pose.0[1] + support[1]])))
            }
            @if body.motion == Motion::Fixed {
                @for ends in rails(scene, index, &shown.poses) {
                    (rail(rail_ends(ends.map(|end| layout.place(end))), true, Ink::Muted))
                }
            } @else {
                g data-body=(index) transform=(placed(layout.place(pose.0), -pose.1.to_degrees())) {
                    (link(&mechanism::outline(scene, index).into_iter().map(local).collect::<Vec<_>>(), Ink::Series(index)))
                    @for ends in rails(scene, index, &shown.poses) {
                        (rail(rail_ends(ends.map(local)), false, Ink::Series(index)))
                    }
                    @for joint in &scene.joints {
                        @if let (JointKind::Prismatic { axis, angle } | JointKind::Guide(GuideClearance { axis, angle, .. }), true) = (&joint.kind, joint.journal.body == index) {
                            (block(local(joint.journal.position), -(axis - angle).to_degrees(), Ink::Series(index)))
                        }
                    }
                }
            }
        }
    }
}

/// Ends of the rails of a body in its own frame [m].
fn rails(scene: &Scene, body: usize, cycle: &[Vec<Pose>]) -> Vec<[[f64; 2]; 2]> {
    let own = scene.joints.iter().filter(|joint| joint.bushing.body == body);
    own.filter_map(|joint| mechanism::rail(joint, cycle)).collect()
}

/// A circle and the name of every joint, the names where they do not cover each other.
fn joint_marks(scene: &Scene, layout: &Layout, shown: &AnimatedCycle<'_>) -> Markup {
    let at = |joint: &Joint| layout.place(place(&shown.poses[0], &joint.journal));
    let names: Vec<(&str, [f64; 2])> =
        scene.joints.iter().map(|joint| (joint.name.as_str(), at(joint))).collect();
    let offsets = name_offsets(&names);
    let (paper, ink) = (Ink::Paper.hex(), Ink::Ink.hex());
    html! {
        @for (index, ((name, at), [right, down])) in names.iter().zip(offsets).enumerate() {
            g data-joint=(index) transform=(format!("translate({})", pair(*at))) {
                circle r="4.5" fill=(paper) stroke=(ink) stroke-width="2" {}
                text x=(coordinate(right)) y=(coordinate(down)) fill=(ink) stroke=(paper) stroke-width="3" paint-order="stroke" {
                    (name)
                }
            }
        }
    }
}

/// Offsets of names from their points `(n)(2,)` [drawing units]: for each the nearest place where it lies within the drawing and
/// covers no name before it.
fn name_offsets(names: &[(&str, [f64; 2])]) -> Vec<[f64; 2]> {
    let mut taken: Vec<LabelArea> = Vec::new();
    let place = |(name, [x, y]): &(&str, [f64; 2])| {
        let width = LETTER * name.chars().count() as f64;
        let sides = [8.0, -8.0 - width, -0.5 * width];
        let rows = (0..8).flat_map(|k| [-8.0 - 18.0 * f64::from(k), 20.0 + 18.0 * f64::from(k)]);
        let area = |[right, down]: [f64; 2]| LabelArea {
            from: [x + right - 1.0, y + down - 14.0],
            to: [x + right + width + 1.0, y + down + 4.0],
        };
        let is_free = |offset: &[f64; 2]| {
            let own = area(*offset);
            own.from[0] >= 0.0 && own.to[0] <= WIDTH && !taken.iter().any(|other| other.overlaps(&own))
        };
        let mut candidates = rows.flat_map(|down| sides.map(|right| [right, down]));
        let offset = candidates.find(is_free).unwrap_or([8.0, -8.0]);
        taken.push(area(offset));
        offset
    };
    names.iter().map(place).collect()
}

/// Joints with clearance, by the scene's numbering.
pub fn with_clearance(scene: &Scene) -> impl Iterator<Item = usize> {
    let all = scene.joints.iter().enumerate();
    all.filter(|(_, joint)| matches!(joint.kind, JointKind::Clearance(_))).map(|(index, _)| index)
}

/// A journal in its bore: unworn bore, worn bore and journal turn with the body of the bushing.
fn magnified(
    scene: &Scene,
    layout: &Layout,
    shown: &AnimatedCycle<'_>,
    index: usize,
    depth: &[f64],
    [x, y]: [f64; 2],
) -> Markup {
    let joint = &scene.joints[index];
    let JointKind::Clearance(clearance) = &joint.kind else { return html! {} };
    let journal = BORE - clearance.radial_clearance() * layout.magnified;
    let poses = &shown.poses[0];
    let (bushing, pin) = (poses[joint.bushing.body].1, poses[joint.journal.body].1);
    let (paper, muted, ink, wear) =
        (Ink::Paper.hex(), Ink::Muted.hex(), Ink::Ink.hex(), Ink::Series(0).hex());
    let cell = format!("translate({})", pair([x, y - 6.0]));
    let turned_bore = format!("rotate({})", coordinate(-bushing.to_degrees()));
    let moved_journal = placed(layout.magnify(eccentricity(poses, joint)), (bushing - pin).to_degrees());
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
    let steps = 4 * n;
    let corner = |step: usize| {
        let (k, share) = (step / 4, (step % 4) as f64 / 4.0);
        let between = depth[k] * (1.0 - share) + depth[(k + 1) % n] * share;
        let radius = BORE + if between.is_finite() { between * magnified } else { 0.0 };
        let (sin, cos) = (TAU * step as f64 / steps as f64).sin_cos();
        [radius * cos, -radius * sin]
    };
    let path = path_along(&(0..steps).map(corner).collect::<Vec<_>>());
    if path.is_empty() { path } else { path + "Z" }
}

/// Frames per cycle.
pub const FRAMES: usize = 120;

/// A cycle to be animated.
pub struct AnimatedCycle<'a> {
    /// Name in the list of cycles.
    pub name: &'static str,
    /// True if the bores are those at the end of life.
    pub worn: bool,
    /// Motion over the cycle.
    pub cycle: &'a CycleHistory,
    /// Poses of all bodies at its instants `(n, bodies)`.
    pub poses: Vec<Vec<Pose>>,
}

impl AnimatedCycle<'_> {
    /// Poses of all bodies in the frames, which are evenly spread over the cycle.
    pub fn frames(&self) -> impl Iterator<Item = &[Pose]> {
        let last = self.poses.len() - 1;
        (0..FRAMES).map(move |frame| self.poses[frame * last / FRAMES].as_slice())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_at_one_point_do_not_cover_each_other() {
        let names = [
            ("coupler", [240.0, 100.0]),
            ("crank", [240.0, 100.0]),
            ("rocker", [243.0, 102.0]),
            ("frame", [470.0, 100.0]),
        ];
        let offsets = name_offsets(&names);
        let areas: Vec<LabelArea> = names
            .iter()
            .zip(&offsets)
            .map(|((name, [x, y]), [right, down])| LabelArea {
                from: [x + right, y + down - 13.0],
                to: [x + right + LETTER * name.len() as f64, y + down + 3.0],
            })
            .collect();
        for (k, area) in areas.iter().enumerate() {
            assert!(area.from[0] >= 0.0 && area.to[0] <= WIDTH, "{area:?}");
            assert!(areas[..k].iter().all(|other| !other.overlaps(area)), "{areas:?}");
        }
        assert_eq!(offsets[0], [8.0, -8.0]);
    }
}
