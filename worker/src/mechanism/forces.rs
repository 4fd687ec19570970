//! Generalised forces of an island: the forces of its joints with clearance and of its loads, assembled with
//! their derivatives.
//!
//! # Written blocks
//! Which blocks of an island's derivatives have been written in a linearisation.
//!
//! K and D consist of blocks of 3 x 3: the force on one body by the motion of another. The first joint or load that acts on a pair of bodies writes its
//! block, those after it add to it, and the blocks that none has written are set to zero at the end: cheaper than to set all to zero before.

use super::frame::Frame;
use super::guide::Guiding;
use super::joint::{Blocks, PairMotion, Touching, pair_force};
use super::load::{IslandLoad, NO_FRAME};
use super::piecewise_cubic::Jet;
use crate::contact::Walls;
use crate::integrate::{Layout, Linearised};
use crate::lanes::{Real, Vectorised};

/// Joints and loads that act on an island, and the frames of its bodies.
pub(super) struct Acting<'a, R, J, G> {
    pub joints: &'a [J],
    pub guides: &'a [G],
    pub loads: &'a [IslandLoad<R>],
    /// Weight of the free bodies `(n,)`.
    pub weight: &'a [R],
    /// Frames of the free bodies, then of the prescribed ones.
    pub frames: &'a [Frame<R>],
    /// Angle and derivatives of the prescribed ones.
    pub jets: &'a [Jet<R>],
}

/// Space for what is computed of all joints before the next step is done of any: all are long chains of operations, and those of several
/// joints side by side fill the time that one alone waits.
#[derive(Debug, Clone, Default)]
pub(super) struct JointSpace<R> {
    /// Motion of each joint `(joints,)`.
    pub(super) pairs: Vec<PairMotion<R>>,
    /// Surfaces at the contact of each joint `(joints,)`.
    pub(super) walls: Vec<Walls<R>>,
}

impl<R: Real> JointSpace<R> {
    /// Space for these joints, filled with bodies at rest; `like` sets the number of lanes.
    pub(super) fn new(joints: &[impl Touching<R>], like: R) -> Self {
        let zero = like.zero();
        let at_rest = Frame { x: [zero; 2], angle: zero, cs: [zero; 2], v: [zero; 2], omega: zero };
        let pair = |joint: &_| PairMotion::new(Touching::parts(joint).0, &at_rest, &at_rest);
        let pairs: Vec<_> = joints.iter().map(pair).collect();
        let wall = |(joint, pair): (&_, &PairMotion<R>)| {
            Touching::parts(joint).1.walls(&pair.place, pair.motion.turn)
        };
        let walls = joints.iter().zip(&pairs).map(wall).collect();
        JointSpace { pairs, walls }
    }
}

