//! What to record of the motion of a cycle.

use crate::mechanism::Coordinate;
use common::scene::{Attachment, HeldInput};

/// A backlash that an output asks for.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SoughtBacklash {
    /// Coordinate that is moved.
    pub coordinate: Coordinate,
    /// Where the drives are held; `None` for all positions of a cycle.
    pub held: Option<HeldInput>,
}

impl SoughtBacklash {
    /// Of the angle of a free body.
    pub(super) fn of_angle(body: usize, held: Option<HeldInput>) -> Self {
        SoughtBacklash { coordinate: Coordinate::Angle(body), held }
    }

    /// Of a place on a free body along the direction at this angle from the x axis [rad].
    pub(super) fn of_place(at: Attachment, direction: f64, held: Option<HeldInput>) -> Self {
        let (sin, cos) = libm::sincos(direction);
        SoughtBacklash { coordinate: Coordinate::Position(at, [cos, sin]), held }
    }
}

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
    /// Backlashes for which the influence of the joints is needed, in the mechanism with ideal joints.
    pub backlashes: Vec<SoughtBacklash>,
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
