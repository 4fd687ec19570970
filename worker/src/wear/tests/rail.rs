//! Wear of guides and sliders under histories made for the purpose: volumes, closed forms, equilibria of random loads.

use crate::contact::GuideReaction;
use crate::rail::RailLayout;
use crate::wear::rail_equilibrium::RailGaps;
use crate::wear::{
    FinerBore, RailHistory, RailInstant, RailWearRate, WearLaw, WearStep, WearStepStats, WornAmounts,
};

const CLEARANCE: f64 = 1e-4;
const STIFFNESS: f64 = 7e9;
const HALF: f64 = 0.025;
const WIDTH: f64 = 0.02;
const COEFFICIENT: f64 = 1e-13;

fn layout(points: usize, elements: usize, slider_wears: bool) -> RailLayout {
    let (reach, guide_wears) = ([-0.1, 0.1], true);
    RailLayout { points, reach, elements, half_length: HALF, width: WIDTH, guide_wears, slider_wears }
}

fn law(layout: RailLayout, coefficients: [f64; 2]) -> RailWearRate {
    RailWearRate::new(coefficients, layout, CLEARANCE, STIFFNESS)
}

/// A slider that presses with these forces on the left and right face, at these distances from its middle, at the position `s` with the speed
/// `speed`.
fn instant(normal: [f64; 2], arm: [f64; 2], s: f64, speed: f64) -> RailInstant {
    let mut now = GuideReaction::none(0.0);
    now.normal = normal;
    now.moment = [normal[0] * arm[0], normal[1] * arm[1]];
    now.rubbing = normal.map(|p| p * speed);
    now.position = s;
    now.penetration = [normal[0], -1.0, normal[1], -1.0];
    RailInstant::new(&now)
}

fn history(layout: &RailLayout, instants: &[(f64, RailInstant)]) -> RailHistory {
    let mut history = RailHistory::new(1.0, 300, layout);
    instants.iter().for_each(|(duration, at)| history.push(*duration, at));
    history.close_interval();
    history
}

fn wear(rate: &mut RailWearRate, depth: &mut [f64], cycles: f64, tolerance: f64) -> WearStepStats {
    let mut stats = WearStepStats::default();
    WearStep::new(depth.len(), Some(tolerance))
        .advance(rate, depth, cycles, &[], |_, _| {}, &mut stats)
        .expect("worn");
    stats
}

/// Pseudo-random numbers in [0, 1), Weyl's sequence.
fn random(k: u32, n: u32) -> f64 {
    (f64::from(k) * 0.618_033_988_749_895 + f64::from(n) * 0.754_877_666_246_693).fract()
}

/// Loads on either face, anywhere in the guide.
fn random_loads(layout: &RailLayout, count: u32) -> Vec<(f64, RailInstant)> {
    let one = |k: u32| {
        let s = 0.14 * (random(k, 1) - 0.5);
        let n = 10f64.powf(4.0 * random(k, 2) - 1.0);
        let arm = 1.99 * layout.half_length * (random(k, 3) - 0.5);
        let at = if k.is_multiple_of(2) {
            instant([n, 0.0], [arm, 0.0], s, 0.3)
        } else {
            instant([0.0, n], [0.0, arm], s, 0.3)
        };
        (1.0 / f64::from(count), at)
    };
    (0..count).map(one).collect()
}

/// Archard's volume K integral of P |ds|, of each surface, whatever the loads and however worn.
#[test]
fn worn_volumes_are_those_of_the_work() {
    for (points, elements) in [(31, 5), (8, 4), (101, 13)] {
        let layout = layout(points, elements, true);
        let history = history(&layout, &random_loads(&layout, 240));
        let (of_guide, of_slider) = (COEFFICIENT, 3e-13);
        let mut rate = law(layout, [of_guide, of_slider]);
        rate.freeze(&history);
        let mut depth = vec![0.0; layout.depths()];
        let cycles = 2000.0;
        wear(&mut rate, &mut depth, cycles, 5e-3);
        let volume = |range: std::ops::Range<usize>| -> f64 {
            range.map(|k| depth[k] * layout.area(k)).sum::<f64>()
                / (cycles * history.samples.iter().map(|sample| sample.work).sum::<f64>())
        };
        let guide = volume(0..layout.guide_depths()) / of_guide;
        let slider = volume(layout.guide_depths()..layout.depths()) / of_slider;
        println!("{points} points: volumes {guide} and {slider} of Archard's");
        assert!((guide - 1.0).abs() < 1e-3 && (slider - 1.0).abs() < 1e-3, "{guide} {slider}");
        assert!(depth.iter().all(|h| *h >= 0.0));
    }
}

