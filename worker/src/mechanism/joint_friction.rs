//! Friction of an island's ideal joints: the reactions that hold with the friction that follows from them.
//!
//! Friction in the joints k has the generalised force -sum_k b_k c_k N_k, with directions b_k `(n,)`, ratios c_k = mu tanh(v_t / v_0) of
//! their sliding speeds and normal forces N_k of their multipliers (`sliding.rs`). With the multipliers lambda_0 `(m,)` without
//! friction and those of unit friction forces, p_k = R^-1 Q' M^-1/2 b_k `(m,)` (`elimination.rs`),
//!
//!   lambda = lambda_0 - sum_k p_k c_k x_k,  x_k = N_k(lambda),
//!
//! as many equations as joints with friction. They are solved by Newton's method from x_k = N_k(lambda_0), with the matrix
//! A = 1 + (dN_j/dlambda p_k c_k)_jk, until x and N(lambda) agree to 1e-12 of the largest normal force. N_k is a norm of the two multipliers of its joint:
//! where the matrix (N_j(p_k) |c_k|)_jk has a spectral radius below one, x -> N(lambda(x)) is a contraction in a weighted largest
//! norm, so that there is one solution, and the leading minors of A are positive. Random systems up to a spectral radius of 0.99 took at most 7
//! steps.
//!
//! Beyond that there may be none or several: a mechanism that locks itself. A solution counts only if all pivots of A are positive: then it can be continued to less friction.
//! Elsewhere, and where Newton's method ends without solution, the force does not exist, and what was tried is refused.
//!
//! Derivatives are exact: dx = A^-1 dN/dlambda dlambda at constant x.
//!
//! # Source
//! Solvability with friction in ideal joints: Fraczek, Wojtyra (2011), Mechanism and Machine Theory 46, 312-334; Genot, Brogliato
//! (1999), European Journal of Mechanics A/Solids 18, 653-677. Newton's method with corners: Qi, Sun (1993), Mathematical
//! Programming 58, 353-367.

// In lanes, closures of iterators are not compiled for the instruction set of the loop around them.
#![allow(clippy::needless_range_loop)]

use super::constraint::Constraint;
use super::orthonormal::OrthonormalRows;
use super::placed::Placed;
use super::sliding::Sliding;
use crate::integrate::{Band, Linearised, factor, solve};
use crate::lanes::Real;

/// Most steps of Newton's method.
const MOST_ITERATIONS: usize = 12;
/// Accepted difference of x and N(lambda), over the largest normal force [1].
const TOLERANCE: f64 = 1e-12;

/// A joint with friction.
#[derive(Debug, Clone)]
struct Rubbing<R> {
    /// Index of its constraint, and the constraint's first row.
    constraint: usize,
    row: usize,
    sliding: Option<Sliding<R>>,
    /// Normal force x [N].
    normal: R,
    /// Derivative of N to the multipliers of the joint `(2,)` [1, 1/m].
    slopes: [R; 2],
}

/// Friction of the ideal joints of an island, or of one island per lane.
#[derive(Debug, Clone)]
pub struct JointFriction<R = f64> {
    joints: Vec<Rubbing<R>>,
    /// Number of rows m of all constraints.
    m: usize,
    /// Q' M^-1/2 b_k and p_k `(joints, m)` each.
    spread: Vec<R>,
    influence: Vec<R>,
    /// lambda_0, later R^-T dN/dlambda of every joint `(joints, m)`; at least `(m,)`.
    space: Vec<R>,
    /// Layout of the matrix A, and its factors.
    layout: Band,
    matrix: Vec<R>,
    /// Differences x - N, or another column `(joints,)`.
    column: Vec<R>,
    /// One in lanes in which the last solution did not exist at a finite state, since the last linearisation.
    locked: R,
}

