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

use super::frame::{End, Frame};
use crate::contact::{JointForce, JointMotion, LawLanes, PolarEccentricity, Walls};
use crate::lanes::Real;
use crate::plane::{fused_cross as cross, fused_dot as dot, left};

/// Derivatives of a force `(3,)` to three coordinates and to their rates `(3, 3)`.
pub type Block<R> = [[[R; 3]; 3]; 2];

/// Derivatives of the generalised force on a pair of bodies, block by block.
pub trait Blocks<R> {
    /// Derivatives of the force on body `ON` of the pair to the coordinates of body `TO` and to their rates.
    fn block<const ON: usize, const TO: usize>(&self) -> Block<R>;
}

/// Derivatives of the force on the journal's body in global axes and of the moments on both bodies: rows (F_x, F_y, M_i
/// + a_i x F, M_j - a_j x F). The bodies' positions and velocities act through e and w alone.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PairSlopes<R = f64> {
    /// To e and to w, in global axes `(4, 2)` each.
    to_e: [[R; 2]; 4],
    to_w: [[R; 2]; 4],
    /// To the angles of journal and bushing at constant positions, and to the angular velocities `(4, 2)` each.
    to_angle: [[R; 2]; 4],
    to_omega: [[R; 2]; 4],
}

impl<R: Real> Blocks<R> for PairSlopes<R> {
    #[inline(always)]
    fn block<const ON: usize, const TO: usize>(&self) -> Block<R> {
        let zero = self.to_e[0][0].zero();
        let mut block = [[[zero; 3]; 3]; 2];
        for (block, (along, turning)) in
            block.iter_mut().zip([(&self.to_e, &self.to_angle), (&self.to_w, &self.to_omega)])
        {
            for r in 0..3 {
                // The force on the bushing's body is the opposite one, and e falls with its position.
                let row = if r == 2 { 2 + ON } else { r };
                let opposite = r < 2 && ON == 1;
                for c in 0..2 {
                    block[r][c] = if opposite != (TO == 1) { -along[row][c] } else { along[row][c] };
                }
                block[r][2] = if opposite { -turning[row][TO] } else { turning[row][TO] };
            }
        }
        block
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
        let (wi, wj) = (fi.v[k].plus_product(fi.omega, pi[k]), fj.v[k].plus_product(fj.omega, pj[k]));
        w[k] = wi - wj;
    }
    (e, w)
}

/// A joint with clearance as a source of force in an island, or one per lane.
pub trait Touching<R> {
    /// Ends of the joint, journal and bushing, and its contact law on the surfaces as worn so far.
    fn parts(&self) -> ([End<R>; 2], &LawLanes<R>);
}

/// Motion of a joint, with what else its generalised forces need.
#[derive(Debug, Clone, Copy)]
pub struct PairMotion<R> {
    /// Arms of journal and bushing `(2, 2)` [m], e [m] and w [m/s], all in global axes.
    arms: [[R; 2]; 2],
    separation: [[R; 2]; 2],
    /// Motion in the bushing's frame, and the place of the contact there.
    pub motion: JointMotion<R>,
    pub place: PolarEccentricity<R>,
}

impl<R: Real> PairMotion<R> {
    /// Motion of the joint with these `ends`, its journal on the body in frame `fi` and its bushing on that in `fj`.
    #[inline(always)]
    pub(crate) fn new([i, j]: [End<R>; 2], fi: &Frame<R>, fj: &Frame<R>) -> Self {
        let arms = [fi.turn(i.arm), fj.turn(j.arm)];
        let (e, w) = separation(fi, arms[0], fj, arms[1]);
        let (omega_journal, omega_bushing) = (fi.omega, fj.omega);
        let turn = fi.angle - fj.angle;
        let motion =
            JointMotion { e: fj.turn_back(e), w: fj.turn_back(w), omega_journal, omega_bushing, turn };
        PairMotion { arms, separation: [e, w], place: PolarEccentricity::new(motion.e), motion }
    }
}

/// Generalised forces `(6,)` [N, N m] of a joint with this `law` at the motion `pair` and the surfaces `wall`, with its journal on the body in frame
/// `fi` and its bushing on that in `fj`; the force of the joint in the bushing's frame; and with `JACOBIAN` the exact derivatives of the
/// generalised forces, else zero.
#[inline(always)]
pub(crate) fn pair_force<R: Real, const JACOBIAN: bool>(
    law: &LawLanes<R>,
    pair: &PairMotion<R>,
    wall: &Walls<R>,
    fi: &Frame<R>,
    fj: &Frame<R>,
) -> ([R; 6], JointForce<R>, PairSlopes<R>) {
    let PairMotion { arms: [ai, aj], separation: [e, w], motion, place } = *pair;
    let (joint, slopes) = law.force::<JACOBIAN>((&place, wall), &motion);
    let force = fj.turn(joint.force);
    let pair = if JACOBIAN {
        let axis = fj.turn(slopes.u);
        let mut pair = PairSlopes::of_law(&slopes.rows, axis, [e, w], force);
        pair.add_arms([fi, fj], [ai, aj], force);
        if let Some(to_turn) = slopes.to_turn {
            pair.add_turn(to_turn, axis, [ai, aj]);
        }
        pair
    } else {
        PairSlopes::none(force[0])
    };
    let on_bodies = [
        force[0],
        force[1],
        joint.torque_journal + cross(ai, force),
        -force[0],
        -force[1],
        joint.torque_bushing - cross(aj, force),
    ];
    (on_bodies, joint, pair)
}

