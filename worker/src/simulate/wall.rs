//! Ends of wear: bushings and sliders that are worn through, and wear steps without a result.

use crate::wear::{WearStep, WearStepFailed};
use common::failure::SimulationFailure;
use common::scene::{ContactLaw, JointKind, Scene};

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

/// The failure of a wear step of the joint `joint` of this kind, in the block that begins with `cycle`.
pub(super) fn wear_failure(
    kind: &JointKind,
    cycle: u32,
    joint: String,
    failed: impl Into<WearStepFailed>,
) -> SimulationFailure {
    let uniform =
        matches!(kind, JointKind::Clearance(clearance) if clearance.contact_law != ContactLaw::Foundation);
    match failed.into() {
        WearStepFailed::Tolerance(error) if uniform => SimulationFailure::WearStep { cycle, joint, error },
        WearStepFailed::Tolerance(error) => SimulationFailure::WearOnFoundation { cycle, joint, error },
        WearStepFailed::TooDeep([depth, bound]) => {
            SimulationFailure::WornTooDeep { cycle, joint, depth, bound }
        }
        WearStepFailed::TooManyStages => {
            SimulationFailure::TooManyWearStages { cycle, joint, bound: WearStep::MOST_EVALUATIONS }
        }
    }
}