impl JointFriction {
    /// Constraint of the joint whose friction amplifies its own reaction most, N_k(p_k) |c_k|, if no solution has been found since the
    /// last linearisation.
    pub(super) fn locked_constraint(&self) -> Option<usize> {
        let amplification = |k: &usize| {
            let Rubbing { row, sliding, .. } = &self.joints[*k];
            let influence = &self.influence[k * self.m + row..][..2];
            sliding.as_ref().map_or(0.0, |s| s.normal([influence[0], influence[1]]).0 * s.ratio.abs())
        };
        let worst = (0..self.count()).max_by(|a, b| amplification(a).total_cmp(&amplification(b)));
        worst.filter(|_| self.locked == 1.0).map(|k| self.joints[k].constraint)
    }
}

impl<R: Real> JointFriction<R> {
    /// The friction of those of `constraints` that have any; `first` are their first rows, `m` is the number of all. `like` sets the
    /// number of lanes.
    pub(super) fn new(constraints: &[Constraint<R>], first: &[usize], m: usize, like: R) -> Self {
        let zero = like.zero();
        let rubbing = |k: &usize| Rubbing {
            constraint: *k,
            row: first[*k],
            sliding: None,
            normal: zero,
            slopes: [zero; 2],
        };
        let with_friction = |k: &usize| constraints[*k].friction.is_some();
        let joints: Vec<_> =
            (0..constraints.len()).filter(with_friction).map(|k| rubbing(&k)).collect();
        let count = joints.len();
        let layout = Band::new(count, count);
        JointFriction {
            spread: vec![zero; count * m],
            influence: vec![zero; count * m],
            space: vec![zero; count * m],
            matrix: vec![zero; layout.len()],
            column: vec![zero; count],
            locked: zero,
            layout,
            joints,
            m,
        }
    }

    /// Number of joints with friction.
    #[inline(always)]
    pub(super) fn count(&self) -> usize {
        self.joints.len()
    }

    /// Friction force c x [N] and sliding speed [m/s] of joint `k`, as solved last.
    #[inline(always)]
    fn force(&self, k: usize) -> [R; 2] {
        let joint = &self.joints[k];
        joint.sliding.as_ref().map_or([joint.normal.zero(); 2], |s| [s.ratio * joint.normal, s.speed])
    }

    /// Adds the friction to the applied force `f` `(n,)` and to its share R lambda = Q' M^-1/2 f + R^-T h `(m,)` in the multipliers. Returns one,
    /// zero in lanes where no solution was found.
    #[inline(always)]
    pub(super) fn add(
        &mut self,
        at: Placed<R>,
        constraints: &[Constraint<R>],
        rows: &OrthonormalRows<R>,
        f: &mut [R],
        share: &mut [R],
    ) -> R {
        let m = self.m;
        let zero = share[0].zero();
        for k in 0..self.joints.len() {
            let joint = &mut self.joints[k];
            let c = &constraints[joint.constraint];
            let [a, b] = at.pair(c);
            joint.sliding = c.sliding(a, b);
            let Some(sliding) = &joint.sliding else { continue };
            let spread = &mut self.spread[k * m..k * m + m];
            spread.fill(zero);
            for side in 0..2 {
                let frame = c.ends[side].frame;
                if at.jet(frame).is_none() {
                    for r in 0..3 {
                        rows.add_force(3 * frame + r, sliding.direction[3 * side + r], spread);
                    }
                }
            }
            let influence = &mut self.influence[k * m..k * m + m];
            influence.copy_from_slice(spread);
            rows.backward(influence);
        }
        self.space[..m].copy_from_slice(share);
        rows.backward(&mut self.space[..m]);
        let balanced = self.solve();
        for k in 0..self.joints.len() {
            let joint = &self.joints[k];
            let c = &constraints[joint.constraint];
            let Some(sliding) = &joint.sliding else { continue };
            let friction = sliding.ratio * joint.normal;
            for side in 0..2 {
                let frame = c.ends[side].frame;
                if at.jet(frame).is_none() {
                    for r in 0..3 {
                        let f = &mut f[3 * frame + r];
                        *f = f.minus_product(sliding.direction[3 * side + r], friction);
                    }
                }
            }
            for i in 0..m {
                share[i] = share[i].minus_product(self.spread[k * m + i], friction);
            }
        }
        balanced
    }

