//! Both contact laws with a worn journal: exact derivatives, also to the angle of the journal, balances of power and momentum, and
//! agreement with a worn bore.

use crate::bore::Profile;
use crate::contact::energy::ContactEnergy;
use crate::contact::tests::{SURFACE, laws, motions, worn};
use crate::contact::{
    Contact, JointForce, JointMotion, Journal, LawLanes, PolarEccentricity, Surface, Surfaces,
};
use std::f64::consts::TAU;

/// Depths of a journal with a wide and a narrow scar.
fn scars(points: usize) -> Vec<f64> {
    let scar = |i: usize| {
        let chi = TAU * i as f64 / points as f64;
        4e-6 * (1.0 + (chi - 2.5).cos()) + 3e-6 * (0.5 + 0.5 * (chi + 1.0).cos()).powi(6)
    };
    (0..points).map(scar).collect()
}

fn journal(contact: &Contact) -> Journal {
    let mut journal = contact.new_journal(36);
    journal.set_depth(&scars(36));
    journal
}

/// Motions of `tests.rs`, as much deeper in the bore as the journal is worn.
fn motions_in_contact(profile: &Profile, journal: &Journal) -> Vec<JointMotion> {
    let reach = |motion: &JointMotion| {
        let psi = motion.e[1].atan2(motion.e[0]);
        SURFACE.journal_radius - journal.radius_at(psi - motion.turn).r
    };
    motions(profile)
        .into_iter()
        .map(|motion| {
            let size = motion.e[0].hypot(motion.e[1]);
            let share = 1.0 + reach(&motion) / size;
            JointMotion { e: motion.e.map(|e| share * e), ..motion }
        })
        .collect()
}

fn rows(f: &JointForce) -> [f64; 4] {
    [f.force[0], f.force[1], f.torque_journal, f.torque_bushing]
}

fn moved(m: &JointMotion, column: usize, step: f64) -> JointMotion {
    let mut m = *m;
    match column {
        0 | 1 => m.e[column] += step,
        2 | 3 => m.w[column - 2] += step,
        4 => m.omega_journal += step,
        5 => m.omega_bushing += step,
        _ => m.turn += step,
    }
    m
}

#[test]
fn derivatives_agree_with_differences() {
    let bore = worn();
    for law in laws(SURFACE, &bore) {
        let journal = journal(&law);
        let surfaces = Surfaces { bore: &bore, journal: Some(&journal) };
        let (mut worst, mut of_turn) = (0.0_f64, 0.0_f64);
        for motion in motions_in_contact(&bore, &journal) {
            let (at, slopes) = law.force::<true>(surfaces, &motion);
            assert!(at.normal > 0.0 && at.sliding.abs() * SURFACE.per_friction_speed < 30.0, "{at:?}");
            assert_eq!(
                rows(&at),
                rows(&law.force::<false>(surfaces, &motion).0),
                "with and without derivative"
            );
            let steps = [1e-10, 1e-10, 1e-8, 1e-8, 1e-5, 1e-5, 1e-6];
            for (column, step) in steps.into_iter().enumerate() {
                let [plus, minus] = [step, -step]
                    .map(|step| rows(&law.force::<false>(surfaces, &moved(&motion, column, step)).0));
                for (r, row) in slopes.in_bushing_axes().iter().enumerate() {
                    let largest = |of: &[f64]| of.iter().fold(0.0_f64, |a, b| a.max(b.abs()));
                    let turning = largest(&row[4..]).max(SURFACE.journal_radius * largest(&row[2..4]));
                    let to_turn = slopes.turn_in_bushing_axes();
                    let (exact, scale) = match column {
                        0 | 1 => (row[column], largest(&row[..2])),
                        2 | 3 => (row[column], largest(&row[2..4])),
                        4 | 5 => (row[column], turning),
                        // The scars are some micrometres deep over half a radian.
                        _ => (to_turn[r], 1e-5 * largest(&row[..2])),
                    };
                    let difference = (plus[r] - minus[r]) / (2.0 * step);
                    let off = (difference - exact).abs() / scale;
                    worst = worst.max(off);
                    if column == 6 {
                        of_turn = of_turn.max(exact.abs() / scale);
                    }
                }
            }
        }
        println!("derivatives off by {worst:e}, to the turn up to {of_turn} of the scale");
        assert!(worst < 1e-5, "{law:?}: {worst}");
        assert!(of_turn > 0.3, "{of_turn}");
    }
}

/// Power of the joint's forces on both bodies.
fn power(f: &JointForce, m: &JointMotion) -> f64 {
    f.force[0] * m.w[0]
        + f.force[1] * m.w[1]
        + f.torque_journal * m.omega_journal
        + f.torque_bushing * m.omega_bushing
}

