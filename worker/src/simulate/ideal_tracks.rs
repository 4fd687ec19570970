//! Motion of points and bodies on the mechanism with ideal joints, from its poses over a cycle.

use crate::mechanism::{Frame, Pose};
use crate::outputs::{BodyTrack, PointTrack};
use common::scene::{Attachment, Scene};

/// Angle of a free body of the scene over the `poses` of the ideal mechanism.
pub(crate) fn ideal_angle(poses: &[Pose], body: usize) -> BodyTrack {
    let mut track = BodyTrack::default();
    for pose in poses {
        if let (Some(q), Some(v)) = (pose.q[body], pose.v[body]) {
            track.push(pose.time, q[2], v[2], 0.0);
        }
    }
    track
}

/// Path of a point of the scene over the `poses` of the ideal mechanism.
pub(crate) fn ideal_path(scene: &Scene, poses: &[Pose], at: &Attachment) -> PointTrack {
    let mut path = PointTrack::default();
    let arm = scene.arm(at);
    for pose in poses {
        if let (Some(q), Some(v)) = (pose.q[at.body], pose.v[at.body]) {
            let frame = Frame::free(&q, &v);
            path.push(pose.time, frame.point(arm), frame.velocity(arm));
        }
    }
    path
}
