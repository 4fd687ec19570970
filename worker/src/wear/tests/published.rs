//! The published forms of the wear against closed forms: the rule of the points inside an arc, the explicit step, the approximating spline.

use super::step::{COEFFICIENT, SURFACE, WIDTH};
use crate::bore::Profile;
use crate::contact::{Contact, LocalHertz};
use crate::wear::local_arcs::LocalArcs;
use crate::wear::{BoreWearRate, ContactHistory, ContactSample, WearLaw, WearStep, WearStepStats};
use common::scene::{BoreSpline, WearDistribution};
use std::f64::consts::TAU;

const POINTS: usize = 36;
const SPACING: f64 = TAU / POINTS as f64;
const RADIUS: f64 = SURFACE.journal_radius + SURFACE.clearance;

fn contact() -> Contact {
    Contact::LocalHertz(LocalHertz { surface: SURFACE })
}

/// Work 1 N m in the direction `psi` [rad], with a contact arc of this half angle [rad] on the round bore.
fn sample(psi: f64, half: f64) -> ContactSample {
    // p(half) = 0 of `arc_ends.rs`: a quadratic equation of the eccentricity e = c + delta.
    let (a, b) = (half.sin().powi(2) / (2.0 * SURFACE.journal_radius), half.cos());
    let e = (b - (b * b - 4.0 * a * SURFACE.clearance).sqrt()) / (2.0 * a);
    ContactSample {
        e: [e * psi.cos(), e * psi.sin()],
        penetration: e - SURFACE.clearance,
        force: [psi.cos(), psi.sin()],
        work: 1.0,
        turn: 0.0,
    }
}

fn shares(distribution: WearDistribution, sample: ContactSample) -> Vec<f64> {
    let mut arcs = LocalArcs::new(&contact(), POINTS, false);
    arcs.distribution = distribution;
    arcs.freeze(&[sample]);
    let mut shares = vec![0.0; POINTS];
    arcs.shares(&Profile::round(RADIUS, POINTS), &[], &mut shares);
    shares
}

#[test]
fn every_point_inside_an_arc_has_the_depth_of_the_arc() {
    for (place, half, inside) in [
        (7.0, 2.3, 5..10),
        (7.4, 1.0, 7..9),
        (20.5, 0.9, 20..22),
        // None between two points, and one on a point.
        (7.5, 0.3, 7..7),
        (7.0, 0.3, 7..8),
    ] {
        let found = shares(WearDistribution::PointsInside, sample(place * SPACING, half * SPACING));
        for (i, share) in found.iter().enumerate() {
            // F S / (R |AB|), with the length of the arc in spacings.
            let expected = if inside.contains(&i) { 1.0 / (RADIUS * 2.0 * half) } else { 0.0 };
            // The end of an arc of 3 degrees on a table of 1.25 degrees is off by some 2 %.
            let tolerance = if half < 0.5 { 3e-2 } else { 2e-3 };
            assert!((share - expected).abs() <= tolerance * expected, "{i} of {place}: {share}, {expected}");
        }
    }
}

#[test]
fn points_inside_an_arc_across_angle_zero_wear_on_both_sides() {
    let found = shares(WearDistribution::PointsInside, sample(-0.2 * SPACING, 1.5 * SPACING));
    let worn: Vec<usize> = (0..POINTS).filter(|i| found[*i] > 0.0).collect();
    assert_eq!(worn, [0, 1, 35]);
}

#[test]
fn hat_shares_add_up_to_the_worn_volume_and_points_inside_do_not() {
    let sum = |distribution, place: f64, half: f64| -> f64 {
        shares(distribution, sample(place * SPACING, half * SPACING)).iter().sum::<f64>() * RADIUS
    };
    for (place, half, inside) in [(7.0, 2.3, 5.0), (7.5, 0.3, 0.0), (7.0, 0.3, 1.0)] {
        assert!((sum(WearDistribution::HatShares, place, half) - 1.0).abs() < 1e-12);
        let expected = inside / (2.0 * half);
        let found = sum(WearDistribution::PointsInside, place, half);
        assert!((found - expected).abs() <= 3e-2 * expected, "{found}, {expected}");
    }
}

