//! A set of free bodies that influence one another, with the joints and loads that act on them. Islands have
//! no forces in common and are integrated each with its own steps.

use super::frame::Frame;
use super::joint::pair_force;
use super::prescribed::Prescribed;
use crate::bore::Profile;
use crate::contact::Contact;
use crate::integrate::{Dynamics, Linearised};
use common::failure::SimulationFailure;
use common::scene::{Attachment, JointKind, Load, Motion, Scene};

/// One end of a joint or load: which frame of the island, and where in it.
#[derive(Debug, Clone, Copy, PartialEq)]
struct End {
    frame: usize,
    /// From the frame's reference point, in the body's axes [m].
    arm: [f64; 2],
}

/// A joint with clearance and its bore.
#[derive(Debug, Clone)]
pub struct WearingJoint {
    /// Index into the scene's joints.
    pub scene_joint: usize,
    /// Name.
    pub name: String,
    /// Contact law.
    pub contact: Contact,
    /// The bore as worn so far.
    pub profile: Profile,
    /// Wear coefficient [1/Pa].
    pub wear_coefficient: f64,
    /// Width [m].
    pub width: f64,
    journal: End,
    bushing: End,
}

impl WearingJoint {
    /// Replaces the bore's wear.
    pub fn set_depth(&mut self, depth: &[f64]) {
        self.profile.set_depth(depth);
        self.contact.profile_changed(&self.profile);
    }
}

#[derive(Debug, Clone)]
enum IslandLoad {
    Spring { at: End, anchor: End, direction: [f64; 2], stiffness: f64, free_length: f64 },
    Force { at: End, force: [f64; 2] },
    Torque { frame: usize, torque: f64 },
}

/// The other end of a load that acts on one body only.
const NOBODY: usize = usize::MAX;

/// The island.
#[derive(Debug, Clone)]
pub struct Island {
    /// Scene bodies with unknowns; body k owns coordinates 3k..3k+3 (centre of mass, angle).
    pub bodies: Vec<usize>,
    /// Joints with clearance.
    pub joints: Vec<WearingJoint>,
    prescribed: Vec<Prescribed>,
    loads: Vec<IslandLoad>,
    mass: Vec<f64>,
    weight: Vec<f64>,
    scale_q: Vec<f64>,
    scale_v: Vec<f64>,
}

/// Splits a checked scene into its islands, in the order of their first bodies.
///
/// # Errors
/// [`SimulationFailure::NotModelled`] for ideal joints, and joints between two prescribed bodies.
pub fn islands(scene: &Scene) -> Result<Vec<Island>, SimulationFailure> {
    let free: Vec<bool> = scene.bodies.iter().map(|b| matches!(b.motion, Motion::Free { .. })).collect();
    // Connected components over free bodies.
    let mut root: Vec<usize> = (0..scene.bodies.len()).collect();
    fn find(root: &mut [usize], mut k: usize) -> usize {
        while root[k] != k {
            root[k] = root[root[k]];
            k = root[k];
        }
        k
    }
    let pairs = scene.joints.iter().map(|j| (j.journal.body, j.bushing.body)).chain(
        scene.loads.iter().filter_map(|l| match l {
            Load::DirectionalSpring { at, anchor, .. } => Some((at.body, anchor.body)),
            _ => None,
        }),
    );
    for (a, b) in pairs.filter(|&(a, b)| free[a] && free[b]) {
        let (a, b) = (find(&mut root, a), find(&mut root, b));
        root[a.max(b)] = a.min(b);
    }
    for joint in &scene.joints {
        if !free[joint.journal.body] && !free[joint.bushing.body] {
            return Err(SimulationFailure::NotModelled {
                what: format!("joint {} connects two bodies whose motion is given", joint.name),
            });
        }
    }
    let mut islands = Vec::new();
    for first in 0..scene.bodies.len() {
        if free[first] && find(&mut root, first) == first {
            let members: Vec<usize> =
                (first..scene.bodies.len()).filter(|&b| free[b] && find(&mut root, b) == first).collect();
            islands.push(Island::new(scene, members)?);
        }
    }
    Ok(islands)
}

