//! Contact law `foundation`: conformal contact on an elastic (Winkler) foundation along the bore.
//!
//! Gap function g(psi) = e.u(psi) + R1 - R(psi) [m], positive in contact, with the eccentricity e [m], the
//! unit vector u at angle psi, the journal radius R1 and the worn bore R [m]. The pressure is p = kappa g /
//! (R2 L) [Pa], so that each radian of bore in contact pushes the journal along -u with kappa g; kappa [N/(m
//! rad)] is the foundation's modulus (`modulus.rs`), R2 the bore's unworn radius and L its width [m]. With V
//! = integral of g^2 / 2 over the arc in contact [m^2 rad] and the potential U(V) [J], the elastic force on
//! the journal is -dU/de and kappa = dU/dV.
//!
//! The modulus is the same all along the arc and such that an unworn bore gives F_el = K_n delta^1.5: within
//! 0.1 % for penetrations from 10 nm to 2 um in clearances from 1 um to 0.5 mm (see the test). The elastic
//! force is the gradient of a potential of e in the bushing's frame, so the law stays conservative as the
//! bore wears.
//!
//! With a worn journal, whose surface turns in the bore, the gap function is that of `rotated_arc.rs`, and U is a function of the
//! eccentricity e and of the angle alpha [rad] of the journal's body from the bushing's. The pressure on the journal's uneven surface
//! then also has the moment -M about its centre, M = dU/dalpha [N m], with the lever arm b = M / F_el [m]. The law stays conservative:
//! dU/dt = F_el delta_dot with
//!
//!   delta_dot = n.(w - omega_j x e) + b (omega_i - omega_j),
//!
//! and F_N = F_el max(0, 1 + D delta_dot) damps force and moment alike. Friction acts at e + R_j n, with the radius R_j of the journal in
//! the direction of n: v_t = w.t + omega_i R_j - omega_j (R_j + e.n). Torques: -R_j F_T - b F_N on the journal, F_N (e x n + b) + F_T
//! (e.n + R_j) on the bushing; no moment is left over, and the power is -F_N delta_dot - F_T v_t. A round journal has b = 0, R_j = R1.
//!
//! # Source
//! Winkler (1867), Die Lehre von der Elasticitaet und Festigkeit; elastic foundation model in Johnson (1985),
//! Contact Mechanics, chapter 4. The modulus that reproduces Hertz's force is derived in `modulus.rs`; the moment follows from the same
//! potential.

use super::arc::{Arcs, FreeArcs};
use super::integrals::RotatedIntegrals;
use super::journal_table::within_a_turn;
use super::modulus::Modulus;
use super::rotated_arc::RotatedArc;
use super::{Arc, ForceSlopes, JointForce, JointMotion, Journal, Surface, Surfaces, equivalent_penetration};
use crate::bore::{Profile, Radius};
use crate::lanes::{Real, direction_angle};
use crate::plane::{dot, left, length};
use std::f64::consts::TAU;

/// Lightest contact for which the arc is tabulated [m]: its half angle sqrt(2 delta / c) spans three intervals, which puts its force
/// within 7e-4 of the integral.
const LIGHTEST: f64 = 1e-8;
/// Intervals of the bore: twenty per control point at 36 of them at least, three in the lightest contact at a clearance of 0.5 mm at most.
const FEWEST: usize = 720;
const MOST: usize = 3024;

/// The law with its constants and the tabulated bore.
#[derive(Debug, Clone, PartialEq)]
pub struct Foundation<R = f64, A = Arc> {
    /// Constants of the joint.
    pub surface: Surface<R>,
    /// Modulus of the foundation.
    pub(super) modulus: Modulus<R>,
    /// The tabulated bore, with the journal if that wears, or one per lane.
    pub arc: A,
}

/// The law of one joint with a worn journal.
pub type FoundationWithJournal<'a> = Foundation<f64, RotatedArc<'a>>;

/// Load that the foundation carries at one eccentricity of a journal, whose angle alpha matters if it is worn.
#[derive(Debug, Clone, Copy)]
pub struct FoundationLoad<R = f64> {
    /// Potential U [J].
    pub energy: R,
    /// Elastic force on the bushing, dU/de `(2,)` [N].
    pub force: [R; 2],
    /// Its derivative to e, entries xx, xy, yy [N/m].
    pub stiffness: [R; 3],
    /// M = dU/dalpha [N m], and its derivatives to e `(2,)` [N] and alpha [N m]; zero for a round journal.
    moment: R,
    moment_e: [R; 2],
    moment_alpha: R,
}

