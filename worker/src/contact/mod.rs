//! Forces in one joint with clearance, as pure functions of the motion of that joint.
//!
//! All vectors are in the bushing's frame: e = r_journal - r_bushing, w = velocity of the journal's centre
//! minus that of the bushing's centre (both turned into the bushing's frame, not differentiated in it),
//! omega_i of the journal's body, omega_j of the bushing's. The force returned acts on the journal at its
//! centre; the opposite force acts on the bushing at its centre; friction adds the torques.
//!
//! Each law has a file, which defines its elastic force F_el [N], its penetration delta [m] and the rate of
//! that, delta_dot [m/s]. All laws share
//! - the normal force F_N = F_el max(0, 1 + D delta_dot), damping factor D [s/m]; zero in free flight (delta
//!   <= 0);
//! - the friction force F_T = mu F_N tanh(v_t / v_0), friction coefficient mu [1], sliding speed v_t [m/s] of
//!   the journal's surface over the bushing's, regularisation speed v_0 [m/s];
//! - the film force -c_f w through the centres, film damping c_f [N s/m], in contact and in free flight.
//!
//! Valid for penetrations up to a tenth of the journal radius ([`Surface::deepest`]). Below about v_0
//! friction is viscous: the model has no state of sticking.
//!
//! # Source
//! Normal force: Hunt, Crossley (1975), J. Appl. Mech. 42, 440-445. Friction: Coulomb's law regularised as by
//! Andersson, Soderberg, Bjorklund (2007), Tribology International 40, 580-587.

mod arc;
mod damping;
mod energy;
mod foundation;
mod local_hertz;
mod modulus;
mod stiffness;
#[cfg(test)]
mod tests;

pub use arc::Arc;
pub use damping::Restitution;
pub use energy::ContactEnergy;
pub use foundation::{Foundation, Pressing, equivalent_penetration};
pub use local_hertz::LocalHertz;
pub use stiffness::hertz_stiffness;

use crate::bore::Profile;
use crate::lanes::{Real, tanh};
use common::scene::{Clearance, ContactLaw};

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
}

/// What a joint does at one instant.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct JointForce<R = f64> {
    /// Force on the journal, at its centre `(2,)` [N].
    pub force: [R; 2],
    /// Torque on the journal's body beside that of `force` [N m].
    pub torque_journal: R,
    /// Torque on the bushing's body beside that of the opposite force [N m].
    pub torque_bushing: R,
    /// Normal contact force F_N >= 0, without the film [N].
    pub normal: R,
    /// Direction in which the journal presses on the bushing, zero in free flight `(2,)` [1].
    pub direction: [R; 2],
    /// Penetration delta, negative in free flight [m].
    pub penetration: R,
    /// Sliding speed v_t of the journal's surface over the bushing's [m/s].
    pub sliding: R,
    /// Derivative of (force, torque_journal, torque_bushing) to (e, w, omega_journal, omega_bushing) `(4,
    /// 6)`; zero unless asked for.
    pub jacobian: [[R; 6]; 4],
}

impl<R: Real> JointForce<R> {
    /// No force, in as many lanes as `like`.
    #[inline(always)]
    pub fn none(like: R) -> Self {
        let zero = like.zero();
        JointForce {
            force: [zero; 2],
            torque_journal: zero,
            torque_bushing: zero,
            normal: zero,
            direction: [zero; 2],
            penetration: zero,
            sliding: zero,
            jacobian: [[zero; 6]; 4],
        }
    }
}

/// What both contact laws need to know of the joint.
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
    /// How D follows from the speed of approach; none: it is constant.
    pub restitution: Option<Restitution>,
    /// Friction coefficient [1].
    pub friction: R,
    /// Regularisation speed v_0 [m/s].
    pub friction_speed: R,
    /// Film damping [N s/m].
    pub film: R,
}

impl Surface {
    /// Takes what the contact needs from a checked joint.
    pub fn of(joint: &Clearance) -> Self {
        let (damping, restitution) = damping::initial(&joint.contact_damping);
        Surface {
            journal_radius: joint.journal_radius,
            clearance: joint.radial_clearance(),
            stiffness: hertz_stiffness(joint),
            damping,
            restitution,
            friction: joint.friction,
            friction_speed: joint.friction_speed,
            film: joint.film_damping,
        }
    }

