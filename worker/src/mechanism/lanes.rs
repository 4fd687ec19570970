//! Islands of identical topology, one per SIMD lane: the same bodies, joints and loads with different
//! numbers.

use super::closing::IdealJoints;
use super::effective_mass::begun;
use super::elimination::Elimination;
use super::forces::{Acting, JointSpace};
use super::frame::Placed;
use super::joint::Touching;
use super::load::IslandLoad;
use super::piecewise_cubic::Jet;
use super::{End, Frame, Guide, Island, Prescribed, WearingJoint};
use crate::contact::{GuideReaction, LawLanes};
use crate::integrate::{Band, Dynamics, Linearised, SteppedLanes};
use crate::lanes::{Lanewise, Real};
use std::mem::discriminant;

/// One joint with clearance per lane: its ends, and its contact law on its surfaces.
type JointLanes<R> = ([End<R>; 2], LawLanes<R>);

/// One prescribed body per lane.
#[derive(Debug, Clone)]
struct PrescribedLanes<R> {
    motions: Vec<Prescribed>,
    /// Position of the reference point `(2,)` [m].
    position: [R; 2],
    /// Whether the body is fixed in every lane.
    still: bool,
    /// Angle at time zero [rad] and angular velocity [rad/s], if every lane turns evenly.
    even: Option<[R; 2]>,
}

/// One island per lane.
#[derive(Debug, Clone)]
pub struct IslandLanes<R: Real> {
    /// Number of free bodies.
    bodies: usize,
    joints: Vec<JointLanes<R>>,
    guides: Vec<Guide<R>>,
    loads: Vec<IslandLoad<R>>,
    prescribed: Vec<PrescribedLanes<R>>,
    /// The islands' ideal joints, eliminated.
    ideal: Elimination<R>,
    /// Whether these may become dependent for an instant, where an island by itself passes.
    may_be_singular: bool,
    /// Size of the mechanisms [m].
    size: R,
    /// Diagonal of the mass matrix `(n,)` [kg, kg m^2].
    mass: Vec<R>,
    /// Weight of the free bodies `(n,)` [N, N m].
    weight: Vec<R>,
    /// Inverse scales of positions and velocities `(n, 2)`.
    inverse: Vec<(R, R)>,
    frames: Vec<Frame<R>>,
    jets: Vec<Jet<R>>,
    space: JointSpace<R>,
    /// In the place of a linearisation where none is computed.
    no_linearisation: Linearised<R>,
    band: Band,
}

/// Whether two islands fit the lanes of one [`IslandLanes`].
pub(crate) fn same_topology(a: &Island, b: &Island) -> bool {
    let joint = |a: &WearingJoint, b: &WearingJoint| {
        a.ends.has_same_topology(&b.ends)
            && a.profile.points() == b.profile.points()
            && a.journal.is_some() == b.journal.is_some()
            && discriminant(&a.contact) == discriminant(&b.contact)
            && a.contact.surface().has_same_topology(b.contact.surface())
    };
    a.bodies.len() == b.bodies.len()
        && a.prescribed.len() == b.prescribed.len()
        && a.joints.len() == b.joints.len()
        && a.guides.len() == b.guides.len()
        && a.loads.len() == b.loads.len()
        && a.joints.iter().zip(&b.joints).all(|(a, b)| joint(a, b))
        && a.guides.iter().zip(&b.guides).all(|(a, b)| a.flat.has_same_topology(&b.flat))
        && a.loads.iter().zip(&b.loads).all(|(a, b)| a.has_same_topology(b))
        && a.ideal.has_same_topology(&b.ideal)
        && a.passage.is_some() == b.passage.is_some()
}

