//! Energy balance of one joint: stored energy, and the power lost to friction, damping and film.
//!
//! The power of the joint's forces on its two bodies is P = -d(stored)/dt - friction - damping - film +
//! unphysical [W], with friction F_T v_t, damping (F_N - F_el) delta_dot, film c_f |w|^2 and the stored
//! energy (2/5) K_n delta^2.5 (`local-hertz`) or U (`foundation`) [J]. The unphysical part is zero for an
//! elastic force that is a gradient; `local-hertz` on a worn bore has -F_N R' (w.t / r - omega_j), with the
//! slope R' of the bore [m/rad], the tangent t and the eccentricity r = |e|; a worn journal of radius R_j adds F_N R_j' (w.t / r - omega_i).
//!
//! # Source
//! Hunt, Crossley (1975), J. Appl. Mech. 42, 440-445; the same balance in Simbody: Sherman, Seth, Delp
//! (2011), Procedia IUTAM 2, 241-261.

use super::{Contact, JointForce, JointMotion, Surfaces};

/// Energy stored in a joint and powers, at one instant.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct ContactEnergy {
    /// Elastic energy: (2/5) K_n delta^2.5, or the foundation's potential U [J].
    pub stored: f64,
    /// Power lost to friction, F_T v_t >= 0 [W].
    pub friction: f64,
    /// Power lost to the damping of the contact, (F_N - F_el) delta_dot >= 0 [W].
    pub damping: f64,
    /// Power lost to the film, c_f |w|^2 >= 0 [W].
    pub film: f64,
    /// Power created (above zero) or destroyed by a law that is not conservative [W].
    pub unphysical: f64,
}

