//! A machine under a motor whose cycle is one turn of its crank, or a time that is no turn.

use crate::settling::{run, scene};
use common::accuracy::Accuracy;
use common::outputs::Evaluation;
use common::scene::Scene;
use std::f64::consts::TAU;
use worker::simulate::{SimulateOptions, simulate};

/// A crank with a flywheel under a motor, whose piston wears the bore of its rod; `period` is that of `[life]`.
fn motor_driven(period: &str) -> Scene {
    scene(&format!(
        r#"
[scene]
name = "motor-driven"
[[bodies]]
name = "frame"
motion = "fixed"
[bodies.points]
o = ["0 m", "0 m"]
[[bodies]]
name = "crank"
motion = "free"
mass = "0.5 kg"
inertia = "0.02 kg m^2"
centre_of_mass = ["0 m", "0 m"]
start_position = ["0 m", "0 m"]
start_angle = "0.4 rad"
start_speed = "150 rad/s"
[bodies.points]
o = ["0 m", "0 m"]
p = ["0.03 m", "0 m"]
[[bodies]]
name = "rod"
motion = "free"
mass = "0.15 kg"
inertia = "1.25e-4 kg m^2"
centre_of_mass = ["0.04 m", "0 m"]
start_position = ["0.02763182982008655 m", "0.011682550269259516 m"]
start_angle = "-0.11709289112021558 rad"
[bodies.points]
a = ["0 m", "0 m"]
b = ["0.1 m", "0 m"]
[[bodies]]
name = "piston"
motion = "free"
mass = "0.2 kg"
inertia = "1e-4 kg m^2"
centre_of_mass = ["0 m", "0 m"]
start_position = ["0.12694707547354211 m", "0 m"]
start_angle = "0 rad"
[bodies.points]
p = ["0 m", "0 m"]
[[joints]]
name = "main"
type = "revolute"
a = {{ body = "crank", point = "o" }}
b = {{ body = "frame", point = "o" }}
[[joints]]
name = "big"
type = "revolute"
a = {{ body = "rod", point = "a" }}
b = {{ body = "crank", point = "p" }}
[[joints]]
name = "cyl"
type = "prismatic"
a = {{ body = "piston", point = "p" }}
b = {{ body = "frame", point = "o" }}
axis = "0 rad"
angle = "0 rad"
[materials.s]
elastic_modulus = "206 GPa"
poisson_ratio = 0.3
[materials.b]
elastic_modulus = "105 GPa"
poisson_ratio = 0.34
[[joints]]
name = "wrist"
type = "clearance"
journal = {{ body = "piston", point = "p" }}
bushing = {{ body = "rod", point = "b" }}
journal_radius = "4 mm"
radial_clearance = "20 um"
width = "12 mm"
journal_material = "s"
bushing_material = "b"
contact_law = "local-hertz"
contact_damping = {{ hunt_crossley = "2 s/m" }}
film_damping = "100 N s/m"
friction = 0.05
friction_speed = "0.005 m/s"
wear_coefficient = "1e-13 1/Pa"
control_points = 72
[[loads]]
name = "motor"
type = "motor"
body = "crank"
stall_torque = "20 N m"
no_load_speed = "180 rad/s"
[[loads]]
name = "drag"
type = "rotational-drag"
body = "crank"
linear = "0.02 N m s/rad"
[[outputs]]
name = "volume"
type = "worn-volume"
[life]
period = "{period}"
cycles = 1000
checkpoint_every = 1000
"#
    ))
}

/// Worn volume per time of the settled machine [m^3/s], by an independent integration (DOP853, ideal joints, K F v).
const WEAR_RATE: f64 = 1.3231e-12;

/// Worn volume per time and its stated error [m^3/s], and the length of a cycle [s].
fn wear_rate(evaluation: &Evaluation, accuracy_period: f64) -> (f64, f64) {
    let life = 1000.0 * accuracy_period;
    (evaluation.histories[0][0] / life, evaluation.errors[0][0] / life)
}

#[test]
fn issue_an_undriven_machine_could_not_take_a_turn_of_a_body_as_its_period() {
    let turning = motor_driven("turn of crank");
    let evaluation =
        simulate(&turning, &Accuracy::draft(), SimulateOptions::WITH_FIRST_CYCLE).expect("simulated");
    let first = evaluation.first_cycle.as_ref().expect("asked for");
    let period = first.time[first.time.len() - 1];
    let crank = first.motion.iter().find(|motion| motion.body == "crank").expect("moves");
    let turned = crank.angle[crank.angle.len() - 1] - crank.angle[0];
    assert!((turned / TAU - 1.0).abs() < 1e-6, "{turned} in {period} s");
    let (rate, error) = wear_rate(&evaluation, period);
    println!("period {period} s: {rate:e} +- {error:e} m^3/s, {:?}", evaluation.diagnostics);
    assert!((rate - WEAR_RATE).abs() < error + 1e-4 * WEAR_RATE, "{rate:e} +- {error:e}");
    assert!(error < 0.02 * WEAR_RATE, "{error:e}");
    assert_eq!(evaluation.diagnostics.unsettled, None);
}

#[test]
fn issue_a_cycle_that_is_no_turn_was_taken_for_one_that_repeats() {
    let evaluation = run(&motor_driven("0.04 s"), &Accuracy::draft());
    let unsettled = evaluation.diagnostics.unsettled.as_ref().expect("pointed out");
    let (body, angle) = unsettled.turning.as_ref().expect("turns");
    println!("{unsettled:?}, turns {} deg", angle.to_degrees());
    assert!(body == "crank" && (angle.to_degrees() - 329.5).abs() < 25.0, "{body} {angle}");
    let (rate, error) = wear_rate(&evaluation, 0.04);
    println!("{rate:e} +- {error:e} m^3/s");
    assert!((rate - WEAR_RATE).abs() < error, "{rate:e} +- {error:e}");
}
