//! Contact law `foundation` with a worn journal, whose surface turns in the bore.
//!
//! With the gap function g(psi) = e.u + R1 - R(psi) - h(psi - alpha) [m] of `turned_arc.rs` the potential U(V)
//! [J] of `foundation.rs` is a function of the eccentricity e and of the angle alpha [rad] of the journal's
//! body from the bushing's. The elastic force on the journal is -dU/de, of size F_el and direction -n; the
//! pressure on the journal's uneven surface also has the moment -M about its centre, M = dU/dalpha [N m], with the
//! lever arm b = M / F_el [m]. The law stays conservative: dU/dt = F_el delta_dot with
//!
//!   delta_dot = n.(w - omega_j x e) + b (omega_i - omega_j),
//!
//! and F_N = F_el max(0, 1 + D delta_dot) damps force and moment alike. Friction acts at e + R_j n, with the
//! radius R_j of the worn journal in the direction of n: v_t = w.t + omega_i R_j - omega_j (R_j + e.n). Torques:
//! -R_j F_T - b F_N on the journal, F_N (e x n + b) + F_T (e.n + R_j) on the bushing; no moment is left over,
//! and the power is -F_N delta_dot - F_T v_t.
//!
//! # Source
//! As of `foundation.rs`; the moment follows from the same potential.

// Compiled into the loops of the lanes, where closures of iterators are not: plain loops.
#![allow(clippy::needless_range_loop)]

use super::foundation::{Foundation, FoundationLoad, in_bushing_frame};
use super::joint_force::{ForceSlopes, JointForce, JointMotion};
use super::journal::{Journal, within_a_turn};
use super::law::Elastic;
use super::stiffness::equivalent_penetration;
use super::turned_arc::{TurnedArc, TurnedIntegrals};
use crate::bore::Radius;
use crate::lanes::{Real, direction_angle};
use crate::plane::{dot, left, length};

/// A tabulated bore with a worn journal, or one per lane.
pub trait JournalInArc<R: Real> {
    /// Integrals over the arc in contact at the eccentricity `e` [m] with the journal turned by `alpha` [rad]; the second derivatives
    /// only if `SECOND`.
    fn integrate<const SECOND: bool>(&self, e: [R; 2], alpha: R) -> TurnedIntegrals<R>;
    /// Penetration in free flight, not above zero [m]; zero where `touches` is above zero.
    fn free_penetration(&self, e: [R; 2], alpha: R, touches: R) -> R;
    /// Direction in which the journal is nearest to the bore at the eccentricity `e` [m], which is not zero `(2,)` [1], and the derivative of
    /// the gap to alpha there [m/rad]; zeros where `penetration` is above zero.
    fn nearest_free(&self, e: [R; 2], alpha: R, penetration: R) -> ([R; 2], R);
    /// Radius of the journal at the angle `chi` in its own body, within half a turn of zero [rad].
    fn journal(&self, chi: R) -> Radius<R>;
}

/// A tabulated bore with the journal in it.
#[derive(Debug, Clone, Copy)]
pub struct Pair<'a> {
    turned: TurnedArc<'a>,
    journal: &'a Journal,
}

impl JournalInArc<f64> for Pair<'_> {
    #[inline(always)]
    fn integrate<const SECOND: bool>(&self, e: [f64; 2], alpha: f64) -> TurnedIntegrals {
        self.turned.integrate::<true>(e, alpha)
    }

    #[inline(always)]
    fn free_penetration(&self, e: [f64; 2], alpha: f64, touches: f64) -> f64 {
        if touches <= 0.0 { self.turned.free_penetration(e, alpha) } else { 0.0 }
    }

    #[inline(always)]
    fn nearest_free(&self, e: [f64; 2], alpha: f64, penetration: f64) -> ([f64; 2], f64) {
        if penetration > 0.0 { ([0.0; 2], 0.0) } else { self.turned.nearest(e, alpha) }
    }

    #[inline(always)]
    fn journal(&self, chi: f64) -> Radius {
        self.journal.radius_at(chi)
    }
}

