//! One cycle of a mechanism on given surfaces, with the contacts of every time step: the built-in mechanics for a program that wears the
//! surfaces itself.

use super::{LaneQueue, Run, Simulated, assemble, run_alone};
use crate::contact::GuideReaction;
use crate::mechanism::moved_to_origin;
use crate::plane::length;
use common::accuracy::Accuracy;
use common::external::{CycleContacts, JointCycle};
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
) -> Simulated<ServedCycle> {
    let local = moved_to_origin(scene);
    let scene = local.as_ref().map_or(scene, |(local, _)| local);
    run_alone(|queue| on_surfaces(queue, scene, accuracy, depths))
}

async fn on_surfaces(
    queue: LaneQueue,
    scene: &Scene,
    accuracy: &Accuracy,
    depths: &BTreeMap<String, Vec<f64>>,
) -> Simulated<ServedCycle> {
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
        let states = state.recorder.traced.as_deref().unwrap_or_default();
        let time: Vec<f64> = states.iter().map(|state| state.time).collect();
        for (k, joint) in state.island.joints.iter().enumerate() {
            let at = || states.iter().map(|state| &state.contacts[k]);
            let force: Vec<[f64; 2]> = at().map(|contact| contact.force()).collect();
            let cycle = JointCycle {
                time: time.clone(),
                normal: force.iter().map(|force| length(*force)).collect(),
                sliding: at().map(|contact| contact.sliding()).collect(),
                contacts: CycleContacts::Bore {
                    force,
                    angle: Some(at().map(|contact| contact.turn).collect()),
                    eccentricity: Some(at().map(|contact| contact.e).collect()),
                },
            };
            joints.insert(run.scene.joints[joint.scene_joint].name.clone(), cycle);
        }
        for (k, guide) in state.island.guides.iter().enumerate().filter(|(_, guide)| guide.wears()) {
            let at = || states.iter().map(|state| &state.guides[k]);
            let normal = |of: &GuideReaction| of.normal[0] + of.normal[1];
            let sliding = |of: &GuideReaction| {
                let normal = normal(of);
                if normal > 0.0 { (of.rubbing[0] + of.rubbing[1]) / normal } else { 0.0 }
            };
            let load = |of: &GuideReaction| [of.normal, of.moment].map(|[left, right]| left - right);
            let cycle = JointCycle {
                time: time.clone(),
                normal: at().map(normal).collect(),
                sliding: at().map(sliding).collect(),
                contacts: CycleContacts::Guide {
                    load: at().map(load).collect(),
                    position: at().map(|guide| guide.position).collect(),
                },
            };
            joints.insert(run.scene.joints[guide.flat.scene_joint].name.clone(), cycle);
        }
    }
    joints
}
