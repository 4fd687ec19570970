//! The wear rate of the local law against its readable version: a walk from angle to angle, sample by sample.

use crate::bore::Profile;
use crate::contact::{Contact, JointForce, LocalHertz, Surface};
use crate::wear::arc_ends::subdivision;
use crate::wear::local_arcs::LocalArcs;
use crate::wear::{BoreWearRate, ContactHistory, ContactInstant, ContactSample, WearLaw};
use std::f64::consts::{PI, TAU};

const CLEARANCE: f64 = 23.5e-6;
const R1: f64 = 1.5e-3;
const COEFFICIENT: f64 = 1.288e-13;
const WIDTH: f64 = 4e-3;

/// Arc in direction `psi` and further patches on the side of `sign`, as distances from `psi` `(2,)` each, by a walk over the table's
/// angles up to half a turn [rad].
fn walked(profile: &Profile, psi: f64, penetration: f64, sign: f64) -> Vec<[f64; 2]> {
    let n = subdivision(profile.points()) * profile.points();
    let spacing = TAU / n as f64;
    let at = profile.radius_at(psi);
    let e = penetration + at.r - R1;
    let beyond = |angle: f64| {
        let (s, c) = (angle - psi).sin_cos();
        R1 + e * c - e * e * s * s / (2.0 * R1) - profile.radius_at(angle.rem_euclid(TAU)).r
    };
    let place = psi / spacing;
    let first = if sign > 0.0 { place.floor() + 1.0 } else { place.floor() };
    let mut angle = first * spacing;
    let (mut phi, mut p) = (sign * (angle - psi), beyond(angle));
    let mut patches = vec![];
    let mut start = (p > 0.0).then_some(0.0);
    if p <= 0.0 {
        // Smallest positive root of delta + slope x + q x^2 through the point found outside.
        let slope = -sign * at.d1;
        let q = (p - penetration - slope * phi) / (phi * phi);
        let root = (slope * slope - 4.0 * q * penetration).sqrt();
        let roots = [(-slope - root) / (2.0 * q), (-slope + root) / (2.0 * q)];
        patches.push([0.0, roots.into_iter().filter(|x| *x > 0.0).fold(phi, f64::min)]);
    }
    while phi < PI {
        angle += sign * spacing;
        let next = beyond(angle);
        let zero = phi + spacing * p / (p - next);
        match start {
            Some(from) if next <= 0.0 => {
                patches.push([from, zero]);
                start = None;
            }
            None if next > 0.0 => start = Some(zero),
            _ => {}
        }
        (p, phi) = (next, phi + spacing);
    }
    patches.extend(start.map(|from| [from, PI]));
    patches
}

/// Wear per cycle of these samples: (direction, penetration, work).
fn plain(profile: &Profile, samples: &[(f64, f64, f64)]) -> Vec<f64> {
    let n = profile.points();
    let mut rate = vec![0.0; n];
    for &(psi, penetration, work) in samples {
        let [down, up] = [-1.0, 1.0].map(|sign| walked(profile, psi, penetration, sign));
        // The arc in both directions, then further patches: from, middle and to.
        let mut patches = vec![[-down[0][1], 0.0, up[0][1]]];
        patches.extend(down[1..].iter().map(|[from, to]| [-to, -0.5 * (from + to), -from]));
        patches.extend(up[1..].iter().map(|[from, to]| [*from, 0.5 * (from + to), *to]));
        let length: f64 = patches.iter().map(|[from, _, to]| to - from).sum();
        let radius = |angle: f64| profile.radius_at((psi + angle).rem_euclid(TAU)).r;
        for [from, middle, to] in patches {
            let mean_radius = (radius(from) + 4.0 * radius(middle) + radius(to)) / 6.0;
            // Mean over the patch of each point's hat function, summed over the turns it appears in, by the antiderivative
            // of each of its two straight sides.
            let spacing = TAU / n as f64;
            let rising = |from: f64, to: f64| if to > from { 0.5 * (to * to - from * from) } else { 0.0 };
            for (i, rate) in rate.iter_mut().enumerate() {
                let mean: f64 = (-1..=1)
                    .map(|turn| {
                        let at = i as f64 * spacing + f64::from(turn) * TAU;
                        let (start, end) = ((psi + from - at) / spacing, (psi + to - at) / spacing);
                        let side = |start: f64, end: f64| {
                            rising(1.0 + start.clamp(-1.0, 0.0), 1.0 + end.clamp(-1.0, 0.0))
                        };
                        (side(start, end) + side(-end, -start)) / (end - start)
                    })
                    .sum();
                let share = work * (to - from) / length;
                *rate += COEFFICIENT / WIDTH * share * mean / (mean_radius * spacing);
            }
        }
    }
    rate
}