impl Contact {
    /// The joint's energy and powers at a motion, given its force there.
    pub(crate) fn energy<'a>(
        &self,
        surfaces: impl Into<Surfaces<'a>>,
        motion: &JointMotion,
        force: &JointForce,
    ) -> ContactEnergy {
        let surface = self.surface();
        let surfaces = surfaces.into();
        let [stored, elastic, rate] = match self {
            Contact::LocalHertz(law) => law.elastic(surfaces, motion),
            Contact::Foundation(law) => law.elastic(surfaces, motion),
        };
        let JointMotion { w, omega_journal, omega_bushing, .. } = *motion;
        let power = force.force[0] * w[0]
            + force.force[1] * w[1]
            + force.torque_journal * omega_journal
            + force.torque_bushing * omega_bushing;
        let friction = surface.friction(force.sliding).0 * force.normal * force.sliding;
        let damping = (force.normal - elastic) * rate;
        let film = surface.film * (w[0] * w[0] + w[1] * w[1]);
        ContactEnergy {
            stored,
            friction,
            damping,
            film,
            unphysical: power + elastic * rate + friction + damping + film,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bore::Profile;
    use crate::contact::tests::{SURFACE, laws, motions, worn};
    use std::f64::consts::TAU;

    fn unworn() -> Profile {
        Profile::round(SURFACE.journal_radius + SURFACE.clearance, 36)
    }

    /// A journal that rattles along the bore, in and out of contact: sums of sines with unrelated periods, as
    /// seen from the bushing, which swings.
    fn rattle(profile: &Profile, t: f64) -> JointMotion {
        let e = |t: f64| {
            let psi = 2.0 + 1.7 * (31.0 * t).sin() + 0.8 * (77.0 * t + 1.0).sin();
            let depth = 1.5e-7 * (0.3 + (1500.0 * t).sin() + 0.7 * (2700.0 * t + 0.4).cos());
            let reach = profile.radius_at(psi.rem_euclid(TAU)).r - SURFACE.journal_radius + depth;
            [reach * psi.cos(), reach * psi.sin()]
        };
        let omega_bushing = 40.0 * (53.0 * t).cos();
        let step = 1e-7;
        let (now, after, before) = (e(t), e(t + step), e(t - step));
        let own = [0, 1].map(|k| (after[k] - before[k]) / (2.0 * step));
        JointMotion {
            e: now,
            w: [own[0] - omega_bushing * now[1], own[1] + omega_bushing * now[0]],
            omega_journal: 25.0 * (19.0 * t).sin(),
            omega_bushing,
            turn: 0.0,
        }
    }

    /// Sum of the sizes of what makes up the power.
    fn size(f: &JointForce, m: &JointMotion) -> f64 {
        (f.force[0] * m.w[0]).abs()
            + (f.force[1] * m.w[1]).abs()
            + (f.torque_journal * m.omega_journal).abs()
            + (f.torque_bushing * m.omega_bushing).abs()
    }

    fn power(f: &JointForce, m: &JointMotion) -> f64 {
        f.force[0] * m.w[0]
            + f.force[1] * m.w[1]
            + f.torque_journal * m.omega_journal
            + f.torque_bushing * m.omega_bushing
    }

    #[test]
    fn power_of_the_joint_is_what_the_ledger_says() {
        let mut flying = 0;
        for profile in [unworn(), worn()] {
            for law in laws(SURFACE, &profile) {
                let mut touching = 0;
                let (mut worst, mut largest, mut unphysical) = (0.0_f64, 0.0_f64, 0.0_f64);
                for k in 0..400 {
                    let t = 2.3e-4 * f64::from(k);
                    let motion = rattle(&profile, t);
                    let force = law.force::<false>(&profile, &motion).0;
                    let ledger = law.energy(&profile, &motion, &force);
                    assert!(ledger.friction >= 0.0 && ledger.damping >= 0.0 && ledger.film >= 0.0);
                    assert!(ledger.stored >= 0.0);
                    touching += u32::from(force.normal > 0.0);
                    flying += u32::from(force.normal == 0.0);
                    // Rate of the stored energy along the motion itself, of fourth order in the step.
                    let stored = |s: f64| {
                        let motion = rattle(&profile, t + s);
                        law.energy(&profile, &motion, &law.force::<false>(&profile, &motion).0).stored
                    };
                    let h = 1e-6;
                    let rate =
                        (8.0 * (stored(h) - stored(-h)) - stored(2.0 * h) + stored(-2.0 * h)) / (12.0 * h);
                    let said = -rate - ledger.friction - ledger.damping - ledger.film + ledger.unphysical;
                    worst = worst.max((power(&force, &motion) - said).abs());
                    largest = largest.max(power(&force, &motion).abs());
                    unphysical = unphysical.max(ledger.unphysical.abs());
                }
                // The motion's own velocity is a difference, good to (2700 rad/s * 1e-7 s)^2 / 6 = 1e-8.
                assert!(worst < 1e-6 * largest, "{worst} W of {largest} W");
                println!("off by {worst:e} W of {largest:e} W, {unphysical:e} W unphysical");
                assert!(touching > 100, "{touching} states in contact");
            }
        }
        assert!(flying > 100, "{flying} states in free flight");
    }

    #[test]
    fn only_the_local_law_on_a_worn_bore_is_unphysical() {
        for (profile, is_worn) in [(unworn(), false), (worn(), true)] {
            let [local, foundation] = laws(SURFACE, &profile);
            for motion in motions(&profile) {
                let force = foundation.force::<false>(&profile, &motion).0;
                let found = foundation.energy(&profile, &motion, &force).unphysical;
                assert!(found.abs() < 1e-13 * size(&force, &motion), "foundation: {found}");

                let force = local.force::<false>(&profile, &motion).0;
                let found = local.energy(&profile, &motion, &force).unphysical;
                let r = motion.e[0].hypot(motion.e[1]);
                let along = (motion.e[0] * motion.w[1] - motion.e[1] * motion.w[0]) / r;
                let slope = profile.radius_at(motion.e[1].atan2(motion.e[0])).d1;
                let expected = -force.normal * slope * (along / r - motion.omega_bushing);
                assert!((found - expected).abs() < 1e-13 * size(&force, &motion), "{found}, {expected}");
                assert_eq!(is_worn, expected.abs() > 1e-6 * size(&force, &motion), "{expected}");
            }
        }
    }

    #[test]
    fn a_contact_that_lets_go_early_loses_what_it_still_stores() {
        // Beyond delta_dot = -1/D the normal force is zero though the bore is still compressed.
        let profile = worn();
        for law in laws(SURFACE, &profile) {
            let away = motions(&profile)[3];
            let motion =
                JointMotion { w: [-20.0 * away.e[0] / 23.5e-6, -20.0 * away.e[1] / 23.5e-6], ..away };
            let force = law.force::<false>(&profile, &motion).0;
            let ledger = law.energy(&profile, &motion, &force);
            assert!(force.normal == 0.0 && ledger.stored > 0.0 && ledger.damping > 0.0);
            assert!(ledger.unphysical.abs() < 1e-13 * size(&force, &motion));
            assert_eq!(ledger.friction, 0.0);
        }
    }

    #[test]
    fn an_unworn_bore_stores_hertz_energy_under_both_laws() {
        let profile = unworn();
        for motion in motions(&profile) {
            let delta = motion.e[0].hypot(motion.e[1]) - SURFACE.clearance;
            let expected = 0.4 * SURFACE.stiffness * delta.powf(2.5);
            for law in laws(SURFACE, &profile) {
                let stored = law.energy(&profile, &motion, &law.force::<false>(&profile, &motion).0).stored;
                // Of the foundation: its modulus is fitted within 4e-5, the ends of the arc add their share.
                assert!((stored / expected - 1.0).abs() < 1e-4, "{stored} against {expected}");
            }
        }
    }
}