impl<R: Real> IslandLanes<R> {
    /// `island` in every lane; `like` sets the number of lanes.
    pub(crate) fn new(island: &Island, like: R) -> Self {
        let all = |values: &[f64]| values.iter().map(|x| x.in_lanes(like)).collect::<Vec<R>>();
        let zero = like.zero();
        let joint = |joint: &WearingJoint| {
            (joint.ends.in_lanes(like), LawLanes::new(&joint.contact, joint.surfaces(), like))
        };
        let motion = |motion: &Prescribed| PrescribedLanes {
            motions: vec![motion.clone(); R::LANES],
            position: motion.position.in_lanes(like),
            still: motion.is_still(),
            even: None,
        };
        let frame = Frame { x: [zero; 2], angle: zero, cs: [zero; 2], v: [zero; 2], omega: zero };
        let mut lanes = IslandLanes {
            bodies: island.bodies.len(),
            joints: island.joints.iter().map(joint).collect(),
            guides: island.guides.iter().map(|guide| guide.flat.in_lanes(like)).collect(),
            loads: island.loads.iter().map(|load| load.in_lanes(like)).collect(),
            prescribed: island.prescribed.iter().map(motion).collect(),
            ideal: island.ideal.in_lanes(like),
            may_be_singular: island.passage.is_some(),
            size: like.like(island.size),
            mass: all(&island.mass),
            weight: all(&island.weight),
            inverse: vec![(zero, zero); island.coordinates()],
            frames: vec![frame; island.bodies.len() + island.prescribed.len()],
            jets: vec![[zero; 4]; island.prescribed.len()],
            space: JointSpace { pairs: vec![], walls: vec![] },
            no_linearisation: Linearised::new(like, Band::default(), 0),
            band: island.band(),
        };
        (0..R::LANES).for_each(|lane| lanes.set(lane, island));
        lanes.space = JointSpace::new(&lanes.joints, like);
        (0..R::LANES).for_each(|lane| lanes.leave_idle(lane));
        lanes
    }

    /// Leaves lane `lane` idle until [`Self::set`] replaces it: its numbers stay finite and mean nothing.
    pub(crate) fn leave_idle(&mut self, lane: usize) {
        self.joints.iter_mut().for_each(|(_, law)| law.leave_idle(lane));
    }

    /// Replaces lane `lane` by an island of the same topology.
    pub(crate) fn set(&mut self, lane: usize, island: &Island) {
        for (to, from) in self.joints.iter_mut().zip(&island.joints) {
            from.ends.write_lane::<R>(lane, &mut to.0);
            to.1.set(lane, &from.contact, from.surfaces());
        }
        for (to, from) in self.guides.iter_mut().zip(&island.guides) {
            from.flat.write_lane::<R>(lane, to);
        }
        for (to, from) in self.loads.iter_mut().zip(&island.loads) {
            from.write_lane::<R>(lane, to);
        }
        for (to, from) in self.prescribed.iter_mut().zip(&island.prescribed) {
            from.position.write_lane::<R>(lane, &mut to.position);
            to.motions[lane].clone_from(from);
            to.still = to.motions.iter().all(Prescribed::is_still);
            to.even = even_rotation(&to.motions, to.position[0]);
        }
        island.ideal.write_lane(lane, &mut self.ideal);
        self.size.set_lane(lane, island.size);
        for (to, from) in [(&mut self.mass, &island.mass), (&mut self.weight, &island.weight)] {
            to.iter_mut().zip(from).for_each(|(to, from)| from.write_lane::<R>(lane, to));
        }
        let scales = island.scale_q.iter().zip(&island.scale_v);
        for ((inverse_q, inverse_v), (q, v)) in self.inverse.iter_mut().zip(scales) {
            inverse_q.set_lane(lane, 1.0 / q);
            inverse_v.set_lane(lane, 1.0 / v);
        }
        self.update_still_frames();
    }

