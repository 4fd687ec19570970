//! What to record of the motion of a cycle.

use common::scene::{Attachment, OutputKind};

/// Quantities to record over every measured cycle.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct RecordingRequest {
    /// Bodies of the scene whose angle and angular velocity are recorded.
    pub bodies: Vec<usize>,
    /// Points whose path is recorded.
    pub points: Vec<Attachment>,
    /// Points whose path on the mechanism with ideal joints is needed.
    pub ideal_points: Vec<Attachment>,
    /// Bodies of the scene whose angle on the mechanism with ideal joints is needed.
    pub ideal_bodies: Vec<usize>,
    /// Points whose largest acceleration is recorded.
    pub accelerations: Vec<Attachment>,
    /// Bodies of the scene whose largest angular acceleration is recorded.
    pub angular_accelerations: Vec<usize>,
    /// Driven bodies of the scene on which the moment of joints and loads is recorded.
    pub driven: Vec<usize>,
    /// Outputs that are a backlash, for which the influence of the joints is needed, in the mechanism with ideal joints.
    pub backlashes: Vec<OutputKind>,
    /// True if the largest force of every joint is recorded.
    pub peak_forces: bool,
    /// True if the impacts of every joint with clearance are recorded.
    pub impacts: bool,
}

impl RecordingRequest {
    /// True if the motion of the mechanism with ideal joints is needed.
    pub(crate) fn needs_ideal_motion(&self) -> bool {
        !(self.ideal_points.is_empty() && self.ideal_bodies.is_empty() && self.backlashes.is_empty())
    }
}
