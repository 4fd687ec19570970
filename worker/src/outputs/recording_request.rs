//! What to record of the motion of a cycle.

use common::scene::Attachment;

/// Quantities to record over every measured cycle.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct RecordingRequest {
    /// Bodies of the scene whose angle and angular velocity are recorded.
    pub bodies: Vec<usize>,
    /// Points whose path is recorded.
    pub points: Vec<Attachment>,
    /// Driven bodies of the scene on which the moment of joints and loads is recorded.
    pub driven: Vec<usize>,
    /// True if the largest force of every joint is recorded.
    pub peak_forces: bool,
}