/// Under even pressure p the slider wears evenly by K p s.
#[test]
fn a_slider_wears_evenly_under_even_pressure() {
    let layout = layout(31, 5, true);
    let (force, speed, cycles) = (500.0, 0.3, 5000.0);
    let mut rate = law(layout, [0.0, COEFFICIENT]);
    rate.freeze(&history(&layout, &[(1.0, instant([0.0, force], [0.0; 2], 0.03, speed))]));
    let mut depth = vec![0.0; layout.depths()];
    wear(&mut rate, &mut depth, cycles, 1e-3);
    let expected = COEFFICIENT * force / (2.0 * HALF * WIDTH) * speed * cycles;
    let (left, right) = depth[layout.guide_depths()..].split_at(layout.nodes());
    assert!(left.iter().all(|h| *h == 0.0) && depth[..layout.guide_depths()].iter().all(|h| *h == 0.0));
    for h in right {
        assert!((h / expected - 1.0).abs() < 1e-3, "{h:e} against {expected:e}");
    }
}

/// Places along a guide that does not wear make no difference: the loads of all of them are one sample.
#[test]
fn issue_places_along_an_unworn_guide_had_samples_of_their_own() {
    let layout = RailLayout { guide_wears: false, ..layout(31, 5, true) };
    let rates = |stroke: f64| {
        let pressed = |k: i32| instant([500.0, 0.0], [0.01, 0.0], stroke * f64::from(k), 0.3);
        let instants: Vec<_> = (-7..7).map(|k| (0.1, pressed(k))).collect();
        let mut rate = law(layout, [0.0, COEFFICIENT]);
        rate.freeze(&history(&layout, &instants));
        let mut found = vec![0.0; layout.depths()];
        rate.rate(&vec![0.0; layout.depths()], &mut found).expect("an equilibrium");
        (rate.samples.len(), found)
    };
    let (of_one, of_many) = (rates(0.0), rates(0.01));
    assert_eq!((of_one.0, of_many.0), (1, 1));
    for (one, many) in of_one.1.iter().zip(&of_many.1) {
        assert!((one - many).abs() <= 1e-12 * one, "{one} {many}");
    }
}

/// A slider that moves to and fro over the stroke S evenly pressed wears a place of the guide by K p times the length of it that passes, twice a
/// cycle: a trapezoid, l wide at its slopes if the stroke is longer than the slider.
#[test]
fn a_stroke_wears_a_trapezoid_into_the_guide() {
    // Worn by a hundredth of the overlap: the pressure stays even.
    let (force, stroke, cycles) = (300.0, 0.08, 0.15);
    let mut off = Vec::new();
    for points in [41, 161] {
        let layout = layout(points, 5 * (points / 40), false);
        let steps = 1600;
        let instants: Vec<_> = (0..2 * steps)
            .map(|k| {
                let there = (f64::from(k) + 0.5) / f64::from(steps);
                let s = stroke * (if there < 1.0 { there } else { 2.0 - there } - 0.5);
                (0.5 / f64::from(steps), instant([force, 0.0], [0.0; 2], s, 2.0 * stroke))
            })
            .collect();
        let mut rate = law(layout, [COEFFICIENT, 0.0]);
        rate.freeze(&history(&layout, &instants));
        let mut depth = vec![0.0; layout.depths()];
        wear(&mut rate, &mut depth, cycles, 1e-3);
        let pressure = force / (2.0 * HALF * WIDTH);
        let passes = |s: f64| (0.5 * stroke + HALF - s.abs()).clamp(0.0, 2.0 * HALF);
        let largest = 2.0 * COEFFICIENT * pressure * 2.0 * HALF * cycles;
        let worst = (0..points)
            .map(|k| {
                let s = -0.1 + 0.2 * k as f64 / (points - 1) as f64;
                let expected = 2.0 * COEFFICIENT * pressure * passes(s) * cycles;
                (depth[k] - expected).abs() / largest
            })
            .fold(0.0, f64::max);
        println!("{points} points: off the trapezoid by {worst:e} of its depth");
        assert!(depth[points..].iter().all(|h| *h == 0.0));
        off.push(worst);
    }
    assert!(off[1] < 5e-3 && off[0] < 0.03, "{off:?}");
}

