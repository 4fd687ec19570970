//! Generalised forces of a joint with clearance on its two bodies, from the force in the bushing's frame.
//!
//! Coordinates of the pair: (x, y, angle) [m, m, rad] of the journal's body, then of the bushing's. With the
//! arms a from the bodies' reference points to the joint's centres in global axes [m], e = x_i + a_i - x_j -
//! a_j and w = de/dt. The generalised force on the journal's body is (F, M_i + a_i x F), on the bushing's
//! (-F, M_j - a_j x F), with the force F [N] and the torques M [N m] of the contact law. The derivatives are
//! exact.
//!
//! # Source
//! Clearance joint as a force element: Flores, Ambrosio, Claro, Lankarani (2008), Kinematics and Dynamics of
//! Multibody Systems with Imperfect Joints.

// In lanes, closures of iterators are not compiled for the instruction set of the loop around them.
#![allow(clippy::needless_range_loop)]

use super::frame::{End, Frame};
use crate::contact::{JointForce, JointMotion};
use crate::lanes::Real;
use crate::plane::{cross, dot, left};

/// Derivatives of the generalised force on a pair of bodies, row by row.
pub trait Rows<R> {
    /// Derivatives of entry `r` of the force to the six coordinates and to their rates.
    fn row(&self, r: usize) -> ([R; 6], [R; 6]);
}

/// Generalised forces of a pair of bodies.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PairForce<R = f64> {
    /// Generalised force `(6,)` [N, N m].
    pub f: [R; 6],
    /// Force of the joint in the bushing's frame.
    pub joint: JointForce<R>,
    /// Eccentricity in the bushing's frame `(2,)` [m].
    pub e: [R; 2],
    /// Derivatives of f; zero unless computed with `JACOBIAN`.
    pub slopes: PairSlopes<R>,
}

/// Derivatives of (F, M_i, M_j) in global axes, and the arms that turn them into those of the generalised
/// force.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PairSlopes<R = f64> {
    /// Derivatives to the coordinates `(4, 6)`; zero unless computed with `JACOBIAN`.
    to_q: [[R; 6]; 4],
    /// Derivatives to their rates `(4, 6)`.
    to_v: [[R; 6]; 4],
    /// Arms of journal and bushing in global axes `(2, 2)` [m].
    arms: [[R; 2]; 2],
    /// Derivative of the moment of F to the arm's own angle, on either body.
    swing: [R; 2],
}

impl<R: Real> Rows<R> for PairSlopes<R> {
    #[inline(always)]
    fn row(&self, r: usize) -> ([R; 6], [R; 6]) {
        let mut rows = [self.to_q[0], self.to_v[0]];
        for (row, from) in rows.iter_mut().zip([&self.to_q, &self.to_v]) {
            for c in 0..6 {
                let along = [from[0][c], from[1][c]];
                row[c] = match r {
                    0 | 1 => along[r],
                    2 => from[2][c] + cross(self.arms[0], along),
                    3 | 4 => -along[r - 3],
                    _ => from[3][c] - cross(self.arms[1], along),
                };
            }
        }
        if r == 2 || r == 5 {
            rows[0][r] += self.swing[r / 3];
        }
        (rows[0], rows[1])
    }
}

/// e and its rate in global axes, from the arms turned there.
#[inline(always)]
fn separation<R: Real>(fi: &Frame<R>, ai: [R; 2], fj: &Frame<R>, aj: [R; 2]) -> ([R; 2], [R; 2]) {
    // Derivatives of the arms to the angles.
    let (pi, pj) = (left(ai), left(aj));
    let mut e = ai;
    let mut w = ai;
    for k in 0..2 {
        e[k] = fi.x[k] + ai[k] - fj.x[k] - aj[k];
        w[k] = fi.v[k] + fi.omega * pi[k] - fj.v[k] - fj.omega * pj[k];
    }
    (e, w)
}

/// Motion of a joint with its journal at `arm_i` of the body in frame `fi` and its bushing at `arm_j` of that
/// in `fj`, in the bushing's frame.
#[inline(always)]
pub(crate) fn joint_motion<R: Real>(
    fi: &Frame<R>,
    arm_i: [R; 2],
    fj: &Frame<R>,
    arm_j: [R; 2],
) -> JointMotion<R> {
    let (e, w) = separation(fi, fi.turn(arm_i), fj, fj.turn(arm_j));
    JointMotion { e: fj.turn_back(e), w: fj.turn_back(w), omega_journal: fi.omega, omega_bushing: fj.omega }
}