/// The law of one joint with a worn journal.
pub type FoundationWithJournal<'a> = Foundation<f64, Pair<'a>>;

/// Load of the foundation on a turned journal.
pub(super) struct TurnedLoad<R> {
    /// Potential, force and their derivatives to e.
    to_e: FoundationLoad<R>,
    /// M = dU/dalpha [N m], and its derivatives to e `(2,)` [N] and alpha [N m].
    moment: R,
    moment_e: [R; 2],
    moment_alpha: R,
}

/// A contact in the axes (n, t) of its elastic force, as in `foundation.rs`; what is new there for the journal.
struct TurnedResultant<R> {
    n: [R; 2],
    t: [R; 2],
    /// e.n and e.t [m].
    en: R,
    et: R,
    /// Relative velocity differentiated in the bushing's frame along t [m/s], and omega_i - omega_j [rad/s].
    bn: R,
    bt: R,
    spin: R,
    omega_bushing: R,
    /// Elastic force F_el, zero where none acts [N], and one over it, one where none acts [1/N].
    elastic: R,
    per_elastic: R,
    /// Lever arm b of the elastic moment [m].
    lever: R,
    /// 1 + D delta_dot [1].
    factor: R,
    /// Normal force F_N [N].
    normal: R,
    /// F_T / F_N [1] and its derivative to the sliding speed [s/m].
    mu: R,
    mu_v: R,
    /// Friction force F_T [N].
    friction: R,
    /// Radius of the journal in the direction of n.
    journal: Radius<R>,
}

impl Foundation {
    /// An unworn journal with `points` control points on this foundation.
    pub(crate) fn new_journal(&self, points: usize) -> Journal {
        Journal::new(self.surface.journal_radius, points, Some(self.arc().intervals()))
    }

    /// The law with this journal, which has a table of its depth if it belongs to a joint with this law.
    #[inline(always)]
    pub(crate) fn with_journal<'a>(&'a self, journal: &'a Journal) -> Option<FoundationWithJournal<'a>> {
        let turned = TurnedArc { arc: self.arc(), journal: journal.table()? };
        let arc = Pair { turned, journal };
        Some(Foundation { surface: self.surface, modulus: self.modulus, arc })
    }
}

impl FoundationWithJournal<'_> {
    /// Potential, force and stiffness to e at the eccentricity `e` [m] with the journal turned by `alpha` [rad].
    #[inline(always)]
    pub(crate) fn load_at(&self, e: [f64; 2], alpha: f64) -> FoundationLoad {
        self.turned_load(self.arc.turned.integrate::<false>(e, alpha)).to_e
    }

    /// Half the angle over which the contact extends at the eccentricity `e` [m] with the journal turned by `alpha` [rad].
    pub(crate) fn half_arc(&self, e: [f64; 2], alpha: f64) -> f64 {
        let [xx, _, yy] = self.arc.turned.integrate::<false>(e, alpha).to_e.d;
        0.5 * (xx + yy)
    }

    /// The tabulated bore with the journal in it.
    #[inline(always)]
    pub(crate) fn turned_arc(&self) -> TurnedArc<'_> {
        self.arc.turned
    }

    /// The elastic part of the contact.
    pub(super) fn elastic_with_journal(&self, motion: &JointMotion) -> Elastic {
        let TurnedLoad { to_e: FoundationLoad { energy, force, .. }, moment, .. } =
            self.load_with_journal::<false>(motion.e, motion.turn);
        let size = libm::hypot(force[0], force[1]);
        if size <= 0.0 {
            return Elastic::default();
        }
        let spin = motion.omega_journal - motion.omega_bushing;
        let power = dot(force, in_bushing_frame(motion)) + moment * spin;
        Elastic { stored: energy, force: size, rate: power / size }
    }
}

