//! What ends an evaluation, in the words of its scene: bushings and sliders that are worn through, wear steps without a result, sliders outside
//! their guides, and outputs that have no value where ideal joints become dependent, since the forces of single joints grow without bound there.

use crate::integrate::IntegrationError;
use crate::mechanism::{Island, ideal_cycle, places_in_guide};
use crate::wear::{WearStep, WearStepFailed};
use common::failure::SimulationFailure;
use common::scene::{ContactLaw, Joint, JointKind, OutputKind, Scene};

/// A result of a simulation, or what ended it.
pub(crate) type Simulated<T> = Result<T, SimulationFailure>;

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

/// The failure of a wear step of a `joint`, in the block that begins with `cycle`.
pub(super) fn wear_failure(
    joint: &Joint,
    cycle: u32,
    failed: impl Into<WearStepFailed>,
) -> SimulationFailure {
    let uniform =
        matches!(&joint.kind, JointKind::Clearance(joint) if joint.contact_law != ContactLaw::Foundation);
    let joint = joint.name.clone();
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

/// Poses of the cycle that are looked at, a pose every two degrees.
const POSES: usize = 181;

/// What to change in the scene where the slider of the guide with this index into the scene's joints leaves it: the ends that the guide needs
/// at least, with ideal joints. Empty if it has them, or if drives and joints do not determine the motion.
fn advice(scene: &Scene, joint: usize) -> String {
    let Some((needed, [start, end])) = covered(scene, joint) else { return String::new() };
    if start <= needed[0] && needed[1] <= end {
        return String::new();
    }
    format!(
        "; with ideal joints it needs a guide_start of at most {:.3} mm and a guide_end of at least {:.3} mm",
        1e3 * needed[0],
        1e3 * needed[1]
    )
}

/// From where to where the slider reaches along the axis of its guide over a cycle, and the ends of the guide, from its point `(2,)` each [m].
fn covered(scene: &Scene, joint: usize) -> Option<([f64; 2], [f64; 2])> {
    let joint = &scene.joints[joint];
    let JointKind::Guide(guide) = &joint.kind else { return None };
    let poses = ideal_cycle(scene, POSES, &mut 0).ok().filter(|poses| poses.len() == POSES)?;
    let along = places_in_guide(scene, joint, guide.axis, &poses);
    let first = along.iter().copied().fold(f64::INFINITY, f64::min);
    let last = along.into_iter().fold(f64::NEG_INFINITY, f64::max);
    let half = 0.5 * guide.length;
    Some(([first - half, last + half], guide.reach))
}

/// Checks that no output of the scene reads forces of the ideal joints of an island that has passed this number of positions in which they
/// are dependent.
///
/// # Errors
/// [`SimulationFailure::NotModelled`] with the output.
pub(crate) fn refuse_unbounded_forces(scene: &Scene, island: &Island, passages: u64) -> Simulated<()> {
    let reads = |kind: &OutputKind| match kind {
        OutputKind::PeakJointForce { joints } => {
            island.ideal.constraints.iter().any(|c| joints.contains(&c.scene_joint))
        }
        OutputKind::DrivingTorque { body } => island.touched.contains(body),
        _ => false,
    };
    match scene.outputs.iter().find(|output| reads(&output.kind)) {
        Some(output) if passages > 0 => Err(SimulationFailure::NotModelled {
            what: format!(
                "output {}: the motion passes a position in which the forces of ideal joints have no bound",
                output.name
            ),
        }),
        _ => Ok(()),
    }
}

/// The failure of an evaluation of `scene` whose integration stopped: adds the life `cycle` [cycles] and the names of joints.
pub(crate) fn failure(
    error: IntegrationError,
    cycle: u32,
    island: &Island,
    scene: &Scene,
) -> SimulationFailure {
    let named = |joint: usize| scene.joints[joint].name.clone();
    let name = |joint: usize| island.contacts().nth(joint).map_or_else(String::new, named);
    // Without contact the friction of ideal joints may be what makes steps short.
    let rubbing =
        || island.ideal.constraints.iter().find(|c| c.friction.is_some()).map(|c| named(c.scene_joint));
    match error {
        IntegrationError::StepTooSmall { time, step, error, joint } => {
            let joint = joint.map(name).or_else(rubbing);
            SimulationFailure::StepTooSmall { cycle, time, joint, step, error }
        }
        IntegrationError::TooManySteps { time, bound, joint } => {
            let joint = joint.map(name).or_else(rubbing);
            SimulationFailure::TooManySteps { cycle, time, joint, bound }
        }
        IntegrationError::OutOfRange { time, joint, penetration } => {
            SimulationFailure::OutOfRange { cycle, time, joint: name(joint), penetration }
        }
        IntegrationError::LeftGuide { time, guide, distance } => {
            let index = island.guides[guide].flat.scene_joint;
            let (joint, by, advice) = (&scene.joints[index].name, 1e6 * distance, advice(scene, index));
            let what = format!(
                "joint {joint}: its slider stands out of its guide by {by:.3} um at t = {time:.6} s{advice}"
            );
            SimulationFailure::NotModelled { what }
        }
        IntegrationError::Singular(time) => SimulationFailure::Singular { cycle, time },
        IntegrationError::Branching { time, joint } => {
            SimulationFailure::Branching { cycle, time, joint: named(joint) }
        }
        IntegrationError::SelfLocking { time, joint } => {
            let joint = named(island.ideal.constraints[joint].scene_joint);
            SimulationFailure::SelfLocking { cycle, time, joint }
        }
        IntegrationError::NotFinite(time) => {
            SimulationFailure::NotFinite { cycle, time, quantity: "the force".into() }
        }
    }
}