    /// Penetration up to which a journal is in contact with its bore in any sense of Hertz: a tenth of its
    /// radius [m].
    pub fn deepest(&self) -> f64 {
        0.1 * self.journal_radius
    }
}

impl<R: Real> Surface<R> {
    /// The same surface in every lane.
    pub fn of_lanes(surface: &Surface, like: R) -> Self {
        let mut all = Surface {
            journal_radius: like,
            clearance: like,
            stiffness: like,
            damping: like,
            restitution: None,
            friction: like,
            friction_speed: like,
            film: like,
        };
        (0..R::LANES).for_each(|lane| all.set_lane(lane, surface));
        all
    }

    /// Replaces a lane; how damping follows from the approach is not taken over.
    pub fn set_lane(&mut self, lane: usize, from: &Surface) {
        self.journal_radius.set_lane(lane, from.journal_radius);
        self.clearance.set_lane(lane, from.clearance);
        self.stiffness.set_lane(lane, from.stiffness);
        self.damping.set_lane(lane, from.damping);
        self.friction.set_lane(lane, from.friction);
        self.friction_speed.set_lane(lane, from.friction_speed);
        self.film.set_lane(lane, from.film);
    }

    /// mu tanh(v/v_0) and its derivative to v.
    #[inline(always)]
    fn friction(&self, v: R) -> (R, R) {
        let th = tanh(v / self.friction_speed);
        (self.friction * th, self.friction * (th.like(1.0) - th * th) / self.friction_speed)
    }

    /// Adds the film's force -c_f w through the centres.
    #[inline(always)]
    fn add_film<const JACOBIAN: bool>(&self, motion: &JointMotion<R>, out: &mut JointForce<R>) {
        for k in 0..2 {
            out.force[k] -= self.film * motion.w[k];
            if JACOBIAN {
                out.jacobian[k][2 + k] -= self.film;
            }
        }
    }
}

/// The contact law of one joint.
#[derive(Debug, Clone, PartialEq)]
pub enum Contact {
    /// F = K_n delta^1.5 along the eccentricity.
    LocalHertz(LocalHertz),
    /// Elastic foundation along the bore.
    Foundation(Foundation),
}

impl Contact {
    /// Builds the law a checked joint asks for.
    pub fn of(joint: &Clearance) -> Self {
        let surface = Surface::of(joint);
        match joint.contact_law {
            ContactLaw::LocalHertz => Contact::LocalHertz(LocalHertz { surface }),
            ContactLaw::Foundation => Contact::Foundation(Foundation::new(surface, joint.control_points)),
        }
    }

    /// What both laws share.
    pub fn surface(&self) -> &Surface {
        match self {
            Contact::LocalHertz(law) => &law.surface,
            Contact::Foundation(law) => law.surface(),
        }
    }

    /// Takes notice of a changed profile.
    pub fn profile_changed(&mut self, profile: &Profile) {
        if let Contact::Foundation(law) = self {
            law.profile_changed(profile);
        }
    }

    /// Takes notice of an accepted step that led to this motion and force: in free flight, the damping of the
    /// contact to come is that of the present speed of approach; a contact keeps what it began with. A law
    /// with constant D has nothing to take notice of.
    pub fn accepted(&mut self, profile: &Profile, motion: &JointMotion, now: &JointForce) {
        let Some(restitution) = self.surface().restitution else { return };
        if now.penetration > 0.0 {
            return;
        }
        let approach = if motion.e == [0.0; 2] {
            // From the middle of the bore every way leads to the wall.
            libm::hypot(motion.w[0], motion.w[1])
        } else {
            match self {
                Contact::LocalHertz(law) => law.approach(profile, motion),
                Contact::Foundation(law) => law.approach(motion),
            }
        };
        self.resume(restitution.damping(approach));
    }

    /// Goes on as a contact with this damping [s/m]: what the joint remembers of how its contact began.
    pub fn resume(&mut self, damping: f64) {
        let surface = match self {
            Contact::LocalHertz(law) => &mut law.surface,
            Contact::Foundation(law) => &mut law.surface,
        };
        surface.damping = damping;
    }

    /// Force at this motion; with `JACOBIAN` its derivative too.
    #[inline]
    pub fn force<const JACOBIAN: bool>(&self, profile: &Profile, motion: &JointMotion) -> JointForce {
        match self {
            Contact::LocalHertz(law) => law.force::<JACOBIAN>(profile, motion),
            Contact::Foundation(law) => law.force::<JACOBIAN>(motion),
        }
    }
}