impl<R: Real> PairSlopes<R> {
    /// No dependence on the motion; `like` sets the number of lanes.
    #[inline(always)]
    fn none(like: R) -> Self {
        let nothing = [[like.zero(); 2]; 4];
        PairSlopes { to_e: nothing, to_w: nothing, to_angle: nothing, to_omega: nothing }
    }

    /// The derivatives of the joint's force and torques from `rows` in the contact's axes, the first of which is `u` in
    /// global axes; e [m], w [m/s] and the force `force` [N] are in global axes as well. The angle of the journal has no effect yet,
    /// that of the bushing turns the law.
    #[inline(always)]
    fn of_law(rows: &[[R; 6]; 4], u: [R; 2], [e, w]: [[R; 2]; 2], force: [R; 2]) -> Self {
        let t = left(u);
        let (e, w) = ([dot(e, u), dot(e, t)], [dot(w, u), dot(w, t)]);
        let [a, b, c, d] = rows;
        // Each array is written once, which filling it row by row would not be.
        let mut slopes = PairSlopes {
            to_e: [to_place(a, u), to_place(b, u), to_place(c, u), to_place(d, u)],
            to_w: [to_rate(a, u), to_rate(b, u), to_rate(c, u), to_rate(d, u)],
            to_angle: [to_turned(a, e, w), to_turned(b, e, w), to_turned(c, e, w), to_turned(d, e, w)],
            to_omega: [[a[4], a[5]], [b[4], b[5]], [c[4], c[5]], [d[4], d[5]]],
        };
        for columns in [&mut slopes.to_e, &mut slopes.to_w, &mut slopes.to_angle, &mut slopes.to_omega] {
            for c in 0..2 {
                let (along, across) = (columns[0][c], columns[1][c]);
                columns[0][c] = (along * u[0]).plus_product(across, t[0]);
                columns[1][c] = (along * u[1]).plus_product(across, t[1]);
            }
        }
        slopes.to_angle[0][1] -= force[1];
        slopes.to_angle[1][1] += force[0];
        slopes
    }

    /// Adds the derivatives `to_turn` to the angle of a worn journal from the bushing, in the contact's axes, the first of which is `u`
    /// in global axes; the force has the moments of `arms` of journal and bushing [m].
    #[inline(always)]
    fn add_turn(&mut self, to_turn: [R; 4], u: [R; 2], [ai, aj]: [[R; 2]; 2]) {
        let t = left(u);
        let [along, across, journal, bushing] = to_turn;
        let force = [0, 1].map(|k| (along * u[k]).plus_product(across, t[k]));
        let column = [force[0], force[1], journal + cross(ai, force), bushing - cross(aj, force)];
        for r in 0..4 {
            self.to_angle[r][0] += column[r];
            self.to_angle[r][1] -= column[r];
        }
    }

    /// Adds what the arms `arms` of journal and bushing [m] contribute: e and w change with the bodies' angles and angular
    /// velocities, and the force has moments on the bodies.
    #[inline(always)]
    fn add_arms(&mut self, [fi, fj]: [&Frame<R>; 2], arms: [[R; 2]; 2], force: [R; 2]) {
        let [ai, aj] = arms;
        let (pi, pj) = (left(ai), left(aj));
        for r in 0..4 {
            let (ke, kw) = (self.to_e[r], self.to_w[r]);
            self.to_angle[r][0] = dot(ke, pi).minus_product(fi.omega, dot(kw, ai));
            self.to_angle[r][1] += (-dot(ke, pj)).plus_product(fj.omega, dot(kw, aj));
            self.to_omega[r][0] += dot(kw, pi);
            self.to_omega[r][1] -= dot(kw, pj);
        }
        for columns in [&mut self.to_e, &mut self.to_w, &mut self.to_angle, &mut self.to_omega] {
            for c in 0..2 {
                let along = [columns[0][c], columns[1][c]];
                columns[2][c] += cross(ai, along);
                columns[3][c] -= cross(aj, along);
            }
        }
        self.to_angle[2][0] += cross(pi, force);
        self.to_angle[3][1] -= cross(pj, force);
    }
}

/// Of a row of slopes in the axes u and its left normal, those to the place e in the axes in which `u` is given `(2,)`.
#[inline(always)]
fn to_place<R: Real>(row: &[R; 6], u: [R; 2]) -> [R; 2] {
    let t = left(u);
    [(row[0] * u[0]).plus_product(row[1], t[0]), (row[0] * u[1]).plus_product(row[1], t[1])]
}

/// Of such a row, those to the rate w of the place in the same axes `(2,)`.
#[inline(always)]
fn to_rate<R: Real>(row: &[R; 6], u: [R; 2]) -> [R; 2] {
    to_place(&[row[2], row[3], row[4], row[5], row[0], row[1]], u)
}

/// The slopes to the angles of journal and bushing, of which the first has no effect, at e and w in the axes of the row `(2,)`.
#[inline(always)]
fn to_turned<R: Real>(row: &[R; 6], e: [R; 2], w: [R; 2]) -> [R; 2] {
    [e[0].zero(), cross([row[0], row[1]], e) + cross([row[2], row[3]], w)]
}
