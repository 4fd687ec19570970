//! Archard's volume K_H F S and the wear step, under contact histories made for the purpose.

use super::step::{COEFFICIENT, POINTS, SURFACE, WIDTH, foundation};
use crate::bore::Profile;
use crate::contact::{Contact, Foundation, JointForce, LocalHertz};
use crate::wear::{
    BoreWearRate, ContactHistory, ContactInstant, FinerBore, WearLaw, WearStep, WearStepStats, WornAmounts,
};
use std::f64::consts::TAU;

/// Normal force [N] and sliding distance per cycle [m], those of the flapping-wing's joints.
const FORCE: f64 = 4.0;
const SLIDING: f64 = 9e-3;

fn round() -> Profile {
    Profile::round(SURFACE.journal_radius + SURFACE.clearance, POINTS)
}

fn local(_points: usize) -> Contact {
    Contact::LocalHertz(LocalHertz { surface: SURFACE })
}

fn foundation_of(points: usize) -> Contact {
    Contact::Foundation(Foundation::new(SURFACE, points))
}

/// A history with the same force and sliding in each of these directions, the work of a cycle shared between
/// them.
fn history(directions: &[f64]) -> ContactHistory {
    let mut history = ContactHistory::new(1.0, directions.len(), false);
    let penetration = (FORCE / SURFACE.stiffness).powf(2.0 / 3.0);
    for psi in directions {
        let u = [psi.cos(), psi.sin()];
        let reach = SURFACE.clearance + penetration;
        let contact = JointForce {
            normal: FORCE,
            direction: u,
            penetration,
            sliding: SLIDING,
            ..JointForce::default()
        };
        history.push(
            1.0 / directions.len() as f64,
            &ContactInstant::new([reach * u[0], reach * u[1]], &contact),
        );
        history.close_interval();
    }
    history
}

fn rate(contact: &Contact, history: &ContactHistory) -> BoreWearRate {
    let mut rate = BoreWearRate::new([COEFFICIENT, 0.0], WIDTH, contact, &round());
    rate.freeze(history);
    rate
}

fn wear(rate: &mut BoreWearRate, depth: &mut [f64], cycles: f64, tolerance: f64) {
    WearStep::new(POINTS, Some(tolerance))
        .advance(rate, depth, cycles, &[], |_, _| {}, &mut WearStepStats::default())
        .expect("the wear step reaches its tolerance");
}

/// Volume between the worn and the unworn bore, by the control points' sectors [m^3].
fn volume(depth: &[f64]) -> f64 {
    let r0 = SURFACE.journal_radius + SURFACE.clearance;
    let sum: f64 = depth.iter().map(|h| 0.5 * ((r0 + h) * (r0 + h) - r0 * r0)).sum();
    sum * TAU / depth.len() as f64 * WIDTH
}

/// Integral of the foundation's pressure over the worn bore, over the force it makes in direction zero, found
/// on a fine grid by bisection of the eccentricity: for profiles symmetric about that direction.
fn pressure_over_force(depth: &[f64]) -> f64 {
    const GRID: usize = 20_000;
    let mut profile = round();
    profile.set_depth(depth);
    let mut law = Foundation::new(SURFACE, POINTS);
    law.profile_changed(&profile);
    let bore: Vec<(f64, f64)> = (0..GRID)
        .map(|k| {
            let psi = TAU * (k as f64 / GRID as f64 - 0.5);
            (psi.cos(), profile.radius_at(psi).r)
        })
        .collect();
    let sums = |e: f64| {
        let (along, all) = bore.iter().fold((0.0, 0.0), |(along, all), (cos, radius)| {
            let gap = (e * cos + SURFACE.journal_radius - radius).max(0.0);
            (along + gap * cos, all + gap)
        });
        let force = law.load([e, 0.0]).force[0];
        (force, if along > 0.0 { force * all / along } else { 0.0 })
    };
    let (mut low, mut high) = (0.0, 2.0 * SURFACE.clearance);
    for _ in 0..60 {
        let e = 0.5 * (low + high);
        if sums(e).0 < FORCE { low = e } else { high = e }
    }
    sums(low).1 / FORCE
}

