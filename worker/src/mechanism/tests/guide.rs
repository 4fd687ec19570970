//! A guide with clearance by itself: derivatives, closed forms of its contacts, energy, momentum.

use crate::contact::GuideReaction;
use crate::mechanism::frame::{End, Frame};
use crate::mechanism::guide::{Guide, Guiding};
use common::scene::{ContactDamping, GuideClearance, Material};

const LENGTH: f64 = 0.05;
const HEIGHT: f64 = 0.03;
const CLEARANCE: f64 = 1e-4;

fn guide(damping: ContactDamping, friction: f64, axis: f64) -> Guide {
    let steel = Material { elastic_modulus: 207e9, poisson_ratio: 0.3 };
    let constants = GuideClearance {
        axis,
        angle: 0.2,
        length: LENGTH,
        height: HEIGHT,
        width: 0.02,
        clearance: CLEARANCE,
        reach: [-0.1, 0.15],
        slider_material: steel,
        guide_material: steel,
        contact_damping: damping,
        friction,
        friction_speed: 0.5,
        wear: None,
    };
    Guide::new(0, &constants, [End { frame: 0, arm: [0.004, -0.002] }, End { frame: 1, arm: [-0.02, 0.01] }])
}

/// Frames with the slider displaced from the middle of its guide by `off` along it, across it, and turned [m, m, rad], at the rates `v` of
/// (x, y, angle) of slider and guide.
fn frames(axis: f64, off: [f64; 3], turned: f64, v: [f64; 6]) -> ([f64; 6], [f64; 6]) {
    let guide = [0.3, -0.2, turned];
    let b = Frame::free(&guide, &[0.0; 3]);
    let angle = turned + 0.2 + off[2];
    let (sin, cos) = axis.sin_cos();
    let centre = b.point([-0.02 + cos * off[0] - sin * off[1], 0.01 + sin * off[0] + cos * off[1]]);
    let arm = Frame::free(&[0.0, 0.0, angle], &[0.0; 3]).turn([0.004, -0.002]);
    ([centre[0] - arm[0], centre[1] - arm[1], angle, guide[0], guide[1], guide[2]], v)
}

fn at(guide: &Guide, (q, v): &([f64; 6], [f64; 6])) -> ([f64; 6], GuideReaction) {
    let frames = [Frame::free(&q[..3], &v[..3]), Frame::free(&q[3..], &v[3..])];
    let (load, done) = guide.force::<false>(&frames);
    (load.f, done)
}

const AT_REST: [f64; 6] = [0.0; 6];
/// One corner, both corners of a face, two opposite corners, and nearly flat with one half free.
const CONTACTS: [[f64; 3]; 5] = [
    [0.01, CLEARANCE - 1.2e-5, 5e-4],
    [-0.02, CLEARANCE + 2e-6, 1e-5],
    [0.03, 1e-6, 4.1e-3],
    [0.0, -CLEARANCE - 1e-6, 2e-7],
    [0.0, -CLEARANCE - 1e-6, 1e-4],
];

#[test]
fn derivatives_agree_with_differences() {
    let (axis, turned) = (0.7, -0.4);
    for off in CONTACTS {
        let v = [0.2, -0.1, 3.0, 0.05, 0.1, -2.0];
        let guide = guide(ContactDamping::HuntCrossley { factor: 0.8 }, 0.12, axis);
        let (q, v) = frames(axis, off, turned, v);
        assert_derivatives(&guide, &q, &v, &format!("{off:?}"));
    }
}

/// Both bodies feel the same contact: no net force, no net moment; what the forces do is what is stored and lost.
#[test]
fn momentum_is_kept_and_the_power_is_accounted_for() {
    let (axis, turned) = (0.7, -0.4);
    for off in CONTACTS {
        let v = [0.2, -0.1, 3.0, 0.05, 0.1, -2.0];
        let guide = guide(ContactDamping::HuntCrossley { factor: 0.8 }, 0.12, axis);
        let (q, v) = frames(axis, off, turned, v);
        let (f, done) = at(&guide, &(q, v));
        let size = f.iter().fold(0.0_f64, |a, b| a.max(b.abs()));
        assert!((f[0] + f[3]).abs() < 1e-12 * size && (f[1] + f[4]).abs() < 1e-12 * size);
        let moment = f[2] + f[5] + q[0] * f[1] - q[1] * f[0] + q[3] * f[4] - q[4] * f[3];
        assert!(moment.abs() < 1e-11 * size, "{moment} {f:?}");
        let h = 1e-10;
        let stored = |t: f64| at(&guide, &(std::array::from_fn(|k| q[k] + t * v[k]), v)).1.stored;
        let rate = (stored(h) - stored(-h)) / (2.0 * h);
        let power: f64 = f.iter().zip(&v).map(|(f, v)| f * v).sum();
        assert!((power + rate + done.lost).abs() < 1e-4 * power.abs(), "{power} {rate} {}", done.lost);
        assert!(done.lost > 0.0);
    }
}

