//! The law `hertz`: the place of the contact against a dense search, agreement with `local-hertz` on a round bore, a potential that is continuous
//! on any bore, and lanes against one number.

use super::tests::{SURFACE, laws, motions, worn};
use super::{Contact, JointMotion, Journal, Surface, Surfaces};
use crate::bore::Profile;
use std::f64::consts::TAU;

fn bore(points: usize, depth: impl Fn(f64) -> f64) -> Profile {
    let mut profile = Profile::round(SURFACE.journal_radius + SURFACE.clearance, points);
    let depth: Vec<f64> = (0..points).map(|i| depth(TAU * i as f64 / points as f64)).collect();
    profile.set_depth(&depth);
    profile
}

fn hertz(surface: Surface, profile: &Profile) -> Contact {
    let [_, hertz, _] = laws(surface, profile);
    hertz
}

/// Angle to `middle` within half a turn over `half` [1].
fn distance(psi: f64, middle: f64, half: f64) -> f64 {
    ((psi - middle + 0.5 * TAU).rem_euclid(TAU) - 0.5 * TAU).abs() / half
}

/// A wide scar, and a groove that is narrower than the journal.
fn grooved(points: usize) -> Profile {
    bore(points, |psi| {
        let x = distance(psi, 2.0, 0.4);
        let groove = if x < 1.0 { 6e-6 * (1.0 - x * x).powi(2) } else { 0.0 };
        10e-6 * (1.0 + (psi - 1.0).cos()) + groove
    })
}

fn at(e: [f64; 2]) -> JointMotion {
    JointMotion { e, w: [0.0; 2], omega_journal: 0.0, omega_bushing: 0.0, turn: 0.0 }
}

/// Largest closing of the gap over 40 000 angles, and its angle [m, rad].
fn searched(surfaces: Surfaces, motion: &JointMotion) -> (f64, f64) {
    let closed = |theta: f64| {
        let radius = surfaces
            .journal
            .map_or(SURFACE.journal_radius, |journal| journal.radius_at(theta - motion.turn).r);
        motion.e[0] * theta.cos() + motion.e[1] * theta.sin() + radius - surfaces.bore.radius_at(theta).r
    };
    (0..40_000)
        .map(|k| TAU * f64::from(k) / 40_000.0)
        .map(|theta| (closed(theta), theta))
        .fold((f64::NEG_INFINITY, 0.0), |a, b| if b.0 > a.0 { b } else { a })
}

/// Eccentricities all round a bore, as far as this penetration in their own direction.
fn eccentricities(profile: &Profile, penetration: f64) -> impl Iterator<Item = [f64; 2]> {
    (0..720).map(move |k| {
        let psi = TAU * (f64::from(k) + 0.3) / 720.0;
        let reach = profile.radius_at(psi).r - SURFACE.journal_radius + penetration;
        [reach * psi.cos(), reach * psi.sin()]
    })
}

#[test]
fn the_contact_is_where_the_gap_is_closed_furthest() {
    for points in [36, 72, 144] {
        for profile in [worn(), grooved(points)] {
            let law = hertz(SURFACE, &profile);
            for penetration in [2e-8, 2e-7, 2e-6] {
                for e in eccentricities(&profile, penetration) {
                    let (furthest, angle) = searched((&profile).into(), &at(e));
                    let found = law.force::<false>(&profile, &at(e)).0;
                    // The angles of the search are 1.6e-4 rad apart.
                    assert!(
                        (found.penetration - furthest).abs() < 1e-12,
                        "{e:?}: {found:?}, {furthest} at {angle}"
                    );
                }
            }
        }
    }
}

#[test]
fn the_contact_of_a_turning_worn_journal_is_where_the_gap_is_closed_furthest() {
    let profile = grooved(36);
    let law = hertz(SURFACE, &profile);
    let mut journal: Journal = law.new_journal(36);
    let scar = |i: u32| 5e-6 * (0.5 + 0.5 * (TAU * f64::from(i) / 36.0 + 1.0).cos()).powi(4);
    journal.set_depth(&(0..36).map(scar).collect::<Vec<_>>());
    let surfaces = Surfaces { bore: &profile, journal: Some(&journal) };
    let mut worst = 0.0_f64;
    for (k, e) in eccentricities(&profile, 3e-6).enumerate() {
        let motion = JointMotion { turn: 0.7 * k as f64, ..at(e) };
        let (furthest, _) = searched(surfaces, &motion);
        let found = law.force::<false>(surfaces, &motion).0;
        if furthest > 0.0 {
            worst = worst.max((found.penetration - furthest).abs());
        }
    }
    assert!(worst < 1e-12, "{worst}");
}

