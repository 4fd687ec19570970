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
//! # Source
//! Winkler (1867), Die Lehre von der Elasticitaet und Festigkeit; elastic foundation model in Johnson (1985),
//! Contact Mechanics, chapter 4. The modulus that reproduces Hertz's force is derived in `modulus.rs`.

// Compiled into the loops of the lanes, where closures of iterators are not: plain loops.
#![allow(clippy::needless_range_loop)]

use super::arc::{Arc, Arcs};
use super::joint_force::{ForceSlopes, JointForce, JointMotion};
use super::journal::Surfaces;
use super::law::{Elastic, Law, Pressure};
use super::modulus::Modulus;
use super::stiffness::equivalent_penetration;
use super::surface::Surface;
use crate::bore::Profile;
use crate::lanes::Real;
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
    pub(super) arc: A,
}

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

/// A contact in the axes (n, t) of its elastic force: n the direction in which the journal presses, t its
/// left normal.
struct Resultant<R> {
    n: [R; 2],
    t: [R; 2],
    /// e.n and e.t [m].
    en: R,
    et: R,
    /// Relative velocity differentiated in the bushing's frame along n and along t [m/s].
    bn: R,
    bt: R,
    /// Elastic force F_el, zero where none acts [N], and one over it, one where none acts [1/N].
    elastic: R,
    per_elastic: R,
    /// 1 + D delta_dot [1].
    factor: R,
    /// Normal force F_N [N].
    normal: R,
    /// F_T / F_N [1] and its derivative to the sliding speed [s/m].
    mu: R,
    mu_v: R,
    /// Friction force F_T [N].
    friction: R,
    /// Lever arms of friction and normal force about the bushing's centre [m].
    arm: R,
    lever: R,
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

    /// The tabulated bore.
    #[inline(always)]
    pub(crate) fn arc(&self) -> &Arc {
        &self.arc
    }

    /// Tabulates a changed profile.
    #[inline(always)]
    pub(crate) fn profile_changed(&mut self, profile: &Profile) {
        self.arc.profile_changed(profile);
    }
}

impl<R: Real, A: Arcs<R>> Foundation<R, A> {
    /// Elastic potential, force and stiffness at the eccentricity `e` [m].
    #[inline(always)]
    pub(crate) fn load(&self, e: [R; 2]) -> FoundationLoad<R> {
        self.load_to::<true>(e)
    }

    /// The same, without the stiffness unless `SECOND`.
    #[inline(always)]
    fn load_to<const SECOND: bool>(&self, e: [R; 2]) -> FoundationLoad<R> {
        let sum = self.arc.integrate::<SECOND>(e);
        let potential = self.modulus.potential(sum.v);
        let (modulus, growth, [px, py]) = (potential.modulus, potential.growth, sum.p);
        let mut stiffness = sum.d;
        if SECOND {
            for (k, product) in [(0, px * px), (1, px * py), (2, py * py)] {
                stiffness[k] = modulus * sum.d[k] + growth * product;
            }
        }
        FoundationLoad { energy: potential.energy, force: [modulus * px, modulus * py], stiffness }
    }

