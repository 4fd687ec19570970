//! Lengths of a mechanism that do not depend on its place.

use crate::lanes::Real;
use common::scene::{Attachment, Body, Motion, Scene};

/// Least length of an arm over the radius of gyration of its body, where all joints are near the centre of mass [1].
const SHARE_OF_GYRATION: f64 = 0.1;

/// Radius of gyration of a free body about its centre of mass [m]; `None` for other bodies.
pub(super) fn gyration(body: &Body) -> Option<f64> {
    match body.motion {
        Motion::Free { mass, inertia, .. } => Some((inertia / mass).sqrt()),
        Motion::Fixed | Motion::Driven { .. } => None,
    }
}

/// Least length at which rotations of a free body count [m]; zero for other bodies.
pub(super) fn least_arm(body: &Body) -> f64 {
    SHARE_OF_GYRATION * gyration(body).unwrap_or(0.0)
}

/// The length by which angles and lengths of a mechanism are made alike [m]: the largest extent along an axis of the joints of one body, the
/// centre of mass of a free one and the axes of drives included; those of the fixed bodies are one body's. A turn of the whole changes it by
/// less than a factor of the square root of two, a move not at all. At least a tenth of the largest radius of gyration.
pub(super) fn extent(scene: &Scene) -> f64 {
    let axes = scene.bodies.iter().filter_map(|body| match body.motion {
        Motion::Driven { position, .. } => Some(position),
        Motion::Fixed | Motion::Free { .. } => None,
    });
    let joined = |on: &dyn Fn(&Attachment) -> bool| -> Vec<[f64; 2]> {
        let ends = scene.joints.iter().flat_map(|joint| [joint.journal, joint.bushing]);
        ends.filter(|at| on(at)).map(|at| at.position).collect()
    };
    let is_fixed = |at: &Attachment| scene.bodies[at.body].motion == Motion::Fixed;
    let mut sets = vec![joined(&is_fixed)];
    sets[0].extend(axes);
    for (index, body) in scene.bodies.iter().enumerate().filter(|(_, body)| body.motion != Motion::Fixed) {
        let mut points = joined(&|at| at.body == index);
        points.push(body.motion.base_point());
        sets.push(points);
    }
    let along = |points: &[[f64; 2]], axis: usize| {
        let ends = points.iter().fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], point| {
            [low.min(point[axis]), high.max(point[axis])]
        });
        ends[1] - ends[0]
    };
    let extents = sets.iter().flat_map(|points| [along(points, 0), along(points, 1)]);
    let least = scene.bodies.iter().map(least_arm);
    extents.chain(least).fold(f64::MIN_POSITIVE, f64::max)
}

/// A point near the mechanism `(2,)` [m]: the axis of its first driven body, else the first point of a joint on a fixed body, else the start of
/// the first free body. Coordinates from there have the least rounding.
pub fn local_origin(scene: &Scene) -> [f64; 2] {
    let driven = scene.bodies.iter().find_map(|body| match body.motion {
        Motion::Driven { position, .. } => Some(position),
        Motion::Fixed | Motion::Free { .. } => None,
    });
    let mut ends = scene.joints.iter().flat_map(|joint| [joint.journal, joint.bushing]);
    let fixed = ends.find(|at| scene.bodies[at.body].motion == Motion::Fixed).map(|at| at.position);
    let free = scene.bodies.iter().find_map(|body| match body.motion {
        Motion::Free { start_position, .. } => Some(start_position),
        Motion::Fixed | Motion::Driven { .. } => None,
    });
    driven.or(fixed).or(free).unwrap_or_default()
}

/// The scene with its [`local_origin`] at zero, and that origin; `None` if it is there.
pub(crate) fn moved_to_origin(scene: &Scene) -> Option<(Scene, [f64; 2])> {
    let origin = local_origin(scene);
    (origin != [0.0; 2]).then(|| (scene.moved(origin.map(|x| -x)), origin))
}

/// Rounding of a gap between bodies over that of their coordinates [1].
pub(super) const ROUNDING: f64 = 8.0 * f64::EPSILON;

/// Largest coordinate of a body, angles times `size` [m]: its rounding is that of gaps.
#[inline(always)]
pub(super) fn farthest<R: Real>(q: &[R], size: R) -> R {
    let mut farthest = size.zero();
    for body in q.chunks_exact(3) {
        let angle = body[2].abs() * size;
        farthest = farthest.larger(body[0].abs()).larger(body[1].abs()).larger(angle);
    }
    farthest
}