impl<R: Real> FoundationLoad<R> {
    /// Sets the derivatives to zero where there is no contact.
    #[inline(always)]
    fn keep_where(&mut self, touches: R::Mask) {
        let nothing = self.moment.zero();
        for k in 0..3 {
            self.stiffness[k] = R::select(touches, self.stiffness[k], nothing);
        }
        for k in 0..2 {
            self.moment_e[k] = R::select(touches, self.moment_e[k], nothing);
        }
        self.moment_alpha = R::select(touches, self.moment_alpha, nothing);
    }
}

impl Foundation {
    /// The law on an unworn bore with `control_points` control points, tabulated finely enough for forces.
    pub(crate) fn new(surface: Surface, control_points: usize) -> Self {
        let half_angle = (2.0 * LIGHTEST / surface.clearance).sqrt();
        let intervals = (3.0 * TAU / half_angle).ceil() as usize;
        Self::with_intervals(surface, control_points, intervals.clamp(FEWEST, MOST))
    }

    /// The law on an unworn bore tabulated at `intervals` intervals or more, a multiple of the control points.
    pub(crate) fn with_intervals(surface: Surface, control_points: usize, intervals: usize) -> Self {
        Foundation {
            modulus: Modulus::new(surface.stiffness, surface.clearance),
            arc: Arc::new(surface.journal_radius, surface.clearance, control_points, intervals),
            surface,
        }
    }

    /// Tabulates a changed profile.
    #[inline(always)]
    pub(crate) fn profile_changed(&mut self, profile: &Profile) {
        self.arc.profile_changed(profile);
    }

    /// An unworn journal with `points` control points on this foundation.
    pub(crate) fn new_journal(&self, points: usize) -> Journal {
        Journal::new(self.surface.journal_radius, points, Some(self.arc.intervals()))
    }

    /// The law with this journal, which has a table of its depth if it belongs to a joint with this law.
    #[inline(always)]
    pub(crate) fn with_journal<'a>(&'a self, journal: &'a Journal) -> Option<FoundationWithJournal<'a>> {
        let arc = RotatedArc { arc: &self.arc, journal: journal.table.as_ref()? };
        Some(Foundation { surface: self.surface, modulus: self.modulus, arc })
    }

    /// The elastic part of the contact between these surfaces: stored energy [J], force F_el [N] and delta_dot [m/s], by which the force
    /// multiplies to the rate of the energy; all zero in free flight.
    pub(super) fn elastic(&self, surfaces: Surfaces, motion: &JointMotion) -> [f64; 3] {
        match surfaces.journal.and_then(|journal| self.with_journal(journal)) {
            None => self.elastic_part(motion),
            Some(pair) => pair.elastic_part(motion),
        }
    }

    /// Elastic potential, force and stiffness at the eccentricity `e` [m] of a round journal.
    #[inline(always)]
    pub(crate) fn load(&self, e: [f64; 2]) -> FoundationLoad {
        self.rotated_load::<true>(e, 0.0)
    }
}

impl FoundationWithJournal<'_> {
    /// Potential, force and stiffness to e at the eccentricity `e` [m] with the journal turned by `alpha` [rad].
    #[inline(always)]
    pub(crate) fn load_at(&self, e: [f64; 2], alpha: f64) -> FoundationLoad {
        self.carried::<true>(&self.arc.integrals::<false>(e, alpha))
    }

    /// Half the angle over which the contact extends at the eccentricity `e` [m] with the journal turned by `alpha` [rad].
    pub(crate) fn half_arc(&self, e: [f64; 2], alpha: f64) -> f64 {
        let [xx, _, yy] = self.arc.integrals::<false>(e, alpha).to_e.d;
        0.5 * (xx + yy)
    }
}