    /// Force on the journal; with `JACOBIAN` its exact derivative, else no slopes.
    ///
    /// The elastic force -dU/de has size F_el and direction -n. Damping and friction follow
    /// the resultant: delta_dot = n.(w - omega_j x e), F_N = F_el max(0, 1 + D delta_dot),
    /// v_t = w.t + omega_i R1 - omega_j (R1 + e.n). The reaction acts on the bushing at e + R1 n, hence its
    /// torque F_N (e x n) + F_T (e.n + R1). In free flight, and where the contact lets go early (1 + D delta_dot <= 0), only the
    /// film acts.
    #[inline(always)]
    pub(crate) fn force<const JACOBIAN: bool>(
        &self,
        motion: &JointMotion<R>,
    ) -> (JointForce<R>, ForceSlopes<R>) {
        let s = &self.surface;
        let JointMotion { e, w, omega_journal, omega_bushing, .. } = *motion;
        let loaded = self.load_to::<JACOBIAN>(e);
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
        // e x n, and the relative velocity differentiated in the bushing's frame.
        let lever = -et;
        let (bn, bt) = (wn + omega_bushing * et, wt - omega_bushing * en);
        let factor = one + s.damping * bn;
        // NaN compares as no contact.
        let touches = R::both(pressed, nothing.below(factor));
        let elastic = R::select(touches, size, nothing);
        let normal = elastic * factor;
        let arm = s.journal_radius + en;
        let sliding = wt + omega_journal * s.journal_radius - omega_bushing * arm;
        let sliding = R::select(touches, sliding, nothing);
        let (mu, mu_v) = s.friction(sliding);
        let friction = mu * normal;
        let mut out = JointForce {
            force: [-normal * n[0] - friction * t[0], -normal * n[1] - friction * t[1]],
            torque_journal: -(s.journal_radius * friction),
            torque_bushing: normal * lever + friction * arm,
            normal,
            direction: [R::select(touches, n[0], nothing), R::select(touches, n[1], nothing)],
            penetration: equivalent_penetration(size, s.stiffness) + self.arc.free_penetration(e, size),
            sliding,
        };
        s.add_film(motion, &mut out);
        let mut slopes = ForceSlopes::none(nothing);
        if JACOBIAN {
            let resultant = Resultant {
                n,
                t,
                en,
                et,
                bn,
                bt,
                elastic,
                per_elastic,
                factor,
                normal,
                mu,
                mu_v,
                friction,
                arm,
                lever,
            };
            let mut stiffness = loaded.stiffness;
            for k in 0..3 {
                stiffness[k] = R::select(touches, stiffness[k], nothing);
            }
            let rows = self.slopes(&resultant, stiffness, omega_bushing);
            slopes = ForceSlopes { u: n, rows, to_turn: None };
            s.add_film_slopes(&mut slopes);
        }
        (out, slopes)
    }

    /// Rate of the largest gap, where `penetration` is not above zero [m/s]: in the direction in which the journal is nearest to the bore; in
    /// the middle of the bore, from where every direction leads to the wall, the speed.
    #[inline(always)]
    pub(super) fn approach(&self, motion: &JointMotion<R>, penetration: R) -> R {
        let JointMotion { e, w, .. } = *motion;
        let rate = dot(self.arc.nearest_free(e, penetration), in_bushing_frame(motion));
        let size = length(e);
        R::select(size.zero().below(size), rate, length(w))
    }

    /// Derivative of (force, torques) without the film to (e, w, omega_i, omega_j), in the axes (n, t) `(4, 6)`, with
    /// the foundation's stiffness, entries xx, xy, yy [N/m].
    #[inline(always)]
    fn slopes(&self, resultant: &Resultant<R>, [xx, xy, yy]: [R; 3], omega_bushing: R) -> [[R; 6]; 4] {
        let s = &self.surface;
        let &Resultant {
            n,
            t,
            en,
            et,
            bn,
            bt,
            elastic,
            per_elastic,
            factor,
            normal,
            mu,
            mu_v,
            friction,
            arm,
            lever,
        } = resultant;
        let nothing = en.zero();
        let one = nothing.like(1.0);
        // Columns in the axes (n, t): e along n, e along t, w along n, w along t, omega_i, omega_j.
        let (kn, kt) =
            ([xx * n[0] + xy * n[1], xy * n[0] + yy * n[1]], [xx * t[0] + xy * t[1], xy * t[0] + yy * t[1]]);
        let elastic_c = [dot(n, kn), dot(n, kt)];
        let turn_c = [dot(t, kn) * per_elastic, dot(t, kt) * per_elastic];
        let rate_own = [nothing, omega_bushing, one, nothing, nothing, et];
        let sliding_own = [-omega_bushing, nothing, nothing, one, s.journal_radius, -arm];
        let (damped, grip) = (elastic * s.damping, mu_v * normal);
        let mut rows = [[nothing; 6]; 4];
        for c in 0..6 {
            let (mut d_normal, mut d_sliding) = (damped * rate_own[c], sliding_own[c]);
            if c < 2 {
                d_normal += elastic_c[c] * factor + damped * bt * turn_c[c];
                d_sliding -= bn * turn_c[c];
            }
            let d_friction = mu * d_normal + grip * d_sliding;
            rows[0][c] = -d_normal;
            rows[1][c] = -d_friction;
            rows[2][c] = -(s.journal_radius * d_friction);
            rows[3][c] = d_normal * lever + d_friction * arm;
        }
        // The axes turn with the force, and the arms change with e.
        for c in 0..2 {
            let turn = turn_c[c];
            rows[0][c] += friction * turn;
            rows[1][c] -= normal * turn;
            rows[3][c] += normal * en * turn + friction * et * turn;
        }
        rows[3][0] += friction;
        rows[3][1] -= normal;
        rows
    }
}