impl<R: Real, A: JournalInArc<R>> Foundation<R, A> {
    /// Potential, force and moment at the eccentricity `e` [m] with the journal turned by `alpha` [rad]; their derivatives only if `SECOND`.
    #[inline(always)]
    fn load_with_journal<const SECOND: bool>(&self, e: [R; 2], alpha: R) -> TurnedLoad<R> {
        self.turned_load(self.arc.integrate::<SECOND>(e, alpha))
    }

    /// The load with these integrals over the arc in contact.
    #[inline(always)]
    fn turned_load(&self, integrals: TurnedIntegrals<R>) -> TurnedLoad<R> {
        let TurnedIntegrals { to_e: sum, t, et, tt } = integrals;
        let potential = self.modulus.potential(sum.v);
        let (modulus, growth, [px, py]) = (potential.modulus, potential.growth, sum.p);
        TurnedLoad {
            to_e: FoundationLoad {
                energy: potential.energy,
                force: [modulus * px, modulus * py],
                stiffness: [
                    modulus * sum.d[0] + growth * px * px,
                    modulus * sum.d[1] + growth * px * py,
                    modulus * sum.d[2] + growth * py * py,
                ],
            },
            moment: modulus * t,
            moment_e: [modulus * et[0] + growth * px * t, modulus * et[1] + growth * py * t],
            moment_alpha: modulus * tt + growth * t * t,
        }
    }

    /// Force on the journal; with `JACOBIAN` its exact derivative, else no slopes.
    #[inline(always)]
    pub(super) fn force_with_journal<const JACOBIAN: bool>(
        &self,
        motion: &JointMotion<R>,
    ) -> (JointForce<R>, ForceSlopes<R>) {
        let s = &self.surface;
        let JointMotion { e, w, omega_journal, omega_bushing, turn } = *motion;
        let mut loaded = self.load_with_journal::<JACOBIAN>(e, turn);
        let nothing = e[0].zero();
        let one = nothing.like(1.0);
        let size = length(loaded.to_e.force);
        let pressed = nothing.below(size);
        let per_elastic = one / R::select(pressed, size, one);
        let n = [
            R::select(pressed, loaded.to_e.force[0] * per_elastic, one),
            R::select(pressed, loaded.to_e.force[1] * per_elastic, nothing),
        ];
        let t = left(n);
        let (en, et) = (dot(e, n), dot(e, t));
        let (wn, wt) = (dot(w, n), dot(w, t));
        let spin = omega_journal - omega_bushing;
        let lever = loaded.moment * per_elastic;
        let (bn, bt) = (wn + omega_bushing * et, wt - omega_bushing * en);
        let factor = one + s.damping * (bn + lever * spin);
        // NaN compares as no contact.
        let touches = R::both(pressed, nothing.below(factor));
        let elastic = R::select(touches, size, nothing);
        let normal = elastic * factor;
        let journal = self.arc.journal(within_a_turn(direction_angle(n) - turn));
        let arm = journal.r + en;
        let sliding = wt + omega_journal * journal.r - omega_bushing * arm;
        let sliding = R::select(touches, sliding, nothing);
        let (mu, mu_v) = s.friction(sliding);
        let friction = mu * normal;
        let mut out = JointForce {
            force: [-normal * n[0] - friction * t[0], -normal * n[1] - friction * t[1]],
            torque_journal: -(journal.r * friction) - normal * lever,
            torque_bushing: normal * (lever - et) + friction * arm,
            normal,
            direction: [R::select(touches, n[0], nothing), R::select(touches, n[1], nothing)],
            penetration: equivalent_penetration(size, s.stiffness) + self.arc.free_penetration(e, turn, size),
            sliding,
        };
        s.add_film(motion, &mut out);
        let mut slopes = ForceSlopes::none(nothing);
        if JACOBIAN {
            let resultant = TurnedResultant {
                n,
                t,
                en,
                et,
                bn,
                bt,
                spin,
                omega_bushing,
                elastic,
                per_elastic,
                lever,
                factor,
                normal,
                mu,
                mu_v,
                friction,
                journal,
            };
            loaded.keep_where(touches);
            slopes = self.slopes_with_journal(&resultant, &loaded);
            s.add_film_slopes(&mut slopes);
        }
        (out, slopes)
    }

