//! Constants of one joint that all contact laws share, with the friction and film laws that follow from them.
//!
//! Friction F_T = mu F_N tanh(v_t / v_0), with the friction coefficient mu [1], the normal force F_N [N], the
//! sliding speed v_t and the regularisation speed v_0 [m/s]; film force -c_f w through the centres,
//! with the film damping c_f [N s/m] and the relative velocity w of the centres [m/s].
//!
//! # Source
//! Coulomb's law regularised as by Andersson, Soderberg, Bjorklund (2007), Tribology International 40,
//! 580-587.
//!
//! # Contact damping
//! Contact damping from a coefficient of restitution: the damping factor D of the impact that has begun.
//!
//! F_N = F_el (1 + D delta_dot) with D = (D v0) / v0 [s/m], where v0 [m/s] is the speed of approach at which
//! the present contact began and D v0 [1] a function of the coefficient of restitution e [1] alone:
//! - Lankarani and Nikravesh: D v0 = 3 (1 - e^2) / 4;
//! - Hunt and Crossley: D v0 = 3 (1 - e) / 2;
//! - Flores et al.: D v0 = 8 (1 - e) / (5 e).
//!
//! The first two are approximations for e near 1. The restitution that an impact with a given D v0 really has
//! is not e but the root x of D v0 (1 + x) = ln[(1 + D v0) / (1 - x D v0)], whatever stiffness, exponent and
//! mass.
//!
//! Source:
//! Lankarani, Nikravesh (1990), J. Mech. Design 112, 369-376, and (1994), Nonlinear Dynamics 5, 193-207.
//! Hunt, Crossley (1975), J. Appl. Mech. 42, 440-445. Flores, Machado, Silva, Martins (2011), Multibody
//! System Dynamics 25, 357-375.
//!
//! # Motion and force
//! Motion of one joint with clearance and the force it exerts; frame and signs as in the parent module.

use crate::lanes::{Real, cube_root, lanewise, tanh};
use common::scene::{Clearance, ContactDamping, Material, RestitutionLaw};
use std::f64::consts::PI;

/// Constants of one joint that all contact laws share.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Surface<R = f64> {
    /// Journal radius R1 [m].
    pub journal_radius: R,
    /// Radial clearance c of the unworn joint [m].
    pub clearance: R,
    /// Hertz stiffness K_n [N/m^1.5].
    pub stiffness: R,
    /// Damping factor D in effect [s/m].
    pub damping: R,
    /// How D follows from the speed of approach; `None` if D is constant.
    pub restitution: Option<Restitution<R>>,
    /// Friction coefficient mu [1].
    pub friction: R,
    /// Inverse of the regularisation speed v_0 [s/m].
    pub per_friction_speed: R,
    /// Film damping c_f [N s/m].
    pub film: R,
}

lanewise!(Surface {
    journal_radius,
    clearance,
    stiffness,
    damping,
    restitution,
    friction,
    per_friction_speed,
    film
});

impl Surface {
    /// Constants of a checked joint.
    pub(crate) fn new(joint: &Clearance) -> Self {
        let (damping, restitution) = initial_damping(&joint.contact_damping);
        Surface {
            journal_radius: joint.journal_radius,
            clearance: joint.radial_clearance(),
            stiffness: hertz_stiffness(joint),
            damping,
            restitution,
            friction: joint.friction,
            per_friction_speed: 1.0 / joint.friction_speed,
            film: joint.film_damping,
        }
    }
}

impl<R: Real> Surface<R> {
    /// Largest penetration for which Hertz's theory is taken as valid: a tenth of the journal radius [m].
    #[inline(always)]
    pub(crate) fn deepest(&self) -> R {
        self.journal_radius * 0.1
    }

    /// F_T / F_N = mu tanh(v / v_0) at the sliding speed v [m/s], and its derivative to v [s/m].
    #[inline(always)]
    pub(super) fn friction(&self, v: R) -> (R, R) {
        coulomb(self.friction, self.per_friction_speed, v)
    }