/// A couple holds the slider at two opposite corners, tilted by theta = 2 c / l, more as they wear. Each corner gets a facet along the face of
/// the guide: with the depth delta at the corner its volume is w delta^2 / (2 tan theta).
#[test]
fn a_couple_wears_facets_into_two_corners() {
    let (force, speed, cycles) = (200.0, 0.3, 2000.0);
    let mut errors = Vec::new();
    for elements in [8, 16, 32] {
        let layout = layout(31, elements, true);
        let arm = HALF * 0.98;
        let mut rate = law(layout, [0.0, COEFFICIENT]);
        rate.freeze(&history(&layout, &[(1.0, instant([force; 2], [arm, -arm], 0.0, speed))]));
        let mut depth = vec![0.0; layout.depths()];
        let stats = wear(&mut rate, &mut depth, cycles, 2e-3);
        let slider = &depth[layout.guide_depths()..];
        let (left, right) = (slider[layout.nodes() - 1], slider[layout.nodes()]);
        assert!((left / right - 1.0).abs() < 1e-6, "{left} {right}");
        // tan(theta) = (2 c + 2 delta) / l: by two corners of the depth delta the slider tilts further. The pressure on a facet of the length x
        // falls from the corner inwards as 1 - y / (l / 2), and the couple acts at the distance of its resultant. The cycles that a depth takes
        // are the integral of dV / (K P speed).
        let couple = 2.0 * force * arm;
        let tan = |delta: f64| (CLEARANCE + delta) / HALF;
        let volume = |delta: f64| WIDTH * delta * delta / (2.0 * tan(delta));
        let pressed = |delta: f64| {
            let x = delta / tan(delta);
            couple / (2.0 * (HALF - (0.5 * x * x - x.powi(3) / (3.0 * HALF)) / (x - x * x / (2.0 * HALF))))
        };
        let (mut delta, mut taken, step) = (0.0, 0.0, 1e-8);
        while taken < cycles {
            let worn = volume(delta + step) - volume(delta);
            taken += worn / (COEFFICIENT * pressed(delta + 0.5 * step) * speed);
            delta += step;
        }
        let error = left / delta - 1.0;
        println!(
            "{elements} elements: {left:e} m, closed form {delta:e} m, error {error}, facet over {} elements, {stats:?}",
            delta / tan(delta) / layout.element()
        );
        errors.push(error.abs());
    }
    // Of second order in the length of the elements.
    assert!(errors[2] < 2e-3 && errors[1] < 0.4 * errors[0] && errors[2] < 0.4 * errors[1], "{errors:?}");
}

/// A force beside the middle of a face wears a wedge: the pressure that carries it stays as it was, p (1 + 3 x e / (l/2)^2), and the slider tilts
/// along with the wedge.
#[test]
fn a_force_beside_the_middle_wears_a_wedge() {
    let layout = layout(31, 10, true);
    let (force, speed, cycles, beside) = (500.0, 0.3, 5000.0, 0.3 * HALF / 3.0);
    let mut rate = law(layout, [0.0, COEFFICIENT]);
    rate.freeze(&history(&layout, &[(1.0, instant([force, 0.0], [beside, 0.0], 0.03, speed))]));
    let mut depth = vec![0.0; layout.depths()];
    wear(&mut rate, &mut depth, cycles, 1e-3);
    let mean = COEFFICIENT * force / (2.0 * HALF * WIDTH) * speed * cycles;
    for (node, h) in depth[layout.guide_depths()..][..layout.nodes()].iter().enumerate() {
        let expected = mean * (1.0 + 3.0 * layout.node(node) * beside / (HALF * HALF));
        // The first and last node bear half an element, whose mean pressure is that a third of it inside.
        assert!((h / expected - 1.0).abs() < 0.02, "{node}: {h:e} against {expected:e}");
    }
}

/// Random loads on random faces are carried.
#[test]
fn every_load_has_its_equilibrium() {
    let layout = layout(31, 9, true);
    let mut gaps = RailGaps::new(layout, STIFFNESS);
    let mut pose = [0.0; 2];
    for k in 0..20_000_u32 {
        let depth = 10f64.powf(-8.0 + 4.0 * random(k, 4));
        for (face, gaps) in gaps.gap.iter_mut().enumerate() {
            for (node, gap) in gaps.iter_mut().enumerate() {
                *gap = CLEARANCE + depth * random(k.wrapping_mul(31), 7 * node as u32 + face as u32);
            }
        }
        let size = 10f64.powf(8.0 * random(k, 5) - 3.0);
        let angle = std::f64::consts::TAU * random(k, 6);
        let load = [size * angle.cos(), size * angle.sin()];
        let start = if k % 2 == 0 { pose } else { [0.0; 2] };
        let found = gaps.equilibrium(load, start).unwrap_or_else(|error| panic!("{k}: {error:?} {load:?}"));
        let sums = |face: usize| -> [f64; 2] {
            let forces = gaps.force[face].iter().enumerate();
            forces.fold([0.0; 2], |[n, m], (node, p)| [n + p, m + p * layout.node(node) / HALF])
        };
        let (left, right) = (sums(0), sums(1));
        let carried = [left[0] - right[0], left[1] - right[1]];
        // Lighter ones than a face bears at 1e-12 m of overlap are made as heavy.
        let heavier = found.1;
        for c in 0..2 {
            assert!(
                (carried[c] - heavier * load[c]).abs() < 1e-6 * heavier * size,
                "{k}: {carried:?} {load:?}"
            );
        }
        assert!(heavier < 1.0 + 1e-6 || size < 1e-2, "{k}: {heavier} {size}");
        pose = found.0;
    }
}

