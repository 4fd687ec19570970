//! The part of a guide that its slider covers while the mechanism moves with ideal joints.

use crate::mechanism::{Frame, Pose, Prescribed, ideal_cycle};
use crate::plane::dot;
use common::scene::{Attachment, JointKind, Scene};

/// Poses of the cycle that are looked at, a pose every two degrees.
const POSES: usize = 181;

/// What to change in the scene where the slider of the guide with this index into the scene's joints leaves it: the ends that the guide needs
/// at least, with ideal joints. Empty if it has them, or if drives and joints do not determine the motion.
pub(crate) fn advice(scene: &Scene, joint: usize) -> String {
    let Some((needed, [start, end])) = covered(scene, joint) else { return String::new() };
    if start <= needed[0] && needed[1] <= end {
        return String::new();
    }
    format!(
        "; with ideal joints it needs a guide_start of at most {:.3} mm and a guide_end of at least {:.3} mm",
        1e3 * needed[0],
        1e3 * needed[1]
    )
}

/// From where to where the slider reaches along the axis of its guide over a cycle, and the ends of the guide, from its point `(2,)` each [m].
fn covered(scene: &Scene, joint: usize) -> Option<([f64; 2], [f64; 2])> {
    let joint = &scene.joints[joint];
    let JointKind::Guide(guide) = &joint.kind else { return None };
    let poses = ideal_cycle(scene, POSES, &mut 0).ok().filter(|poses| poses.len() == POSES)?;
    let (sin, cos) = libm::sincos(guide.axis);
    let (mut first, mut last) = (f64::INFINITY, f64::NEG_INFINITY);
    for pose in &poses {
        let (slider, rail) = (frame(scene, pose, &joint.journal)?, frame(scene, pose, &joint.bushing)?);
        let (at, from) = (slider.point(scene.arm(&joint.journal)), rail.point(scene.arm(&joint.bushing)));
        let along = dot(rail.turn([cos, sin]), [at[0] - from[0], at[1] - from[1]]);
        (first, last) = (first.min(along), last.max(along));
    }
    let half = 0.5 * guide.length;
    Some(([first - half, last + half], guide.reach))
}

/// Frame of the body of this place in a pose.
fn frame(scene: &Scene, pose: &Pose, place: &Attachment) -> Option<Frame> {
    match (pose.q[place.body], pose.v[place.body]) {
        (Some(q), Some(v)) => Some(Frame::free(&q, &v)),
        _ => {
            let motion = Prescribed::from_body(&scene.bodies[place.body])?;
            Some(Frame::turning(motion.position(), &motion.jet(pose.time)))
        }
    }
}
