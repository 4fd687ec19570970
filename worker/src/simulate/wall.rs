//! Bushings and sliders that are worn through.

use common::scene::{JointKind, Scene};

/// Largest depth and thickness of the wall of a joint of the scene [m], if the depth has reached the thickness: of the first surface, a
/// bushing's wall, of the second one, half the height of a slider.
pub(super) fn worn_through(scene: &Scene, joint: usize, [first, second]: [&[f64]; 2]) -> Option<(f64, f64)> {
    let (depth, wall) = match &scene.joints[joint].kind {
        JointKind::Clearance(clearance) => (first, clearance.wall?),
        JointKind::Guide(guide) => (second, 0.5 * guide.height),
        _ => return None,
    };
    let largest = depth.iter().fold(0.0_f64, |a, &b| a.max(b));
    (largest >= wall).then_some((largest, wall))
}
