//! Islands of the same make, one per lane: the same bodies, joints and loads, each with numbers of its own.

use super::forces::Acting;
use super::frame::{End, Frame};
use super::island::{Island, WearingJoint};
use super::joint::Touching;
use super::load::IslandLoad;
use super::prescribed::{Prescribed, turned};
use super::table::Jet;
use crate::bore::Bores;
use crate::contact::{Contact, JointForce, JointMotion, LocalHertz, Surface};
use crate::integrate::{Band, Dynamics, Linearised, Scaled};
use crate::lanes::Real;

/// A joint with clearance per lane.
#[derive(Debug, Clone)]
struct PackedJoint<R> {
    ends: [End<R>; 2],
    law: LocalHertz<R>,
    bores: Bores,
}

/// A prescribed body per lane.
#[derive(Debug, Clone)]
struct PackedMotion<R> {
    motions: Vec<Prescribed>,
    position: [R; 2],
    /// Whether it stands still in every lane.
    still: bool,
}

/// The islands.
#[derive(Debug, Clone)]
pub struct Pack<R> {
    bodies: usize,
    joints: Vec<PackedJoint<R>>,
    loads: Vec<IslandLoad<R>>,
    prescribed: Vec<PackedMotion<R>>,
    mass: Vec<R>,
    weight: Vec<R>,
    /// Inverse scales of positions and velocities.
    inverse: Vec<(R, R)>,
    frames: Vec<Frame<R>>,
    jets: Vec<Jet<R>>,
    band: Band,
}

/// Whether an island's motion can be computed in lanes: all its joints have clearance, the local contact law
/// and no memory. Under the foundation nearly all the time goes into each joint's own arc, and ideal joints
/// are eliminated one island at a time.
pub fn packs(island: &Island) -> bool {
    let simple = |joint: &WearingJoint| {
        matches!(joint.contact, Contact::LocalHertz(_)) && joint.contact.surface().restitution.is_none()
    };
    island.constraint_rows() == 0 && island.joints.iter().all(simple)
}

/// Whether two islands that pack have the same make.
pub fn same_make(a: &Island, b: &Island) -> bool {
    let frames = |ends: &[End; 2]| ends.map(|end| end.frame);
    let joint = |a: &WearingJoint, b: &WearingJoint| {
        frames(&a.ends) == frames(&b.ends) && a.profile.points() == b.profile.points()
    };
    a.bodies.len() == b.bodies.len()
        && a.prescribed.len() == b.prescribed.len()
        && a.joints.len() == b.joints.len()
        && a.loads.len() == b.loads.len()
        && a.joints.iter().zip(&b.joints).all(|(a, b)| joint(a, b))
        && a.loads.iter().zip(&b.loads).all(|(a, b)| a.has_make_of(b))
}

impl<R: Real> Pack<R> {
    /// The same island in every lane.
    pub fn of(island: &Island, like: R) -> Self {
        let all = |values: &[f64]| values.iter().map(|&x| like.like(x)).collect::<Vec<R>>();
        let zero = like.zero();
        let joint = |joint: &WearingJoint| PackedJoint {
            ends: joint.ends.map(|end| End { frame: end.frame, arm: end.arm.map(|x| like.like(x)) }),
            law: LocalHertz { surface: Surface::of_lanes(joint.contact.surface(), like) },
            bores: Bores::new(vec![joint.profile.clone(); R::LANES]),
        };
        let motion = |motion: &Prescribed| PackedMotion {
            motions: vec![motion.clone(); R::LANES],
            position: [zero; 2],
            still: false,
        };
        let frame = Frame { x: [zero; 2], angle: zero, cs: [zero; 2], v: [zero; 2], omega: zero };
        let mut pack = Pack {
            bodies: island.bodies.len(),
            joints: island.joints.iter().map(joint).collect(),
            loads: island.loads.iter().map(|load| load.in_lanes(like)).collect(),
            prescribed: island.prescribed.iter().map(motion).collect(),
            mass: all(&island.mass),
            weight: all(&island.weight),
            inverse: vec![(zero, zero); island.coordinates()],
            frames: vec![frame; island.bodies.len() + island.prescribed.len()],
            jets: vec![[zero; 4]; island.prescribed.len()],
            band: island.band(),
        };
        (0..R::LANES).for_each(|lane| pack.set(lane, island));
        pack
    }