    /// One in lanes where a joint of the islands linearised as `at` is deeper than its contact law allows, else zero.
    #[inline(always)]
    pub(crate) fn outside(&self, at: &Linearised<R>) -> R {
        let zero = self.size.zero();
        let mut outside = zero;
        for index in 0..self.joints.len() {
            let deepest = self.joints[index].1.surface().deepest();
            outside = R::select(deepest.below(at.joints[index].penetration), zero.like(1.0), outside);
        }
        for index in 0..self.guides.len() {
            let (deepest, now) = (self.guides[index].deepest(), &at.guides[index]);
            outside = R::select(deepest.below(now.deepest()), zero.like(1.0), outside);
            outside = R::select(zero.below(now.beyond), zero.like(1.0), outside);
        }
        outside
    }

    /// Writes what the contact laws of a lane remember into its island.
    pub(crate) fn read_memory(&self, lane: usize, island: &mut Island) {
        for (from, to) in self.joints.iter().zip(&mut island.joints) {
            to.set_damping(from.1.surface().damping.lane(lane));
        }
        for (from, to) in self.guides.iter().zip(&mut island.guides) {
            to.flat.damping = from.damping.map(|damping| damping.lane(lane));
        }
    }

    /// Storage for the linearisation.
    pub(crate) fn linearised(&self) -> Linearised<R> {
        let zero = self.mass[0].zero();
        Linearised {
            lambda: vec![zero; self.ideal.rows],
            friction: vec![[zero; 2]; self.ideal.friction.count()],
            prescribed: vec![[zero; 3]; self.prescribed.len()],
            guides: vec![GuideReaction::none(zero); self.guides.len()],
            ..Linearised::new(zero, self.band, self.joints.len())
        }
    }

    /// Evaluates the frames of the bodies that are fixed in every lane.
    fn update_still_frames(&mut self) {
        for (k, motion) in self.prescribed.iter().enumerate().filter(|(_, motion)| motion.still) {
            self.jets[k] = [motion.position[0].zero(); 4];
            self.frames[self.bodies + k] = Frame::turning(motion.position, &self.jets[k]);
        }
    }

    /// Evaluates the other frames at (t, q, v).
    #[inline(always)]
    fn update_frames(&mut self, t: R, q: &[R], v: &[R]) {
        for ((frame, q), v) in self.frames.iter_mut().zip(q.chunks_exact(3)).zip(v.chunks_exact(3)) {
            *frame = Frame::free(q, v);
        }
        for (k, motion) in self.prescribed.iter().enumerate().filter(|(_, motion)| !motion.still) {
            let jet = &mut self.jets[k];
            if let Some([start, speed]) = motion.even {
                *jet = [start.plus_product(speed, t), speed, t.zero(), t.zero()];
            } else {
                for (lane, motion) in motion.motions.iter().enumerate() {
                    motion.jet(t.lane(lane)).write_lane::<R>(lane, jet);
                }
            }
            self.frames[self.bodies + k] = Frame::turning(motion.position, jet);
        }
        self.ideal.update_inputs(t, &self.frames);
    }

    /// What [`Dynamics::force`] does.
    #[inline(always)]
    pub(super) fn add_forces(&mut self, t: R, [q, v]: [&[R]; 2], f: &mut [R]) {
        self.update_frames(t, q, v);
        let (acting, space, none) = self.acting();
        acting.applied::<false>(t, space, f, none);
        if self.ideal.rows > 0 {
            let (ideal, at) = self.joints();
            ideal.add_reactions(at, f);
        }
    }

    /// What [`Dynamics::linearise`] does.
    #[inline(always)]
    pub(super) fn add_derivatives(&mut self, t: R, [q, v]: [&[R]; 2], at: &mut Linearised<R>) {
        self.update_frames(t, q, v);
        let mut f = std::mem::take(&mut at.f);
        let (acting, space, _) = self.acting();
        acting.applied::<true>(t, space, &mut f, at);
        at.f = f;
        if self.ideal.rows > 0 {
            let (ideal, placed) = self.joints();
            let [independent, balanced] = ideal.add_reactions(placed, &mut at.f);
            ideal.reduce_derivatives(placed, at);
            let apart = if self.may_be_singular { self.ideal.factors.apart } else { independent };
            // Near singular positions an island is integrated by itself.
            (at.independent, at.balanced) = (Some(independent * apart), Some(balanced));
        }
    }