/// Flat: N = K delta, K = sqrt(l w) E / (0.95 2 (1 - nu^2)). One corner in a flat face at the slope theta: N = (K / l) delta^2 / (2 tan theta), as the
/// overlap is a triangle.
#[test]
fn a_flat_face_and_a_corner_have_their_closed_forms() {
    let guide = guide(ContactDamping::None, 0.0, 0.0);
    let stiffness = (LENGTH * 0.02).sqrt() * 207e9 / (0.95 * 2.0 * (1.0 - 0.09));
    let delta = 3e-7;
    let (f, done) = at(&guide, &frames(0.0, [0.02, CLEARANCE + delta, 0.0], 0.0, AT_REST));
    assert!((done.normal[0] / (stiffness * delta) - 1.0).abs() < 1e-8, "{:?}", done.normal);
    assert!((f[1] + stiffness * delta).abs() < 1e-6 * stiffness * delta && f[0].abs() < 1e-9);
    let theta: f64 = 1e-3;
    // Half of the turned height and length above the centre.
    let reach = 0.5 * (LENGTH * theta.sin() + HEIGHT * theta.cos());
    let across = 0.5 * HEIGHT + CLEARANCE + delta - reach;
    let done = at(&guide, &frames(0.0, [0.0, across, theta], 0.0, AT_REST)).1;
    // The edge is measured along the turned slider: g falls by sin(theta) per length.
    let closed = stiffness / LENGTH * delta * delta / (2.0 * theta.sin());
    assert!((done.normal[0] / closed - 1.0).abs() < 1e-6, "{} against {closed}", done.normal[0]);
    assert_eq!(done.normal[1], 0.0);
}

/// A slider turned in the middle of its guide is held at two opposite corners by equal forces N, each along the normal of the guide: they give the
/// moment N times the distance of their points along the guide.
#[test]
fn a_tilted_slider_bears_on_opposite_corners() {
    let guide = guide(ContactDamping::None, 0.0, 0.0);
    let theta: f64 = 2.0 * CLEARANCE / LENGTH + 4e-5;
    let (f, done) = at(&guide, &frames(0.0, [0.0, 0.0, theta], 0.0, AT_REST));
    let [left, right] = done.normal;
    assert!(left > 1.0 && (left / right - 1.0).abs() < 1e-9, "{left} {right}");
    assert!(f[0].abs() < 1e-6 * left && f[1].abs() < 1e-6 * left, "the forces balance: {f:?}");
    // The pressure is a triangle from the corner: its resultant lies a third of its length inside.
    let arm = LENGTH - 2.0 / 3.0 * done.deepest() / theta.sin();
    let expected = -left * (arm * theta.cos() - HEIGHT * theta.sin());
    assert!((f[2] / expected - 1.0).abs() < 1e-6, "{} against {expected}", f[2]);
}

#[test]
fn a_slider_beyond_its_guide_is_seen_and_a_pad_keeps_the_damping_of_its_impact() {
    let restitution = ContactDamping::Restitution {
        law: common::scene::RestitutionLaw::LankaraniNikravesh,
        coefficient: 0.9,
        least_speed: 1e-3,
    };
    let mut guide = guide(restitution, 0.0, 0.0);
    let inside = at(&guide, &frames(0.0, [0.12, 0.0, 0.0], 0.0, AT_REST)).1.beyond;
    let outside = at(&guide, &frames(0.0, [0.127, 0.0, 0.0], 0.0, AT_REST)).1.beyond;
    assert!((inside + 0.005).abs() < 1e-12 && (outside - 0.002).abs() < 1e-12, "{inside} {outside}");
    let least = guide.damping[0];
    let towards_the_left = frames(0.0, [0.0; 3], 0.0, [0.0, 0.5, 0.0, 0.0, 0.0, 0.0]);
    let now = at(&guide, &towards_the_left).1;
    guide.follow_approach(&now);
    let factor = 0.75 * (1.0 - 0.81);
    let expected = [factor / 0.5, factor / 0.5, factor / 1e-3, factor / 1e-3];
    for (found, expected) in guide.damping.iter().zip(expected) {
        assert!((found / expected - 1.0).abs() < 1e-12, "{:?}", guide.damping);
    }
    let touching = frames(0.0, [0.0, CLEARANCE + 1e-7, 0.0], 0.0, [0.0, -0.3, 0.0, 0.0, 0.0, 0.0]);
    let now = at(&guide, &touching).1;
    guide.follow_approach(&now);
    assert!((guide.damping[0] - factor / 0.5).abs() < 1e-12 && guide.damping[2] < least);
}

