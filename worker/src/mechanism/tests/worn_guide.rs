//! A slider on worn faces by itself: the flat guide as its limit, derivatives, energy, momentum.

use super::guide::assert_derivatives;
use crate::contact::{GuideReaction, PADS};
use crate::mechanism::guide::Guiding;
use crate::mechanism::{End, Frame, WearingGuide};
use common::scene::{ContactDamping, GuideClearance, GuideWear, Material, WearingSurfaces};

const CLEARANCE: f64 = 1e-4;
const AXIS: f64 = 0.7;
const TURNED: f64 = -0.4;
/// One corner, both corners of a face, two opposite corners, nearly flat with one half free, and flat [m, m, rad].
const CONTACTS: [[f64; 3]; 5] = [
    [0.01, CLEARANCE - 1.2e-5, 5e-4],
    [-0.02, CLEARANCE + 2e-6, 1e-5],
    [0.03, 1e-6, 4.1e-3],
    [0.003, -CLEARANCE - 1e-6, 1e-4],
    [0.0, -CLEARANCE - 1e-6, 0.0],
];
const RATES: [f64; 6] = [0.2, -0.1, 3.0, 0.05, 0.1, -2.0];

fn guide(damping: f64, friction: f64, wears: bool) -> WearingGuide {
    let steel = Material { elastic_modulus: 207e9, poisson_ratio: 0.3 };
    let wear = GuideWear {
        wears: WearingSurfaces::Both,
        coefficient: 1e-13,
        slider_coefficient: None,
        control_points: 31,
    };
    let constants = GuideClearance {
        axis: AXIS,
        angle: 0.2,
        length: 0.05,
        height: 0.03,
        width: 0.02,
        clearance: CLEARANCE,
        reach: [-0.1, 0.15],
        slider_material: steel,
        guide_material: steel,
        contact_damping: ContactDamping::HuntCrossley { factor: damping },
        friction,
        friction_speed: 0.5,
        wear: wears.then_some(wear),
    };
    let ends = [End { frame: 0, arm: [0.004, -0.002] }, End { frame: 1, arm: [-0.02, 0.01] }];
    WearingGuide::new(0, &constants, ends)
}

/// The guide with waves of some micrometres on all faces.
fn worn(damping: f64, friction: f64) -> WearingGuide {
    let mut guide = guide(damping, friction, true);
    let pair = guide.pair_mut().expect("it wears");
    let depth: Vec<f64> = (0..pair.depths())
        .map(|k| 2e-6 * (1.0 + (0.9 * k as f64).sin()) + if k < pair.first_depths() { 4e-6 } else { 0.0 })
        .collect();
    pair.set_depth(&depth);
    guide
}

/// Coordinates of slider and guide with the slider displaced by `off` from the middle of the guide along it, across it, and turned.
fn state(off: [f64; 3]) -> [f64; 6] {
    let guide = [0.3, -0.2, TURNED];
    let b = Frame::free(&guide, &[0.0; 3]);
    let angle = TURNED + 0.2 + off[2];
    let (sin, cos) = AXIS.sin_cos();
    let centre = b.point([-0.02 + cos * off[0] - sin * off[1], 0.01 + sin * off[0] + cos * off[1]]);
    let arm = Frame::free(&[0.0, 0.0, angle], &[0.0; 3]).turn([0.004, -0.002]);
    [centre[0] - arm[0], centre[1] - arm[1], angle, guide[0], guide[1], guide[2]]
}

fn deeper(off: [f64; 3]) -> [f64; 3] {
    let across = if off[1].abs() > 1e-5 { 1.2e-5 * off[1].signum() } else { 0.0 };
    [off[0], off[1] + across, if across == 0.0 { off[2] + 4e-4 } else { off[2] }]
}

fn at(guide: &WearingGuide, q: &[f64; 6], v: &[f64; 6]) -> ([f64; 6], GuideReaction) {
    let (load, done) = guide.force::<false>(&[Frame::free(&q[..3], &v[..3]), Frame::free(&q[3..], &v[3..])]);
    (load.f, done)
}

/// A flat face cut into elements has the potential of the whole one.
#[test]
fn unworn_faces_have_the_force_of_a_flat_guide() {
    let (cut, flat) = (guide(0.8, 0.0, true), guide(0.8, 0.0, false));
    assert!(cut.wears() && !flat.wears());
    for off in CONTACTS {
        let q = state(off);
        let frames = [Frame::free(&q[..3], &RATES[..3]), Frame::free(&q[3..], &RATES[3..])];
        let ((a, done), (b, expected)) = (cut.force::<true>(&frames), flat.force::<true>(&frames));
        let largest = |rows: &[[f64; 6]; 6]| rows.iter().flatten().fold(0.0_f64, |a, b| a.max(b.abs()));
        let size = b.f.iter().fold(0.0_f64, |a, b| a.max(b.abs()));
        assert!(size > 1.0, "{off:?}: nothing touches");
        let (k, d) = (largest(&b.k), largest(&b.d));
        for r in 0..6 {
            assert!((a.f[r] - b.f[r]).abs() < 1e-9 * size, "{off:?}: {} {}", a.f[r], b.f[r]);
            for c in 0..6 {
                assert!(
                    (a.k[r][c] - b.k[r][c]).abs() < 1e-9 * k,
                    "{off:?} {r} {c}: {} {}",
                    a.k[r][c],
                    b.k[r][c]
                );
                assert!((a.d[r][c] - b.d[r][c]).abs() < 1e-9 * d, "{off:?} {r} {c}");
            }
        }
        for face in 0..2 {
            let off = (done.normal[face] - expected.normal[face]).abs();
            assert!(off <= 1e-9 * size && (done.stored / expected.stored - 1.0).abs() < 1e-9);
        }
        // Of a flat face that touches flatly any place is the deepest one.
        for pad in (0..PADS).filter(|_| off[2] != 0.0) {
            let apart = |of: fn(&GuideReaction) -> [f64; PADS]| (of(&done)[pad] - of(&expected)[pad]).abs();
            assert!(apart(|done| done.penetration) < 1e-15 && apart(|done| done.approach) < 1e-13, "{off:?}");
        }
        assert!((done.beyond - expected.beyond).abs() < 1e-15 && (done.position - off[0]).abs() < 1e-12);
    }
}