#[test]
fn foundation_wears_the_volume_its_pressure_asks_for() {
    // A constant force in a fixed direction. Pressures of a wide arc add up to more than their resultant, so
    // the volume is K_H S times the integral of the pressure; in the narrow arc of a new bore that is K_H F
    // S.
    let mut rate = rate(&foundation(), &history(&[0.0]));
    let mut depth = vec![0.0; POINTS];
    let cell = TAU / POINTS as f64 * (SURFACE.journal_radius + SURFACE.clearance) * WIDTH;
    let archard = COEFFICIENT * FORCE * SLIDING;
    let (mut expected, mut worn, mut widest) = (0.0, 0.0, 1.0);
    let mut before = 1.0;
    for block in 0..16 {
        let ratio = pressure_over_force(&depth);
        let mut per_cycle = vec![0.0; POINTS];
        rate.rate(&depth, &mut per_cycle).expect("the force has an equilibrium");
        let now = per_cycle.iter().sum::<f64>() * cell / archard;
        assert!((now / ratio - 1.0).abs() < 2e-4, "block {block}: {now} against {ratio}");
        if block == 0 {
            assert!((now - 1.0).abs() < 3e-3, "narrow arc: {now}");
        } else {
            expected += 0.5 * (before + ratio) * 2000.0 * archard;
        }
        (before, widest) = (ratio, f64::max(widest, ratio));
        let old = depth.clone();
        if block < 15 {
            wear(&mut rate, &mut depth, 2000.0, 1e-3);
        }
        assert!(depth.iter().zip(&old).all(|(new, old)| new >= old), "wear decreased");
        worn = depth.iter().sum::<f64>() * cell;
    }
    assert!((worn / expected - 1.0).abs() < 1e-3, "{worn} against {expected}");
    assert!(widest > 1.01, "the arc became wide: {widest}");
}

#[test]
fn local_law_wears_archards_volume_under_a_load_that_sweeps_round() {
    // What is missing to equality (9e-4) is the chord by which the arc's ends are found between table angles.
    let directions: Vec<f64> = (0..1440).map(|k| TAU * (f64::from(k) + 0.5) / 1440.0).collect();
    let mut rate = rate(&local(POINTS), &history(&directions));
    let mut depth = vec![0.0; POINTS];
    for block in 1..=4 {
        let old = depth.clone();
        wear(&mut rate, &mut depth, 4000.0, 1e-3);
        assert!(depth.iter().zip(&old).all(|(new, old)| new > old));
        let archard = COEFFICIENT * FORCE * SLIDING * 4000.0 * f64::from(block);
        let ratio = volume(&depth) / archard;
        assert!((ratio - 1.0).abs() < 1e-3, "block {block}: {ratio}");
    }
    let (least, most) = depth.iter().fold((f64::MAX, 0.0_f64), |(a, b), &h| (a.min(h), b.max(h)));
    assert!(most / least - 1.0 < 1e-3, "an even load wears evenly: {least} to {most}");
}

#[test]
fn wear_does_not_depend_on_how_a_block_is_cut() {
    let swinging: Vec<f64> = (0..200).map(|k| 0.8 * (TAU * f64::from(k) / 200.0).sin()).collect();
    for contact in [local(POINTS), foundation()] {
        let history = history(&swinging);
        let run = |blocks: u32| {
            let mut rate = rate(&contact, &history);
            let mut depth = vec![0.0; POINTS];
            // A worn-in start, where the whole length of the block counts.
            wear(&mut rate, &mut depth, 4000.0, 1e-3);
            for _ in 0..blocks {
                wear(&mut rate, &mut depth, 2000.0 / f64::from(blocks), 1e-3);
            }
            depth
        };
        let (once, often) = (run(1), run(8));
        // What a mark inside the block sees is the depth there.
        let (mut half, mut marked) = (vec![0.0; POINTS], vec![]);
        wear(&mut rate(&contact, &history), &mut half, 2000.0, 1e-3);
        WearStep::new(POINTS, Some(1e-3))
            .advance(
                &mut rate(&contact, &history),
                &mut vec![0.0; POINTS],
                4000.0,
                &[2000.0],
                |_, [depth, _]| marked = depth.to_vec(),
                &mut WearStepStats::default(),
            )
            .expect("the wear step reaches its tolerance");
        let deepest = half.iter().fold(0.0_f64, |a, b| a.max(*b));
        assert!(half.iter().zip(&marked).all(|(a, b)| (a - b).abs() < 1e-3 * deepest), "{half:?} {marked:?}");
        let largest = once.iter().fold(0.0_f64, |a, b| a.max(*b));
        for (a, b) in once.iter().zip(&often) {
            assert!((a - b).abs() < 1e-3 * largest, "{a} against {b} of {largest}");
        }
    }
}