    /// Sets the damping factor of a contact that is about to begin, at its speed of approach [m/s], in lanes where the `penetration` [m] is
    /// not above zero; no effect for constant D.
    #[inline(always)]
    pub(super) fn follow_approach(&mut self, approach: R, penetration: R) {
        if let Some(restitution) = self.restitution {
            let touches = approach.zero().below(penetration);
            self.damping = R::select(touches, self.damping, restitution.damping(approach));
        }
    }

    /// Adds the film's force -c_f w through the centres.
    #[inline(always)]
    pub(super) fn add_film(&self, motion: &JointMotion<R>, out: &mut JointForce<R>) {
        for k in 0..2 {
            out.force[k] = out.force[k].minus_product(self.film, motion.w[k]);
        }
    }

    /// Adds the derivative of the film's force, which is the same in all axes.
    #[inline(always)]
    pub(super) fn add_film_slopes(&self, slopes: &mut ForceSlopes<R>) {
        for k in 0..2 {
            slopes.rows[k][2 + k] -= self.film;
        }
    }
}

/// F_T / F_N at the sliding speed `v` [m/s], for the coefficient `mu` and the inverse `per_speed` of the regularisation speed [s/m], and its derivative
/// to v [s/m].
#[inline(always)]
pub(crate) fn coulomb<R: Real>(mu: R, per_speed: R, v: R) -> (R, R) {
    let th = tanh(v * per_speed);
    (mu * th, mu * th.like(1.0).minus_product(th, th) * per_speed)
}

/// K_n = 4 / (3 pi (h_1 + h_2)) sqrt(R1 R2 / (R2 - R1)) [N/m^1.5], h_l = (1 - nu_l^2) / (pi E_l).
///
/// Poisson's ratio nu_l [1] and Young's modulus E_l [Pa] of journal and bushing; radii R2 > R1 > 0 [m] of the
/// unworn joint, as checked when the scene is read.
/// Equal to (4/3) E* sqrt(R1 R2 / (R2 - R1)) with the effective modulus E* [Pa].
///
/// # Source
/// Goldsmith (1960), Impact, as used by Lankarani, Nikravesh (1990), J. Mech. Design 112, 369-376.
pub fn hertz_stiffness(joint: &Clearance) -> f64 {
    let compliance = |m: &Material| (1.0 - m.poisson_ratio * m.poisson_ratio) / (PI * m.elastic_modulus);
    let (r1, r2) = (joint.journal_radius, joint.bushing_radius);
    let h = compliance(&joint.journal_material) + compliance(&joint.bushing_material);
    4.0 / (3.0 * PI * h) * (r1 * r2 / (r2 - r1)).sqrt()
}

/// Penetration at which F = K_n delta^1.5 gives the force `force` [N] for the stiffness `stiffness` [N/m^1.5]
/// [m].
#[inline(always)]
pub(crate) fn equivalent_penetration<R: Real>(force: R, stiffness: R) -> R {
    let root = cube_root(force / stiffness);
    root * root
}

/// Motion of one joint, in the bushing's frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct JointMotion<R = f64> {
    /// Eccentricity `(2,)` [m].
    pub e: [R; 2],
    /// Relative velocity of the centres `(2,)` [m/s].
    pub w: [R; 2],
    /// Angular velocity of the journal's body [rad/s].
    pub omega_journal: R,
    /// Angular velocity of the bushing's body [rad/s].
    pub omega_bushing: R,
    /// Angle alpha of the journal's body minus that of the bushing's [rad].
    pub turn: R,
}

/// Force and torques of one joint at one instant.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct JointForce<R = f64> {
    /// Force on the journal, at its centre `(2,)` [N].
    pub force: [R; 2],
    /// Torque on the journal's body in addition to that of `force` [N m].
    pub torque_journal: R,
    /// Torque on the bushing's body in addition to that of the opposite force [N m].
    pub torque_bushing: R,
    /// Normal contact force F_N >= 0, without the film [N].
    pub normal: R,
    /// Direction in which the journal presses on the bushing, zero in free flight `(2,)` [1].
    pub direction: [R; 2],
    /// Penetration delta, negative in free flight [m].
    pub penetration: R,
    /// Sliding speed v_t of the journal's surface over the bushing's [m/s].
    pub sliding: R,
}