/// The copy with twice as many control points states an error that holds the difference from a converged guide.
#[test]
fn the_finer_copy_states_an_error_that_holds() {
    let instants = || -> Vec<(f64, RailInstant)> {
        let steps = 200;
        (0..steps)
            .map(|k| {
                let phase = std::f64::consts::TAU * f64::from(k) / f64::from(steps);
                let (s, speed) = (0.03 * phase.cos(), 0.03 * std::f64::consts::TAU * phase.sin().abs());
                let at = instant([200.0 * (1.0 + 0.5 * phase.sin()), 0.0], [0.4 * HALF, 0.0], s, speed);
                (1.0 / f64::from(steps), at)
            })
            .collect()
    };
    let life = 40_000.0;
    // The converged guide has no copy, which would have twice its points.
    let run = |layout: RailLayout, with_copy: bool| -> (WornAmounts, WornAmounts) {
        let history = history(&layout, &instants());
        let mut rate = law(layout, [COEFFICIENT, 5e-14]);
        let finer = layout.finer();
        let mut copy = FinerBore::new(law(finer, [COEFFICIENT, 5e-14]), finer.depths(), Some(5e-3));
        let (mut depth, mut worn) = (vec![0.0; layout.depths()], WornAmounts::default());
        for _ in 0..8 {
            rate.freeze(&history);
            if with_copy {
                copy.freeze(&history, life / 8.0, worn);
                copy.advance();
            }
            wear(&mut rate, &mut depth, life / 8.0, 5e-3);
            worn = rate.sizes().amounts(&depth);
        }
        if with_copy {
            copy.freeze(&history, 0.0, worn);
            copy.advance();
        }
        (worn, copy.errors())
    };
    let (exact, _) = run(layout(241, 30, true), false);
    for (points, elements) in [(31, 4), (61, 8)] {
        let (worn, stated) = run(layout(points, elements, true), true);
        for k in 0..2 {
            let off = (worn.depth(k) - exact.depth(k)).abs();
            println!(
                "{points} points, surface {k}: {:e} m, off by {off:e}, stated {:e}",
                worn.depth(k),
                stated.depth(k)
            );
            assert!(
                off <= stated.depth(k) + 1e-3 * exact.depth(k),
                "{points} {k}: {off:e} {:e}",
                stated.depth(k)
            );
        }
        assert!((worn.volume / exact.volume - 1.0).abs() < 1e-3);
    }
}

/// Gaps between a worn slider and its worn guide at the end of a life [um]: along the left face the two have nearly the same shape.
const WORN_GAPS: [[f64; 15]; 2] = [
    [
        43.082, 43.003, 42.908, 42.82, 42.731, 42.643, 42.558, 42.474, 42.392, 42.315, 42.232, 42.168,
        42.085, 42.66, 44.225,
    ],
    [
        57.232, 54.924, 52.592, 50.265, 47.94, 45.617, 43.298, 40.981, 38.668, 36.364, 34.075, 32.044,
        31.375, 31.125, 31.069,
    ],
];

/// Light loads on a face that the slider nearly fits touch one element after the other while they are sought.
#[test]
fn light_loads_on_a_nearly_fitting_face_find_their_equilibrium() {
    let mut gaps = RailGaps::new(layout(36, 7, false), 4.2e9);
    gaps.gap = WORN_GAPS.map(|face| face.map(|gap| 1e-6 * gap).to_vec());
    // Three numbers in [0, 1) of each case that do not depend on each other.
    let scattered = |case: u32, k: u32| (43_758.545_3 * f64::from(3 * case + k).sin()).rem_euclid(1.0);
    let unbalanced = (0..2000_u32).filter(|&case| {
        let size = 10f64.powf(2.5 * scattered(case, 0) - 5.5);
        let load = [1, 2].map(|k| size * (2.0 * scattered(case, k) - 1.0));
        gaps.equilibrium(load, [0.0; 2]).is_err()
    });
    assert_eq!(unbalanced.count(), 0);
}
