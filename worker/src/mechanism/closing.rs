//! Ideal joints closed again after a step: positions and velocities back on the constraints.
//!
//! Newton's method, with steps normal to the constraints in the metric of the mass matrix, until the largest gap has fallen to rounding or to a
//! millionth of the first one; then the velocities are projected once. One source serves one island and one island per SIMD
//! lane: a lane that is closed, or not to be closed, keeps its state while others go on.
//!
//! # Source
//! Coordinate projection: Eich (1993), SIAM J. Numer. Anal. 30, 1467-1482.

use super::elimination::Elimination;
use super::extent::{ROUNDING, farthest};
use super::frame::Placed;
use crate::lanes::Real;

/// Most Newton steps before a joint counts as impossible to close.
const MOST_ITERATIONS: usize = 8;
/// Gap that counts as closed, over the size of the mechanism [1].
const SHARE_OF_SIZE: f64 = 1e-14;
/// Gap that counts as closed, over the first one: the step after it leaves its square [1].
const SHARE_OF_FIRST: f64 = 1e-6;

/// Gap that counts as closed at the positions `q` `(n,)` [m]: Newton's last step leaves rounding of the coordinates themselves.
#[inline(always)]
pub(super) fn least_gap<R: Real>(q: &[R], size: R) -> R {
    (size * SHARE_OF_SIZE).larger(farthest(q, size) * ROUNDING)
}

/// An island with ideal joints, or one per lane.
pub(super) trait IdealJoints<R: Real> {
    /// Evaluates the frames of all bodies at (t, q, v).
    fn place(&mut self, t: R, q: &[R], v: &[R]);
    /// The joints, with the state last placed.
    fn joints(&mut self) -> (&mut Elimination<R>, Placed<'_, R>);
    /// Size of the mechanism [m].
    fn size(&self) -> R;
}

/// Closes the joints at time `t` [s] in lanes where `wanted` is one: changes positions `q` and velocities `v` `(n,)` there.
/// Returns the largest distance by which a joint had drifted open (angles times the size of the mechanism) [m], and one where the
/// joints are closed, zero where they could not be closed or were not to be.
#[inline(always)]
pub(super) fn close<R: Real>(
    system: &mut impl IdealJoints<R>,
    t: R,
    wanted: R,
    q: &mut [R],
    v: &mut [R],
) -> [R; 2] {
    let (zero, one) = (t.zero(), t.like(1.0));
    let size = system.size();
    let (mut open, mut closed) = (wanted, zero);
    let mut drift = zero;
    for iteration in 0..MOST_ITERATIONS {
        system.place(t, q, v);
        let (joints, at) = system.joints();
        let (gap, independent) = joints.measure_gaps(at, size);
        open = open * independent;
        joints.move_back(open, q);
        if iteration == 0 {
            drift = gap;
        }
        let enough = gap.below(least_gap(q, size).larger(drift * SHARE_OF_FIRST));
        let done = R::both(enough, zero.below(open));
        if R::any(done) {
            let done = R::select(done, one, zero);
            joints.measure_velocities(at, v);
            joints.move_back(done, v);
            (open, closed) = (open - done, closed + done);
        }
        if !R::any(zero.below(open)) {
            break;
        }
    }
    [drift, closed]
}

impl<R: Real> Elimination<R> {
    /// Prepares a Newton step of the positions back onto the constraints, dq = -M^-1/2 Q R^-T phi. Returns the largest gap before it
    /// (angles times `size`) [m], and one, zero in lanes where the constraints are dependent.
    #[inline(always)]
    pub(crate) fn measure_gaps(&mut self, at: Placed<R>, size: R) -> (R, R) {
        let independent = self.factor(at);
        let mut gap = independent.zero();
        for joint in 0..self.constraints.len() {
            let (first, c) = (self.first[joint], self.constraints[joint]);
            for k in 0..c.rows() {
                let phi = self.phi[first + k].abs();
                gap = gap.larger(if c.is_angle(k) { phi * size } else { phi });
            }
        }
        self.lambda.copy_from_slice(&self.phi);
        self.factors.forward(&mut self.lambda, 1);
        (gap, independent)
    }

    /// After [`Self::measure_gaps`] has found no gap: prepares the projection of the velocities onto the constraints, dv =
    /// -M^-1/2 Q (Q' M^1/2 v + R^-T dphi/dt).
    #[inline(always)]
    pub(crate) fn measure_velocities(&mut self, at: Placed<R>, v: &[R]) {
        let zero = v[0].zero();
        for joint in 0..self.constraints.len() {
            let (first, c) = (self.first[joint], self.constraints[joint]);
            let [a, b] = at.pair(&c.ends);
            let (_, rows) = c.position(a, b);
            for r in 0..c.rows() {
                let mut given = c.over_time().map_or(zero, |[rate, _]| rate);
                for side in 0..2 {
                    if let Some(jet) = at.jet(c.ends[side].frame) {
                        given = given.plus_product(rows[r][3 * side + 2], jet[1]);
                    }
                }
                self.lambda[first + r] = given;
            }
        }
        self.factors.forward(&mut self.lambda, 1);
        self.factors.add_velocities(v, &mut self.lambda);
    }

    /// x -= M^-1/2 Q lambda with what was prepared last, in lanes where `which` is one.
    #[inline(always)]
    pub(crate) fn move_back(&self, which: R, x: &mut [R]) {
        let moves = which.zero().below(which);
        for k in 0..x.len() {
            x[k] = R::select(moves, self.factors.moved_back(k, x[k], &self.lambda), x[k]);
        }
    }
}