/// The halves of a face are one surface: one that begins to touch beside the other takes the damping of its own speed, but at most that of the
/// impact under way.
#[test]
fn a_half_that_begins_beside_the_other_has_at_most_its_damping() {
    let restitution = ContactDamping::Restitution {
        law: common::scene::RestitutionLaw::LankaraniNikravesh,
        coefficient: 0.9,
        least_speed: 1e-3,
    };
    let mut guide = guide(restitution, 0.0, 0.0);
    let factor = 0.75 * (1.0 - 0.81);
    let mut follow = |penetration: [f64; 4], approach: [f64; 4]| {
        guide.follow_approach(&GuideReaction { penetration, approach, ..GuideReaction::none(0.0) });
        guide.damping.map(|damping| damping / factor)
    };
    let close = |found: [f64; 4], expected: [f64; 4]| {
        assert!(
            found.iter().zip(expected).all(|(a, b)| (a / b - 1.0).abs() < 1e-12),
            "{found:?} {expected:?}"
        );
    };
    let free = -1e-6;
    close(follow([free; 4], [0.5, 0.4, 0.25, 0.2]), [2.0, 2.5, 4.0, 5.0]);
    // Alone a slow half would have ten times the factor; a face across the guide is another surface.
    close(follow([1e-7, free, free, free], [0.5, 0.1, 0.1, 0.1]), [2.0, 2.0, 10.0, 10.0]);
    close(follow([1e-7, free, free, free], [0.5, 4.0, 0.1, 0.1]), [2.0, 0.25, 10.0, 10.0]);
    close(follow([1e-7, 1e-7, free, 1e-7], [0.01; 4]), [2.0, 0.25, 10.0, 10.0]);
}

/// A flat face that has pressed by K u t since it began to touch at the speed u has the impulse K g^2 / (2 u), half its force times g / u; within a
/// shorter step only that of the step is missing.
#[test]
fn the_impulse_of_a_contact_that_begins_is_that_of_a_force_that_grows_evenly() {
    let guide = guide(ContactDamping::None, 0.0, 0.0);
    let (overlap, speed) = (3e-7, 0.1);
    let begun = |speed: f64, before: f64, h: f64| {
        let (q, v) = frames(0.0, [0.02, CLEARANCE + overlap, 0.0], 0.0, [0.0, speed, 0.0, 0.0, 0.0, 0.0]);
        let before = GuideReaction { penetration: [before; 4], ..GuideReaction::none(0.0) };
        guide.begun(&[Frame::free(&q[..3], &v[..3]), Frame::free(&q[3..], &v[3..])], &before, h)
    };
    let stiffness = (LENGTH * 0.02).sqrt() * 207e9 / (0.95 * 2.0 * (1.0 - 0.09));
    for (h, since) in [(1e-5, overlap / speed), (1e-6, 1e-6)] {
        let impulse = begun(speed, -1e-6, h);
        let expected = 0.5 * stiffness * overlap * since;
        assert!((impulse[1] / expected - 1.0).abs() < 1e-6 && (impulse[4] / expected - 1.0).abs() < 1e-6);
        assert!(impulse[0].abs() < 1e-9 * expected, "{impulse:?}");
    }
    // Where it has turned back, the whole step counts; what touched before was seen by the scheme.
    assert!((begun(-speed, -1e-6, 1e-6)[1] / (0.5 * stiffness * overlap * 1e-6) - 1.0).abs() < 1e-6);
    assert_eq!(begun(speed, 1e-9, 1e-5), [0.0; 6]);
}

/// Asserts that the derivatives of the force in the state `q`, `v` are those of its differences, and that something touches; `of` is named in messages.
pub(super) fn assert_derivatives(guide: &impl Guiding<f64>, q: &[f64; 6], v: &[f64; 6], of: &str) {
    let frames = |q: &[f64; 6], v: &[f64; 6]| [Frame::free(&q[..3], &v[..3]), Frame::free(&q[3..], &v[3..])];
    let exact = guide.force::<true>(&frames(q, v)).0;
    assert!(exact.f.iter().any(|f| f.abs() > 1.0), "{of}: nothing touches");
    let scale = |rows: &[[f64; 6]; 6], r: usize| rows[r].iter().fold(1.0_f64, |a, b| a.max(b.abs()));
    for c in 0..6 {
        let moved = |h: f64| {
            let mut q = *q;
            q[c] += h;
            guide.force::<false>(&frames(&q, v)).0.f
        };
        let faster = |h: f64| {
            let mut v = *v;
            v[c] += h;
            guide.force::<false>(&frames(q, &v)).0.f
        };
        let h = if c % 3 == 2 { 2e-9 } else { 1e-10 };
        let (low, high, slow, fast) = (moved(-h), moved(h), faster(-1e-6), faster(1e-6));
        for r in 0..6 {
            let (k, d) = ((high[r] - low[r]) / (2.0 * h), (fast[r] - slow[r]) / 2e-6);
            let (k_off, d_off) = ((exact.k[r][c] - k).abs(), (exact.d[r][c] - d).abs());
            assert!(k_off < 1e-4 * scale(&exact.k, r), "{of} k {r} {c}: {} {k}", exact.k[r][c]);
            assert!(d_off < 1e-5 * scale(&exact.d, r), "{of} d {r} {c}: {} {d}", exact.d[r][c]);
        }
    }
}
