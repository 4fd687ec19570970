//! One cycle of a mechanism on given surfaces, with the contacts of every time step: the built-in mechanics for a program that wears the
//! surfaces itself.

use super::conditions::assemble;
use super::run::Run;
use super::side_by_side::{LaneQueue, run_alone};
use crate::mechanism::moved_to_origin;
use common::accuracy::Accuracy;
use common::external::JointCycle;
use common::failure::SimulationFailure;
use common::scene::Scene;
use std::collections::BTreeMap;

/// A cycle of a mechanism.
#[derive(Debug, Clone, PartialEq)]
pub struct ServedCycle {
    /// Contacts of every joint with clearance, by its name.
    pub joints: BTreeMap<String, JointCycle>,
    /// Outputs of the scene, zero for those of the wear `(outputs,)` [SI].
    pub outputs: Vec<f64>,
}

/// Simulates the settled cycle of a scene whose joints of these names are worn to `depths` at their control points, the bore's and then those
/// of a journal that wears `(depths,)` [m].
///
/// # Errors
/// [`SimulationFailure`]; [`SimulationFailure::NotModelled`] for another number of depths than the joint has.
pub fn simulate_one_cycle(
    scene: &Scene,
    accuracy: &Accuracy,
    depths: &BTreeMap<String, Vec<f64>>,
) -> Result<ServedCycle, SimulationFailure> {
    let local = moved_to_origin(scene);
    let scene = local.as_ref().map_or(scene, |(local, _)| local);
    run_alone(|queue| on_surfaces(queue, scene, accuracy, depths))
}

async fn on_surfaces(
    queue: LaneQueue,
    scene: &Scene,
    accuracy: &Accuracy,
    depths: &BTreeMap<String, Vec<f64>>,
) -> Result<ServedCycle, SimulationFailure> {
    let mut runs = assemble(&queue, scene, accuracy)?;
    let [run] = &mut runs[..] else {
        let what = "several operating conditions in one cycle".to_owned();
        return Err(SimulationFailure::NotModelled { what });
    };
    for state in &mut run.islands {
        for (pair, worn) in state.island.pairs_mut().zip(&mut state.depth) {
            let name = &scene.joints[pair.scene_joint()].name;
            let Some(depth) = depths.get(name) else { continue };
            if depth.len() != worn.len() {
                let what = format!("{} depths of joint {name}, which has {}", depth.len(), worn.len());
                return Err(SimulationFailure::NotModelled { what });
            }
            worn.clone_from(depth);
            pair.set_depth(depth);
        }
        state.recorder.traced = Some(vec![]);
    }
    run.settle().await?;
    run.measure_first().await?;
    run.next_settled_cycle().await?;
    Ok(ServedCycle { joints: traced(run), outputs: run.measured.clone() })
}

/// The contacts of the cycle measured last.
fn traced(run: &Run) -> BTreeMap<String, JointCycle> {
    let mut joints = BTreeMap::new();
    for state in &run.islands {
        for (k, joint) in state.island.joints.iter().enumerate() {
            let traced = state.recorder.traced.iter().flatten();
            let at = || traced.clone().map(|(_, contacts)| &contacts[k]);
            let cycle = JointCycle {
                time: traced.clone().map(|(time, _)| *time).collect(),
                force: at().map(|contact| contact.force()).collect(),
                sliding: at().map(|contact| contact.sliding()).collect(),
                angle: Some(at().map(|contact| contact.place().1).collect()),
                eccentricity: Some(at().map(|contact| contact.place().0).collect()),
            };
            joints.insert(run.scene.joints[joint.scene_joint].name.clone(), cycle);
        }
    }
    joints
}