    /// Multipliers of joint `k` at the normal forces x `(2,)`.
    #[inline(always)]
    fn multipliers(&self, k: usize) -> [R; 2] {
        let row = self.joints[k].row;
        let mut lambda = [self.space[row], self.space[row + 1]];
        for j in 0..self.joints.len() {
            let other = &self.joints[j];
            let Some(sliding) = &other.sliding else { continue };
            let friction = sliding.ratio * other.normal;
            for r in 0..2 {
                lambda[r] = lambda[r].minus_product(self.influence[j * self.m + row + r], friction);
            }
        }
        lambda
    }

    /// Solves for the normal forces from lambda_0. Returns one, zero in lanes where no solution was found.
    #[inline(always)]
    fn solve(&mut self) -> R {
        let zero = self.locked.zero();
        let one = zero.like(1.0);
        let count = self.joints.len();
        // Not a number where lambda_0 is not finite.
        let mut nothing = zero;
        for k in 0..count {
            let row = self.joints[k].row;
            let lambda = [self.space[row], self.space[row + 1]];
            nothing = nothing.plus_product(lambda[0] + lambda[1], zero);
            let joint = &mut self.joints[k];
            let Some(sliding) = &joint.sliding else { continue };
            joint.normal = sliding.normal(lambda).0;
        }
        let mut iteration = 0;
        let balanced = loop {
            let (mut difference, mut largest) = (zero, zero.like(f64::MIN_POSITIVE));
            for k in 0..count {
                let lambda = self.multipliers(k);
                let joint = &mut self.joints[k];
                let Some(sliding) = &joint.sliding else { continue };
                let (normal, slopes) = sliding.normal(lambda);
                let x = joint.normal;
                joint.slopes = slopes;
                self.column[k] = x - normal;
                // What is not a number must not be below the tolerance.
                difference = (x - normal).abs().larger(difference) + (x - normal) * zero;
                largest = largest.larger(normal).larger(x);
            }
            self.fill_matrix(one);
            let sound = factor(&mut self.matrix, &self.layout, zero);
            let solved = difference.below(largest * TOLERANCE);
            let mut regular = zero.below(sound);
            for k in 0..count {
                regular = R::both(regular, zero.below(self.matrix[self.layout.index(k, k)]));
            }
            iteration += 1;
            // Lanes that are solved keep their state while others go on.
            let open = R::select(solved, zero, one);
            if iteration > MOST_ITERATIONS || !R::any(zero.below(open)) {
                break R::select(R::both(solved, regular), one, zero);
            }
            solve(&self.matrix, &self.layout, &mut self.column);
            for k in 0..count {
                let joint = &mut self.joints[k];
                joint.normal = R::select(solved, joint.normal, joint.normal - self.column[k]);
            }
        };
        let finite = nothing.below(one);
        let unbalanced = balanced.below(one);
        self.locked = R::select(R::both(finite, unbalanced), one, self.locked);
        balanced
    }

    /// Fills the matrix A at the slopes of the joints.
    #[inline(always)]
    fn fill_matrix(&mut self, one: R) {
        let (zero, m) = (one.zero(), self.m);
        for j in 0..self.joints.len() {
            let Rubbing { row, slopes, .. } = self.joints[j];
            for k in 0..self.joints.len() {
                let Some(sliding) = &self.joints[k].sliding else { continue };
                let influence = &self.influence[k * m + row..k * m + row + 2];
                let product = (slopes[0] * influence[0]).plus_product(slopes[1], influence[1]);
                let diagonal = if j == k { one } else { zero };
                self.matrix[self.layout.index(j, k)] = diagonal.plus_product(product, sliding.ratio);
            }
        }
    }

