//! Outputs that have no value where ideal joints become dependent: the forces of single joints grow without bound there.

use crate::mechanism::Island;
use common::failure::SimulationFailure;
use common::scene::{OutputKind, Scene};

/// Checks that no output of the scene reads forces of the ideal joints of an island that has passed this number of positions in which they
/// are dependent.
///
/// # Errors
/// [`SimulationFailure::NotModelled`] with the output.
pub(crate) fn refuse_unbounded_forces(
    scene: &Scene,
    island: &Island,
    passages: u64,
) -> Result<(), SimulationFailure> {
    let reads = |kind: &OutputKind| match kind {
        OutputKind::PeakJointForce { joints } => {
            island.constraints().iter().any(|c| joints.contains(&c.scene_joint))
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
