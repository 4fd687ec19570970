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
//! # Source
//! Lankarani, Nikravesh (1990), J. Mech. Design 112, 369-376, and (1994), Nonlinear Dynamics 5, 193-207.
//! Hunt, Crossley (1975), J. Appl. Mech. 42, 440-445. Flores, Machado, Silva, Martins (2011), Multibody
//! System Dynamics 25, 357-375.

use crate::lanes::{Real, lanewise};
use common::scene::{ContactDamping, RestitutionLaw};

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
pub(crate) fn initial(damping: &ContactDamping) -> (f64, Option<Restitution>) {
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
            let (damping, restitution) = initial(&scene);
            assert_eq!(damping, 0.0);
            assert_eq!(restitution.expect("a restitution was given").damping(0.2), 0.0);
        }
    }
}