/// A joint with clearance as a source of force in an island.
pub trait Touching<R: Real> {
    /// Ends of the joint: journal, bushing.
    fn ends(&self) -> [End<R>; 2];
    /// Force of the joint at this motion; with `JACOBIAN` its exact derivative too.
    fn force<const JACOBIAN: bool>(&self, motion: &JointMotion<R>) -> JointForce<R>;
}

/// Generalised forces of a joint with its journal on the body in frame `fi` and its bushing on that in `fj`;
/// with `JACOBIAN` their exact derivatives.
#[inline(always)]
pub(crate) fn pair_force<R: Real, const JACOBIAN: bool>(
    touching: &impl Touching<R>,
    fi: &Frame<R>,
    fj: &Frame<R>,
) -> PairForce<R> {
    let [i, j] = touching.ends();
    let (ai, aj) = (fi.turn(i.arm), fj.turn(j.arm));
    let (e, w) = separation(fi, ai, fj, aj);
    let motion = JointMotion {
        e: fj.turn_back(e),
        w: fj.turn_back(w),
        omega_journal: fi.omega,
        omega_bushing: fj.omega,
    };
    let joint = touching.force::<JACOBIAN>(&motion);
    let force = fj.turn(joint.force);
    let nothing = force[0].zero();
    let mut slopes =
        PairSlopes { to_q: [[nothing; 6]; 4], to_v: [[nothing; 6]; 4], arms: [ai, aj], swing: [nothing; 2] };
    if JACOBIAN {
        slopes.fill(&joint.jacobian, [fi, fj], [e, w], force);
    }
    PairForce {
        f: [
            force[0],
            force[1],
            joint.torque_journal + cross(ai, force),
            -force[0],
            -force[1],
            joint.torque_bushing - cross(aj, force),
        ],
        joint,
        e: motion.e,
        slopes,
    }
}

impl<R: Real> PairSlopes<R> {
    /// Computes the derivatives from the law's `jacobian` in the bushing's frame, for the frames of journal
    /// and bushing, e [m] and its rate w [m/s] and the force `force` [N] in global axes.
    #[inline(always)]
    fn fill(&mut self, jacobian: &[[R; 6]; 4], [fi, fj]: [&Frame<R>; 2], [e, w]: [[R; 2]; 2], force: [R; 2]) {
        let [ai, aj] = self.arms;
        let (pi, pj) = (left(ai), left(aj));
        self.swing = [cross(pi, force), -cross(pj, force)];
        self.turn_law(jacobian, fj.cs);
        for r in 0..4 {
            let (ke, kw) = ([self.to_q[r][0], self.to_q[r][1]], [self.to_v[r][0], self.to_v[r][1]]);
            // The law turns with the bushing's angle as well.
            let mut turn = ke[0] * e[1] - ke[1] * e[0] + kw[0] * w[1] - kw[1] * w[0];
            if r == 0 {
                turn -= force[1];
            } else if r == 1 {
                turn += force[0];
            }
            let (own, others) = (dot(kw, pi), dot(kw, pj));
            self.to_q[r][2] = dot(ke, pi) - fi.omega * dot(kw, ai);
            self.to_q[r][3] = -ke[0];
            self.to_q[r][4] = -ke[1];
            self.to_q[r][5] = fj.omega * dot(kw, aj) - dot(ke, pj) + turn;
            self.to_v[r][2] += own;
            self.to_v[r][3] = -kw[0];
            self.to_v[r][4] = -kw[1];
            self.to_v[r][5] -= others;
        }
    }

    /// Fills the columns of e, w and the angular velocities from the law's `jacobian`, turned from the
    /// bushing's frame with the cosine and sine `[c, s]` of its angle into global axes.
    #[inline(always)]
    fn turn_law(&mut self, jacobian: &[[R; 6]; 4], [c, s]: [R; 2]) {
        for r in 0..4 {
            let turned = |column: usize, k: usize| {
                let (along, across) = (jacobian[r][column], jacobian[r][column + 1]);
                if k == 0 { along * c - across * s } else { along * s + across * c }
            };
            self.to_q[r][0] = turned(0, 0);
            self.to_q[r][1] = turned(0, 1);
            self.to_v[r][0] = turned(2, 0);
            self.to_v[r][1] = turned(2, 1);
            self.to_v[r][2] = jacobian[r][4];
            self.to_v[r][5] = jacobian[r][5];
        }
        for rows in [&mut self.to_q, &mut self.to_v] {
            for column in 0..6 {
                let (along, across) = (rows[0][column], rows[1][column]);
                rows[0][column] = c * along - s * across;
                rows[1][column] = s * along + c * across;
            }
        }
    }
}
