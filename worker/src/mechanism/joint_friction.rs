//! Friction of an island's ideal joints, as part of its forces.
//!
//! Friction in the joints k has the generalised force -sum_k b_k c_k x_k, with the directions b_k `(n,)`, the ratios
//! c_k = mu tanh(v_t / v_0) of their sliding speeds (`coupling.rs`) and the normal forces x_k that balance the multipliers
//! (`friction_balance.rs`); unit friction forces contribute the multipliers p_k = R^-1 Q' M^-1/2 b_k `(m,)` (`elimination.rs`).
//!
//! Derivatives are exact. For a column of coordinates, rates or time, with the part dlambda of the derivative of the multipliers at
//! constant x, dx = A^-1 dN/dlambda dlambda, and the force changes by -b_k c_k dx_k besides what changes at constant x.

use super::constraint::Constraint;
use super::frame::Placed;
use super::friction_balance::{FrictionBalance, RubbingJoint};
use super::orthonormal::OrthonormalRows;
use super::sliding::Sliding;
use crate::integrate::Linearised;
use crate::lanes::Real;

/// Friction of the ideal joints of an island, or of one island per lane.
#[derive(Debug, Clone)]
pub struct JointFriction<R = f64> {
    /// Index of the constraint of each joint with friction.
    constraints: Vec<usize>,
    /// How each slides, at the state last set.
    sliding: Vec<Option<Sliding<R>>>,
    /// The normal forces.
    balance: FrictionBalance<R>,
    /// Number of rows m of all constraints.
    m: usize,
    /// Q' M^-1/2 b_k, and R^-T dN_k/dlambda `(joints, m)` each.
    spread: Vec<R>,
    adjoint: Vec<R>,
    /// One in lanes where a balance was found last.
    balanced: R,
    /// One in lanes where none was found at a finite state, since the last linearisation at which one was.
    locked: R,
}

impl JointFriction {
    /// Constraint of the joint whose friction amplifies its own reaction most, if no balance was found at a state since the last
    /// linearisation at which one was.
    pub(super) fn locked_constraint(&self) -> Option<usize> {
        let amplification = |k: &usize| self.balance.amplification(*k);
        let worst = (0..self.count()).max_by(|a, b| amplification(a).total_cmp(&amplification(b)));
        worst.filter(|_| self.locked == 1.0).map(|k| self.constraints[k])
    }
}

impl<R: Real> JointFriction<R> {
    /// The friction of those of `constraints` that have any; `first` are their first rows, `m` is the number of all. `like` sets the
    /// number of lanes.
    pub(super) fn new(constraints: &[Constraint<R>], first: &[usize], m: usize, like: R) -> Self {
        let zero = like.zero();
        let mut with_friction = Vec::new();
        let mut joints = Vec::new();
        for (k, (constraint, &row)) in constraints.iter().zip(first).enumerate() {
            if constraint.friction.is_some() {
                with_friction.push(k);
                let per_half = constraint.per_half();
                joints.push(RubbingJoint { row, per_half, ratio: zero, normal: zero, slopes: [zero; 2] });
            }
        }
        let count = joints.len();
        JointFriction {
            constraints: with_friction,
            sliding: vec![None; count],
            balance: FrictionBalance::new(joints, m, like),
            m,
            spread: vec![zero; count * m],
            adjoint: vec![zero; count * m],
            balanced: zero,
            locked: zero,
        }
    }

    /// Follows the constants of `constraints`, which may have changed in a lane.
    pub(super) fn update(&mut self, constraints: &[Constraint<R>]) {
        for (joint, &k) in self.balance.joints.iter_mut().zip(&self.constraints) {
            joint.per_half = constraints[k].per_half();
        }
    }

    /// Number of joints with friction.
    #[inline(always)]
    pub(crate) fn count(&self) -> usize {
        self.constraints.len()
    }