impl<A: Arcs<f64>> Foundation<f64, A> {
    /// The elastic part of the contact.
    fn elastic_part(&self, motion: &JointMotion) -> [f64; 3] {
        let FoundationLoad { energy, force, moment, .. } = self.rotated_load::<true>(motion.e, motion.turn);
        let size = libm::hypot(force[0], force[1]);
        if size <= 0.0 {
            return [0.0; 3];
        }
        let spin = motion.omega_journal - motion.omega_bushing;
        let power = dot(force, in_bushing_frame(motion)) + moment * spin;
        [energy, size, power / size]
    }
}

impl<R: Real, A: Arcs<R>> Foundation<R, A> {
    /// Potential, force and moment at the eccentricity `e` [m] with the journal turned by `alpha` [rad]; their derivatives only if `SECOND`.
    #[inline(always)]
    fn rotated_load<const SECOND: bool>(&self, e: [R; 2], alpha: R) -> FoundationLoad<R> {
        self.carried::<SECOND>(&self.arc.integrate::<SECOND>(e, alpha))
    }

    /// The load with these integrals over the arc in contact.
    #[inline(always)]
    fn carried<const SECOND: bool>(&self, integrals: &RotatedIntegrals<R>) -> FoundationLoad<R> {
        let RotatedIntegrals { to_e: sum, t, et, tt } = *integrals;
        let ([energy, modulus, growth], [px, py]) = (self.modulus.potential(sum.v), sum.p);
        let mut stiffness = sum.d;
        if SECOND {
            for (k, product) in [(0, px * px), (1, px * py), (2, py * py)] {
                stiffness[k] = modulus * sum.d[k] + growth * product;
            }
        }
        let force = [modulus * px, modulus * py];
        if !A::JOURNAL {
            return FoundationLoad { energy, force, stiffness, moment: t, moment_e: et, moment_alpha: tt };
        }
        FoundationLoad {
            energy,
            force,
            stiffness,
            moment: modulus * t,
            moment_e: [modulus * et[0] + growth * px * t, modulus * et[1] + growth * py * t],
            moment_alpha: modulus * tt + growth * t * t,
        }
    }
}

