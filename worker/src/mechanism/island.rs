//! Islands: sets of free bodies that influence each other, with the joints and loads that act on them.
//! Islands have no forces in common; each is integrated with its own steps.

use super::closing::IdealJoints;
use super::elimination::Elimination;
use super::extent::least_arm;
use super::forces::{Acting, JointSpace};
use super::frame::{Frame, Placed};
use super::island_frames::IslandFrames;
use super::joint::PairMotion;
use super::load::{IslandLoad, NO_FRAME};
use super::passage::Passage;
use super::piecewise_cubic::Jet;
use super::prescribed::Prescribed;
use super::wearing_guide::WearingGuide;
use super::wearing_joint::{WearingJoint, WearingPair};
use crate::contact::{GuideReaction, JointMotion};
use crate::extremum::{largest, smallest};
use crate::integrate::{Band, Linearised};
use crate::plane::length;
use common::scene::Scene;

/// Free bodies that influence each other, with the joints and loads that act on them.
#[derive(Debug, Clone)]
pub struct Island {
    /// Scene bodies with unknowns; body k owns coordinates 3k..3k+3 (centre of mass, angle).
    pub bodies: Vec<usize>,
    /// Scene bodies with prescribed motion that joints or loads connect to it.
    pub touched: Vec<usize>,
    /// The island's joints with clearance.
    pub joints: Vec<WearingJoint>,
    /// The island's guides with clearance.
    pub guides: Vec<WearingGuide>,
    /// The island's ideal joints, eliminated.
    pub(crate) ideal: Elimination,
    /// Positions in which they become dependent for an instant, if they may.
    pub(super) passage: Option<Box<Passage>>,
    pub(super) prescribed: Vec<Prescribed>,
    pub(super) loads: Vec<IslandLoad>,
    pub(super) mass: Vec<f64>,
    pub(super) weight: Vec<f64>,
    pub(super) scale_q: Vec<f64>,
    pub(super) scale_v: Vec<f64>,
    /// Size of the mechanism [m].
    pub(super) size: f64,
    /// Frames of the free bodies, then of the prescribed ones, at the state last set.
    pub(super) frames: Vec<Frame>,
    /// Angles of the prescribed bodies with their derivatives, at the state last set.
    pub(crate) jets: Vec<Jet>,
    pub(super) space: JointSpace<f64>,
}

impl Island {
    /// The island of these frames with these joints and guides with clearance, without masses, loads and ideal joints; its scales are not
    /// set yet.
    pub(super) fn new(frames: &IslandFrames, joints: Vec<WearingJoint>, guides: Vec<WearingGuide>) -> Self {
        let (bodies, touched) = (frames.bodies().to_vec(), frames.touched().to_vec());
        Island {
            frames: vec![Frame::default(); bodies.len() + touched.len()],
            jets: vec![Jet::default(); touched.len()],
            space: JointSpace::new(&joints, 0.0),
            scale_q: vec![],
            scale_v: vec![],
            size: 0.0,
            bodies,
            touched,
            joints,
            guides,
            ideal: Elimination::new(vec![], &[]),
            passage: None,
            prescribed: frames.prescribed(),
            loads: vec![],
            mass: vec![],
            weight: vec![],
        }
    }

    /// Number of coordinates n.
    pub fn coordinates(&self) -> usize {
        self.mass.len()
    }

    /// Entries of the island's matrices that may differ from zero: all of them if ideal joints couple the
    /// bodies.
    pub(super) fn band(&self) -> Band {
        let n = self.coordinates();
        if self.ideal.rows > 0 && !self.is_large() {
            return Band::new(n, n);
        }
        let contacts = self.joints.iter().map(|j| j.ends.map(|end| end.frame).to_vec());
        let guides = self.guides.iter().map(|g| g.flat.ends.map(|end| end.frame).to_vec());
        let frames = contacts.chain(guides).chain(self.loads.iter().map(IslandLoad::frames));
        let reach = |frames: Vec<usize>| {
            let free = frames.into_iter().filter(|&frame| frame < self.bodies.len());
            let (first, last) = free.fold((usize::MAX, 0), |(a, b), k| (a.min(k), b.max(k)));
            last.saturating_sub(first)
        };
        Band::new(n, 3 * frames.map(reach).max().unwrap_or(0) + 2)
    }

    /// True if every step is explicit, since the ideal joints are many: the island has no derivatives and is never in lanes.
    pub(crate) fn is_large(&self) -> bool {
        self.passage.as_ref().is_some_and(|passage| passage.is_large)
    }

