//! Values at checkpoints between the simulated lives.

use common::accuracy::Accuracy;
use common::scene::SceneSource;
use worker::simulate::{SimulateOptions, simulate};

/// A crank that drives a loaded piston; the bore of its rod wears. Blocks end after 5, 10, 20, 40 and 80 cycles.
const PRESS: &str = r#"[scene]
name = "press"

[materials.steel]
elastic_modulus = "206 GPa"
poisson_ratio = 0.3

[materials.bronze]
elastic_modulus = "105 GPa"
poisson_ratio = 0.34

[[bodies]]
name = "frame"
motion = "fixed"
points = { axis = ["0 m", "0 m"] }

[[bodies]]
name = "crank"
motion = "driven"
position = ["0 m", "0 m"]
speed = "1500 r/min"
start_angle = "0.4 rad"
points = { pin = ["30 mm", "0 m"] }

[[bodies]]
name = "rod"
motion = "free"
mass = "0.15 kg"
inertia = "1.25e-4 kg m^2"
centre_of_mass = ["40 mm", "0 m"]
start_position = ["27.6 mm", "11.7 mm"]
start_angle = "-0.117 rad"
points = { big = ["0 m", "0 m"], small = ["100 mm", "0 m"] }

[[bodies]]
name = "piston"
motion = "free"
mass = "0.2 kg"
inertia = "1e-4 kg m^2"
centre_of_mass = ["0 m", "0 m"]
start_position = ["127 mm", "0 m"]
start_angle = "0 rad"
points = { pin = ["0 m", "0 m"] }

[[joints]]
name = "cylinder"
type = "prismatic"
a = { body = "piston", point = "pin" }
b = { body = "frame", point = "axis" }
axis = "0 rad"
angle = "0 rad"

[[joints]]
name = "big_end"
type = "clearance"
journal = { body = "crank", point = "pin" }
bushing = { body = "rod", point = "big" }
journal_radius = "5 mm"
radial_clearance = "20 um"
width = "12 mm"
journal_material = "steel"
bushing_material = "bronze"
contact_law = "local-hertz"
contact_damping = { hunt_crossley = "2 s/m" }
film_damping = "100 N s/m"
friction = 0.05
friction_speed = "5 mm/s"
wear_coefficient = "1e-13 1/Pa"
control_points = 72

[[joints]]
name = "small_end"
type = "revolute"
a = { body = "piston", point = "pin" }
b = { body = "rod", point = "small" }

[[loads]]
name = "gas"
type = "force"
at = { body = "piston", point = "pin" }
direction = [-1, 0]
size = { over = { angle = "crank" }, at = ["0 deg", "20 deg", "60 deg", "180 deg", "300 deg", "340 deg", "360 deg"], value = ["900 N", "1000 N", "500 N", "250 N", "300 N", "600 N", "900 N"] }

[[outputs]]
name = "volume"
type = "worn-volume"

[life]
cycles = 80
checkpoint_every = 10
"#;

#[test]
fn issue_worn_volumes_within_a_block_were_off_by_several_stated_errors() {
    let scene = SceneSource::parse(PRESS, "press").expect("valid").nominal().clone();
    let evaluation = simulate(&scene, &Accuracy::draft(), SimulateOptions::default()).expect("simulated");
    let (values, errors) = (&evaluation.histories[0], &evaluation.errors[0]);
    // Under the contact history of a block the volume grows by K F S in every cycle: on a straight line from 40 to 80 cycles.
    assert_eq!(evaluation.cycles, [10, 20, 30, 40, 50, 60, 70, 80]);
    for k in 4..7 {
        let line = values[3] + (values[7] - values[3]) * 0.25 * (k - 3) as f64;
        let off = (values[k] - line).abs();
        println!("{off:e} of {line:e} +- {:e}", errors[k]);
        assert!(off < 2e-5 * line && off < errors[k], "{off:e} of {line:e} +- {:e}", errors[k]);
    }
}