/// Derivatives of the force and torques of one joint to its motion, in the axes of its contact.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ForceSlopes<R = f64> {
    /// Unit vector u of the first axis in the bushing's frame; the second, t, is its left normal `(2,)` [1].
    pub u: [R; 2],
    /// Derivatives of (force along u, force along t, torque_journal, torque_bushing) to (e along u, e along t, w
    /// along u, w along t, omega_journal, omega_bushing) `(4, 6)`.
    pub rows: [[R; 6]; 4],
    /// Derivatives of the same to the angle alpha of the journal from the bushing at constant e and w `(4,)`; `None` if the
    /// journal is round, and its angle without effect.
    pub to_turn: Option<[R; 4]>,
}

lanewise!(numbers JointForce { force, torque_journal, torque_bushing, normal, direction, penetration, sliding });

impl<R: Real> ForceSlopes<R> {
    /// No dependence on the motion; `like` sets the number of lanes.
    #[inline(always)]
    pub(crate) fn none(like: R) -> Self {
        let zero = like.zero();
        ForceSlopes { u: [like.like(1.0), zero], rows: [[zero; 6]; 4], to_turn: None }
    }
}

/// How D follows from the speed of approach.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Restitution<R = f64> {
    /// D v0 [1].
    pub factor: R,
    /// Smallest speed that counts as an impact [m/s].
    pub least_speed: R,
}

lanewise!(Restitution { factor, least_speed });

impl Restitution {
    /// D v0 for the coefficient of restitution e in (0, 1] [1]; zero for e = 1.
    pub(crate) fn new(law: RestitutionLaw, coefficient: f64, least_speed: f64) -> Self {
        let e = coefficient;
        let factor = match law {
            RestitutionLaw::LankaraniNikravesh => 0.75 * (1.0 - e * e),
            RestitutionLaw::HuntCrossley => 1.5 * (1.0 - e),
            RestitutionLaw::Flores => 1.6 * (1.0 - e) / e,
        };
        Restitution { factor, least_speed }
    }
}

impl<R: Real> Restitution<R> {
    /// D of a contact that began at this speed of approach [s/m]; a slower one, or none, counts as the least.
    #[inline(always)]
    pub(crate) fn damping(&self, approach: R) -> R {
        self.factor / approach.larger(self.least_speed)
    }
}

