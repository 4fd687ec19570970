//! The second scene through the same code, turned and mirrored: nothing knows where up is.

use crate::scenes::{evaluate, scene, short};
use crate::transformed::Transform;
use common::accuracy::Accuracy;
use common::outputs::Evaluation;
use common::scene::{Attachment, Load, Scene};
use std::f64::consts::{FRAC_PI_2, FRAC_PI_6};

const CYCLES: u32 = 2000;

/// Tight enough that what is left of the step control's own axes can be told from a defect.
fn tight() -> Accuracy {
    Accuracy { step_tolerance: 1e-5, wear_tolerance: 1e-3, ..Accuracy::balanced() }
}

/// The four-bar with a weight and a side force too, so that every kind of load has a direction to turn.
fn loaded() -> Scene {
    let mut scene = short("four-bar", &[], CYCLES);
    let rocker = scene.bodies.iter().position(|b| b.name == "rocker").expect("a body of the scene");
    let frame = scene.bodies.iter().position(|b| b.name == "frame").expect("a body of the scene");
    let tip = Attachment { body: rocker, position: [0.05, 0.0] };
    scene.gravity = [0.0, -9.81];
    scene.loads.push(Load::ConstantForce { name: "side".into(), at: tip, force: [-2.0, 1.0] });
    scene.loads.push(Load::DirectionalSpring {
        name: "spring".into(),
        at: tip,
        anchor: Attachment { body: frame, position: [0.07, 0.0] },
        direction: [0.6, 0.8],
        stiffness: 20.0,
        free_length: -0.01,
    });
    scene
}

fn turned(turn: f64) -> Scene {
    Transform { turn, ..Transform::NONE }.of(loaded())
}

/// Largest difference in wear, relative to the deepest, where control point i of `a` meets `meets(i)` of `b`.
fn wear_difference(a: &Evaluation, b: &Evaluation, meets: impl Fn(usize) -> usize) -> f64 {
    let deepest = a.joints.iter().flat_map(|j| &j.wear_depth).fold(0.0_f64, |m, h| m.max(*h));
    let mut worst: f64 = 0.0;
    for (x, y) in a.joints.iter().zip(&b.joints) {
        for (i, h) in x.wear_depth.iter().enumerate() {
            worst = worst.max((h - y.wear_depth[meets(i)]).abs());
        }
    }
    worst / deepest
}

#[test]
fn closes_wears_and_gives_both_outputs() {
    let scene = scene("four-bar", &[]);
    let e = evaluate(&scene, &Accuracy::balanced());
    assert_eq!((e.cycles.len(), e.histories.len(), e.joints.len()), (8, 2, 3));
    assert!(e.histories.iter().flatten().all(|x| x.is_finite() && *x > 0.0));
    assert!(e.histories[0].windows(2).all(|w| w[1] > w[0]), "{:?}", e.histories[0]);
    assert!(e.joints.iter().all(|j| j.wear_depth.iter().any(|h| *h > 0.0) && j.peak_force > 1.0));
    // The load torque of 0.8 N m at 50 mm asks for 16 N at least.
    assert!(e.joints.iter().all(|j| j.peak_force > 16.0 && j.peak_force < 200.0));
}

#[test]
fn a_quarter_turn_changes_nothing() {
    let base = evaluate(&loaded(), &Accuracy::balanced());
    let turned = evaluate(&turned(FRAC_PI_2), &Accuracy::balanced());
    let off = wear_difference(&base, &turned, |i| i);
    println!("wear after a quarter turn: {off}");
    assert!(off < 1e-6, "{off}");
    for (a, b) in base.histories[1].iter().zip(&turned.histories[1]) {
        assert!((a / b - 1.0).abs() < 1e-6, "{a} against {b}");
    }
}

#[test]
fn any_turn_changes_no_more_than_the_step_control() {
    // The local error is measured along the global axes, so that other axes give other steps.
    let base = evaluate(&loaded(), &tight());
    let turned = evaluate(&turned(FRAC_PI_6), &tight());
    let off = wear_difference(&base, &turned, |i| i);
    println!("wear after a turn of 30 deg: {off}");
    assert!(off < 2e-4, "{off}");
}

#[test]
fn the_mirror_image_wears_in_the_mirror() {
    let mirrored = Transform { mirrored: true, ..Transform::NONE }.of(loaded());
    let (a, b) = (evaluate(&loaded(), &Accuracy::balanced()), evaluate(&mirrored, &Accuracy::balanced()));
    let off = wear_difference(&a, &b, |i| (36 - i) % 36);
    println!("wear in the mirror: {off}");
    assert!(off < 1e-6, "{off}");
}

#[test]
fn issue_a_warm_up_of_one_cycle_and_a_part_began_at_another_phase() {
    let scene = short("four-bar", &[], CYCLES);
    let at_end = |warm_up: f64| {
        let evaluation = evaluate(&scene, &Accuracy { warm_up, ..Accuracy::draft() });
        [0, 1].map(|output| evaluation.histories[output][1])
    };
    let whole = at_end(1.0);
    for warm_up in [0.0, 0.05, 1.02, 1.5, 2.0] {
        let found = at_end(warm_up);
        for (found, expected) in found.iter().zip(whole) {
            assert!((found / expected - 1.0).abs() < 5e-3, "{warm_up}: {found} against {expected}");
        }
    }
}