impl<R: Real, A: FreeArcs<R>> Foundation<R, A> {
    /// Force on the journal; with `JACOBIAN` its exact derivative, else no slopes.
    ///
    /// The elastic force -dU/de has size F_el and direction -n. Damping and friction follow the resultant. The reaction acts on the bushing
    /// at e + R_j n. In free flight, and where the contact lets go early (1 + D delta_dot <= 0), only the film acts.
    #[inline(always)]
    pub(crate) fn force<const JACOBIAN: bool>(
        &self,
        motion: &JointMotion<R>,
    ) -> (JointForce<R>, ForceSlopes<R>) {
        let s = &self.surface;
        let JointMotion { e, w, omega_journal, omega_bushing, turn } = *motion;
        let mut loaded = self.rotated_load::<JACOBIAN>(e, turn);
        let nothing = e[0].zero();
        let one = nothing.like(1.0);
        let size = length(loaded.force);
        let pressed = nothing.below(size);
        let per_elastic = one / R::select(pressed, size, one);
        let n = [
            R::select(pressed, loaded.force[0] * per_elastic, one),
            R::select(pressed, loaded.force[1] * per_elastic, nothing),
        ];
        let t = left(n);
        let (en, et) = (dot(e, n), dot(e, t));
        let (wn, wt) = (dot(w, n), dot(w, t));
        // The relative velocity differentiated in the bushing's frame.
        let (bn, bt) = (wn + omega_bushing * et, wt - omega_bushing * en);
        let spin = omega_journal - omega_bushing;
        let (mut lever, mut rate, mut offset) = (nothing, bn, -et);
        let mut journal = Radius { r: s.journal_radius, d1: nothing, d2: nothing };
        if A::JOURNAL {
            lever = loaded.moment * per_elastic;
            rate += lever * spin;
            offset += lever;
            journal = self.arc.journal(within_a_turn(direction_angle(n) - turn));
        }
        let factor = one + s.damping * rate;
        // NaN compares as no contact.
        let touches = R::both(pressed, nothing.below(factor));
        let elastic = R::select(touches, size, nothing);
        let normal = elastic * factor;
        let arm = journal.r + en;
        let sliding = wt + omega_journal * journal.r - omega_bushing * arm;
        let sliding = R::select(touches, sliding, nothing);
        let (mu, mu_v) = s.friction(sliding);
        let friction = mu * normal;
        let mut out = JointForce {
            force: [-normal * n[0] - friction * t[0], -normal * n[1] - friction * t[1]],
            torque_journal: -(journal.r * friction),
            torque_bushing: normal * offset + friction * arm,
            normal,
            direction: [R::select(touches, n[0], nothing), R::select(touches, n[1], nothing)],
            penetration: equivalent_penetration(size, s.stiffness) + self.free_penetration(e, turn, size),
            sliding,
        };
        if A::JOURNAL {
            out.torque_journal -= normal * lever;
        }
        s.add_film(motion, &mut out);
        if !JACOBIAN {
            return (out, ForceSlopes::none(nothing));
        }
        // Derivative of (force, torques) without the film to (e, w, omega_i, omega_j), and with a worn journal to alpha, in the axes (n, t).
        loaded.keep_where(touches);
        let [xx, xy, yy] = loaded.stiffness;
        let (kn, kt) =
            ([xx * n[0] + xy * n[1], xy * n[0] + yy * n[1]], [xx * t[0] + xy * t[1], xy * t[0] + yy * t[1]]);
        // Columns in the axes (n, t): e along n, e along t, w along n, w along t, omega_i, omega_j, alpha. The elastic force depends on the
        // first two and the last.
        const ALPHA: usize = 6;
        let rate_own = [nothing, omega_bushing, one, nothing, lever, et - lever, nothing];
        let sliding_own = [-omega_bushing, nothing, nothing, one, journal.r, -arm, nothing];
        let (damped, grip) = (elastic * s.damping, mu_v * normal);
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
                    loaded.moment_e
                };
                let d_elastic = dot(n, force);
                turn = dot(t, force) * per_elastic;
                d_normal += d_elastic * factor + damped * bt * turn;
                d_sliding -= bn * turn;
                if A::JOURNAL {
                    let q = loaded.moment_e;
                    let moment = if c == 0 {
                        dot(q, n)
                    } else if c == 1 {
                        dot(q, t)
                    } else {
                        loaded.moment_alpha
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
        let to_turn = if A::JOURNAL { Some(columns[ALPHA]) } else { None };
        let mut slopes = ForceSlopes { u: n, rows, to_turn };
        s.add_film_slopes(&mut slopes);
        (out, slopes)
    }

    /// Penetration in free flight, not above zero [m]; zero where `touches` is above zero.
    #[inline(always)]
    fn free_penetration(&self, e: [R; 2], alpha: R, touches: R) -> R {
        let mut out = alpha.zero();
        for lane in 0..R::LANES {
            if touches.lane(lane) <= 0.0 {
                let at = [e[0].lane(lane), e[1].lane(lane)];
                out.set_lane(lane, self.arc.free_penetration(lane, at, alpha.lane(lane)));
            }
        }
        out
    }

    /// Rate of the largest gap, where `penetration` is not above zero [m/s]: in the direction in which the journal is nearest to the bore; in
    /// the middle of the bore, from where every direction leads to the wall, the speed.
    #[inline(always)]
    pub(super) fn approach(&self, motion: &JointMotion<R>, penetration: R) -> R {
        let JointMotion { e, w, omega_journal, omega_bushing, turn } = *motion;
        let (mut direction, mut to_alpha) = ([turn.zero(); 2], turn.zero());
        for lane in 0..R::LANES {
            if penetration.lane(lane) > 0.0 {
                continue;
            }
            let (one, slope) = self.arc.nearest(lane, [e[0].lane(lane), e[1].lane(lane)], turn.lane(lane));
            direction[0].set_lane(lane, one[0]);
            direction[1].set_lane(lane, one[1]);
            to_alpha.set_lane(lane, slope);
        }
        let mut rate = dot(direction, in_bushing_frame(motion));
        if A::JOURNAL {
            rate += to_alpha * (omega_journal - omega_bushing);
        }
        let size = length(e);
        R::select(size.zero().below(size), rate, length(w))
    }
}

/// Velocity of the journal's centre differentiated in the bushing's frame, w - omega_j x e `(2,)` [m/s].
#[inline(always)]
fn in_bushing_frame<R: Real>(motion: &JointMotion<R>) -> [R; 2] {
    let JointMotion { e, w, omega_bushing, .. } = *motion;
    [w[0] + omega_bushing * e[1], w[1] - omega_bushing * e[0]]
}