#[test]
fn on_a_round_bore_it_is_local_hertz() {
    let round = Profile::round(SURFACE.journal_radius + SURFACE.clearance, 36);
    let [local, hertz, _] = laws(SURFACE, &round);
    for motion in motions(&round) {
        let ((a, slopes_a), (b, slopes_b)) =
            (local.force::<true>(&round, &motion), hertz.force::<true>(&round, &motion));
        // A penetration of 1e-7 m is the difference of millimetres.
        let close = |a: f64, b: f64, scale: f64| assert!((a - b).abs() < 1e-10 * scale, "{a} against {b}");
        for k in 0..2 {
            close(a.force[k], b.force[k], a.normal);
        }
        close(a.torque_journal, b.torque_journal, a.torque_journal.abs());
        close(a.torque_bushing, b.torque_bushing, a.torque_bushing.abs());
        close(a.penetration, b.penetration, a.penetration);
        close(a.sliding, b.sliding, 1e-2);
        let (a, b) = (slopes_a.in_bushing_axes(), slopes_b.in_bushing_axes());
        for r in 0..4 {
            let scale = a[r].iter().fold(0.0_f64, |m, x| m.max(x.abs()));
            (0..6).for_each(|c| close(a[r][c], b[r][c], scale));
        }
    }
}

/// Elastic energy at the eccentricity `e` [J].
fn stored(law: &Contact, profile: &Profile, e: [f64; 2]) -> f64 {
    let motion = at(e);
    law.energy(profile, &motion, &law.force::<false>(profile, &motion).0).stored
}

#[test]
fn the_energy_is_continuous_and_its_gradient_the_force_also_between_the_edges_of_a_groove() {
    const STEPS: u32 = 40_000;
    let bare = Surface { damping: 0.0, friction: 0.0, film: 0.0, ..SURFACE };
    let profile = grooved(72);
    let law = hertz(bare, &profile);
    let force = |e: [f64; 2]| law.force::<false>(&profile, &at(e)).0;
    for penetration in [1e-6, 4e-6] {
        // A loop about the place where the journal lies on both edges, in and out of contact. A step from one edge to the other misses up
        // to half of its way times the turn of the force.
        let (cos, sin) = (1.81_f64.cos(), 1.81_f64.sin());
        let (mut free, mut pressed) = (0.0, 1e-4);
        for _ in 0..60 {
            let reach = 0.5 * (free + pressed);
            let deep = force([reach * cos, reach * sin]).penetration > 0.5 * penetration;
            if deep { pressed = reach } else { free = reach }
        }
        let path = |s: f64| {
            let (radial, along) = (free + penetration * s.cos(), 1e-6 * s.sin());
            [radial * cos - along * sin, radial * sin + along * cos]
        };
        let (mut work, mut turned, mut largest, mut flying) = (0.0, 0.0_f64, 0.0_f64, 0);
        let (mut e, mut f, mut u) = (path(0.0), force(path(0.0)).force, stored(&law, &profile, path(0.0)));
        for k in 1..=STEPS {
            let to = path(TAU * f64::from(k) / f64::from(STEPS));
            let (now, v) = (force(to), stored(&law, &profile, to));
            let g = now.force;
            flying += u32::from(now.normal == 0.0);
            work += 0.5 * ((f[0] + g[0]) * (to[0] - e[0]) + (f[1] + g[1]) * (to[1] - e[1]));
            largest = largest.max(v);
            let sizes = [f, g].map(|f| f[0].hypot(f[1]));
            if sizes[0] * sizes[1] > 0.0 {
                turned = turned.max((f[0] * g[1] - f[1] * g[0]).abs() / (sizes[0] * sizes[1]));
            }
            // No step of the energy: it changes by the force times the way at most.
            let way = (to[0] - e[0]).hypot(to[1] - e[1]);
            assert!((v - u).abs() <= 1.01 * way * sizes[0].max(sizes[1]) + 1e-16 * largest);
            (e, f, u) = (to, g, v);
        }
        println!(
            "{penetration}: {work:e} J of {largest:e} J, turned by {turned} at once, {flying} in flight"
        );
        assert!(
            work.abs() < 1e-3 * largest && turned > 0.1 && flying > 100,
            "{work} J of {largest} J, {turned}"
        );
    }
}
