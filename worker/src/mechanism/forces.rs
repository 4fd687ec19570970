//! Generalised forces of an island: the forces of its joints with clearance and of its loads, assembled with
//! their derivatives.

use super::frame::Frame;
use super::joint::{Rows, Touching, pair_force};
use super::load::{IslandLoad, NO_FRAME};
use super::piecewise_cubic::Jet;
use crate::contact::JointForce;
use crate::integrate::Linearised;
use crate::lanes::Real;

/// Joints and loads that act on an island, and the frames of its bodies.
pub(super) struct Acting<'a, R, J> {
    pub joints: &'a [J],
    pub loads: &'a [IslandLoad<R>],
    /// Weight of the free bodies `(n,)`.
    pub weight: &'a [R],
    /// Frames of the free bodies, then of the prescribed ones.
    pub frames: &'a [Frame<R>],
    /// Angle and derivatives of the prescribed ones.
    pub jets: &'a [Jet<R>],
}

impl<R: Real, J: Touching<R>> Acting<'_, R, J> {
    /// Forces of joints with clearance and of loads at time `t`, and with `JACOBIAN` their derivatives.
    #[inline(always)]
    pub(crate) fn applied<const JACOBIAN: bool>(&self, t: R, f: &mut [R], at: &mut Linearised<R>) {
        f.copy_from_slice(self.weight);
        if JACOBIAN {
            let zero = t.zero();
            at.k.fill(zero);
            at.d.fill(zero);
            at.ft.fill(zero);
            at.prescribed.fill([zero; 3]);
        }
        for (index, joint) in self.joints.iter().enumerate() {
            let [i, j] = joint.ends();
            let pair = pair_force::<R, JACOBIAN>(joint, &self.frames[i.frame], &self.frames[j.frame]);
            self.add::<JACOBIAN>([i.frame, j.frame], &pair.f, &pair.slopes, f, at);
            if JACOBIAN {
                let joint = &mut at.joints[index];
                // The joint's own derivatives are not needed any more.
                *joint = JointForce { jacobian: joint.jacobian, ..pair.joint };
                at.e[index] = pair.e;
            }
        }
        for load in self.loads {
            let load = load.force(t, self.frames);
            self.add::<JACOBIAN>(load.frames, &load.f, &load, f, at);
            if JACOBIAN {
                self.add_sources(load.frames, &load.ft, load.third, at);
            }
        }
    }

    /// Adds the generalised force of a pair of frames to its free bodies; with `JACOBIAN` also the
    /// derivatives, and the force on prescribed bodies.
    #[inline(always)]
    fn add<const JACOBIAN: bool>(
        &self,
        frames: [usize; 2],
        force: &[R; 6],
        slopes: &impl Rows<R>,
        f: &mut [R],
        at: &mut Linearised<R>,
    ) {
        let free = self.frames.len() - self.jets.len();
        for (side, &frame) in frames.iter().enumerate() {
            if frame >= free {
                if JACOBIAN && frame != NO_FRAME {
                    let on = &mut at.prescribed[frame - free];
                    for k in 0..3 {
                        on[k] += force[3 * side + k];
                    }
                }
                continue;
            }
            for r in 0..3 {
                let row = 3 * frame + r;
                f[row] += force[3 * side + r];
                if !JACOBIAN {
                    continue;
                }
                let (k, d) = slopes.row(3 * side + r);
                for (other, &to) in frames.iter().enumerate() {
                    if to == NO_FRAME {
                        continue;
                    }
                    if to < free {
                        let first = at.band.index(row, 3 * to);
                        let (at_k, at_d) = (&mut at.k[first..first + 3], &mut at.d[first..first + 3]);
                        for c in 0..3 {
                            at_k[c] += k[3 * other + c];
                            at_d[c] += d[3 * other + c];
                        }
                    } else {
                        // A prescribed body only turns.
                        let [_, omega, alpha, _] = self.jets[to - free];
                        at.ft[row] += k[3 * other + 2] * omega + d[3 * other + 2] * alpha;
                    }
                }
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
        at: &mut Linearised<R>,
    ) {
        let free = self.frames.len() - self.jets.len();
        for (side, &frame) in frames.iter().enumerate().filter(|&(_, &frame)| frame < free) {
            for r in 0..3 {
                let row = 3 * frame + r;
                at.ft[row] += ft[3 * side + r];
                match third {
                    Some((other, slope)) if other < free => {
                        at.k[at.band.index(row, 3 * other + 2)] += slope[3 * side + r];
                    }
                    Some((other, slope)) => at.ft[row] += slope[3 * side + r] * self.jets[other - free][1],
                    None => {}
                }
            }
        }
    }
}
