//! Largest force in joints over a cycle.

use super::{MotionOutput, RecordedCycle, RecordingRequest, Sampling};

/// The output `peak-joint-force` [N].
pub struct PeakJointForce<'a> {
    /// Joints of the scene.
    pub joints: &'a [usize],
}

impl MotionOutput for PeakJointForce<'_> {
    fn request(&self, request: &mut RecordingRequest) {
        request.peak_forces = true;
    }

    fn value(&self, cycle: &RecordedCycle) -> f64 {
        self.joints.iter().filter_map(|&joint| cycle.peak_force(joint)).fold(0.0, f64::max)
    }

    fn sampling(&self) -> Sampling {
        Sampling::Steps
    }
}
