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
    let text = format!(
        r#"gravity = ["{:.9} m/s^2", "{:.9} m/s^2"]
[scene]
name = "hung-block"
title = "A block hung on a turning shaft"
[materials.steel]
elastic_modulus = "206 GPa"
poisson_ratio = 0.3
[[bodies]]
name = "shaft"
motion = "driven"
speed = "300 r/min"
position = ["0 m", "0 m"]
start_angle = "0 deg"
[bodies.points]
axis = ["0 m", "0 m"]
[[bodies]]
name = "block"
motion = "free"
mass = "1 kg"
inertia = "1e-2 kg m^2"
centre_of_mass = ["0 m", "0 m"]
start_position = ["0 m", "0 m"]
start_angle = "0 deg"
[bodies.points]
hub = ["0 m", "0 m"]
[[joints]]
name = "hub"
type = "clearance"
contact_law = "{law}"
journal = {{ body = "shaft", point = "axis" }}
bushing = {{ body = "block", point = "hub" }}
journal_radius = "9.95 mm"
bushing_radius = "10 mm"
width = "20 mm"
journal_material = "steel"
bushing_material = "steel"
contact_damping = {{ hunt_crossley = "2 s/m" }}
film_damping = "100 N s/m"
friction = 0
friction_speed = "5 mm/s"
wear_coefficient = "1e-13 1/Pa"
control_points = {points}
[[outputs]]
name = "wear"
type = "largest-wear"
joints = ["hub"]
[life]
period = "0.2 s"
cycles = 1000
checkpoint_every = 1000
settle_cycles = 2
"#,
        WEIGHT * x,
        WEIGHT * y
    );
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
