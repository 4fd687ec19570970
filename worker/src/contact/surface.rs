//! Constants of one joint that all contact laws share, with the friction and film laws that follow from them.
//!
//! Friction F_T = mu F_N tanh(v_t / v_0), with the friction coefficient mu [1], the normal force F_N [N], the
//! sliding speed v_t and the regularisation speed v_0 [m/s]; film force -c_f w through the centres,
//! with the film damping c_f [N s/m] and the relative velocity w of the centres [m/s].
//!
//! # Source
//! Coulomb's law regularised as by Andersson, Soderberg, Bjorklund (2007), Tribology International 40,
//! 580-587.

use super::damping::{Restitution, initial};
use super::joint_force::{ForceSlopes, JointForce, JointMotion};
use crate::lanes::{Real, cube_root, lanewise, tanh};
use common::scene::{Clearance, Material};
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
        let (damping, restitution) = initial(&joint.contact_damping);
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
