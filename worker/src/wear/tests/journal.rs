//! Wear of a journal beside that of its bushing: even wear of a journal that turns, volumes, and mirror images.

use super::step::{COEFFICIENT, POINTS, SURFACE, WIDTH};
use crate::bore::Profile;
use crate::contact::{Contact, Foundation, JointForce, LocalHertz};
use crate::wear::{
    BoreWearRate, ContactHistory, ContactInstant, FinerBore, WearLaw, WearStep, WearStepStats, WornAmounts,
};
use std::f64::consts::TAU;

/// Normal force [N] and sliding distance per cycle [m], those of the flapping-wing's joints.
const FORCE: f64 = 4.0;
const SLIDING: f64 = 9e-3;
const R1: f64 = SURFACE.journal_radius;
const R2: f64 = SURFACE.journal_radius + SURFACE.clearance;

/// Both laws for this number of control points.
fn laws(points: usize) -> [Contact; 2] {
    [
        Contact::LocalHertz(LocalHertz { surface: SURFACE }),
        Contact::Foundation(Foundation::new(SURFACE, points)),
    ]
}

/// A history with the same force and sliding at each of these directions in the bushing and angles of the journal [rad].
fn history(contacts: &[(f64, f64)]) -> ContactHistory {
    let mut history = ContactHistory::new(1.0, contacts.len(), true);
    let penetration = (FORCE / SURFACE.stiffness).powf(2.0 / 3.0);
    for (psi, turn) in contacts {
        let u = [psi.cos(), psi.sin()];
        let e = u.map(|u| (SURFACE.clearance + penetration) * u);
        let contact = JointForce {
            normal: FORCE,
            direction: u,
            penetration,
            sliding: SLIDING,
            ..JointForce::default()
        };
        history.push(1.0 / contacts.len() as f64, &ContactInstant::new(e, &contact).turned(*turn));
        history.close_interval();
    }
    history
}

/// Depths of bore and journal after blocks of 500 cycles under this history, and the errors stated for what they come to.
fn worn(
    contact: &Contact,
    coefficients: [f64; 2],
    history: &ContactHistory,
    (points, blocks): (usize, usize),
) -> (Vec<f64>, Vec<f64>, WornAmounts, WornAmounts) {
    let profile = Profile::round(R2, points);
    let mut rate = BoreWearRate::new(coefficients, WIDTH, contact, &profile);
    rate.freeze(history);
    let mut depth = vec![0.0; 2 * points];
    let mut step = WearStep::new(2 * points, Some(1e-3));
    let mut copy = FinerBore::new(
        BoreWearRate::new(coefficients, WIDTH, contact, &profile.unworn(2 * points)),
        4 * points,
        Some(1e-3),
    );
    for _ in 0..blocks {
        copy.freeze(history, 500.0, rate.sizes().amounts(&depth));
        copy.advance();
        step.advance(&mut rate, &mut depth, 500.0, &[], |_, _| {}, &mut WearStepStats::default())
            .expect("the wear step reaches its tolerance");
    }
    let amounts = rate.sizes().amounts(&depth);
    copy.freeze(history, 0.0, amounts);
    copy.advance();
    let journal = depth.split_off(points);
    (depth, journal, amounts, copy.errors())
}

/// Volumes of bore and journal over K F S after a number of cycles [1].
fn volumes(bore: &[f64], journal: &[f64], cycles: f64) -> [f64; 2] {
    let archard = COEFFICIENT * FORCE * SLIDING * cycles;
    let sum = |depth: &[f64], radius: f64, sign: f64| {
        depth.iter().map(|h| h * (radius + sign * 0.5 * h)).sum::<f64>() * TAU / depth.len() as f64 * WIDTH
    };
    [sum(bore, R2, 1.0) / archard, sum(journal, R1, -1.0) / archard]
}