impl Law for Foundation {
    fn new(surface: Surface, control_points: usize) -> Self {
        Foundation::new(surface, control_points)
    }

    fn surface(&self) -> &Surface {
        &self.surface
    }

    fn surface_mut(&mut self) -> &mut Surface {
        &mut self.surface
    }

    fn profile_changed(&mut self, profile: &Profile) {
        Foundation::profile_changed(self, profile);
    }

    fn pressure(&self) -> Pressure {
        Pressure::Foundation
    }

    #[inline(always)]
    fn force<const JACOBIAN: bool>(
        &self,
        surfaces: Surfaces,
        motion: &JointMotion,
    ) -> (JointForce, ForceSlopes) {
        match surfaces.journal.and_then(|journal| self.with_journal(journal)) {
            None => Foundation::<f64, Arc>::force::<JACOBIAN>(self, motion),
            Some(pair) => pair.force_with_journal::<JACOBIAN>(motion),
        }
    }

    fn elastic(&self, surfaces: Surfaces, motion: &JointMotion) -> Elastic {
        if let Some(pair) = surfaces.journal.and_then(|journal| self.with_journal(journal)) {
            return pair.elastic_with_journal(motion);
        }
        let FoundationLoad { energy, force, .. } = self.load(motion.e);
        let size = libm::hypot(force[0], force[1]);
        if size <= 0.0 {
            return Elastic::default();
        }
        let power = dot(force, in_bushing_frame(motion));
        Elastic { stored: energy, force: size, rate: power / size }
    }

    fn approach(&self, surfaces: Surfaces, motion: &JointMotion) -> f64 {
        match surfaces.journal.and_then(|journal| self.with_journal(journal)) {
            None => Foundation::<f64, Arc>::approach(self, motion, 0.0),
            Some(pair) => pair.approach_with_journal(motion, 0.0),
        }
    }
}

/// Velocity of the journal's centre differentiated in the bushing's frame, w - omega_j x e `(2,)` [m/s].
#[inline(always)]
pub(super) fn in_bushing_frame<R: Real>(motion: &JointMotion<R>) -> [R; 2] {
    let JointMotion { e, w, omega_bushing, .. } = *motion;
    [w[0] + omega_bushing * e[1], w[1] - omega_bushing * e[0]]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn equals_hertz_on_an_unworn_bore() {
        // The modulus is fitted within 4e-5 below a tenth of the clearance and 4e-4 beyond; the ends of an
        // arc whose half angle spans m intervals add 0.025 / m^3 at most.
        let mut worst: f64 = 0.0;
        for clearance in [1e-6, 3e-6, 1e-5, 23.5e-6, 1e-4, 5e-4] {
            let stiffness = 3.264e10 * libm::sqrt(23.5e-6 / clearance);
            let law = Foundation::new(
                Surface {
                    journal_radius: 1.5e-3,
                    clearance,
                    stiffness,
                    damping: 0.0,
                    restitution: None,
                    friction: 0.0,
                    per_friction_speed: 1.0 / 1e-3,
                    film: 0.0,
                },
                36,
            );
            for delta in [1e-8, 1.7e-8, 3e-8, 1e-7, 3.2e-7, 1e-6, 2e-6] {
                for k in 0..40 {
                    let (angle, e) = (0.7 + 2.3e-4 * f64::from(k), clearance + delta);
                    let motion = JointMotion {
                        e: [e * libm::cos(angle), e * libm::sin(angle)],
                        w: [0.0; 2],
                        omega_journal: 0.0,
                        omega_bushing: 0.0,
                        turn: 0.0,
                    };
                    let hertz = stiffness * libm::pow(delta, 1.5);
                    let off = (law.force::<false>(&motion).0.normal / hertz - 1.0).abs();
                    let half_angle = libm::acos(clearance / e);
                    let spanned = half_angle / TAU * law.arc().intervals() as f64;
                    let fitted = if delta < 0.1 * clearance { 4e-5 } else { 4e-4 };
                    let bound = fitted + 0.025 / (spanned * spanned * spanned);
                    assert!(off < bound, "clearance {clearance}, delta {delta}, angle {angle}: {off}");
                    worst = worst.max(off);
                }
            }
        }
        println!("unworn foundation within {worst:e} of K_n delta^1.5");
        assert!(worst < 1e-3, "{worst}");
    }
}
