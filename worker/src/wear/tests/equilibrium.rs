//! Forces in equilibrium on bores of all kinds: round, worn, rough, with a deep narrow groove.

use crate::bore::Profile;
use crate::contact::{Foundation, FoundationLoad, Surface};
use crate::wear::equilibrium::{LEFT, NEARBY, NoEquilibrium, RESOLVED, equilibrium};
use std::f64::consts::TAU;

const POINTS: usize = 36;

fn law(clearance: f64, depth: &[f64; POINTS]) -> Foundation {
    let surface = Surface {
        journal_radius: 1.5e-3,
        clearance,
        stiffness: 3.264e10 * (23.5e-6 / clearance).sqrt(),
        damping: 0.0,
        restitution: None,
        friction: 0.0,
        per_friction_speed: 1.0 / 2.4e-3,
        film: 0.0,
    };
    let mut profile = Profile::round(surface.journal_radius + clearance, POINTS);
    profile.set_depth(depth);
    let mut law = Foundation::with_intervals(surface, POINTS, 288);
    law.profile_changed(&profile);
    law
}

fn polar(length: f64, angle: f64) -> [f64; 2] {
    [length * angle.cos(), length * angle.sin()]
}

/// Numbers in [0, 1), the same ones each time: multiples of the golden ratio's fraction.
struct Even(f64);

impl Even {
    fn next(&mut self) -> f64 {
        self.0 = (self.0 + 0.618_033_988_749_895) % 1.0;
        self.0
    }
}

/// Depths: none, a smooth wide scar, that and roughness between the points, a groove at two points.
fn depths(size: f64, even: &mut Even) -> [[f64; POINTS]; 4] {
    let scar = |i: usize| {
        let off = (i as f64 / POINTS as f64 - 0.4) * TAU;
        size * (1.0 + off.cos()).powi(3) / 8.0
    };
    let smooth = std::array::from_fn(scar);
    let rough = std::array::from_fn(|i| scar(i) + 0.3 * size * even.next());
    let groove = std::array::from_fn(|i| if i == 9 || i == 10 { size } else { 0.0 });
    [[0.0; POINTS], smooth, rough, groove]
}

#[test]
fn on_a_round_bore_a_force_rests_at_hertz_penetration() {
    let clearance = 23.5e-6;
    let law = law(clearance, &[0.0; POINTS]);
    for force in [1.0, 30.0, 1000.0] {
        let depth = (force / law.surface.stiffness).powf(2.0 / 3.0);
        // Half the arc spans m intervals, which puts the force within 0.025 / m^3; the modulus is fitted
        // within 4e-4.
        let spanned = (2.0 * depth / clearance).sqrt() * law.arc.intervals() as f64 / TAU;
        let bound = 4e-4 + 0.025 / spanned.powi(3);
        for psi in [0.1, 2.0, 4.4] {
            let (start, force) = (polar(0.9 * clearance, psi - 1.0), polar(force, psi));
            let e = equilibrium(&law, force, start).expect("in equilibrium").0;
            let off = (e[0].hypot(e[1]) - clearance) / depth - 1.0;
            let turned = (e[1].atan2(e[0]) - psi).rem_euclid(TAU);
            assert!(off.abs() < bound, "{force:?} N: {off} of the penetration");
            assert!(turned.min(TAU - turned) < bound, "{force:?} N: turned by {turned}");
        }
    }
}

#[test]
fn the_potential_is_convex_whatever_the_bore() {
    let mut even = Even(0.6);
    let mut bent = 0;
    for depth in depths(30e-6, &mut even) {
        let law = law(23.5e-6, &depth);
        for _ in 0..400 {
            let mut point = || polar(80e-6 * even.next(), TAU * even.next());
            let (a, b) = (point(), point());
            let energy = |e: [f64; 2]| law.load(e).energy;
            let chord = 0.5 * (energy(a) + energy(b));
            let middle = energy([0.5 * (a[0] + b[0]), 0.5 * (a[1] + b[1])]);
            assert!(middle <= chord * (1.0 + 1e-12), "{a:?} {b:?}: {middle} above {chord}");
            bent += u32::from(middle < 0.99 * chord);
        }
    }
    assert!(bent > 1000, "{bent}");
}