#[test]
fn a_journal_that_turns_under_a_load_fixed_in_the_bushing_wears_evenly() {
    let turning: Vec<(f64, f64)> = (0..720).map(|k| (0.35, TAU * (f64::from(k) + 0.5) / 720.0)).collect();
    let history = history(&turning);
    // Under the foundation the pressures of the wide arc of a worn bushing add up to more than their resultant, for both surfaces alike.
    for (contact, bound) in laws(POINTS).iter().zip([1e-3, 2e-2]) {
        let (bore, journal, ..) = worn(contact, [COEFFICIENT; 2], &history, (POINTS, 2));
        let even = COEFFICIENT * FORCE * SLIDING * 1000.0 / (TAU * R1 * WIDTH);
        let (least, most) = journal.iter().fold((f64::MAX, 0.0_f64), |(a, b), &h| (a.min(h), b.max(h)));
        assert!(most / least - 1.0 < 1e-3, "{least:e} to {most:e}");
        let ratios = volumes(&bore, &journal, 1000.0);
        println!("volumes over K F S: {ratios:?}");
        assert!(ratios.iter().all(|ratio| (ratio - 1.0).abs() < bound), "{ratios:?}");
        assert!((ratios[1] / ratios[0] - 1.0).abs() < 1e-3, "{ratios:?}");
        for depth in &journal {
            assert!((depth / (ratios[1] * even) - 1.0).abs() < 1e-3, "{depth:e} of {even:e}: {journal:?}");
        }
        // The bushing wears on one side only: 150 deg and more from the load not at all.
        let on_the_other_side = |i: usize| (TAU * i as f64 / POINTS as f64 - 0.35).cos() < -0.86;
        assert!((0..POINTS).filter(|&i| on_the_other_side(i)).all(|i| bore[i] == 0.0), "{bore:?}");
        assert!(bore.iter().fold(0.0_f64, |a, &b| a.max(b)) > 10.0 * even);
    }
}

#[test]
fn volumes_are_archards_with_a_coefficient_of_each_surface() {
    // Turning back and forth, with the load swinging in the bushing.
    let swinging = |k: u32| {
        let phase = TAU * f64::from(k) / 400.0;
        (1.0 + 0.3 * phase.sin(), 0.9 * (phase + 0.7).sin() + 0.2 * (2.0 * phase).cos())
    };
    let history = history(&(0..400).map(swinging).collect::<Vec<_>>());
    for points in [18, 36, 72] {
        let [local, _] = laws(points);
        let (bore, journal, ..) = worn(&local, [COEFFICIENT, 0.4 * COEFFICIENT], &history, (points, 4));
        let [of_bore, of_journal] = volumes(&bore, &journal, 2000.0);
        println!("{points} points: {of_bore}, {of_journal}");
        assert!((of_bore - 1.0).abs() < 1e-3 && (of_journal / 0.4 - 1.0).abs() < 1e-3);
    }
}

#[test]
fn bushing_and_journal_that_turn_against_each_other_wear_as_mirror_images() {
    // The load stands still between bodies that turn by beta to either side: it moves by beta in the bushing and by -beta in the
    // journal.
    let turning = |k: u32| {
        let phase = TAU * (f64::from(k) + 0.5) / 400.0;
        let beta = 0.7 * phase.sin() + 0.25 * (2.0 * phase + 0.5).sin();
        (beta, 2.0 * beta)
    };
    let history = history(&(0..400).map(turning).collect::<Vec<_>>());
    for contact in laws(POINTS) {
        let (bore, journal, ..) = worn(&contact, [COEFFICIENT; 2], &history, (POINTS, 4));
        let deepest = bore.iter().fold(0.0_f64, |a, &b| a.max(b));
        let other = journal.iter().fold(0.0_f64, |a, &b| a.max(b));
        println!("{deepest:e} of the bushing, {other:e} of the journal");
        // In volume, as the surfaces have different radii; the ends of the arcs are found on chords between angles of a table.
        for i in 0..POINTS {
            let (a, b) = (R2 * bore[i], R1 * journal[(POINTS - i) % POINTS]);
            assert!((a - b).abs() < 5e-3 * R2 * deepest, "{i}: {a:e} against {b:e}");
        }
        let lopsided = |i: usize| (bore[i] - bore[(POINTS - i) % POINTS]).abs() > 0.1 * deepest;
        assert!((0..POINTS).any(lopsided), "the motion is not symmetric itself");
    }
}

#[test]
fn stated_errors_cover_both_surfaces() {
    let swinging = |k: u32| {
        let phase = TAU * f64::from(k) / 300.0;
        (0.06 * phase.sin() + 0.04, 0.5 * phase.cos())
    };
    let history = history(&(0..300).map(swinging).collect::<Vec<_>>());
    for law in [0, 1] {
        let [coarse, fine] = [POINTS, 4 * POINTS]
            .map(|points| worn(&laws(points)[law], [COEFFICIENT, 0.5 * COEFFICIENT], &history, (points, 4)));
        for k in 0..2 {
            let (found, truth, stated) = (coarse.2.depth(k), fine.2.depth(k), coarse.3.depth(k));
            println!("{found:e} of {truth:e}, stated {stated:e}");
            assert!((found - truth).abs() < stated + 2e-3 * truth, "{found:e}, {truth:e}, {stated:e}");
        }
        let (found, truth) = (coarse.2.volume, fine.2.volume);
        assert!((found - truth).abs() < coarse.3.volume + 1e-3 * truth, "{found:e}, {truth:e}");
    }
}
