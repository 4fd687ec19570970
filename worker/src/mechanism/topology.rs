//! Who influences whom: splits a scene into islands, and places joints and loads on their frames.

use super::constraint::Constraint;
use super::elimination::Elimination;
use super::frame::End;
use super::island::{Island, Parts, WearingJoint};
use super::load::{IslandLoad, Size, coupled_bodies};
use super::prescribed::Prescribed;
use crate::bore::Profile;
use crate::contact::Contact;
use common::failure::SimulationFailure;
use common::scene::{Attachment, JointKind, Load, Motion, Scene};

/// Splits a checked scene into its islands, in the order of their first bodies.
///
/// # Errors
/// [`SimulationFailure::NotModelled`] for joints between two prescribed bodies, and for a scene without a
/// mechanism.
pub fn islands(scene: &Scene) -> Result<Vec<Island>, SimulationFailure> {
    if scene.simulator.is_some() {
        return Err(SimulationFailure::NotModelled {
            what: "the simulator that the scene names: there is no mechanism".into(),
        });
    }
    let free: Vec<bool> = scene.bodies.iter().map(|b| matches!(b.motion, Motion::Free { .. })).collect();
    for joint in &scene.joints {
        if !free[joint.journal.body] && !free[joint.bushing.body] {
            return Err(SimulationFailure::NotModelled {
                what: format!("joint {} connects two bodies whose motion is given", joint.name),
            });
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
    for bodies in joined.chain(scene.loads.iter().map(coupled_bodies)) {
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
    Ok(firsts.into_iter().map(|first| Place::new(scene, members(first)).island()).collect())
}

/// An island being put together: frames are its free bodies, then the prescribed ones it touches.
pub(super) struct Place<'a> {
    scene: &'a Scene,
    bodies: Vec<usize>,
    frames: Vec<usize>,
}

impl<'a> Place<'a> {
    pub(super) fn new(scene: &'a Scene, bodies: Vec<usize>) -> Self {
        Place { scene, frames: bodies.clone(), bodies }
    }

    fn has(&self, body: usize) -> bool {
        self.bodies.contains(&body)
    }

    pub(super) fn frame(&mut self, body: usize) -> usize {
        self.frames.iter().position(|&b| b == body).unwrap_or_else(|| {
            self.frames.push(body);
            self.frames.len() - 1
        })
    }

    fn end(&mut self, a: &Attachment) -> End {
        let origin = match self.scene.bodies[a.body].motion {
            Motion::Free { centre_of_mass, .. } => centre_of_mass,
            _ => [0.0; 2],
        };
        End { frame: self.frame(a.body), arm: [a.position[0] - origin[0], a.position[1] - origin[1]] }
    }

    fn island(mut self) -> Island {
        let scene = self.scene;
        let mut joints = Vec::new();
        let mut constraints = Vec::new();
        for (index, joint) in scene.joints.iter().enumerate() {
            if !self.has(joint.journal.body) && !self.has(joint.bushing.body) {
                continue;
            }
            let ends = [self.end(&joint.journal), self.end(&joint.bushing)];
            match &joint.kind {
                JointKind::Clearance(clearance) => joints.push(WearingJoint {
                    scene_joint: index,
                    name: joint.name.clone(),
                    contact: Contact::of(clearance),
                    profile: Profile::round(clearance.bushing_radius, clearance.control_points),
                    wear_coefficient: clearance.wear_coefficient,
                    width: clearance.width,
                    wall: clearance.wall,
                    ends,
                }),
                ideal => constraints.push(Constraint::new(index, ends, ideal)),
            }
        }
        let mine = |load: &&Load| coupled_bodies(load).iter().any(|b| self.bodies.contains(b));
        let acting: Vec<&Load> = scene.loads.iter().filter(mine).collect();
        let loads = acting.into_iter().map(|load| self.load(load)).collect();
        let mut mass = Vec::new();
        let mut weight = Vec::new();
        for &b in &self.bodies {
            if let Motion::Free { mass: m, inertia, .. } = scene.bodies[b].motion {
                mass.extend([m, m, inertia]);
                weight.extend([m * scene.gravity[0], m * scene.gravity[1], 0.0]);
            }
        }
        let touched = self.touched().to_vec();
        let prescribed = touched.iter().filter_map(|&b| Prescribed::of(&scene.bodies[b])).collect();
        let ideal = Elimination::new(constraints, &mass);
        let bodies = self.bodies;
        let island = Island::new(Parts { bodies, touched, joints, ideal, prescribed, loads, mass, weight });
        island.scaled(scene)
    }

    /// Prescribed bodies whose frames have been asked for.
    pub(super) fn touched(&self) -> &[usize] {
        &self.frames[self.bodies.len()..]
    }

    /// The load, with its places among the frames.
    pub(super) fn load(&mut self, load: &Load) -> IslandLoad {
        match load {
            Load::DirectionalSpring { at, anchor, direction, stiffness, free_length, .. } => {
                IslandLoad::DirectionalSpring {
                    ends: [self.end(at), self.end(anchor)],
                    direction: *direction,
                    stiffness: *stiffness,
                    free_length: *free_length,
                }
            }
            Load::Spring { a, b, stiffness, damping, free_length, .. } => IslandLoad::Spring {
                ends: [self.end(a), self.end(b)],
                stiffness: *stiffness,
                damping: *damping,
                free_length: *free_length,
            },
            Load::TorsionSpring { a, b, stiffness, damping, free_angle, .. } => IslandLoad::TorsionSpring {
                frames: [self.frame(*a), self.frame(*b)],
                stiffness: *stiffness,
                damping: *damping,
                free_angle: *free_angle,
            },
            Load::ConstantForce { at, force, .. } => {
                let size = libm::hypot(force[0], force[1]);
                let direction = if size > 0.0 { force.map(|x| x / size) } else { [0.0; 2] };
                IslandLoad::Force { end: self.end(at), direction, size: Size::Constant(size) }
            }
            Load::ConstantTorque { body, torque, .. } => {
                IslandLoad::Torque { frame: self.frame(*body), size: Size::Constant(*torque) }
            }
            Load::VariableForce { at, direction, size, .. } => IslandLoad::Force {
                end: self.end(at),
                direction: *direction,
                size: Size::of(size, |body| self.frame(body)),
            },
            Load::VariableTorque { body, torque, .. } => IslandLoad::Torque {
                frame: self.frame(*body),
                size: Size::of(torque, |body| self.frame(body)),
            },
            Load::Motor { body, stall_torque, no_load_speed, .. } => IslandLoad::Motor {
                frame: self.frame(*body),
                stall_torque: *stall_torque,
                no_load_speed: *no_load_speed,
            },
        }
    }
}