    /// Force in each ideal joint at the state of `at`, in the order of [`Self::ideal`], negative where a cam pulls [N].
    pub(crate) fn ideal_forces<'a>(&'a self, at: &'a Linearised) -> impl Iterator<Item = f64> + 'a {
        let (mut first, mut rubbing) = (0, at.friction.iter());
        self.ideal.constraints.iter().map(move |c| {
            let lambda = &at.lambda[first..first + c.rows()];
            first += c.rows();
            let friction = c.friction.and_then(|_| rubbing.next());
            c.force(lambda, friction.map_or(0.0, |[force, _]| *force))
        })
    }

    /// Storage for [`Linearised`].
    pub fn linearised(&self) -> Linearised {
        Linearised {
            lambda: vec![0.0; self.ideal.rows],
            friction: vec![[0.0; 2]; self.ideal.friction.count()],
            prescribed: vec![[0.0; 3]; self.prescribed.len()],
            guides: vec![GuideReaction::default(); self.guides.len()],
            ..Linearised::new(0.0, self.band(), self.joints.len())
        }
    }

    /// Scales of the local error. With clearance: a length of 1 % of the smallest clearance (the order of the
    /// penetrations) and the speed it gives at the contact's natural frequency; with guides 0.01 % of their clearance, as flat contacts are stiffer. Without: a ten-thousandth of
    /// the island's size, and the speed that covers it in a radian of the cycle. An angle is the length at
    /// the longest arm of its body, from the centre of mass to a joint, or at a tenth of its radius of gyration; the size of the island is the
    /// longest one, those of its drives included.
    pub(super) fn scaled(mut self, scene: &Scene) -> Self {
        const SHARE_OF_CLEARANCE: f64 = 0.01;
        const SHARE_OF_SIZE: f64 = 1e-4;
        const SHARE_OF_GUIDE: f64 = 1e-4;
        let contacts = self.joints.iter().map(|j| j.ends);
        let ends = contacts.chain(self.ideal.constraints.iter().map(|c| c.ends));
        let mut arm: Vec<f64> = self.bodies.iter().map(|&body| least_arm(&scene.bodies[body])).collect();
        let mut longest = 0.0_f64;
        for end in ends.flatten() {
            let is_driven = |motion: &Prescribed| !motion.is_still();
            match end.frame.checked_sub(self.bodies.len()) {
                None => arm[end.frame] = arm[end.frame].max(length(end.arm)),
                Some(k) if is_driven(&self.prescribed[k]) => longest = longest.max(length(end.arm)),
                Some(_) => {}
            }
        }
        for guide in self.guides.iter().map(|guide| &guide.flat) {
            for (end, farthest) in
                guide.ends.iter().zip(guide.arms()).filter(|(e, _)| e.frame < self.bodies.len())
            {
                arm[end.frame] = arm[end.frame].max(farthest);
            }
        }
        self.size = largest(arm.iter().copied()).max(longest);
        let (mut position, mut frequency) =
            (SHARE_OF_SIZE * self.size, std::f64::consts::TAU / scene.life.period);
        if let Some(least) = self.joints.iter().map(|j| j.contact.surface().clearance).min_by(f64::total_cmp)
        {
            position = SHARE_OF_CLEARANCE * least;
            let lightest = smallest(self.mass.iter().step_by(3).copied());
            let stiffest = largest(self.joints.iter().map(|j| j.contact.surface().stiffness));
            frequency = (1.5 * stiffest * position.sqrt() / lightest).sqrt();
        }
        if let Some(least) = self.guides.iter().map(|guide| guide.flat.clearance()).min_by(f64::total_cmp) {
            let own = SHARE_OF_GUIDE * least;
            position = if self.joints.is_empty() { own } else { position.min(own) };
            let lightest = smallest(self.mass.iter().step_by(3).copied());
            let stiffest = largest(self.guides.iter().map(|guide| guide.flat.stiffness()));
            frequency = frequency.max((stiffest / lightest).sqrt());
        }
        for divisor in arm.into_iter().flat_map(|arm| [1.0, 1.0, arm]) {
            self.scale_q.push(position / divisor);
            self.scale_v.push(position * frequency / divisor);
        }
        self
    }

