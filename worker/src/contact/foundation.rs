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

use super::arc::Arc;
use super::energy::Elastic;
use super::local_hertz::from_polar;
use super::modulus::Modulus;
use super::{JointForce, JointMotion, Surface};
use crate::bore::Profile;
use std::f64::consts::TAU;

/// Lightest contact that the arc is made for [m]: its half angle sqrt(2 delta / c) spans three intervals,
/// which puts its force within 7e-4 of the integral.
const LIGHTEST: f64 = 1e-8;
/// Smallest number of intervals of the bore: twenty to a control point at 36 of them.
const FEWEST: usize = 720;
/// Largest number: three intervals of the lightest contact in a clearance of 0.5 mm, and fewer beyond.
const MOST: usize = 3024;

/// The law with its constants and the tabulated bore.
#[derive(Debug, Clone, PartialEq)]
pub struct Foundation {
    /// Constants of the joint.
    pub(super) surface: Surface,
    modulus: Modulus,
    arc: Arc,
}

/// How the arc in contact presses on the bushing.
#[derive(Debug, Clone, Copy, Default)]
pub struct Pressing {
    /// Potential U [J].
    pub energy: f64,
    /// Modulus in effect: pressure times bore radius and width is modulus times g [N/(m rad)].
    pub modulus: f64,
    /// Elastic force, dU/de `(2,)` [N].
    pub force: [f64; 2],
    /// Its derivative to e `(2, 2)`, symmetric [N/m].
    pub stiffness: [[f64; 2]; 2],
}

impl Foundation {
    /// The law on an unworn bore, for forces.
    pub fn new(surface: Surface, control_points: usize) -> Self {
        let half_angle = (2.0 * LIGHTEST / surface.clearance).sqrt();
        let intervals = (3.0 * TAU / half_angle).ceil() as usize;
        Self::with_intervals(surface, control_points, intervals.clamp(FEWEST, MOST))
    }

    /// The law on an unworn bore with at least so many intervals: a multiple of the control points.
    pub fn with_intervals(surface: Surface, control_points: usize, intervals: usize) -> Self {
        Foundation {
            modulus: Modulus::new(surface.stiffness, surface.clearance),
            arc: Arc::new(surface.journal_radius, surface.clearance, control_points, intervals),
            surface,
        }
    }

    /// Constants of the joint.
    pub fn surface(&self) -> &Surface {
        &self.surface
    }

    /// The tabulated bore.
    pub fn arc(&self) -> &Arc {
        &self.arc
    }

    /// Tabulates a changed profile.
    pub fn profile_changed(&mut self, profile: &Profile) {
        self.arc.profile_changed(profile);
    }

    /// Rate of the gap function where it is largest, in the direction in which the journal is nearest to the
    /// bore: in free flight, the speed at which it approaches [m/s].
    pub fn approach(&self, motion: &JointMotion) -> f64 {
        let JointMotion { e, w, omega_bushing, .. } = *motion;
        let n = self.arc.nearest(e);
        n[0] * (w[0] + omega_bushing * e[1]) + n[1] * (w[1] - omega_bushing * e[0])
    }

    /// Energy, force and rate of the elastic part of the contact.
    pub(super) fn elastic(&self, motion: &JointMotion) -> Elastic {
        let JointMotion { e, w, omega_bushing, .. } = *motion;
        let Pressing { energy, force: [fx, fy], .. } = self.press(e, |_, _, _| {});
        let force = libm::hypot(fx, fy);
        if force <= 0.0 {
            return Elastic::default();
        }
        let power = fx * (w[0] + omega_bushing * e[1]) + fy * (w[1] - omega_bushing * e[0]);
        Elastic { stored: energy, force, rate: power / force }
    }

    /// Elastic potential, force and stiffness at this eccentricity; `weigh` sees each interval of the arc
    /// with the integrals of g that its two ends stand for.
    #[inline]
    pub fn press(&self, e: [f64; 2], weigh: impl FnMut(usize, f64, f64)) -> Pressing {
        let sum = self.arc.integrate(e, weigh);
        let at = self.modulus.at(sum.v);
        let mut out = Pressing { energy: at.energy, modulus: at.modulus, ..Pressing::default() };
        for i in 0..2 {
            out.force[i] = at.modulus * sum.p[i];
            for j in 0..2 {
                out.stiffness[i][j] = at.modulus * sum.d[i][j] + at.growth * sum.p[i] * sum.p[j];
            }
        }
        out
    }