impl<R: Real, J: Touching<R>, G: Guiding<R>> Acting<'_, R, J, G> {
    /// Forces of joints with clearance and of loads at time `t`, and with `JACOBIAN` their derivatives; `space`
    /// is that of the joints.
    #[inline(always)]
    pub(crate) fn applied<const JACOBIAN: bool>(
        &self,
        t: R,
        space: &mut JointSpace<R>,
        f: &mut [R],
        at: &mut Linearised<R>,
    ) {
        f.copy_from_slice(self.weight);
        let free = self.frames.len() - self.jets.len();
        let mut written = WrittenBlocks::default();
        if JACOBIAN {
            let zero = t.zero();
            at.ft.fill(zero);
            at.prescribed.fill([zero; 3]);
            written = WrittenBlocks::begin(free, at);
        }
        let JointSpace { pairs, walls } = &mut *space;
        for (joint, pair) in self.joints.iter().zip(&mut *pairs) {
            let ([i, j], _) = joint.parts();
            *pair = PairMotion::new([i, j], &self.frames[i.frame], &self.frames[j.frame]);
        }
        for (joint, (pair, wall)) in self.joints.iter().zip(pairs.iter().zip(&mut *walls)) {
            *wall = joint.parts().1.walls(&pair.place, pair.motion.turn);
        }
        let space: &JointSpace<R> = space;
        for index in 0..self.joints.len() {
            let to = (&mut *f, &mut *at, &mut written);
            let force = ForceOfJoint::<R, J, G, JACOBIAN> { acting: self, index, space, to };
            // One number has no separate functions: the second branch alone keeps its code small.
            if R::LANES > 1 && self.joints[index].parts().1.is_foundation() {
                t.apart(force);
            } else {
                force.add();
            }
        }
        for (index, guide) in self.guides.iter().enumerate() {
            let (force, done) = guide.force::<JACOBIAN>(self.frames);
            self.add::<JACOBIAN>(force.frames, &force.f, &force, f, (at, &mut written));
            if JACOBIAN {
                at.guides[index] = done;
            }
        }
        for load in self.loads {
            let load = load.force(t, self.frames);
            self.add::<JACOBIAN>(load.frames, &load.f, &load, f, (at, &mut written));
            if JACOBIAN {
                self.add_sources(load.frames, &load.ft, load.third, (at, &mut written));
            }
        }
        if JACOBIAN {
            written.clear_others(free, at);
        }
    }

    /// Adds the generalised force of a pair of frames to its free bodies; with `JACOBIAN` also the
    /// derivatives, and the force on prescribed bodies.
    #[inline(always)]
    fn add<const JACOBIAN: bool>(
        &self,
        frames: [usize; 2],
        force: &[R; 6],
        slopes: &impl Blocks<R>,
        f: &mut [R],
        (at, written): (&mut Linearised<R>, &mut WrittenBlocks),
    ) {
        self.add_to::<JACOBIAN, 0>(frames, force, slopes, f, (at, written));
        self.add_to::<JACOBIAN, 1>(frames, force, slopes, f, (at, written));
    }

    /// The part of [`Self::add`] that acts on body `ON` of the pair.
    #[inline(always)]
    fn add_to<const JACOBIAN: bool, const ON: usize>(
        &self,
        frames: [usize; 2],
        force: &[R; 6],
        slopes: &impl Blocks<R>,
        f: &mut [R],
        (at, written): (&mut Linearised<R>, &mut WrittenBlocks),
    ) {
        let free = self.frames.len() - self.jets.len();
        let frame = frames[ON];
        if frame >= free {
            if JACOBIAN && frame != NO_FRAME {
                let on = &mut at.prescribed[frame - free];
                for r in 0..3 {
                    on[r] += force[3 * ON + r];
                }
            }
            return;
        }
        let f = &mut f[3 * frame..3 * frame + 3];
        for r in 0..3 {
            f[r] += force[3 * ON + r];
        }
        if JACOBIAN {
            self.add_block::<ON, 0>(frames, slopes, at, written);
            self.add_block::<ON, 1>(frames, slopes, at, written);
        }
    }

    /// Adds the derivatives of the force on the free body `ON` of a pair to the motion of body `TO`.
    #[inline(always)]
    fn add_block<const ON: usize, const TO: usize>(
        &self,
        frames: [usize; 2],
        slopes: &impl Blocks<R>,
        at: &mut Linearised<R>,
        written: &mut WrittenBlocks,
    ) {
        let free = self.frames.len() - self.jets.len();
        let (row, to) = (3 * frames[ON], frames[TO]);
        if to == NO_FRAME {
            return;
        }
        let [k, d] = slopes.block::<ON, TO>();
        if to < free {
            let is_first = written.mark(frames[ON], to);
            for r in 0..3 {
                let first = at.band.index(row + r, 3 * to);
                let (at_k, at_d) = (&mut at.k[first..first + 3], &mut at.d[first..first + 3]);
                for c in 0..3 {
                    (at_k[c], at_d[c]) =
                        if is_first { (k[r][c], d[r][c]) } else { (at_k[c] + k[r][c], at_d[c] + d[r][c]) };
                }
            }
        } else {
            // A prescribed body only turns.
            let [_, omega, alpha, _] = self.jets[to - free];
            let ft = &mut at.ft[row..row + 3];
            for r in 0..3 {
                ft[r] = ft[r].plus_product(k[r][2], omega).plus_product(d[r][2], alpha);
            }
        }
    }

    /// Adds a load's dependence on time and on the angle of another frame.
    #[inline(always)]
    fn add_sources(
        &self,
        frames: [usize; 2],
        ft: &[R; 6],
        third: Option<(usize, [R; 6])>,
        (at, written): (&mut Linearised<R>, &mut WrittenBlocks),
    ) {
        let free = self.frames.len() - self.jets.len();
        for (side, &frame) in frames.iter().enumerate().filter(|&(_, &frame)| frame < free) {
            if let Some((other, _)) = third
                && other < free
            {
                written.clear_unless_written(frame, other, at);
            }
            for r in 0..3 {
                let row = 3 * frame + r;
                at.ft[row] += ft[3 * side + r];
                match third {
                    Some((other, slope)) if other < free => {
                        at.k[at.band.index(row, 3 * other + 2)] += slope[3 * side + r];
                    }
                    Some((other, slope)) => {
                        at.ft[row] = at.ft[row].plus_product(slope[3 * side + r], self.jets[other - free][1]);
                    }
                    None => {}
                }
            }
        }
    }
}