#[test]
fn derivatives_on_worn_faces_agree_with_differences() {
    let guide = worn(0.8, 0.12);
    for off in CONTACTS.map(deeper) {
        assert_derivatives(&guide, &state(off), &RATES, &format!("{off:?}"));
    }
}

/// Without damping and friction the force is the gradient of the energy stored, along the guide, too, where the slopes of the worn face push.
#[test]
fn forces_on_worn_faces_are_conservative() {
    let guide = worn(0.0, 0.0);
    let mut pushed = 0;
    for off in CONTACTS.map(deeper) {
        let q = state(off);
        let (f, done) = at(&guide, &q, &RATES);
        assert_eq!(done.lost, 0.0);
        let size = f.iter().fold(0.0_f64, |a, b| a.max(b.abs()));
        for c in 0..6 {
            let h = if c % 3 == 2 { 2e-9 } else { 1e-10 };
            let stored = |h: f64| {
                let mut q = q;
                q[c] += h;
                at(&guide, &q, &RATES).1.stored
            };
            let slope = (stored(h) - stored(-h)) / (2.0 * h);
            assert!((f[c] + slope).abs() < 1e-5 * size, "{off:?} {c}: {} {slope}", f[c]);
        }
        // The component along the guide, whose direction is the axis turned with its body.
        let along = f[0] * (AXIS + TURNED).cos() + f[1] * (AXIS + TURNED).sin();
        pushed += usize::from(along.abs() > 1e-5 * size);
    }
    assert!(pushed >= 3, "{pushed} contacts on slopes");
}

/// Both bodies feel the same contact; what the forces do is what is stored and lost.
#[test]
fn momentum_is_kept_and_the_power_is_accounted_for_on_worn_faces() {
    let guide = worn(0.8, 0.12);
    for off in CONTACTS.map(deeper) {
        let (q, v) = (state(off), RATES);
        let (f, done) = at(&guide, &q, &v);
        let size = f.iter().fold(0.0_f64, |a, b| a.max(b.abs()));
        assert!((f[0] + f[3]).abs() < 1e-11 * size && (f[1] + f[4]).abs() < 1e-11 * size);
        let moment = f[2] + f[5] + q[0] * f[1] - q[1] * f[0] + q[3] * f[4] - q[4] * f[3];
        assert!(moment.abs() < 1e-10 * size, "{moment} {f:?}");
        let h = 1e-10;
        let stored = |t: f64| at(&guide, &std::array::from_fn(|k| q[k] + t * v[k]), &v).1.stored;
        let rate = (stored(h) - stored(-h)) / (2.0 * h);
        let power: f64 = f.iter().zip(&v).map(|(f, v)| f * v).sum();
        assert!((power + rate + done.lost).abs() < 1e-4 * power.abs(), "{power} {rate} {}", done.lost);
        assert!(done.lost > 0.0 && done.rubbing[0] + done.rubbing[1] > 0.0);
    }
}

/// The impulse of worn faces that begin to touch is that of the flat guide where nothing is worn.
#[test]
fn a_contact_that_begins_counts_as_on_a_flat_guide() {
    let (cut, flat) = (guide(0.8, 0.0, true), guide(0.8, 0.0, false));
    // Laid flat, the deepest place of a face is a matter of rounding.
    for off in &CONTACTS[..4] {
        let q = state(*off);
        let frames = [Frame::free(&q[..3], &RATES[..3]), Frame::free(&q[3..], &RATES[3..])];
        let before = GuideReaction { penetration: [-1e-6; 4], ..GuideReaction::none(0.0) };
        for h in [1e-7, 1e-4] {
            let (a, b) = (cut.begun(&frames, &before, h), flat.begun(&frames, &before, h));
            for k in [0, 1, 3, 4] {
                assert!(b[k] > 0.0 && (a[k] / b[k] - 1.0).abs() < 1e-9, "{a:?} {b:?}");
            }
            // Of the sizes of moments, those of parts with either sign add up to less.
            for k in [2, 5] {
                assert!((a[k] / b[k] - 1.0).abs() < 0.2 && a[k] <= b[k] * (1.0 + 1e-9), "{a:?} {b:?}");
            }
        }
    }
}
