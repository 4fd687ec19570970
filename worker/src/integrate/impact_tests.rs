//! Central impact of a journal on an unworn bore against closed forms, with the real contact kernel and step
//! control.

use super::{Advance, AdvanceStats, Dynamics, Linearised, Watch};
use crate::bore::Profile;
use crate::contact::{JointForce, JointMotion, LocalHertz, Surface};

/// A journal without other forces in a fixed bore: coordinates e, masses (m, m).
struct Impact {
    law: LocalHertz,
    bore: Profile,
    mass: [f64; 2],
    scale_q: [f64; 2],
    scale_v: [f64; 2],
}

impl Impact {
    fn new(stiffness: f64, damping: f64, mass: f64, speed: f64) -> Self {
        let surface = Surface {
            journal_radius: 0.5,
            clearance: 0.1,
            stiffness,
            damping,
            restitution: None,
            friction: 0.0,
            friction_speed: 1e-3,
            film: 0.0,
        };
        Impact {
            law: LocalHertz { surface },
            bore: Profile::round(surface.journal_radius + surface.clearance, 36),
            mass: [mass; 2],
            scale_q: [deepest(stiffness, mass, speed); 2],
            scale_v: [speed; 2],
        }
    }

    fn contact<const JACOBIAN: bool>(&self, q: &[f64], v: &[f64]) -> JointForce {
        let motion = JointMotion { e: [q[0], q[1]], w: [v[0], v[1]], omega_journal: 0.0, omega_bushing: 0.0 };
        self.law.force::<JACOBIAN>(&self.bore, &motion)
    }
}

impl Dynamics for Impact {
    fn mass(&self) -> &[f64] {
        &self.mass
    }
    fn force(&self, _t: f64, q: &[f64], v: &[f64], f: &mut [f64]) {
        f.copy_from_slice(&self.contact::<false>(q, v).force);
    }
    fn linearise(&self, _t: f64, q: &[f64], v: &[f64], at: &mut Linearised) {
        let contact = self.contact::<true>(q, v);
        at.f.copy_from_slice(&contact.force);
        for r in 0..2 {
            at.k[2 * r..2 * r + 2].copy_from_slice(&contact.jacobian[r][..2]);
            at.d[2 * r..2 * r + 2].copy_from_slice(&contact.jacobian[r][2..4]);
        }
        at.joints[0] = contact;
    }
    fn scales(&self) -> (&[f64], &[f64]) {
        (&self.scale_q, &self.scale_v)
    }
}

/// Largest penetration of an undamped impact, (5 m v^2 / 4 K)^0.4 [m].
fn deepest(stiffness: f64, mass: f64, speed: f64) -> f64 {
    (1.25 * mass * speed * speed / stiffness).powf(0.4)
}

/// What the impact came to.
#[derive(Default)]
struct Seen {
    deepest: f64,
    last: (f64, f64, f64),
}

impl Watch for Seen {
    fn state(&mut self, t: f64, q: &[f64], v: &[f64], at: &Linearised) {
        let penetration = at.joints[0].penetration;
        let (t0, p0, v0) = self.last;
        if v0 > 0.0 && v[0] <= 0.0 {
            // The peak of the cubic between the last two states, where the velocity passes through zero.
            let (h, s) = (t - t0, v0 / (v0 - v[0]));
            let (slope0, slope1) = (v0 * h, v[0] * h);
            let c = 3.0 * (penetration - p0) - 2.0 * slope0 - slope1;
            let d = slope0 + slope1 - 2.0 * (penetration - p0);
            self.deepest = p0 + s * (slope0 + s * (c + s * d));
        }
        self.last = (t, penetration, v[0]);
        assert!(q[1] == 0.0, "a central impact stays central");
    }
}

/// Largest penetration, contact time and outgoing speed of an impact that begins at first contact.
fn impact(stiffness: f64, damping: f64, mass: f64, speed: f64) -> (f64, f64, f64) {
    let mut system = Impact::new(stiffness, damping, mass, speed);
    let long = 10.0 * deepest(stiffness, mass, speed) / speed;
    let mut advance = Advance::new(2, 1, 1e-7, long / 100.0, long * 1e-12, 100_000);
    let (mut q, mut v) = ([system.law.surface.clearance, 0.0], [speed, 0.0]);
    let mut seen = Seen::default();
    advance
        .run(&mut system, 0.0..long, &mut q, &mut v, &mut seen, &mut AdvanceStats::default())
        .expect("the impact is integrated");
    // Free flight at constant speed leads back to the instant of separation.
    let (t, penetration, out) = seen.last;
    assert!(penetration < 0.0 && out < 0.0, "the journal has left");
    (seen.deepest, t - penetration / out, -out)
}

#[test]
fn hertz_impact_lasts_and_reaches_as_long_and_deep_as_in_closed_form() {
    for (stiffness, mass, speed) in [(3.264e10, 2e-3, 0.05), (1e9, 0.1, 1.0), (1e7, 4.0, 0.3)] {
        let (depth, time, out) = impact(stiffness, 0.0, mass, speed);
        let expected = deepest(stiffness, mass, speed);
        assert!((depth / expected - 1.0).abs() < 1e-4, "depth {depth} against {expected}");
        let lasting = 2.943275 * expected / speed;
        assert!((time / lasting - 1.0).abs() < 1e-4, "time {time} against {lasting}");
        assert!((out / speed - 1.0).abs() < 1e-5, "speed {out} against {speed}");
    }
}

/// Root e in (0, 1) of D v (1 + e) = ln[(1 + D v) / (1 - e D v)], by bisection.
fn restitution(damping: f64, speed: f64) -> f64 {
    let a = damping * speed;
    let (mut low, mut high) = (0.0, 1.0_f64.min(1.0 / a));
    for _ in 0..200 {
        let e = 0.5 * (low + high);
        // Negative below the root; beyond e D v = 1 the logarithm is infinite.
        if ((1.0 + a) / (1.0 - e * a)).ln() - a * (1.0 + e) < 0.0 { low = e } else { high = e }
    }
    0.5 * (low + high)
}

#[test]
fn hunt_crossley_restitution_is_that_of_the_closed_form() {
    let cases =
        [(3.264e10, 2e-3, 7.5, 0.05), (3.264e10, 2e-3, 7.5, 0.5), (1e9, 0.1, 2.0, 1.0), (1e8, 5.0, 0.4, 0.2)];
    for (stiffness, mass, damping, speed) in cases {
        let (_, _, out) = impact(stiffness, damping, mass, speed);
        let (found, expected) = (out / speed, restitution(damping, speed));
        assert!((found - expected).abs() < 1e-4, "D v = {}: {found} against {expected}", damping * speed);
    }
}

#[test]
fn published_damping_factors_give_the_restitution_computed_for_them() {
    // D v0 for a wanted e: Lankarani-Nikravesh 3 (1 - e^2) / 4, Hunt-Crossley 3 (1 - e) / 2, Flores 8 (1 - e) / (5 e).
    for (wanted, nikravesh, crossley, flores) in
        [(0.5, 0.7252, 0.6630, 0.4704), (0.7, 0.7960, 0.7680, 0.6832), (0.9, 0.9132, 0.9090, 0.8939)]
    {
        let e: f64 = wanted;
        let choices =
            [(0.75 * (1.0 - e * e), nikravesh), (1.5 * (1.0 - e), crossley), (1.6 * (1.0 - e) / e, flores)];
        for (damping, expected) in choices {
            let (_, _, out) = impact(1e9, damping, 0.1, 1.0);
            assert!((out - expected).abs() < 1e-4, "wanted {wanted}: {out} against {expected}");
        }
    }
}
