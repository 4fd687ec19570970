//! Bushings that are worn through.

use common::scene::{JointKind, Scene};

/// Largest depth and thickness of the wall of a joint of the scene [m], if the depth has reached the thickness.
pub(super) fn worn_through(scene: &Scene, joint: usize, depth: &[f64]) -> Option<(f64, f64)> {
    let JointKind::Clearance(clearance) = &scene.joints[joint].kind else { return None };
    let largest = depth.iter().fold(0.0_f64, |a, &b| a.max(b));
    clearance.wall.filter(|&wall| largest >= wall).map(|wall| (largest, wall))
}