#[test]
fn power_and_momentum_are_balanced() {
    let bore = worn();
    let bare = Surface { film: 0.0, ..SURFACE };
    for (foundation, law) in [false, true].into_iter().zip(laws(bare, &bore)) {
        let journal = journal(&law);
        let surfaces = Surfaces { bore: &bore, journal: Some(&journal) };
        let mut gained = 0.0_f64;
        for motion in motions_in_contact(&bore, &journal) {
            let force = law.force::<false>(surfaces, &motion).0;
            let ContactEnergy { friction, damping, unphysical, .. } = law.energy(surfaces, &motion, &force);
            // The stored energy along the motion itself, whose rates in the bushing's frame are these.
            let own = [
                motion.w[0] + motion.omega_bushing * motion.e[1],
                motion.w[1] - motion.omega_bushing * motion.e[0],
            ];
            let spin = motion.omega_journal - motion.omega_bushing;
            let stored = |t: f64| {
                let e = [motion.e[0] + t * own[0], motion.e[1] + t * own[1]];
                let then = JointMotion { e, turn: motion.turn + t * spin, ..motion };
                law.energy(surfaces, &then, &force).stored
            };
            let h = 1e-6;
            // Of fourth order in the step.
            let rate = (8.0 * (stored(h) - stored(-h)) - stored(2.0 * h) + stored(-2.0 * h)) / (12.0 * h);
            let done = power(&force, &motion);
            let said = -rate - friction - damping + unphysical;
            let size = friction + rate.abs() + damping.abs();
            assert!((done - said).abs() < 1e-5 * size, "{done} W, {said} W of {size} W");
            gained = gained.max(unphysical.abs() / size);
            let moment = motion.e[0] * force.force[1] - motion.e[1] * force.force[0]
                + force.torque_journal
                + force.torque_bushing;
            if foundation {
                assert!(unphysical.abs() < 1e-12 * size, "{unphysical} W");
                assert!(moment.abs() < 1e-12 * SURFACE.journal_radius * force.normal, "{moment}");
            } else {
                let psi = motion.e[1].atan2(motion.e[0]);
                let r = motion.e[0].hypot(motion.e[1]);
                let along = (motion.e[0] * motion.w[1] - motion.e[1] * motion.w[0]) / r;
                let slopes = [bore.radius_at(psi).d1, journal.radius_at(psi - motion.turn).d1];
                let rates = [along / r - motion.omega_bushing, along / r - motion.omega_journal];
                let expected = force.normal * (slopes[1] * rates[1] - slopes[0] * rates[0]);
                assert!((unphysical - expected).abs() < 1e-10 * size, "{unphysical} against {expected}");
                // Up to the penetration as a lever of the friction.
                let friction = SURFACE.friction * force.normal * force.penetration;
                assert!(moment.abs() < 1.001 * friction, "{moment} against {friction}");
            }
        }
        assert_eq!(foundation, gained < 1e-6, "{gained}");
    }
}

#[test]
fn a_scar_of_the_journal_acts_as_one_of_the_bore_turned_with_the_journal() {
    // Rotated by a whole number of control points the scars of a journal are those of a bore exactly.
    let clearance = SURFACE.journal_radius + SURFACE.clearance;
    let still = Surface { friction: 0.0, damping: 0.0, film: 0.0, ..SURFACE };
    let round = Profile::round(clearance, 36);
    for law in laws(still, &round) {
        let journal = journal(&law);
        for places in [0_usize, 7, 30] {
            let mut bore = Profile::round(clearance, 36);
            let depth: Vec<f64> = (0..36).map(|i| scars(36)[(i + 36 - places) % 36]).collect();
            bore.set_depth(&depth);
            let mut other = law.clone();
            other.profile_changed(&bore);
            for motion in motions(&bore) {
                let turn = TAU * (places as f64 / 36.0 + 3.0);
                let motion = JointMotion { turn, ..motion };
                let expected = other.force::<false>(&bore, &motion).0;
                let found = law.force::<false>(Surfaces { bore: &round, journal: Some(&journal) }, &motion).0;
                for k in 0..2 {
                    let off = (found.force[k] - expected.force[k]).abs();
                    assert!(off < 1e-4 * expected.normal, "{found:?} against {expected:?}");
                }
                assert!((found.penetration - expected.penetration).abs() < 1e-11, "{places}");
            }
        }
    }
}

#[test]
fn a_contact_takes_the_speed_of_approach_of_a_turning_journal() {
    // In free flight, the gap where it is largest a microsecond later and before.
    let bore = worn();
    for law in laws(SURFACE, &bore) {
        let journal = journal(&law);
        let surfaces = Surfaces { bore: &bore, journal: Some(&journal) };
        for motion in motions_in_contact(&bore, &journal) {
            let share = 0.9;
            let motion = JointMotion {
                e: motion.e.map(|e| share * e),
                omega_journal: 400.0,
                omega_bushing: -90.0,
                ..motion
            };
            let e = motion.e;
            let own = [motion.w[0] + motion.omega_bushing * e[1], motion.w[1] - motion.omega_bushing * e[0]];
            let gap = |t: f64| {
                let e = [e[0] + t * own[0], e[1] + t * own[1]];
                let turn = motion.turn + t * (motion.omega_journal - motion.omega_bushing);
                let at = |psi: f64, size: f64| {
                    size + journal.radius_at(psi - turn).r - bore.radius_at(psi.rem_euclid(TAU)).r
                };
                let centre = e[1].atan2(e[0]);
                match law {
                    Contact::LocalHertz(_) => at(centre, e[0].hypot(e[1])),
                    Contact::Foundation(_) => (0..62_832)
                        .map(|k| 1e-4 * f64::from(k))
                        .map(|psi| at(psi, e[0] * psi.cos() + e[1] * psi.sin()))
                        .fold(f64::NEG_INFINITY, f64::max),
                }
            };
            let expected = (gap(1e-6) - gap(-1e-6)) / 2e-6;
            let joint = LawLanes::new(&law, surfaces, 0.0);
            let place = PolarEccentricity::new(e);
            let found = joint.approach((&place, &joint.walls(&place, motion.turn)), &motion, 0.0);
            assert!((found - expected).abs() < 1e-3 * expected.abs() + 1e-5, "{found} against {expected}");
        }
    }
}
