//! A block hung on a turning shaft: a contact that stands still, in directions at and between control points.

use crate::scenes::every_joint;
use common::failure::SimulationFailure;
use common::scene::{ControlPoints, Scene, SceneSource};
use std::f64::consts::TAU;
use worker::simulate::{ContactArc, SimulateOptions, first_look, simulate};

pub const JOURNAL: f64 = 9.95e-3;
pub const BORE: f64 = 10e-3;
pub const WIDTH: f64 = 20e-3;
pub const COEFFICIENT: f64 = 1e-13;
pub const CYCLES: f64 = 1000.0;
pub const WEIGHT: f64 = 9.81;

/// A block of 1 kg on a shaft of 300 r/min, pulled in direction `degrees`.
pub fn hung(degrees: f64, law: &str, points: usize) -> Scene {
    let (y, x) = degrees.to_radians().sin_cos();
    let text = include_str!("scenes/hung-block-at-an-angle.toml")
        .replace("@law@", law)
        .replace("@points@", &points.to_string())
        .replace("@force x@", &format!("{:.9}", WEIGHT * x))
        .replace("@force y@", &format!("{:.9}", WEIGHT * y));
    SceneSource::parse(&text, "hung block").expect("valid").nominal().clone()
}

/// Worn volume over Archard's K F s, largest depth and its stated error [m].
fn worn(scene: &Scene) -> (f64, f64, f64) {
    let e = simulate(scene, &scene.accuracy.accuracy, SimulateOptions::default()).expect("simulated");
    let depth = &e.joints[0].wear_depth;
    let area: f64 = depth.iter().map(|h| 0.5 * ((BORE + h).powi(2) - BORE * BORE)).sum();
    let volume = area * TAU / depth.len() as f64 * WIDTH;
    (volume / (COEFFICIENT * WEIGHT * TAU * JOURNAL * CYCLES), e.histories[0][0], e.errors[0][0])
}

#[test]
fn control_points_left_to_the_arc_are_more_for_a_lighter_load() {
    let mut numbers = vec![];
    for weight in [1.0, 0.05] {
        let mut scene = hung(94.0, "local-hertz", 36);
        scene.gravity = scene.gravity.map(|g| weight * g);
        let with = |points| {
            let mut scene = scene.clone();
            every_joint(&mut scene, |joint| joint.control_points = points);
            scene
        };
        let by_arc = with(ControlPoints::ByArc);
        let evaluate = |scene: &Scene| {
            simulate(scene, &scene.accuracy.accuracy, SimulateOptions::default()).expect("simulated")
        };
        let found = evaluate(&by_arc);
        let number = found.joints[0].wear_depth.len();
        let same = evaluate(&with(ControlPoints::Number(number)));
        assert_eq!((found.histories, found.errors), (same.histories, same.errors));
        let look = first_look(&by_arc, &scene.accuracy.accuracy).expect("the first cycle");
        let per_arc = look.arcs[0].arc / look.arcs[0].spacing;
        println!("{number} control points, {per_arc:.2} per arc");
        assert!(per_arc > 0.99 * ContactArc::ENOUGH, "{per_arc}");
        assert!(per_arc * (number - 12) as f64 / (number as f64) < ContactArc::ENOUGH, "{per_arc}");
        numbers.push(number);
    }
    assert!(numbers[1] > numbers[0] && numbers[0] > 36, "{numbers:?}");
}

#[test]
fn wear_does_not_depend_on_where_the_contact_lies_between_control_points() {
    // With the published rule, points inside the arc, these are 1.08, 1.21, 0.04 and 0 of Archard's volume.
    let (_, converged, _) = worn(&hung(90.0, "local-hertz", 288));
    for degrees in [90.0, 93.0, 94.0, 95.0] {
        let (volume, depth, stated) = worn(&hung(degrees, "local-hertz", 36));
        println!(
            "{degrees} deg: volume {volume:.5}, {:.3} +- {:.3} um of {:.3}",
            1e6 * depth,
            1e6 * stated,
            1e6 * converged
        );
        assert!((volume - 1.0).abs() < 1e-3, "{degrees} deg: {volume}");
        assert!((depth - converged).abs() < stated, "{degrees} deg: {depth:e} +- {stated:e}, {converged:e}");
        // Foundation: pressures of an arc add up to more than their resultant.
        let (volume, ..) = worn(&hung(degrees, "foundation", 36));
        assert!((volume - 1.0).abs() < 4e-3, "{degrees} deg, foundation: {volume}");
    }
}

#[test]
fn issue_a_bore_of_ten_millimetres_was_worn_to_any_depth() {
    let law = "foundation";
    let mut scene = hung(94.0, law, 36);
    every_joint(&mut scene, |joint| joint.wear_coefficient = 1e-8);
    let failed = simulate(&scene, &scene.accuracy.accuracy, SimulateOptions::default());
    let failure = failed.expect_err("worn through the block");
    let named = matches!(
        failure,
        SimulationFailure::WornTooDeep { .. }
            | SimulationFailure::WearOnFoundation { .. }
            | SimulationFailure::TooManyWearStages { .. }
    );
    assert!(named, "{law}: {failure}");
}
