//! Loads of the law `foundation`, and the derivatives of its contact forces in the axes (n, t) of the elastic force.
//!
//! # Source
//! The derivatives of the equations in `foundation.rs`.

use super::arc::Arcs;
use super::joint_force::ForceSlopes;
use crate::bore::Radius;
use crate::lanes::Real;
use crate::plane::dot;

/// Load that the foundation carries at one eccentricity.
#[derive(Debug, Clone, Copy)]
pub struct FoundationLoad<R = f64> {
    /// Potential U [J].
    pub energy: R,
    /// Elastic force on the bushing, dU/de `(2,)` [N].
    pub force: [R; 2],
    /// Its derivative to e, entries xx, xy, yy [N/m].
    pub stiffness: [R; 3],
}

/// Load of the foundation on a journal, whose angle alpha matters if it is worn.
pub(super) struct RotatedLoad<R> {
    /// Potential, force and their derivatives to e.
    pub(super) to_e: FoundationLoad<R>,
    /// M = dU/dalpha [N m], and its derivatives to e `(2,)` [N] and alpha [N m]; zero for a round journal.
    pub(super) moment: R,
    pub(super) moment_e: [R; 2],
    pub(super) moment_alpha: R,
}

/// A contact in the axes (n, t) of its elastic force: n the direction in which the journal presses, t its
/// left normal.
pub(super) struct Resultant<R> {
    pub(super) n: [R; 2],
    pub(super) t: [R; 2],
    /// e.n and e.t [m].
    pub(super) en: R,
    pub(super) et: R,
    /// Relative velocity differentiated in the bushing's frame along n and along t [m/s], and omega_i - omega_j [rad/s].
    pub(super) bn: R,
    pub(super) bt: R,
    pub(super) spin: R,
    pub(super) omega_bushing: R,
    /// Elastic force F_el, zero where none acts [N], and one over it, one where none acts [1/N].
    pub(super) elastic: R,
    pub(super) per_elastic: R,
    /// Lever arm b of the elastic moment about the journal's centre, zero for a round one, and b + e x n, that of the normal force about the
    /// bushing's centre [m].
    pub(super) lever: R,
    pub(super) offset: R,
    /// 1 + D delta_dot [1].
    pub(super) factor: R,
    /// Normal force F_N [N].
    pub(super) normal: R,
    /// F_T / F_N [1] and its derivative to the sliding speed [s/m].
    pub(super) mu: R,
    pub(super) mu_v: R,
    /// Friction force F_T [N].
    pub(super) friction: R,
    /// Radius of the journal in the direction of n.
    pub(super) journal: Radius<R>,
}

impl<R: Real> RotatedLoad<R> {
    /// Sets the derivatives to zero where there is no contact.
    #[inline(always)]
    pub(super) fn keep_where(&mut self, touches: R::Mask) {
        let nothing = self.moment.zero();
        for k in 0..3 {
            self.to_e.stiffness[k] = R::select(touches, self.to_e.stiffness[k], nothing);
        }
        for k in 0..2 {
            self.moment_e[k] = R::select(touches, self.moment_e[k], nothing);
        }
        self.moment_alpha = R::select(touches, self.moment_alpha, nothing);
    }
}

impl<R: Real> Resultant<R> {
    /// Derivative of (force, torques) without the film to (e, w, omega_i, omega_j), and with a worn journal to alpha, in the axes (n, t);
    /// `damping` is D [s/m].
    #[inline(always)]
    pub(super) fn slopes<A: Arcs<R>>(&self, load: &RotatedLoad<R>, damping: R) -> ForceSlopes<R> {
        let &Resultant { n, t, en, et, bn, bt, spin, omega_bushing, elastic, per_elastic, .. } = self;
        let &Resultant { lever, offset, factor, normal, mu, mu_v, friction, journal, .. } = self;
        let nothing = en.zero();
        let one = nothing.like(1.0);
        let [xx, xy, yy] = load.to_e.stiffness;
        let (kn, kt) =
            ([xx * n[0] + xy * n[1], xy * n[0] + yy * n[1]], [xx * t[0] + xy * t[1], xy * t[0] + yy * t[1]]);
        // Columns in the axes (n, t): e along n, e along t, w along n, w along t, omega_i, omega_j, alpha. The elastic force depends on the
        // first two and the last.
        const ALPHA: usize = 6;
        let arm = journal.r + en;
        let rate_own = [nothing, omega_bushing, one, nothing, lever, et - lever, nothing];
        let sliding_own = [-omega_bushing, nothing, nothing, one, journal.r, -arm, nothing];
        let (damped, grip) = (elastic * damping, mu_v * normal);
        let mut columns = [[nothing; 4]; ALPHA + 1];
        for c in 0..if A::JOURNAL { ALPHA + 1 } else { ALPHA } {
            let (mut d_normal, mut d_sliding) = (damped * rate_own[c], sliding_own[c]);
            let (mut turn, mut d_lever, mut d_radius) = (nothing, nothing, nothing);
            let changes_force = c < 2 || c == ALPHA;
            if changes_force {
                let force = if c == 0 {
                    kn
                } else if c == 1 {
                    kt
                } else {
                    load.moment_e
                };
                let d_elastic = dot(n, force);
                turn = dot(t, force) * per_elastic;
                d_normal += d_elastic * factor + damped * bt * turn;
                d_sliding -= bn * turn;
                if A::JOURNAL {
                    let q = load.moment_e;
                    let moment = if c == 0 {
                        dot(q, n)
                    } else if c == 1 {
                        dot(q, t)
                    } else {
                        load.moment_alpha
                    };
                    d_lever = (moment - lever * d_elastic) * per_elastic;
                    // The place on the journal in the direction of the force falls behind as alpha grows.
                    d_radius = journal.d1 * if c == ALPHA { turn - one } else { turn };
                    d_normal += damped * d_lever * spin;
                    d_sliding += spin * d_radius;
                }
            }
            let d_friction = mu * d_normal + grip * d_sliding;
            let column = &mut columns[c];
            *column =
                [-d_normal, -d_friction, -(journal.r * d_friction), d_normal * offset + d_friction * arm];
            if changes_force {
                // The axes turn with the force, and the arms change with e.
                column[0] += friction * turn;
                column[1] -= normal * turn;
                column[3] += normal * en * turn + friction * et * turn;
            }
            if A::JOURNAL {
                column[2] -= d_radius * friction + d_normal * lever + normal * d_lever;
                column[3] += normal * d_lever + friction * d_radius;
            }
        }
        columns[0][3] += friction;
        columns[1][3] -= normal;
        let mut rows = [[nothing; 6]; 4];
        for c in 0..ALPHA {
            for r in 0..4 {
                rows[r][c] = columns[c][r];
            }
        }
        ForceSlopes { u: n, rows, to_turn: if A::JOURNAL { Some(columns[ALPHA]) } else { None } }
    }
}
