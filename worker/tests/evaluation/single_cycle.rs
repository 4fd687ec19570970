//! Motions seen once, from their start: one cycle, none before it, with wear.

use common::accuracy::Accuracy;
use common::outputs::Evaluation;
use common::scene::{Scene, SceneSource};
use worker::simulate::{SimulateOptions, simulate};

/// A rotor in a bore, brought up from rest by a constant torque; its centre of mass is off the axis.
const ROTOR: &str = r#"
[scene]
name = "rotor"
title = "A rotor brought up from rest"

[materials.steel]
elastic_modulus = "206 GPa"
poisson_ratio = 0.3

[[bodies]]
name = "frame"
motion = "fixed"
[bodies.points]
axis = ["0 mm", "0 mm"]

[[bodies]]
name = "rotor"
motion = "free"
mass = "1 kg"
inertia = "0.005 kg m^2"
centre_of_mass = ["1 mm", "0 mm"]
start_position = ["0 mm", "0 mm"]
start_angle = "0 deg"
[bodies.points]
axis = ["0 mm", "0 mm"]

[[joints]]
name = "hinge"
type = "clearance"
journal = { body = "rotor", point = "axis" }
bushing = { body = "frame", point = "axis" }
journal_radius = "4 mm"
radial_clearance = "20 um"
width = "10 mm"
journal_material = "steel"
bushing_material = "steel"
contact_law = "local-hertz"
contact_damping = { hunt_crossley = "2 s/m" }
film_damping = "100 N s/m"
friction = 0
friction_speed = "5 mm/s"
wear_coefficient = "1e-13 1/Pa"

[[loads]]
name = "motor"
type = "constant-torque"
body = "rotor"
torque = "0.1 N m"

[[outputs]]
name = "wear"
type = "largest-wear"

[[outputs]]
name = "force"
type = "peak-joint-force"
joints = ["hinge"]

[life]
period = "2 s"
cycles = 1
checkpoint_every = 1
settle_cycles = 0
"#;

fn run(scene: &Scene, accuracy: &Accuracy) -> Evaluation {
    simulate(scene, accuracy, SimulateOptions::WITH_FIRST_CYCLE).expect("simulated")
}

#[test]
fn issue_a_single_cycle_from_rest_was_restarted_as_if_it_repeated() {
    let scene = SceneSource::parse(ROTOR, "rotor").expect("valid").nominal().clone();
    let (draft, reference) = (run(&scene, &Accuracy::draft()), run(&scene, &Accuracy::reference()));
    // m w^2 r at the end, with w = M t / (I + m r^2).
    let speed = 0.1 * 2.0 / (0.005 + 1e-6);
    let exact = speed * speed * 1e-3;
    for evaluation in [&draft, &reference] {
        let (force, error) = (evaluation.histories[1][0], evaluation.errors[1][0]);
        assert!((force / exact - 1.0).abs() < 0.05, "{force} against {exact}");
        assert_eq!(force, evaluation.joints[0].peak_force, "the output is that of the cycle measured");
        assert!(error < 0.1 * force, "{error}");
    }
    let ([worn, expected], [error, _]) = (
        [&draft, &reference].map(|evaluation| evaluation.histories[0][0]),
        [&draft, &reference].map(|evaluation| evaluation.errors[0][0]),
    );
    assert!(worn > 0.0 && (worn - expected).abs() < error.max(1e-3 * worn), "{worn} +- {error}, {expected}");
    assert!(error < 0.2 * worn, "{error}");
    assert_eq!(draft.diagnostics.simulated_cycles, 2, "the cycle, and the same cycle again for its error");
}

#[test]
fn issue_a_drive_that_does_not_repeat_failed_although_its_one_cycle_is_fine() {
    let stroke = "angle = { over = \"time\", at = [\"0 s\", \"50 ms\", \"0.1 s\"], value = [\"0 deg\", \"40 deg\", \"100 deg\"], \
                  repeat = false }";
    let four_bar = SceneSource::builtin("four-bar").expect("built in").text().to_owned();
    let life = "[life]\nperiod = \"0.1 s\"\ncycles = 1\ncheckpoint_every = 1\nsettle_cycles = 0\n";
    let text = four_bar.replacen("start_angle = \"0 deg\"\nspeed = \"900 r/min\"", stroke, 1).replacen(
        "[life]\ncycles = 8000\ncheckpoint_every = 1000\n",
        life,
        1,
    );
    let scene = SceneSource::parse(&text, "a-stroke").expect("valid").nominal().clone();
    let evaluation = run(&scene, &Accuracy::draft());
    let (speed, error) = (evaluation.histories[1][0], evaluation.errors[1][0]);
    assert!(speed > 0.0 && error < 0.2 * speed, "{speed} +- {error}");
    let first = evaluation.first_cycle.expect("asked for");
    let crank = first.motion.iter().find(|motion| motion.body == "crank").expect("it moves");
    assert!((crank.angle[crank.angle.len() - 1].to_degrees() - 100.0).abs() < 1e-9);
}