    /// Force on the journal; with `JACOBIAN` its exact derivative.
    ///
    /// The elastic force -dU/de has size F_el and direction -n. Damping and friction follow
    /// the resultant: delta_dot = n.(w - omega_j x e), F_N = F_el max(0, 1 + D delta_dot),
    /// v_t = w.t + omega_i R1 - omega_j (R1 + e.n). The reaction acts on the bushing at e + R1 n, whence its
    /// torque F_N (e x n) + F_T (e.n + R1).
    #[inline]
    pub fn force<const JACOBIAN: bool>(&self, motion: &JointMotion) -> JointForce {
        let s = &self.surface;
        let JointMotion { e, w, omega_journal, omega_bushing } = *motion;
        let mut out = JointForce::default();
        let pressing = self.press(e, |_, _, _| {});
        let elastic = (pressing.force[0] * pressing.force[0] + pressing.force[1] * pressing.force[1]).sqrt();
        let radius = (e[0] * e[0] + e[1] * e[1]).sqrt();
        if elastic <= 0.0 {
            out.penetration = if radius <= self.arc.reach() {
                radius - self.arc.reach()
            } else {
                self.arc.gap_along(e).min(0.0)
            };
        } else {
            let n = [pressing.force[0] / elastic, pressing.force[1] / elastic];
            let t = [-n[1], n[0]];
            let dot = |a: [f64; 2], b: [f64; 2]| a[0] * b[0] + a[1] * b[1];
            let (en, et) = (dot(e, n), dot(e, t));
            let (wn, wt) = (dot(w, n), dot(w, t));
            // e x n, and the relative velocity differentiated in the bushing's frame.
            let lever = -et;
            let (bn, bt) = (wn + omega_bushing * et, wt - omega_bushing * en);
            let rate = bn;
            let factor = 1.0 + s.damping * rate;
            out.penetration = equivalent_penetration(elastic, s.stiffness);
            if factor > 0.0 {
                let normal = elastic * factor;
                let arm = s.journal_radius + en;
                let sliding = wt + omega_journal * s.journal_radius - omega_bushing * arm;
                let (mu, mu_v) = s.friction(sliding);
                let friction = mu * normal;
                out.normal = normal;
                out.sliding = sliding;
                out.direction = n;
                out.force = [-normal * n[0] - friction * t[0], -normal * n[1] - friction * t[1]];
                out.torque_journal = -s.journal_radius * friction;
                out.torque_bushing = normal * lever + friction * arm;
                if JACOBIAN {
                    // Columns in the axes (n, t): e along n, e along t, w along n, w along t, omega_i,
                    // omega_j.
                    let k = pressing.stiffness;
                    let along = |a: [f64; 2], b: [f64; 2]| {
                        a[0] * (k[0][0] * b[0] + k[0][1] * b[1]) + a[1] * (k[1][0] * b[0] + k[1][1] * b[1])
                    };
                    let elastic_c = [along(n, n), along(n, t), 0.0, 0.0, 0.0, 0.0];
                    let turn_c = [along(t, n) / elastic, along(t, t) / elastic, 0.0, 0.0, 0.0, 0.0];
                    let en_c = [1.0, 0.0, 0.0, 0.0, 0.0, 0.0];
                    let et_c = [0.0, 1.0, 0.0, 0.0, 0.0, 0.0];
                    let rate_own = [0.0, omega_bushing, 1.0, 0.0, 0.0, et];
                    let sliding_own = [-omega_bushing, 0.0, 0.0, 1.0, s.journal_radius, -arm];
                    let mut polar = [[0.0; 6]; 4];
                    for c in 0..6 {
                        let turn = turn_c[c];
                        let d_rate = rate_own[c] + bt * turn;
                        let d_normal = elastic_c[c] * factor + elastic * s.damping * d_rate;
                        let d_sliding = sliding_own[c] - (wn + omega_bushing * et) * turn;
                        let d_friction = mu * d_normal + mu_v * normal * d_sliding;
                        let d_arm = en_c[c] + et * turn;
                        let d_lever = -(et_c[c] - en * turn);
                        polar[0][c] = -d_normal + friction * turn;
                        polar[1][c] = -d_friction - normal * turn;
                        polar[2][c] = -s.journal_radius * d_friction;
                        polar[3][c] =
                            d_normal * lever + normal * d_lever + d_friction * arm + friction * d_arm;
                    }
                    out.jacobian = from_polar(&polar, n, t);
                }
            }
        }
        s.add_film::<JACOBIAN>(motion, &mut out);
        out
    }
}

/// Penetration at which F = K_n delta^1.5 gives this force [m].
pub fn equivalent_penetration(force: f64, stiffness: f64) -> f64 {
    let root = libm::cbrt(force / stiffness);
    root * root
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
                    friction_speed: 1e-3,
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
                    };
                    let hertz = stiffness * libm::pow(delta, 1.5);
                    let off = (law.force::<false>(&motion).normal / hertz - 1.0).abs();
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