/// Largest depth after 2000 cycles under this history, in blocks of 250, at `points` control points, and the
/// stated error of their spacing [m].
fn scar(contact: &Contact, history: &ContactHistory, points: usize) -> (f64, f64) {
    let profile = Profile::round(SURFACE.journal_radius + SURFACE.clearance, points);
    let mut rate = BoreWearRate::new([COEFFICIENT, 0.0], WIDTH, contact, &profile);
    rate.freeze(history);
    let mut step = WearStep::new(points, Some(5e-3));
    let mut copy = FinerBore::new(
        BoreWearRate::new([COEFFICIENT, 0.0], WIDTH, contact, &profile.unworn(2 * points)),
        2 * points,
        Some(5e-3),
    );
    let (mut depth, mut worn) = (vec![0.0; points], WornAmounts::default());
    for _ in 0..8 {
        step.advance(&mut rate, &mut depth, 250.0, &[], |_, _| {}, &mut WearStepStats::default())
            .unwrap_or_else(|failed| panic!("{points} points: {failed:?}"));
        copy.freeze(history, 250.0, worn);
        copy.advance();
        worn = rate.sizes().amounts(&depth);
    }
    copy.freeze(history, 0.0, worn);
    copy.advance();
    (worn.depth(0), copy.errors().depth(0))
}

#[test]
fn scar_is_converged_within_the_stated_error() {
    // A load that swings through 2, 11 and 92 deg about a control point and about places
    // between: against eight times as many control points.
    for (name, contact) in [("local-hertz", local as fn(usize) -> Contact), ("foundation", foundation_of)] {
        for swing in [0.02, 0.1, 0.8] {
            for direction in [0.0, 3.0, 5.0_f64] {
                let swinging: Vec<f64> = (0..400)
                    .map(|k| direction.to_radians() + swing * (TAU * f64::from(k) / 400.0).sin())
                    .collect();
                let history = history(&swinging);
                let (depth, stated) = scar(&contact(POINTS), &history, POINTS);
                let (finer, _) = scar(&contact(8 * POINTS), &history, 8 * POINTS);
                let off = (depth - finer).abs();
                println!(
                    "{name}, swing {swing}, {direction} deg: {:.3} um, off by {:.2} %, stated {:.2} %",
                    1e6 * finer,
                    100.0 * off / finer,
                    100.0 * stated / finer
                );
                assert!(off < stated + 2e-3 * finer, "{depth:e} against {finer:e}, stated {stated:e}");
            }
        }
    }
}

/// Number of control points deeper than both neighbours by more than a fiftieth of the deepest.
fn peaks(depth: &[f64]) -> usize {
    let n = depth.len();
    let margin = 0.02 * depth.iter().fold(0.0_f64, |a, b| a.max(*b));
    (0..n)
        .filter(|&i| depth[i] > depth[(i + n - 1) % n] + margin && depth[i] > depth[(i + 1) % n] + margin)
        .count()
}

#[test]
fn large_blocks_of_foundation_wear_do_not_zig_zag_as_an_explicit_jump_does() {
    let history = history(&[0.0]);
    let mut stable = vec![0.0; POINTS];
    let mut jumping = vec![0.0; POINTS];
    let mut law = rate(&foundation(), &history);
    let mut explicit = rate(&foundation(), &history);
    let mut per_cycle = vec![0.0; POINTS];
    let (mut most_peaks, mut furthest) = (0, 0.0_f64);
    for _ in 0..8 {
        wear(&mut law, &mut stable, 2000.0, 1e-3);
        assert_eq!(peaks(&stable), 1, "{stable:?}");
        explicit.rate(&jumping, &mut per_cycle).expect("the force has an equilibrium");
        jumping.iter_mut().zip(&per_cycle).for_each(|(h, r)| *h += 2000.0 * r);
        most_peaks = most_peaks.max(peaks(&jumping));
        let off = jumping.iter().zip(&stable).fold(0.0_f64, |m, (a, b)| m.max((a - b).abs()));
        furthest = furthest.max(off / stable[0]);
    }
    println!("explicit: {most_peaks} peaks, {furthest} of the depth away");
    assert!(most_peaks > 1, "peaks of the explicit jump: {most_peaks}");
    assert!(furthest > 0.25, "explicit jump off by {furthest}");
}
