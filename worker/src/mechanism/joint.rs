//! From one joint's force, in its bushing's frame, to generalised forces of its two bodies and back.
//!
//! Coordinates of the pair: (x, y, angle) of the journal's body, then of the bushing's. With a the arms from the
//! bodies' reference points to the joint's centres in global axes and S the quarter turn:
//! e = x_i + a_i - x_j - a_j, w = de/dt; generalised force on the journal's body (F, M_i + a_i x F), on the
//! bushing's (-F, M_j - a_j x F).

use super::frame::{End, Frame};
use crate::contact::{JointForce, JointMotion};
use crate::lanes::Real;

/// Generalised forces of a pair of bodies, with derivatives.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PairForce<R = f64> {
    /// Generalised force `(6,)` [N, N m].
    pub f: [R; 6],
    /// Derivative to the coordinates `(6, 6)`; zero unless asked for.
    pub k: [[R; 6]; 6],
    /// Derivative to their rates `(6, 6)`; zero unless asked for.
    pub d: [[R; 6]; 6],
    /// The joint's own view.
    pub joint: JointForce<R>,
    /// Eccentricity in the bushing's frame [m].
    pub e: [R; 2],
}

#[inline(always)]
pub(super) fn cross<R: Real>(a: [R; 2], b: [R; 2]) -> R {
    a[0] * b[1] - a[1] * b[0]
}

/// e and its rate in global axes, from the arms turned there.
#[inline(always)]
fn separation<R: Real>(fi: &Frame<R>, ai: [R; 2], fj: &Frame<R>, aj: [R; 2]) -> ([R; 2], [R; 2]) {
    // Quarter-turned arms: derivatives of the arms to the angles.
    let (pi, pj) = ([-ai[1], ai[0]], [-aj[1], aj[0]]);
    let mut e = ai;
    let mut w = ai;
    for k in 0..2 {
        e[k] = fi.x[k] + ai[k] - fj.x[k] - aj[k];
        w[k] = fi.v[k] + fi.omega * pi[k] - fj.v[k] - fj.omega * pj[k];
    }
    (e, w)
}

/// Motion of a joint with its journal at `arm_i` of the body in frame `fi` and its bushing at `arm_j` of that in
/// `fj`, in the bushing's frame.
#[inline(always)]
pub fn joint_motion<R: Real>(fi: &Frame<R>, arm_i: [R; 2], fj: &Frame<R>, arm_j: [R; 2]) -> JointMotion<R> {
    let (e, w) = separation(fi, fi.turn(arm_i), fj, fj.turn(arm_j));
    JointMotion { e: fj.turn_back(e), w: fj.turn_back(w), omega_journal: fi.omega, omega_bushing: fj.omega }
}

/// A joint with clearance, as the forces of an island see it.
pub trait Touching<R: Real> {
    /// Places of journal and bushing.
    fn ends(&self) -> [End<R>; 2];
    /// What it does at this motion; with `JACOBIAN` the derivatives too.
    fn force<const JACOBIAN: bool>(&self, motion: &JointMotion<R>) -> JointForce<R>;
}

/// Generalised forces of a joint with its journal on the body in frame `fi` and its bushing on that in `fj`;
/// with `JACOBIAN` their exact derivatives.
#[inline(always)]
pub fn pair_force<R: Real, const JACOBIAN: bool>(
    touching: &impl Touching<R>,
    fi: &Frame<R>,
    fj: &Frame<R>,
) -> PairForce<R> {
    let [i, j] = touching.ends();
    let (ai, aj) = (fi.turn(i.arm), fj.turn(j.arm));
    let (pi, pj) = ([-ai[1], ai[0]], [-aj[1], aj[0]]);
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
    let mut out = PairForce {
        f: [
            force[0],
            force[1],
            joint.torque_journal + cross(ai, force),
            -force[0],
            -force[1],
            joint.torque_bushing - cross(aj, force),
        ],
        k: [[nothing; 6]; 6],
        d: [[nothing; 6]; 6],
        joint,
        e: motion.e,
    };
    if JACOBIAN {
        // Derivatives of (F, M_i, M_j) in global axes to e, w (global), omega_i, omega_j.
        let mut j = joint.jacobian;
        let [c, s] = fj.cs;
        for row in &mut j {
            for first in [0, 2] {
                let (a, b) = (row[first], row[first + 1]);
                row[first] = a * c - b * s;
                row[first + 1] = a * s + b * c;
            }
        }
        let [along_x, along_y, ..] = &mut j;
        for (x, y) in along_x.iter_mut().zip(along_y) {
            (*x, *y) = (c * *x - s * *y, s * *x + c * *y);
        }
        // Explicit dependence on the bushing's angle: the law turns with it.
        let mut turn = [nothing; 4];
        for (row, turn) in j.iter().zip(&mut turn) {
            *turn = row[0] * e[1] - row[1] * e[0] + row[2] * w[1] - row[3] * w[0];
        }
        turn[0] -= force[1];
        turn[1] += force[0];
        let mut kq = [[nothing; 6]; 4];
        let mut kv = [[nothing; 6]; 4];
        for r in 0..4 {
            let row = j[r];
            let along_e = |a: [R; 2]| row[0] * a[0] + row[1] * a[1];
            let along_w = |a: [R; 2]| row[2] * a[0] + row[3] * a[1];
            kq[r] = [
                row[0],
                row[1],
                along_e(pi) - fi.omega * along_w(ai),
                -row[0],
                -row[1],
                -along_e(pj) + fj.omega * along_w(aj) + turn[r],
            ];
            kv[r] = [row[2], row[3], along_w(pi) + row[4], -row[2], -row[3], -along_w(pj) + row[5]];
        }
        for column in 0..6 {
            for (from, to) in [(&kq, &mut out.k), (&kv, &mut out.d)] {
                let df = [from[0][column], from[1][column]];
                to[0][column] = df[0];
                to[1][column] = df[1];
                to[2][column] = from[2][column] + cross(ai, df);
                to[3][column] = -df[0];
                to[4][column] = -df[1];
                to[5][column] = from[3][column] - cross(aj, df);
            }
        }
        out.k[2][2] += cross(pi, force);
        out.k[5][5] -= cross(pj, force);
    }
    out
}
