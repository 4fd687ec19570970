//! What outputs need of the mechanism with ideal joints, from its poses over a cycle: motion of points and bodies, and the influence of
//! small gaps in the joints.

use super::failures::Simulated;
use crate::mechanism::{Frame, Influence, Pose, held_poses, influences};
use crate::outputs::{BodyTrack, IdealTracks, PointTrack, RecordingRequest};
use common::failure::SimulationFailure;
use common::scene::{Attachment, Motion, OutputKind, Scene};

/// What is `requested` of the ideal mechanism over its `poses`. Adds Newton iterations to `iterations`.
///
/// # Errors
/// [`SimulationFailure::NotModelled`] for a backlash where joints and drives do not just determine the position, or of an angle of a drive that
/// the cycle does not contain.
pub(crate) fn ideal_tracks(
    scene: &Scene,
    poses: &[Pose],
    requested: &RecordingRequest,
    iterations: &mut u64,
) -> Simulated<IdealTracks> {
    let path = |at: &Attachment| (*at, ideal_path(scene, poses, at));
    let mut influences = Vec::with_capacity(requested.backlashes.len());
    for sought in &requested.backlashes {
        influences.push((sought.clone(), influences_on(sought, scene, poses, iterations)?));
    }
    Ok(IdealTracks {
        paths: requested.ideal_points.iter().map(path).collect(),
        angles: requested.ideal_bodies.iter().map(|&body| (body, ideal_angle(poses, body))).collect(),
        influences,
    })
}

/// Influence of the joints on a backlash in every position that counts.
fn influences_on(
    sought: &OutputKind,
    scene: &Scene,
    poses: &[Pose],
    iterations: &mut u64,
) -> Simulated<Vec<Influence>> {
    let not_modelled = |what: String| SimulationFailure::NotModelled { what };
    let at_rest;
    let poses = match sought {
        OutputKind::Backlash { held: Some(held), .. }
        | OutputKind::PositionBacklash { held: Some(held), .. } => {
            at_rest = held_poses(scene, poses, held, iterations);
            if at_rest.is_empty() {
                let (body, angle) = (&scene.bodies[held.body].name, held.angle.to_degrees());
                return Err(not_modelled(format!(
                    "a backlash at an angle of {body} of {angle:.6} deg, which its drive does not pass in a cycle"
                )));
            }
            &at_rest
        }
        _ => poses,
    };
    influences(scene, poses, sought).ok_or_else(|| {
        not_modelled(
            "a backlash where joints and drives do not just determine the position: the play of the joints is \
             not independent"
                .into(),
        )
    })
}

/// Angle of a free body of the scene over the `poses` of the ideal mechanism.
fn ideal_angle(poses: &[Pose], body: usize) -> BodyTrack {
    let mut track = BodyTrack::default();
    for pose in poses {
        if let (Some(q), Some(v)) = (pose.q[body], pose.v[body]) {
            track.push(pose.time, [q[2], v[2], 0.0]);
        }
    }
    track
}

/// Path of a point of the scene over the `poses` of the ideal mechanism.
fn ideal_path(scene: &Scene, poses: &[Pose], at: &Attachment) -> PointTrack {
    let mut path = PointTrack::default();
    let arm = scene.arm(at);
    for pose in poses {
        if let (Some(q), Some(v)) = (pose.q[at.body], pose.v[at.body]) {
            let frame = Frame::free(&q, &v);
            let ([x, y], [vx, vy]) = (frame.point(arm), frame.velocity(arm));
            path.push(pose.time, [x, y, vx, vy]);
        }
    }
    path
}

/// Why drives and joints do not determine the motion of the ideal mechanism.
pub(crate) fn left_open(scene: &Scene) -> String {
    let is_held = |index: usize| {
        scene.joints.iter().any(|joint| joint.journal.body == index || joint.bushing.body == index)
    };
    let bodies = scene.bodies.iter().enumerate();
    let loose = bodies.filter(|(k, body)| matches!(body.motion, Motion::Free { .. }) && !is_held(*k));
    let names: Vec<&str> = loose.map(|(_, body)| &*body.name).collect();
    match names.as_slice() {
        [] => "the drives leave the ideal motion open".to_owned(),
        [one] => format!("body {one} is held by no joint"),
        many => format!("bodies {} are held by no joint", many.join(", ")),
    }
}