    /// Joints and loads of the islands at the state last set, the space that their forces take, and what takes the place of a linearisation
    /// where none is computed.
    #[inline(always)]
    #[expect(clippy::type_complexity, reason = "parts of one value, taken apart where they are used")]
    fn acting(&mut self) -> (Acting<'_, R, JointLanes<R>, Guide<R>>, &mut JointSpace<R>, &mut Linearised<R>) {
        let IslandLanes { joints, guides, loads, weight, frames, jets, .. } = self;
        let acting = Acting { joints, guides, loads, weight, frames, jets };
        (acting, &mut self.space, &mut self.no_linearisation)
    }
}

/// Angle at time zero [rad] and angular velocity [rad/s] of these motions, if all of them turn evenly; `like` sets the number of lanes.
fn even_rotation<R: Real>(motions: &[Prescribed], like: R) -> Option<[R; 2]> {
    let all: Option<Vec<[f64; 2]>> = motions.iter().map(Prescribed::even_rotation).collect();
    all.map(|all| [0, 1].map(|k| like.each(|lane| all[lane][k])))
}

impl<R: Real> Touching<R> for JointLanes<R> {
    #[inline(always)]
    fn parts(&self) -> ([End<R>; 2], &LawLanes<R>) {
        (self.0, &self.1)
    }
}

impl<R: Real> IdealJoints<R> for IslandLanes<R> {
    #[inline(always)]
    fn place(&mut self, t: R, q: &[R], v: &[R]) {
        self.update_frames(t, q, v);
    }

    #[inline(always)]
    fn joints(&mut self) -> (&mut Elimination<R>, Placed<'_, R>) {
        (&mut self.ideal, Placed { frames: &self.frames, jets: &self.jets })
    }

    #[inline(always)]
    fn size(&self) -> R {
        self.size
    }
}

impl<R: Real> Dynamics<R> for IslandLanes<R> {
    #[inline(always)]
    fn mass(&self) -> &[R] {
        &self.mass
    }

    #[inline(always)]
    fn force(&mut self, t: R, q: &[R], v: &[R], f: &mut [R]) {
        t.apart((self, t, [q, v], f));
    }

    #[inline(always)]
    fn linearise(&mut self, t: R, q: &[R], v: &[R], at: &mut Linearised<R>) {
        t.apart((self, t, [q, v], at));
    }
}

impl<R: Real> SteppedLanes<R> for IslandLanes<R> {
    #[inline(always)]
    fn is_constrained(&self) -> bool {
        self.ideal.rows > 0
    }

    #[inline(always)]
    fn begins_contacts(&self) -> bool {
        !self.guides.is_empty()
    }

    #[inline(always)]
    fn begun(&mut self, before: &Linearised<R>, h: R, t: R, q: &[R], v: &[R]) -> R {
        self.update_frames(t, q, v);
        begun(&self.guides, &self.frames, &before.guides, h, &self.mass, |k| self.inverse[k].1)
    }

    #[inline(always)]
    fn on_accepted(&mut self, at: &Linearised<R>) {
        for index in 0..self.joints.len() {
            let (pair, wall) = (&self.space.pairs[index], &self.space.walls[index]);
            let penetration = at.joints[index].penetration;
            self.joints[index].1.follow_approach((&pair.place, wall), &pair.motion, penetration);
        }
        for index in 0..self.guides.len() {
            self.guides[index].follow_approach(&at.guides[index]);
        }
    }

    #[inline(always)]
    fn close(&mut self, t: R, wanted: R, q: &mut [R], v: &mut [R]) -> [R; 2] {
        t.apart((self, t, wanted, [q, v]))
    }

    #[inline(always)]
    fn inverse_scales(&self) -> &[(R, R)] {
        &self.inverse
    }
}