/// D of a joint that has not met an impact yet [s/m], and how it changes with impacts, if it does.
pub(crate) fn initial_damping(damping: &ContactDamping) -> (f64, Option<Restitution>) {
    match *damping {
        ContactDamping::None => (0.0, None),
        ContactDamping::HuntCrossley { factor } => (factor, None),
        ContactDamping::Restitution { law, coefficient, least_speed } => {
            let restitution = Restitution::new(law, coefficient, least_speed);
            (restitution.damping(0.0), Some(restitution))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bore::Profile;
    use crate::contact::{Contact, JointMotion, Surface, tests};
    use std::f64::consts::TAU;

    const SURFACE: Surface = Surface {
        restitution: Some(Restitution { factor: 0.75, least_speed: 1e-4 }),
        damping: 0.0,
        film: 0.0,
        ..tests::SURFACE
    };

    fn worn() -> Profile {
        let mut profile = Profile::round(SURFACE.journal_radius + SURFACE.clearance, 36);
        let depth: Vec<f64> =
            (0..36).map(|i| 8e-6 * (1.0 + (TAU * f64::from(i) / 36.0 - 1.0).cos())).collect();
        profile.set_depth(&depth);
        profile
    }

    fn laws(surface: Surface) -> [Contact; 2] {
        tests::laws(surface, &worn())
    }

    /// The journal at angle `psi`, `penetration` deep along the eccentricity.
    fn moving_at(psi: f64, penetration: f64) -> JointMotion {
        let reach = worn().radius_at(psi).r - SURFACE.journal_radius + penetration;
        JointMotion {
            e: [reach * psi.cos(), reach * psi.sin()],
            w: [0.03 * psi.cos() + 0.01 * psi.sin(), 0.03 * psi.sin() - 0.01 * psi.cos()],
            omega_journal: 3.0,
            omega_bushing: -40.0,
            turn: 0.0,
        }
    }

    /// Gap function along the eccentricity (local law), and its largest value (foundation).
    fn penetrations(e: [f64; 2]) -> [f64; 2] {
        let profile = worn();
        let centre = libm::atan2(e[1], e[0]);
        let gap = |psi: f64| {
            e[0] * psi.cos() + e[1] * psi.sin() + SURFACE.journal_radius
                - profile.radius_at(psi.rem_euclid(TAU)).r
        };
        let largest =
            (-20_000..=20_000).map(|k| gap(centre + 1e-4 * f64::from(k))).fold(f64::NEG_INFINITY, f64::max);
        [gap(centre), largest]
    }

    #[test]
    fn in_free_flight_a_joint_takes_the_present_speed_of_approach() {
        for psi in [0.2, 1.3, 2.9, 5.0] {
            let motion = moving_at(psi, -2e-6);
            // Where the journal is a microsecond later and before, seen in the bushing's frame.
            let moved = |t: f64| {
                let JointMotion { e, w, omega_bushing, .. } = motion;
                [e[0] + t * (w[0] + omega_bushing * e[1]), e[1] + t * (w[1] - omega_bushing * e[0])]
            };
            let (after, before) = (penetrations(moved(1e-6)), penetrations(moved(-1e-6)));
            for (k, mut law) in laws(SURFACE).into_iter().enumerate() {
                let now = law.force::<false>(&worn(), &motion).0;
                assert!(now.penetration < 0.0 && now.normal == 0.0);
                law.accepted(&worn(), &motion, &now);
                let approach = (after[k] - before[k]) / 2e-6;
                assert!(approach > 0.02, "{approach}");
                // The grid of directions, 1e-4 rad apart, moves the largest gap by 1e-13 m at most.
                let (found, expected) = (law.surface().damping, 0.75 / approach);
                assert!((found / expected - 1.0).abs() < 1e-4, "{k} at {psi}: {found} against {expected}");
            }
        }
    }

    #[test]
    fn a_contact_keeps_the_damping_it_began_with_and_the_next_begins_anew() {
        for mut law in laws(SURFACE) {
            let profile = worn();
            let mut accept = |motion: &JointMotion| {
                let now = law.force::<false>(&profile, motion).0;
                law.accepted(&profile, motion, &now);
                law.surface().damping
            };
            let flying = accept(&moving_at(0.8, -1e-7));
            assert!(flying > 0.0);
            let inside = JointMotion { w: [-0.7, 0.2], ..moving_at(0.8, 3e-7) };
            assert_eq!(accept(&inside), flying);
            // Moving away counts as the least speed; from the middle any way is an approach.
            assert_eq!(accept(&JointMotion { w: [-0.5, -0.5], ..moving_at(0.8, -1e-7) }), 0.75 / 1e-4);
            let middle = JointMotion { e: [0.0; 2], w: [0.3, -0.4], ..moving_at(0.8, 0.0) };
            assert_eq!(accept(&middle), 0.75 / 0.5);
        }
        let constant = Surface { damping: 7.5, restitution: None, ..SURFACE };
        for mut law in laws(constant) {
            let before = law.clone();
            let motion = moving_at(0.8, -1e-7);
            let now = law.force::<false>(&worn(), &motion).0;
            law.accepted(&worn(), &motion, &now);
            assert_eq!(law, before);
        }
    }

    #[test]
    fn a_perfect_restitution_does_not_damp() {
        for law in [RestitutionLaw::LankaraniNikravesh, RestitutionLaw::HuntCrossley, RestitutionLaw::Flores]
        {
            let scene = ContactDamping::Restitution { law, coefficient: 1.0, least_speed: 1e-3 };
            let (damping, restitution) = initial_damping(&scene);
            assert_eq!(damping, 0.0);
            assert_eq!(restitution.expect("a restitution was given").damping(0.2), 0.0);
        }
    }
}