impl Island {
    fn new(scene: &Scene, bodies: Vec<usize>) -> Result<Self, SimulationFailure> {
        let mut frames = bodies.clone();
        let mut prescribed = Vec::new();
        let mut end = |a: &Attachment| -> End {
            let frame = frames.iter().position(|&b| b == a.body).unwrap_or_else(|| {
                frames.push(a.body);
                prescribed.extend(Prescribed::of(&scene.bodies[a.body]));
                frames.len() - 1
            });
            let origin = match scene.bodies[a.body].motion {
                Motion::Free { centre_of_mass, .. } => centre_of_mass,
                _ => [0.0; 2],
            };
            End { frame, arm: [a.position[0] - origin[0], a.position[1] - origin[1]] }
        };
        let mine = |body: usize| bodies.contains(&body);
        let mut joints = Vec::new();
        for (index, joint) in scene.joints.iter().enumerate() {
            if !mine(joint.journal.body) && !mine(joint.bushing.body) {
                continue;
            }
            let JointKind::Clearance(clearance) = &joint.kind else {
                return Err(SimulationFailure::NotModelled {
                    what: format!("joint {}: the dynamics of ideal joints", joint.name),
                });
            };
            joints.push(WearingJoint {
                scene_joint: index,
                name: joint.name.clone(),
                contact: Contact::of(clearance),
                profile: Profile::round(clearance.bushing_radius, clearance.control_points),
                wear_coefficient: clearance.wear_coefficient,
                width: clearance.width,
                journal: end(&joint.journal),
                bushing: end(&joint.bushing),
            });
        }
        let mut loads = Vec::new();
        for load in &scene.loads {
            match load {
                Load::DirectionalSpring { at, anchor, direction, stiffness, free_length, .. }
                    if mine(at.body) || mine(anchor.body) =>
                {
                    loads.push(IslandLoad::Spring {
                        at: end(at),
                        anchor: end(anchor),
                        direction: *direction,
                        stiffness: *stiffness,
                        free_length: *free_length,
                    });
                }
                Load::ConstantForce { at, force, .. } if mine(at.body) => {
                    loads.push(IslandLoad::Force { at: end(at), force: *force });
                }
                Load::ConstantTorque { body, torque, .. } if mine(*body) => {
                    let frame = bodies.iter().position(|b| b == body).unwrap_or(0);
                    loads.push(IslandLoad::Torque { frame, torque: *torque });
                }
                _ => {}
            }
        }
        let mut mass = Vec::new();
        let mut weight = Vec::new();
        for &b in &bodies {
            if let Motion::Free { mass: m, inertia, .. } = scene.bodies[b].motion {
                mass.extend([m, m, inertia]);
                weight.extend([m * scene.gravity[0], m * scene.gravity[1], 0.0]);
            }
        }
        let mut island = Island {
            scale_q: vec![1.0; mass.len()],
            scale_v: vec![1.0; mass.len()],
            bodies,
            joints,
            prescribed,
            loads,
            mass,
            weight,
        };
        island.set_scales(scene);
        Ok(island)
    }

    /// Number of coordinates.
    pub fn coordinates(&self) -> usize {
        self.mass.len()
    }

    /// Scales of the local error: a length of 1 % of the smallest clearance (the order of the penetrations) and
    /// the speed it gives at the contact's natural frequency; an angle is that length at the longest arm.
    fn set_scales(&mut self, scene: &Scene) {
        const SHARE_OF_CLEARANCE: f64 = 0.01;
        let period = scene.life.period;
        let (mut length, mut frequency) = (1e-3_f64, 1.0 / period);
        if let Some(smallest) =
            self.joints.iter().map(|j| j.contact.surface().clearance).min_by(f64::total_cmp)
        {
            length = SHARE_OF_CLEARANCE * smallest;
            let lightest = self.mass.iter().step_by(3).copied().fold(f64::INFINITY, f64::min);
            let stiffest = self.joints.iter().map(|j| j.contact.surface().stiffness).fold(0.0, f64::max);
            frequency = (1.5 * stiffest * length.sqrt() / lightest).sqrt();
        }
        let ends = self.joints.iter().flat_map(|j| [j.journal, j.bushing]);
        let mut arm = vec![1e-6_f64; self.bodies.len()];
        for end in ends.filter(|e| e.frame < self.bodies.len()) {
            let a = (end.arm[0] * end.arm[0] + end.arm[1] * end.arm[1]).sqrt();
            arm[end.frame] = arm[end.frame].max(a);
        }
        for (slot, arm) in arm.iter().enumerate() {
            for (k, divisor) in [1.0, 1.0, *arm].into_iter().enumerate() {
                self.scale_q[3 * slot + k] = length / divisor;
                self.scale_v[3 * slot + k] = length * frequency / divisor;
            }
        }
    }

    #[inline]
    fn frame(&self, index: usize, t: f64, q: &[f64], v: &[f64]) -> Frame {
        let k = 3 * index;
        if index < self.bodies.len() {
            Frame::free(&q[k..k + 3], &v[k..k + 3])
        } else {
            self.prescribed[index - self.bodies.len()].at(t)
        }
    }