    /// Starts the derivatives after [`Self::add`]: adds to `to` what of the friction changes at constant multipliers, and its force on
    /// prescribed bodies.
    #[inline(always)]
    pub(super) fn add_derivatives(
        &mut self,
        at: Placed<R>,
        constraints: &[Constraint<R>],
        rows: &OrthonormalRows<R>,
        to: &mut Linearised<R>,
    ) {
        let (n, m) = (to.f.len(), self.m);
        self.locked = self.locked.zero();
        for k in 0..self.joints.len() {
            to.friction[k] = self.force(k);
            let joint = &self.joints[k];
            let c = &constraints[joint.constraint];
            let Some(sliding) = &joint.sliding else { continue };
            let space = &mut self.space[k * m..k * m + m];
            space.fill(joint.normal.zero());
            space[joint.row..joint.row + 2].copy_from_slice(&joint.slopes);
            rows.forward(space, 1);
            let Explicit { to_q, to_v } = Explicit::new(sliding, joint.normal);
            let force = sliding.ratio * joint.normal;
            for side in 0..2 {
                let frame = c.ends[side].frame;
                if at.jet(frame).is_some() {
                    for r in 0..3 {
                        let on = &mut to.prescribed[frame - n / 3][r];
                        *on = on.minus_product(sliding.direction[3 * side + r], force);
                    }
                    continue;
                }
                for r in 0..3 {
                    let (own, row) = (3 * side + r, 3 * frame + r);
                    for other in 0..2 {
                        let to_frame = c.ends[other].frame;
                        if let Some(jet) = at.jet(to_frame) {
                            to.ft[row] = to.ft[row]
                                .minus_product(to_q[own][3 * other + 2], jet[1])
                                .minus_product(to_v[own][3 * other + 2], jet[2]);
                            continue;
                        }
                        for s in 0..3 {
                            to.k[row * n + 3 * to_frame + s] -= to_q[own][3 * other + s];
                            to.d[row * n + 3 * to_frame + s] -= to_v[own][3 * other + s];
                        }
                    }
                }
            }
        }
    }

    /// Adds to the derivatives `x` `(n, columns)` of the force, and to their share `share` `(m, columns)` in the multipliers, what of the
    /// friction changes with the multipliers.
    #[inline(always)]
    pub(super) fn reduce(
        &mut self,
        at: Placed<R>,
        constraints: &[Constraint<R>],
        share: &mut [R],
        x: &mut [R],
        columns: usize,
    ) {
        let (m, count) = (self.m, self.joints.len());
        for column in 0..columns {
            for k in 0..count {
                let mut rate = self.locked.zero();
                for i in 0..m {
                    rate = rate.plus_product(self.space[k * m + i], share[i * columns + column]);
                }
                self.column[k] = rate;
            }
            solve(&self.matrix, &self.layout, &mut self.column);
            for k in 0..count {
                let joint = &self.joints[k];
                let c = &constraints[joint.constraint];
                let Some(sliding) = &joint.sliding else { continue };
                let friction = sliding.ratio * self.column[k];
                for side in 0..2 {
                    let frame = c.ends[side].frame;
                    if at.jet(frame).is_none() {
                        for r in 0..3 {
                            let x = &mut x[(3 * frame + r) * columns + column];
                            *x = x.minus_product(sliding.direction[3 * side + r], friction);
                        }
                    }
                }
                for i in 0..m {
                    let share = &mut share[i * columns + column];
                    *share = share.minus_product(self.spread[k * m + i], friction);
                }
            }
        }
    }
}

/// Derivatives of b c N to the coordinates of the pair and to their rates at constant N `(6, 6)` each.
struct Explicit<R> {
    to_q: [[R; 6]; 6],
    to_v: [[R; 6]; 6],
}

impl<R: Real> Explicit<R> {
    #[inline(always)]
    fn new(sliding: &Sliding<R>, normal: R) -> Self {
        let zero = normal.zero();
        let (force, grip) = (sliding.ratio * normal, sliding.slope * normal);
        let mut to = Explicit { to_q: [[zero; 6]; 6], to_v: [[zero; 6]; 6] };
        for r in 0..6 {
            for s in 0..6 {
                to.to_v[r][s] = grip * sliding.direction[r] * sliding.direction[s];
            }
        }
        if let Some(turning) = &sliding.turning {
            for s in 0..6 {
                let mut speed = zero;
                for r in 0..6 {
                    speed = speed.plus_product(turning[r][s], sliding.rates[r]);
                }
                for r in 0..6 {
                    to.to_q[r][s] = (grip * sliding.direction[r] * speed).plus_product(force, turning[r][s]);
                }
            }
        }
        to
    }
}