/// Numbers in [0, 1), the same ones each time: multiples of the golden ratio's fraction.
struct Even(f64);

impl Even {
    fn next(&mut self) -> f64 {
        self.0 = (self.0 + 0.618_033_988_749_895) % 1.0;
        self.0
    }
}

/// Depths of a scar whose arc conforms to the journal, of that with roughness, of a groove, and of none.
fn bores(points: usize, size: f64, even: &mut Even) -> [Vec<f64>; 4] {
    let scar = |i: usize| size * (0.5 + 0.5 * (i as f64 / points as f64 * TAU - 2.0).cos()).powi(4);
    let smooth: Vec<f64> = (0..points).map(scar).collect();
    let rough = smooth.iter().map(|h| h + 0.1 * size * even.next()).collect();
    let groove = (0..points).map(|i| if i % 9 == 4 { size } else { 0.0 }).collect();
    [smooth, rough, groove, vec![0.0; points]]
}

#[test]
fn rates_are_those_of_the_walk_over_smooth_rough_and_grooved_bores() {
    let mut even = Even(0.25);
    let (mut worst, mut compared) = (0.0_f64, 0);
    for points in [12, 36, 90] {
        let mut profile = Profile::round(R1 + CLEARANCE, points);
        let contact = contact();
        for size in [1e-7, 3e-6, 30e-6] {
            let samples: Vec<(f64, f64, f64)> =
                (0..300).map(|_| (TAU * even.next(), 10f64.powf(-8.0 + 2.5 * even.next()), 1e-4)).collect();
            let mut history = ContactHistory::new(1.0, samples.len(), false);
            for &(psi, penetration, work) in &samples {
                let u = [psi.cos(), psi.sin()];
                let force = JointForce {
                    normal: 1.0,
                    sliding: work,
                    direction: u,
                    penetration,
                    ..JointForce::default()
                };
                history.push(1.0, &ContactInstant::new([CLEARANCE * u[0], CLEARANCE * u[1]], &force));
                history.close_interval();
            }
            let mut law = BoreWearRate::new([COEFFICIENT, 0.0], WIDTH, &contact, &profile);
            law.freeze(&history);
            // One bore after the other, so that the search starts from ends that were somewhere else.
            for depth in bores(points, size, &mut even) {
                profile.set_depth(&depth);
                let mut found = vec![0.0; points];
                law.rate(&depth, &mut found).expect("the local law needs no equilibrium");
                let expected = plain(&profile, &samples);
                let largest = expected.iter().fold(0.0_f64, |a, b| a.max(*b));
                assert!(largest > 0.0);
                for (a, b) in found.iter().zip(&expected) {
                    worst = worst.max((a - b).abs() / largest);
                    compared += 1;
                }
            }
        }
        profile.set_depth(&vec![0.0; points]);
    }
    println!("{compared} rates within {worst:e} of the largest");
    assert!(worst < 1e-9, "{worst:e}");
}

/// The law `local-hertz` of these radii.
fn contact() -> Contact {
    let surface = Surface {
        journal_radius: R1,
        clearance: CLEARANCE,
        stiffness: 3.264e10,
        damping: 0.0,
        restitution: None,
        friction: 0.0,
        per_friction_speed: 1.0 / 2.4e-3,
        film: 0.0,
    };
    Contact::LocalHertz(LocalHertz { surface })
}

/// One sample with work 1 N m whose arc has the half angle `half` [rad] on a round bore, in direction `psi`.
fn single(psi: f64, half: f64) -> ContactSample {
    // p(phi) = 0 on the round bore: delta + e (cos - 1) - e^2 sin^2 / (2 R1) = 0 with e = delta + c.
    let beyond = |delta: f64| {
        let e = delta + CLEARANCE;
        delta + e * (half.cos() - 1.0) - (e * half.sin()).powi(2) / (2.0 * R1)
    };
    let (mut low, mut high) = (0.0, 1e-3);
    for _ in 0..100 {
        let delta = 0.5 * (low + high);
        if beyond(delta) < 0.0 { low = delta } else { high = delta }
    }
    let reach = CLEARANCE + low;
    ContactSample {
        e: [reach * psi.cos(), reach * psi.sin()],
        penetration: low,
        force: [1.0, 0.0],
        work: 1.0,
        turn: 0.0,
    }
}