    /// Adds the friction to the applied force `f` `(n,)` and to its share R lambda = Q' M^-1/2 f + R^-T h `(m,)` in the multipliers. Returns one,
    /// zero in lanes where no balance was found.
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
        for k in 0..self.constraints.len() {
            let c = &constraints[self.constraints[k]];
            let [a, b] = at.pair(&c.ends);
            self.sliding[k] = c.sliding(a, b);
            let Some(sliding) = &self.sliding[k] else { continue };
            self.balance.joints[k].ratio = sliding.ratio;
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
            let influence = &mut self.balance.influence[k * m..k * m + m];
            influence.copy_from_slice(spread);
            rows.backward(influence);
        }
        self.balance.lambda.copy_from_slice(share);
        rows.backward(&mut self.balance.lambda);
        let balanced = self.balance.solve();
        let one = zero.like(1.0);
        let mut nothing = zero;
        for i in 0..m {
            nothing = nothing.plus_product(self.balance.lambda[i], zero);
        }
        // A comparison with what is not a number is false.
        let found_wanting = R::both(nothing.below(one), balanced.below(one));
        self.locked = R::select(found_wanting, one, self.locked);
        self.balanced = balanced;
        for k in 0..self.constraints.len() {
            let joint = &self.balance.joints[k];
            let friction = joint.ratio * joint.normal;
            self.subtract(k, at, constraints, friction, (&mut *f, &mut *share), [1, 0]);
        }
        balanced
    }

    /// Subtracts b_k `friction` from column `column` of `x` `(n, columns)`, and its share from that of `share` `(m, columns)`.
    #[inline(always)]
    fn subtract(
        &self,
        k: usize,
        at: Placed<R>,
        constraints: &[Constraint<R>],
        friction: R,
        (x, share): (&mut [R], &mut [R]),
        [columns, column]: [usize; 2],
    ) {
        let c = &constraints[self.constraints[k]];
        let Some(sliding) = &self.sliding[k] else { return };
        for side in 0..2 {
            let frame = c.ends[side].frame;
            if at.jet(frame).is_none() {
                for r in 0..3 {
                    let x = &mut x[(3 * frame + r) * columns + column];
                    *x = x.minus_product(sliding.direction[3 * side + r], friction);
                }
            }
        }
        for i in 0..self.m {
            let share = &mut share[i * columns + column];
            *share = share.minus_product(self.spread[k * self.m + i], friction);
        }
    }

    /// Starts the derivatives after [`Self::add`]: adds to `to` what of the friction changes at constant normal forces, and its force on
    /// prescribed bodies.
    #[inline(always)]
    pub(super) fn add_derivatives(
        &mut self,
        at: Placed<R>,
        constraints: &[Constraint<R>],
        rows: &OrthonormalRows<R>,
        to: &mut Linearised<R>,
    ) {
        let (n, m, zero) = (to.f.len(), self.m, self.locked.zero());
        self.locked = R::select(zero.below(self.balanced), zero, self.locked);
        for k in 0..self.constraints.len() {
            let joint = &self.balance.joints[k];
            let c = &constraints[self.constraints[k]];
            let Some(sliding) = &self.sliding[k] else { continue };
            let adjoint = &mut self.adjoint[k * m..k * m + m];
            adjoint.fill(joint.normal.zero());
            adjoint[joint.row..joint.row + 2].copy_from_slice(&joint.slopes);
            rows.forward(adjoint, 1);
            let force = joint.ratio * joint.normal;
            to.friction[k] = [force, sliding.speed];
            let (to_q, to_v) = at_constant_normal(sliding, joint.normal);
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
    /// friction changes with the normal forces.
    #[inline(always)]
    pub(super) fn reduce(
        &mut self,
        at: Placed<R>,
        constraints: &[Constraint<R>],
        share: &mut [R],
        x: &mut [R],
        columns: usize,
    ) {
        let m = self.m;
        for column in 0..columns {
            for k in 0..self.constraints.len() {
                let mut rate = self.locked.zero();
                for i in 0..m {
                    rate = rate.plus_product(self.adjoint[k * m + i], share[i * columns + column]);
                }
                self.balance.column[k] = rate;
            }
            self.balance.solve_column();
            for k in 0..self.constraints.len() {
                let friction = self.balance.joints[k].ratio * self.balance.column[k];
                self.subtract(k, at, constraints, friction, (&mut *x, &mut *share), [columns, column]);
            }
        }
    }
}

/// Derivatives of b c x to the coordinates of the pair and to their rates at constant normal force x `(6, 6)` each.
#[inline(always)]
fn at_constant_normal<R: Real>(sliding: &Sliding<R>, normal: R) -> ([[R; 6]; 6], [[R; 6]; 6]) {
    let zero = normal.zero();
    let (force, grip) = (sliding.ratio * normal, sliding.slope * normal);
    let (mut to_q, mut to_v) = ([[zero; 6]; 6], [[zero; 6]; 6]);
    for r in 0..6 {
        for s in 0..6 {
            to_v[r][s] = grip * sliding.direction[r] * sliding.direction[s];
        }
    }
    if let Some(turning) = &sliding.turning {
        for s in 0..6 {
            let mut speed = zero;
            for r in 0..6 {
                speed = speed.plus_product(turning[r][s], sliding.rates[r]);
            }
            for r in 0..6 {
                to_q[r][s] = (grip * sliding.direction[r] * speed).plus_product(force, turning[r][s]);
            }
        }
    }
    (to_q, to_v)
}
