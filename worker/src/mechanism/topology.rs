//! Topology of a scene: the islands of bodies that influence each other, with their joints and loads.

use super::constraint::first_rows;
use super::coupling::JointInput;
use super::elimination::Elimination;
use super::island_frames::IslandFrames;
use super::load::IslandLoad;
use super::passage::Passage;
use super::{Constraint, Island, WearingGuide, WearingJoint};
use common::failure::SimulationFailure;
use common::scene::{Joint, JointKind, Load, Motion, Scene};

/// Splits a checked scene into its islands, in the order of their first bodies.
///
/// # Errors
/// [`SimulationFailure::NotModelled`] for joints between two prescribed bodies, and for a scene without a
/// mechanism.
pub fn islands(scene: &Scene) -> Result<Vec<Island>, SimulationFailure> {
    if scene.simulator.is_some() {
        let what = "the simulator that the scene names: there is no mechanism".into();
        return Err(SimulationFailure::NotModelled { what });
    }
    let free: Vec<bool> = scene.bodies.iter().map(|b| matches!(b.motion, Motion::Free { .. })).collect();
    for joint in &scene.joints {
        if !free[joint.journal.body] && !free[joint.bushing.body] {
            let what = format!("joint {} connects two bodies whose motion is given", joint.name);
            return Err(SimulationFailure::NotModelled { what });
        }
    }
    // Connected components over free bodies; a root is the first body of its island.
    let mut root: Vec<usize> = (0..scene.bodies.len()).collect();
    fn find(root: &mut [usize], mut k: usize) -> usize {
        while root[k] != k {
            root[k] = root[root[k]];
            k = root[k];
        }
        k
    }
    let joined = scene.joints.iter().map(|j| vec![j.journal.body, j.bushing.body]);
    for bodies in joined.chain(scene.loads.iter().map(Load::bodies)) {
        let mut members = bodies.into_iter().filter(|&b| free[b]);
        if let Some(first) = members.next() {
            for other in members {
                let (a, b) = (find(&mut root, first), find(&mut root, other));
                root[a.max(b)] = a.min(b);
            }
        }
    }
    let first_bodies = (0..scene.bodies.len()).filter(|&b| free[b]);
    let firsts: Vec<usize> = first_bodies.filter(|&b| find(&mut root, b) == b).collect();
    let mut members = |first: usize| -> Vec<usize> {
        (first..scene.bodies.len()).filter(|&b| free[b] && find(&mut root, b) == first).collect()
    };
    Ok(firsts.into_iter().map(|first| assemble(scene, members(first))).collect())
}

/// The joints with clearance of a scene whose cycles a program simulates, as an island without bodies.
pub fn island_of_program(scene: &Scene) -> Island {
    let mut frames = IslandFrames::new(scene, vec![]);
    let (joints, guides, _) = joints_of(scene, &mut frames, |_| true);
    Island::new(&frames, joints, guides)
}

/// Joints and guides with clearance, and ideal joints.
type Joints = (Vec<WearingJoint>, Vec<WearingGuide>, Vec<Constraint>);

/// The joints of a scene that `belong` to an island, with their ends on its `frames`.
fn joints_of(scene: &Scene, frames: &mut IslandFrames, belong: impl Fn(&Joint) -> bool) -> Joints {
    let (mut joints, mut guides, mut ideal) = (Vec::new(), Vec::new(), Vec::new());
    for (index, joint) in scene.joints.iter().enumerate().filter(|(_, joint)| belong(joint)) {
        let ends = [frames.end(&joint.journal), frames.end(&joint.bushing)];
        match &joint.kind {
            JointKind::Clearance(hinge) => joints.push(WearingJoint::new(index, (hinge, &scene.wear), ends)),
            JointKind::Guide(guide) => guides.push(WearingGuide::new(index, guide, ends)),
            kind => ideal.push(Constraint::new(index, ends, kind).with_friction(joint.friction)),
        }
    }
    (joints, guides, ideal)
}

/// The island of the free bodies `bodies` of a scene.
fn assemble(scene: &Scene, bodies: Vec<usize>) -> Island {
    let mut frames = IslandFrames::new(scene, bodies.clone());
    let on_them = |joint: &Joint| [&joint.journal, &joint.bushing].iter().any(|at| bodies.contains(&at.body));
    let (joints, guides, constraints) = joints_of(scene, &mut frames, on_them);
    let acting = scene.loads.iter().filter(|load| load.bodies().iter().any(|b| bodies.contains(b)));
    let loads: Vec<IslandLoad> = acting.map(|load| IslandLoad::new(load, &mut frames)).collect();
    let mut mass = Vec::new();
    let mut weight = Vec::new();
    for &b in &bodies {
        if let Motion::Free { mass: m, inertia, .. } = scene.bodies[b].motion {
            mass.extend([m, m, inertia]);
            weight.extend([m * scene.gravity[0], m * scene.gravity[1], 0.0]);
        }
    }
    let stiff = !(joints.is_empty() && guides.is_empty());
    let inputs: Vec<(usize, JointInput)> = constraints
        .iter()
        .enumerate()
        .filter_map(|(k, c)| Some((k, JointInput::new(&scene.joints[c.scene_joint].kind)?)))
        .collect();
    let passage = if inputs.is_empty() { passage(&constraints, stiff, &loads, &mass) } else { None };
    let ideal = match &passage {
        Some(passage) if passage.is_large => Elimination::without_factors(constraints),
        _ => Elimination::new(constraints, &mass).with_inputs(inputs),
    };
    let island = Island::new(&frames, joints, guides);
    Island { ideal, passage, loads, mass, weight, ..island }.scaled(scene)
}

/// Rows of ideal joints from which an island that may pass singular positions takes explicit steps only, whose cost grows linearly with its
/// bodies: the derivatives that implicit steps need are dense. At this size explicit steps are the cheaper ones by far.
const LARGE: usize = 40;

/// How the island passes positions in which its ideal joints are dependent, if it may: without contacts, which are `stiff`, and without
/// friction, which has no bound there.
fn passage(
    constraints: &[Constraint],
    stiff: bool,
    loads: &[IslandLoad],
    mass: &[f64],
) -> Option<Box<Passage>> {
    if stiff || constraints.iter().any(|c| c.friction.is_some()) {
        return None;
    }
    let is_large = first_rows(constraints).1 >= LARGE && loads.iter().all(IslandLoad::drives);
    Passage::new(constraints, mass, is_large).map(Box::new)
}
