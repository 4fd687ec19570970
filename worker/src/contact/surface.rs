//! Constants of one joint that all contact laws share, with the friction and film laws that follow from them.
//!
//! Friction F_T = mu F_N tanh(v_t / v_0), with the friction coefficient mu [1], the normal force F_N [N], the
//! sliding speed v_t and the regularisation speed v_0 [m/s] (`coulomb.rs`); film force -c_f w through the centres,
//! with the film damping c_f [N s/m] and the relative velocity w of the centres [m/s].
//!
//! # Source
//! Coulomb's law regularised as by Andersson, Soderberg, Bjorklund (2007), Tribology International 40,
//! 580-587.

use super::coulomb::coulomb;
use super::damping::{self, Restitution};
use super::joint_force::{ForceSlopes, JointForce, JointMotion};
use super::stiffness::hertz_stiffness;
use crate::lanes::{Real, lanewise};
use common::scene::Clearance;

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
        let (damping, restitution) = damping::initial(&joint.contact_damping);
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