/// Wear rate of one sample by this rule, and the depths after one explicit step and at the marks.
fn stepped(
    cycles: f64,
    marks: &[f64],
    distribution: WearDistribution,
) -> (Vec<f64>, Vec<f64>, Vec<Vec<f64>>) {
    let mut history = ContactHistory::new(1.0, 1, false);
    history.samples.push(sample(7.0 * SPACING, 2.3 * SPACING));
    let profile = Profile::round(RADIUS, POINTS);
    let mut law =
        BoreWearRate::new([COEFFICIENT, 0.0], WIDTH, &contact(), &profile).distributed(distribution);
    law.freeze(&history);
    let (mut rate, mut depth, mut marked) = (vec![0.0; POINTS], vec![0.0; POINTS], vec![]);
    law.rate(&depth, &mut rate).expect("the local law needs no equilibrium");
    let mut stats = WearStepStats::default();
    WearStep::new(POINTS, None)
        .advance(&mut law, &mut depth, cycles, marks, |_, [depth, _]| marked.push(depth.to_vec()), &mut stats)
        .expect("an explicit step has no tolerance to miss");
    assert_eq!((stats.stages, stats.rejected), (1, 0));
    (rate, depth, marked)
}

#[test]
fn an_explicit_step_adds_the_rate_at_its_start() {
    let (rate, depth, marked) = stepped(0.5, &[0.125, 0.5], WearDistribution::PointsInside);
    // K_H F S / (|AB| L) a cycle at the five points inside.
    let expected = COEFFICIENT / (RADIUS * 4.6 * SPACING * WIDTH);
    for i in 0..POINTS {
        let inside = (5..=9).contains(&i);
        assert!((rate[i] - if inside { expected } else { 0.0 }).abs() <= 2e-3 * expected, "{i}: {}", rate[i]);
        assert_eq!(depth[i], 0.5 * rate[i]);
        assert_eq!([marked[0][i], marked[1][i]], [0.125 * rate[i], depth[i]]);
    }
}

#[test]
fn an_explicit_step_through_a_wall_is_refused() {
    let mut history = ContactHistory::new(1.0, 1, false);
    history.samples.push(sample(0.0, SPACING));
    let mut law = BoreWearRate::new([COEFFICIENT, 0.0], WIDTH, &contact(), &Profile::round(RADIUS, POINTS));
    law.freeze(&history);
    let mut depth = vec![0.0; POINTS];
    let worn = WearStep::new(POINTS, None).advance(
        &mut law,
        &mut depth,
        1e9,
        &[],
        |_, _| {},
        &mut WearStepStats::default(),
    );
    assert!(matches!(worn, Err(crate::wear::WearStepFailed::TooDeep(_))), "{worn:?}");
    assert_eq!(depth, [0.0; POINTS]);
}

/// A bore by the approximating spline with these depths [m].
fn approximating(depth: impl Fn(usize) -> f64) -> Profile {
    let mut bore = Profile::round(RADIUS, POINTS).with_spline(BoreSpline::Approximating);
    bore.set_depth(&(0..POINTS).map(depth).collect::<Vec<f64>>());
    bore
}

#[test]
fn an_approximating_spline_is_the_sum_of_its_basis() {
    // Cubic B-spline of a peak at one point, at distance x from it [spacings].
    let basis = |x: f64| match x.abs() {
        x if x < 1.0 => 2.0 / 3.0 - x * x + 0.5 * x * x * x,
        x if x < 2.0 => (2.0 - x).powi(3) / 6.0,
        _ => 0.0,
    };
    let peak = approximating(|i| if i == 9 { 1e-5 } else { 0.0 });
    let constant = approximating(|_| 1e-5);
    for k in 0..720 {
        let place = f64::from(k) / 20.0;
        let at = |bore: &Profile| bore.radius_at(place * SPACING).r - RADIUS;
        assert!((at(&peak) - 1e-5 * basis(place - 9.0)).abs() < 1e-17, "{place}: {}", at(&peak));
        assert!((at(&constant) - 1e-5).abs() < 1e-17);
    }
    // Linear between 0 and 18 points: reproduced away from the two corners.
    let linear = approximating(|i| 1e-6 * i.min(POINTS - i) as f64);
    for k in 40..=320 {
        let place = f64::from(k) / 20.0;
        assert!((linear.radius_at(place * SPACING).r - RADIUS - 1e-6 * place).abs() < 1e-17, "{place}");
    }
    assert!(linear.radius_at(18.0 * SPACING).r - RADIUS < 17.7e-6);
}

#[test]
fn a_finer_bore_keeps_its_spline() {
    let mut finer = approximating(|_| 1e-5).unworn(2 * POINTS);
    assert_eq!((finer.points(), finer.radius_at(1.0).r), (2 * POINTS, RADIUS));
    finer.set_depth(&(0..2 * POINTS).map(|i| if i == 9 { 6e-6 } else { 0.0 }).collect::<Vec<f64>>());
    assert!((finer.radius_at(4.5 * SPACING).r - RADIUS - 4e-6).abs() < 1e-17);
}