    /// Rate of the largest gap, where `penetration` is not above zero [m/s]; in the middle of the bore, from where every direction leads to
    /// the wall, the speed.
    #[inline(always)]
    pub(super) fn approach_with_journal(&self, motion: &JointMotion<R>, penetration: R) -> R {
        let JointMotion { e, w, omega_journal, omega_bushing, turn } = *motion;
        let (direction, to_alpha) = self.arc.nearest_free(e, turn, penetration);
        let rate = dot(direction, in_bushing_frame(motion)) + to_alpha * (omega_journal - omega_bushing);
        let size = length(e);
        R::select(size.zero().below(size), rate, length(w))
    }

    /// Derivative of (force, torques) without the film to (e, w, omega_i, omega_j) and to alpha, in the axes (n, t).
    #[inline(always)]
    fn slopes_with_journal(&self, resultant: &TurnedResultant<R>, load: &TurnedLoad<R>) -> ForceSlopes<R> {
        let s = &self.surface;
        let &TurnedResultant {
            n,
            t,
            en,
            et,
            bn,
            bt,
            spin,
            omega_bushing,
            elastic,
            per_elastic,
            lever,
            factor,
            normal,
            mu,
            mu_v,
            friction,
            journal,
        } = resultant;
        let nothing = en.zero();
        let one = nothing.like(1.0);
        let ([xx, xy, yy], q) = (load.to_e.stiffness, load.moment_e);
        // Columns: e along n, e along t, alpha; then w along n, w along t, omega_i, omega_j, on which the elastic part does not depend.
        let forces = [
            [xx * n[0] + xy * n[1], xy * n[0] + yy * n[1]],
            [xx * t[0] + xy * t[1], xy * t[0] + yy * t[1]],
            q,
        ];
        let moments = [dot(q, n), dot(q, t), load.moment_alpha];
        let arm = journal.r + en;
        let rate_own = [nothing, omega_bushing, nothing, one, nothing, lever, et - lever];
        let sliding_own = [-omega_bushing, nothing, nothing, nothing, one, journal.r, -arm];
        let (damped, grip) = (elastic * s.damping, mu_v * normal);
        let mut columns = [[nothing; 4]; 7];
        for c in 0..7 {
            let (mut d_normal, mut d_sliding) = (damped * rate_own[c], sliding_own[c]);
            let (mut turn, mut d_lever, mut d_radius) = (nothing, nothing, nothing);
            if c < 3 {
                let d_elastic = dot(n, forces[c]);
                turn = dot(t, forces[c]) * per_elastic;
                d_lever = (moments[c] - lever * d_elastic) * per_elastic;
                // The place on the journal in the direction of the force falls behind as alpha grows.
                d_radius = journal.d1 * if c == 2 { turn - one } else { turn };
                d_normal += d_elastic * factor + damped * (bt * turn + d_lever * spin);
                d_sliding += spin * d_radius - bn * turn;
            }
            let d_friction = mu * d_normal + grip * d_sliding;
            columns[c] = [
                friction * turn - d_normal,
                -d_friction - normal * turn,
                -(journal.r * d_friction) - d_radius * friction - d_normal * lever - normal * d_lever,
                d_normal * (lever - et)
                    + normal * (d_lever + en * turn)
                    + d_friction * arm
                    + friction * (d_radius + et * turn),
            ];
        }
        columns[0][3] += friction;
        columns[1][3] -= normal;
        let mut rows = [[nothing; 6]; 4];
        for (c, column) in [0, 1, 3, 4, 5, 6].into_iter().enumerate() {
            for r in 0..4 {
                rows[r][c] = columns[column][r];
            }
        }
        ForceSlopes { u: n, rows, to_turn: Some(columns[2]) }
    }
}

impl<R: Real> TurnedLoad<R> {
    /// Sets the derivatives to zero where there is no contact.
    #[inline(always)]
    fn keep_where(&mut self, touches: R::Mask) {
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