    #[inline]
    fn assemble<const JACOBIAN: bool>(
        &self,
        t: f64,
        q: &[f64],
        v: &[f64],
        f: &mut [f64],
        at: &mut Linearised,
    ) {
        let n = self.mass.len();
        f.copy_from_slice(&self.weight);
        if JACOBIAN {
            at.k.fill(0.0);
            at.d.fill(0.0);
            at.ft.fill(0.0);
        }
        let mut add = |ends: [usize; 2],
                       force: &[f64; 6],
                       k: &[[f64; 6]; 6],
                       d: &[[f64; 6]; 6],
                       at: &mut Linearised| {
            for (side, &frame) in ends.iter().enumerate() {
                if frame >= self.bodies.len() {
                    continue;
                }
                for r in 0..3 {
                    let row = 3 * frame + r;
                    f[row] += force[3 * side + r];
                    if !JACOBIAN {
                        continue;
                    }
                    for (other, &to) in ends.iter().enumerate() {
                        if to == NOBODY {
                            continue;
                        }
                        if to < self.bodies.len() {
                            for c in 0..3 {
                                at.k[row * n + 3 * to + c] += k[3 * side + r][3 * other + c];
                                at.d[row * n + 3 * to + c] += d[3 * side + r][3 * other + c];
                            }
                        } else {
                            // A prescribed body only turns.
                            let [_, omega, alpha, _] = self.prescribed[to - self.bodies.len()].jet(t);
                            at.ft[row] += k[3 * side + r][3 * other + 2] * omega
                                + d[3 * side + r][3 * other + 2] * alpha;
                        }
                    }
                }
            }
        };
        for (index, joint) in self.joints.iter().enumerate() {
            let (i, j) = (joint.journal, joint.bushing);
            let pair = pair_force::<JACOBIAN>(
                &joint.contact,
                &joint.profile,
                &self.frame(i.frame, t, q, v),
                i.arm,
                &self.frame(j.frame, t, q, v),
                j.arm,
            );
            add([i.frame, j.frame], &pair.f, &pair.k, &pair.d, at);
            if JACOBIAN {
                at.joints[index] = pair.joint;
                at.e[index] = pair.e;
            }
        }
        for load in &self.loads {
            let (ends, force, k) = self.load_force(load, t, q, v);
            add(ends, &force, &k, &[[0.0; 6]; 6], at);
        }
    }

    /// Generalised force of a load on its two frames, and its derivative to their coordinates.
    #[inline]
    fn load_force(
        &self,
        load: &IslandLoad,
        t: f64,
        q: &[f64],
        v: &[f64],
    ) -> ([usize; 2], [f64; 6], [[f64; 6]; 6]) {
        let mut k = [[0.0; 6]; 6];
        match *load {
            IslandLoad::Spring { at, anchor, direction: d, stiffness, free_length } => {
                let (fa, fb) = (self.frame(at.frame, t, q, v), self.frame(anchor.frame, t, q, v));
                let (a, b) = (fa.turn(at.arm), fb.turn(anchor.arm));
                let y = d[0] * (fa.x[0] + a[0] - fb.x[0] - b[0]) + d[1] * (fa.x[1] + a[1] - fb.x[1] - b[1]);
                // Gradient of y to the six coordinates: the force is -stiffness (y - y0) times it.
                let g = [d[0], d[1], a[0] * d[1] - a[1] * d[0], -d[0], -d[1], -(b[0] * d[1] - b[1] * d[0])];
                let pull = -stiffness * (y - free_length);
                for r in 0..6 {
                    for c in 0..6 {
                        k[r][c] = -stiffness * g[r] * g[c];
                    }
                }
                k[2][2] -= pull * (a[0] * d[0] + a[1] * d[1]);
                k[5][5] += pull * (b[0] * d[0] + b[1] * d[1]);
                ([at.frame, anchor.frame], g.map(|g| pull * g), k)
            }
            IslandLoad::Force { at, force } => {
                let a = self.frame(at.frame, t, q, v).turn(at.arm);
                k[2][2] = -(a[0] * force[0] + a[1] * force[1]);
                let torque = a[0] * force[1] - a[1] * force[0];
                ([at.frame, NOBODY], [force[0], force[1], torque, 0.0, 0.0, 0.0], k)
            }
            IslandLoad::Torque { frame, torque } => ([frame, NOBODY], [0.0, 0.0, torque, 0.0, 0.0, 0.0], k),
        }
    }
}

impl Dynamics for Island {
    fn mass(&self) -> &[f64] {
        &self.mass
    }

    fn force(&self, t: f64, q: &[f64], v: &[f64], f: &mut [f64]) {
        self.assemble::<false>(t, q, v, f, &mut Linearised::default());
    }

    fn linearise(&self, t: f64, q: &[f64], v: &[f64], at: &mut Linearised) {
        let mut f = std::mem::take(&mut at.f);
        self.assemble::<true>(t, q, v, &mut f, at);
        at.f = f;
    }

    fn scales(&self) -> (&[f64], &[f64]) {
        (&self.scale_q, &self.scale_v)
    }

    fn blamed(&self, coordinate: usize, at: &Linearised) -> Option<usize> {
        let on = |end: End| end.frame == coordinate / 3;
        (0..self.joints.len())
            .filter(|&k| on(self.joints[k].journal) || on(self.joints[k].bushing))
            .max_by(|&a, &b| at.joints[a].normal.total_cmp(&at.joints[b].normal))
    }

    fn in_range(&self, at: &Linearised) -> Result<(), (usize, f64)> {
        for (k, (joint, force)) in self.joints.iter().zip(&at.joints).enumerate() {
            // Beyond a tenth of its radius a journal is not in contact with a bore any more, in any sense of Hertz.
            if force.penetration > 0.1 * joint.contact.surface().journal_radius {
                return Err((k, force.penetration));
            }
        }
        Ok(())
    }
}