    /// Puts an island of the same make into a lane.
    pub fn set(&mut self, lane: usize, island: &Island) {
        for (to, from) in self.joints.iter_mut().zip(&island.joints) {
            for (to, from) in to.ends.iter_mut().zip(&from.ends) {
                to.arm.iter_mut().zip(&from.arm).for_each(|(to, from)| to.set_lane(lane, *from));
            }
            to.law.surface.set_lane(lane, from.contact.surface());
            to.bores.set(lane, &from.profile);
        }
        for (to, from) in self.loads.iter_mut().zip(&island.loads) {
            to.set_lane(lane, from);
        }
        for (to, from) in self.prescribed.iter_mut().zip(&island.prescribed) {
            to.position.iter_mut().zip(from.position()).for_each(|(to, from)| to.set_lane(lane, from));
            to.motions[lane].clone_from(from);
            to.still = to.motions.iter().all(Prescribed::is_still);
        }
        let put = |to: &mut [R], from: &[f64]| {
            to.iter_mut().zip(from).for_each(|(to, from)| to.set_lane(lane, *from));
        };
        put(&mut self.mass, &island.mass);
        put(&mut self.weight, &island.weight);
        let (scale_q, scale_v) = island.scale();
        for ((inverse_q, inverse_v), (q, v)) in self.inverse.iter_mut().zip(scale_q.iter().zip(scale_v)) {
            inverse_q.set_lane(lane, 1.0 / q);
            inverse_v.set_lane(lane, 1.0 / v);
        }
        if self.prescribed.iter().any(|motion| motion.still) {
            self.place_still();
        }
    }

    /// Room for the linearisation.
    pub fn linearised(&self) -> Linearised<R> {
        let zero = self.mass[0].zero();
        Linearised {
            prescribed: vec![[zero; 3]; self.prescribed.len()],
            ..Linearised::new(zero, self.band, self.joints.len())
        }
    }

    fn place_still(&mut self) {
        for (k, motion) in self.prescribed.iter().enumerate().filter(|(_, motion)| motion.still) {
            self.jets[k] = [motion.position[0].zero(); 4];
            self.frames[self.bodies + k] = turned(motion.position, &self.jets[k]);
        }
    }

    #[inline(always)]
    fn place(&mut self, t: R, q: &[R], v: &[R]) {
        for ((frame, q), v) in self.frames.iter_mut().zip(q.chunks_exact(3)).zip(v.chunks_exact(3)) {
            *frame = Frame::free(q, v);
        }
        for (k, motion) in self.prescribed.iter().enumerate().filter(|(_, motion)| !motion.still) {
            let jet = &mut self.jets[k];
            for (lane, motion) in motion.motions.iter().enumerate() {
                let at = motion.jet(t.lane(lane));
                for k in 0..4 {
                    jet[k].set_lane(lane, at[k]);
                }
            }
            self.frames[self.bodies + k] = turned(motion.position, jet);
        }
    }

    #[inline(always)]
    fn acting(&self) -> Acting<'_, R, PackedJoint<R>> {
        Acting {
            joints: &self.joints,
            loads: &self.loads,
            weight: &self.weight,
            frames: &self.frames,
            jets: &self.jets,
        }
    }
}

impl<R: Real> Touching<R> for PackedJoint<R> {
    #[inline(always)]
    fn ends(&self) -> [End<R>; 2] {
        self.ends
    }

    #[inline(always)]
    fn force<const JACOBIAN: bool>(&self, motion: &JointMotion<R>) -> JointForce<R> {
        self.law.force::<JACOBIAN>(&self.bores, motion)
    }
}

impl<R: Real> Dynamics<R> for Pack<R> {
    #[inline(always)]
    fn mass(&self) -> &[R] {
        &self.mass
    }

    #[inline(always)]
    fn force(&mut self, t: R, q: &[R], v: &[R], f: &mut [R]) {
        self.place(t, q, v);
        self.acting().applied::<false>(t, f, &mut Linearised::nothing());
    }

    #[inline(always)]
    fn linearise(&mut self, t: R, q: &[R], v: &[R], at: &mut Linearised<R>) {
        self.place(t, q, v);
        let mut f = std::mem::take(&mut at.f);
        self.acting().applied::<true>(t, &mut f, at);
        at.f = f;
    }
}

impl<R: Real> Scaled<R> for Pack<R> {
    #[inline(always)]
    fn inverse_scales(&self) -> &[(R, R)] {
        &self.inverse
    }
}
