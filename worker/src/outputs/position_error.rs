//! Largest distance of a point of a body from its path on the mechanism with ideal joints.

use super::{MotionOutput, RecordedCycle, RecordingRequest};
use common::scene::Attachment;

/// The output `position-error` [m].
pub struct PositionError<'a> {
    /// Point of a body of the scene.
    pub at: &'a Attachment,
}

impl MotionOutput for PositionError<'_> {
    fn request(&self, request: &mut RecordingRequest) {
        request.points.push(*self.at);
    }

    fn value(&self, cycle: &RecordedCycle) -> f64 {
        cycle.paths(self.at).map_or(0.0, |(recorded, ideal)| recorded.largest_distance(ideal))
    }
}