#[test]
fn every_force_within_range_finds_its_rest_on_any_bore() {
    let mut even = Even(0.2);
    let (mut far, mut most) = (0, 0);
    for clearance in [1e-6, 5e-6, 23.5e-6, 0.5e-3] {
        for size in [1e-7, 3e-6, 30e-6, 200e-6] {
            for depth in depths(size, &mut even) {
                let law = law(clearance, &depth);
                // From loads no joint would notice to the edge of the range.
                let edge = law.surface.stiffness * law.surface.deepest().powf(1.5);
                for power in [0, 1, 2, 3, 5, 7, 9, 12, 15] {
                    let force = polar(0.999 * edge * 10f64.powi(-power), TAU * even.next());
                    let start = polar((clearance + size) * even.next(), TAU * even.next());
                    let found = equilibrium(&law, force, start)
                        .unwrap_or_else(|e| panic!("{e:?}: {force:?} N, {clearance} m, {depth:?}"));
                    let FoundationLoad { force: carried, stiffness: [a, _, d], .. } = law.load(found.0);
                    let left = (carried[0] - force[0]).hypot(carried[1] - force[1]);
                    let bound = f64::max(
                        LEFT * force[0].hypot(force[1]),
                        RESOLVED * law.surface.journal_radius * (a + d),
                    );
                    assert!(left <= bound * (1.0 + 1e-9), "{left} of {force:?}");
                    far += u32::from(found.1 > NEARBY);
                    most = most.max(found.1);
                }
            }
        }
    }
    println!("{far} of 576 from a heavy load, {most} evaluations at most");
    assert!(far > 100, "{far} from a heavy load");
    // Eleven loads at most, some seven evaluations each, and those spent before: 98.
    assert!(most < 150, "{most} evaluations");
}

#[test]
fn from_nearby_a_rest_costs_a_few_evaluations() {
    // What a wear step asks for: a bore that has worn a little since, under the same force.
    let scar = |size: f64| depths(size, &mut Even(0.1))[1];
    for force in [1.0, 10.0, 100.0] {
        for psi in [0.3, 2.5, 5.1] {
            let force = polar(force, psi);
            let before =
                equilibrium(&law(23.5e-6, &scar(10e-6)), force, polar(30e-6, psi)).expect("in equilibrium");
            let after = law(23.5e-6, &scar(10.1e-6));
            let found = equilibrium(&after, force, before.0).expect("in equilibrium");
            assert!(found.1 <= 8, "{force:?}: {} evaluations", found.1);
        }
    }
}

#[test]
fn a_force_too_light_to_resolve_rests_where_the_journal_touches() {
    for depth in depths(10e-6, &mut Even(0.3)) {
        let law = law(23.5e-6, &depth);
        for power in [14, 16, 20, 100, 300] {
            let force = polar(10f64.powi(-power), 1.9);
            let found = equilibrium(&law, force, [0.0; 2]).expect("in equilibrium");
            let carried = law.load(found.0).force;
            let size = carried[0].hypot(carried[1]);
            assert!(size > 0.0 && size < 1e-12, "1e-{power} N: {carried:?}");
        }
    }
}

#[test]
fn a_force_beyond_the_range_is_refused_by_its_penetration() {
    let law = law(23.5e-6, &[0.0; POINTS]);
    // Penetration goes with the force to the power of two thirds.
    let force = 8.0 * law.surface.stiffness * law.surface.deepest().powf(1.5);
    let Err(NoEquilibrium(excess)) = equilibrium(&law, [force, 0.0], [0.0; 2]) else {
        panic!("{force} N in equilibrium")
    };
    assert!((excess - 4.0).abs() < 1e-12, "{excess}");
}
