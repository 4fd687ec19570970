//! What the outputs of a scene need to be recorded of its motion.

use common::scene::{Attachment, OutputKind, Scene};

/// Quantities to record over every measured cycle.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Wanted {
    /// Bodies whose angle and speed are asked for.
    pub bodies: Vec<usize>,
    /// Points whose path is asked for.
    pub points: Vec<Attachment>,
    /// Driven bodies whose torque is asked for.
    pub driven: Vec<usize>,
    /// Whether joint forces are asked for.
    pub peaks: bool,
}

impl Wanted {
    /// By the outputs of a scene.
    pub fn by(scene: &Scene) -> Self {
        let mut wanted = Wanted::default();
        for output in &scene.outputs {
            match &output.kind {
                OutputKind::LargestWear { .. } | OutputKind::External { .. } => {}
                OutputKind::AngularVelocityDifference { a, b } | OutputKind::AngleDifference { a, b } => {
                    wanted.bodies.extend([a.body, b.body]);
                }
                OutputKind::PeakJointForce { .. } => wanted.peaks = true,
                OutputKind::PositionError { at } => wanted.points.push(*at),
                OutputKind::DrivingTorque { body } => wanted.driven.push(*body),
            }
        }
        wanted
    }
}