/// A joint whose force is added to a force, with `JACOBIAN` with its derivatives to a linearisation. In lanes the force of an elastic
/// foundation is a separate function, see [`Real::apart`]; that of the cheaper law is not: its results would be copied.
struct ForceOfJoint<'a, R, J, G, const JACOBIAN: bool> {
    acting: &'a Acting<'a, R, J, G>,
    index: usize,
    space: &'a JointSpace<R>,
    to: (&'a mut [R], &'a mut Linearised<R>, &'a mut WrittenBlocks),
}

impl<R: Real, J: Touching<R>, G: Guiding<R>, const JACOBIAN: bool> ForceOfJoint<'_, R, J, G, JACOBIAN> {
    #[inline(always)]
    fn add(self) {
        let ForceOfJoint { acting, index, space, to: (f, at, written) } = self;
        let ([i, j], law) = acting.joints[index].parts();
        let (pair, wall) = (&space.pairs[index], &space.walls[index]);
        let (fi, fj) = (&acting.frames[i.frame], &acting.frames[j.frame]);
        let (force, joint, slopes) = pair_force::<R, JACOBIAN>(law, pair, wall, fi, fj);
        acting.add::<JACOBIAN>([i.frame, j.frame], &force, &slopes, f, (&mut *at, written));
        if JACOBIAN {
            at.joints[index] = joint;
            at.e[index] = pair.motion.e;
            at.turns[index] = pair.motion.turn;
        }
    }
}

impl<R: Real, J: Touching<R>, G: Guiding<R>, const JACOBIAN: bool> Vectorised
    for ForceOfJoint<'_, R, J, G, JACOBIAN>
{
    type Output = ();

    #[inline(always)]
    fn run(self) {
        if self.acting.joints[self.index].parts().1.is_foundation() {
            self.add();
        }
    }
}

/// Blocks written so far.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct WrittenBlocks {
    /// Bit 8 i + j: the block of bodies i and j. All bits are one if the bodies are more than [`MOST_BODIES`].
    bits: u64,
}

/// Number of bodies of which each pair has a bit.
const MOST_BODIES: usize = 8;

impl WrittenBlocks {
    /// Begins the derivatives of this number of bodies: no block is written, or of more bodies than have bits all are, with zeros.
    #[inline(always)]
    pub(super) fn begin<R: Real>(bodies: usize, at: &mut Linearised<R>) -> Self {
        if bodies <= MOST_BODIES {
            return WrittenBlocks { bits: 0 };
        }
        for entry in 0..at.k.len() {
            (at.k[entry], at.d[entry]) = (at.k[entry].zero(), at.d[entry].zero());
        }
        WrittenBlocks { bits: u64::MAX }
    }

    /// Marks the block of bodies `i` and `j` as written. True if it was not before.
    #[inline(always)]
    pub(super) fn mark(&mut self, i: usize, j: usize) -> bool {
        let before = self.bits;
        self.bits |= 1_u64.wrapping_shl((MOST_BODIES * i + j) as u32);
        before != self.bits
    }

    /// Sets the block of bodies `i` and `j` to zero and marks it as written, unless it was before.
    #[inline(always)]
    pub(super) fn clear_unless_written<R: Real>(&mut self, i: usize, j: usize, at: &mut Linearised<R>) {
        if !self.mark(i, j) {
            return;
        }
        for r in 0..3 {
            let first = at.band.index(3 * i + r, 3 * j);
            for entry in first..first + 3 {
                (at.k[entry], at.d[entry]) = (at.k[entry].zero(), at.d[entry].zero());
            }
        }
    }

    /// Sets the blocks of all other pairs of `bodies` to zero.
    #[inline(always)]
    pub(super) fn clear_others<R: Real>(mut self, bodies: usize, at: &mut Linearised<R>) {
        if bodies > MOST_BODIES {
            return;
        }
        for i in 0..bodies {
            for j in 0..bodies {
                if at.band.kept(3 * i).contains(&(3 * j)) {
                    self.clear_unless_written(i, j, at);
                }
            }
        }
    }
}