    /// Joints and loads of the island, at the state last set.
    #[inline(always)]
    pub(super) fn acting(&self) -> Acting<'_, f64, WearingJoint, WearingGuide> {
        Acting {
            joints: &self.joints,
            guides: &self.guides,
            loads: &self.loads,
            weight: &self.weight,
            frames: &self.frames,
            jets: &self.jets,
        }
    }

    /// Evaluates all body frames at (t, q, v); later queries refer to this state.
    #[inline(always)]
    pub(crate) fn set_state(&mut self, t: f64, q: &[f64], v: &[f64]) {
        let free = self.bodies.len();
        for (k, frame) in self.frames[..free].iter_mut().enumerate() {
            *frame = Frame::free(&q[3 * k..3 * k + 3], &v[3 * k..3 * k + 3]);
        }
        for ((prescribed, frame), jet) in
            self.prescribed.iter().zip(&mut self.frames[free..]).zip(&mut self.jets)
        {
            *jet = prescribed.jet(t);
            *frame = Frame::turning(prescribed.position, jet);
        }
        self.ideal.update_inputs(t, &self.frames);
    }

    /// Of masses and loads, at the state last set: kinetic energy and potential energy of gravity and springs [J], power lost in dampers [W],
    /// and power of loads without potential [W].
    pub(crate) fn load_power(&self, t: f64, v: &[f64]) -> [f64; 3] {
        let kinetic = v.iter().zip(&self.mass).map(|(v, mass)| 0.5 * mass * v * v).sum();
        let (mut stored, mut lost, mut driving): (f64, f64, f64) = (kinetic, 0.0, 0.0);
        for (slot, weight) in self.weight.chunks_exact(3).enumerate() {
            let x = self.frames[slot].x;
            stored -= weight[0] * x[0] + weight[1] * x[1];
        }
        for source in &self.loads {
            let load = source.force(t, &self.frames);
            stored += load.stored;
            lost += load.lost;
            if source.drives() {
                driving += load.lost;
                for (side, &frame) in load.frames.iter().enumerate().filter(|&(_, &frame)| frame != NO_FRAME)
                {
                    let Frame { v, omega, .. } = self.frames[frame];
                    let f = &load.f[3 * side..];
                    driving += f[0] * v[0] + f[1] * v[1] + f[2] * omega;
                }
            }
        }
        [stored, lost, driving]
    }

    /// Motion of a joint with clearance, at the state last set.
    pub(crate) fn joint_motion(&self, joint: usize) -> JointMotion {
        let [i, j] = self.joints[joint].ends;
        PairMotion::new([i, j], &self.frames[i.frame], &self.frames[j.frame]).motion
    }

    /// Largest penetration in the range of the contact laws, of the joints with clearance and then of the guides [m].
    pub(crate) fn deepest(&self) -> impl Iterator<Item = f64> + '_ {
        let joints = self.joints.iter().map(|joint| joint.contact.surface().deepest());
        joints.chain(self.guides.iter().map(|guide| guide.flat.deepest()))
    }

    /// The joints with clearance, then the guides that wear, as pairs of surfaces.
    pub(crate) fn pairs(&self) -> impl Iterator<Item = &dyn WearingPair> {
        let joints = self.joints.iter().map(|joint| joint as &dyn WearingPair);
        joints.chain(self.guides.iter().filter_map(WearingGuide::pair))
    }

    /// The joints with clearance, then the guides that wear, as pairs of surfaces whose depths can be replaced.
    pub(crate) fn pairs_mut(&mut self) -> impl Iterator<Item = &mut dyn WearingPair> {
        let joints = self.joints.iter_mut().map(|joint| joint as &mut dyn WearingPair);
        joints.chain(self.guides.iter_mut().filter_map(WearingGuide::pair_mut))
    }

    /// True if the island is integrated by itself and never in lanes: if it is large, or a guide of it wears, whose worn faces have no form in
    /// lanes.
    pub(crate) fn is_alone(&self) -> bool {
        self.is_large() || self.guides.iter().any(WearingGuide::wears)
    }

    /// Index into the scene's joints of those with clearance, then of the guides, in the order of their forces.
    pub(crate) fn contacts(&self) -> impl Iterator<Item = usize> + '_ {
        let joints = self.joints.iter().map(|joint| joint.scene_joint);
        joints.chain(self.guides.iter().map(|guide| guide.flat.scene_joint))
    }

    /// Index into the scene's joints of all of them: the contacts, then the ideal ones.
    pub(crate) fn all_joints(&self) -> impl Iterator<Item = usize> + '_ {
        self.contacts().chain(self.ideal.constraints.iter().map(|c| c.scene_joint))
    }
}

impl IdealJoints<f64> for Island {
    #[inline(always)]
    fn place(&mut self, t: f64, q: &[f64], v: &[f64]) {
        self.set_state(t, q, v);
    }

    #[inline(always)]
    fn joints(&mut self) -> (&mut Elimination, Placed<'_>) {
        (&mut self.ideal, Placed { frames: &self.frames, jets: &self.jets })
    }

    #[inline(always)]
    fn size(&self) -> f64 {
        self.size
    }
}