#[test]
fn every_arc_wears_the_volume_of_archard_wherever_it_lies() {
    // Arcs of 1 to 60 deg in 97 directions over a spacing and more, at 18 to 144 control points,
    // on a round and on a worn bore.
    let mut worst = 0.0_f64;
    for points in [18, 36, 72, 144] {
        for worn in [false, true] {
            let mut profile = Profile::round(R1 + CLEARANCE, points);
            let scar = |i: usize| 5e-6 * (0.5 + 0.5 * (i as f64 / points as f64 * TAU).cos());
            if worn {
                profile.set_depth(&(0..points).map(scar).collect::<Vec<f64>>());
            }
            for degrees in [1.0, 2.0, 5.0, 8.2, 10.0, 20.0, 40.0, 60.0_f64] {
                for step in 0..97 {
                    let psi = (f64::from(step) * 0.31_f64).to_radians();
                    let mut arcs = LocalArcs::new(&contact(), points, false);
                    arcs.freeze(&[single(psi, 0.5 * degrees.to_radians())]);
                    let mut shares = vec![0.0; points];
                    arcs.shares(&profile, &[], &mut shares);
                    // Volume over K: each point's depth, F S w / (R spacing L), times its cell R spacing L.
                    let radius = |k: usize| profile.radius_at(TAU * k as f64 / points as f64).r;
                    let volume: f64 = shares.iter().enumerate().map(|(k, q)| q * radius(k)).sum();
                    worst = worst.max((volume - 1.0).abs());
                }
            }
        }
    }
    println!("volume within {worst:e} of K F S");
    assert!(worst < 1e-3, "{worst:e}");
}

#[test]
fn a_groove_that_splits_an_arc_changes_its_wear_without_a_jump() {
    // The groove lies inside the arc: as it deepens, the circle is beyond the bore in front of it and behind it, and no longer in it.
    let points = 36;
    let wear = |depth: f64| {
        let mut profile = Profile::round(R1 + CLEARANCE, points);
        let mut depths = vec![0.0; points];
        depths[11] = depth;
        profile.set_depth(&depths);
        let mut arcs = LocalArcs::new(&contact(), points, false);
        arcs.freeze(&[single(TAU * 9.0 / points as f64, 0.6)]);
        let mut shares = vec![0.0; points];
        arcs.shares(&profile, &[], &mut shares);
        shares
    };
    let steps = 4000;
    let (mut largest, mut total) = (0.0_f64, 0.0_f64);
    let mut before = wear(0.0);
    for step in 1..=steps {
        let now = wear(10e-6 * f64::from(step) / f64::from(steps));
        let change =
            now.iter().zip(&before).map(|(a, b)| (a - b).abs()).sum::<f64>() / now.iter().sum::<f64>();
        (largest, total) = (largest.max(change), total + change);
        before = now;
    }
    println!("largest change of one of {steps} steps {largest:e}, of all {total}");
    assert!(total > 0.1, "the groove must matter: {total}");
    assert!(largest < 0.01 * total, "{largest:e} of {total}");
}

#[test]
fn what_is_outside_every_arc_does_not_wear_at_all() {
    let points = 36;
    let profile = Profile::round(R1 + CLEARANCE, points);
    let mut arcs = LocalArcs::new(&contact(), points, false);
    let sample =
        ContactSample { e: [0.0, -CLEARANCE], penetration: 1e-7, force: [0.0; 2], work: 1.0, turn: 0.0 };
    arcs.freeze(&[sample]);
    let mut shares = vec![1.0; points];
    arcs.shares(&profile, &[], &mut shares);
    // Half angle sqrt(2 delta / c) of 5.3 deg: the point in the middle and its neighbours, 10 deg away.
    let worn: Vec<usize> = (0..points).filter(|&i| shares[i] != 0.0).collect();
    assert_eq!(worn, [26, 27, 28], "{shares:?}");
}
