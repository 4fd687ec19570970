//! Largest acceleration of a point of a body, and largest angular acceleration of a body, over a cycle.
//!
//! At the end of every time step the forces on the body give the acceleration of its centre of mass a [m/s^2] and its angular
//! acceleration alpha [rad/s^2]; a point at the distance r [m] from that centre, turned with the body, has
//!
//!   a_P = a + alpha x r - omega^2 r.
//!
//! The outputs are the largest |a_P| and the largest |alpha|. They contain the vibrations of the contacts: where the time steps pass
//! over these, two step lengths give different values, and the stated error is large.
//!
//! # Source
//! Acceleration of a point of a rigid body: Goldstein, Poole, Safko, Classical Mechanics (2002), chapter 4.

use super::{MotionOutput, RecordedCycle, RecordingRequest, Sampling};
use common::scene::Attachment;

/// The output `acceleration` [m/s^2].
pub struct Acceleration<'a> {
    /// Point of a free body of the scene.
    pub at: &'a Attachment,
}

impl MotionOutput for Acceleration<'_> {
    fn request(&self, request: &mut RecordingRequest) {
        request.accelerations.push(*self.at);
    }

    fn value(&self, cycle: &RecordedCycle) -> f64 {
        cycle.peak_acceleration(self.at).unwrap_or(0.0)
    }

    fn sampling(&self) -> Sampling {
        Sampling::Steps
    }
}

/// The output `angular-acceleration` [rad/s^2].
pub struct AngularAcceleration {
    /// Free body of the scene.
    pub body: usize,
}

impl MotionOutput for AngularAcceleration {
    fn request(&self, request: &mut RecordingRequest) {
        request.angular_accelerations.push(self.body);
    }

    fn value(&self, cycle: &RecordedCycle) -> f64 {
        cycle.peak_angular_acceleration(self.body).unwrap_or(0.0)
    }

    fn sampling(&self) -> Sampling {
        Sampling::Steps
    }
}
