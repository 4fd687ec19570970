//! A shaft that turns in a block on a rail, with wear coefficients that only a mistyped unit has.

use common::accuracy::Accuracy;
use common::failure::SimulationFailure;
use common::scene::{Scene, SceneSource};
use worker::simulate::{SimulateOptions, simulate};

fn scene(wear: f64, friction: f64) -> Scene {
    let text = format!(
        r#"
[scene]
name = "rig"
[parameters]
W = "500 N"
n = "600 r/min"
[materials.steel]
elastic_modulus = "206 GPa"
poisson_ratio = 0.3
[[bodies]]
name = "frame"
motion = "fixed"
[bodies.points]
o = ["0 mm", "0 mm"]
[[bodies]]
name = "shaft"
motion = "driven"
position = ["0 mm", "0 mm"]
speed = "n"
mass = "1 kg"
inertia = "1e-4 kg m^2"
[bodies.points]
c = ["0 mm", "0 mm"]
[[bodies]]
name = "block"
motion = "free"
mass = "1 kg"
inertia = "1e-3 kg m^2"
centre_of_mass = ["0 mm", "0 mm"]
start_position = ["0 mm", "0 mm"]
start_angle = "0 deg"
[bodies.points]
c = ["0 mm", "0 mm"]
[[joints]]
name = "rail"
type = "prismatic"
a = {{ body = "block", point = "c" }}
b = {{ body = "frame", point = "o" }}
axis = "90 deg"
[[joints]]
name = "bearing"
type = "clearance"
journal = {{ body = "shaft", point = "c" }}
bushing = {{ body = "block", point = "c" }}
journal_radius = "5 mm"
radial_clearance = "20 um"
width = "10 mm"
control_points = 72
journal_material = "steel"
bushing_material = "steel"
contact_law = "local-hertz"
contact_damping = {{ hunt_crossley = "2 s/m" }}
film_damping = "100 N s/m"
friction = {friction}
friction_speed = "2 mm/s"
wears = "journal"
wear_coefficient = "{wear} 1/Pa"
[[loads]]
name = "load"
type = "constant-force"
at = {{ body = "block", point = "c" }}
force = ["0 N", "-W"]
[[outputs]]
name = "depth"
type = "largest-wear"
[[limit_states]]
name = "deep"
output = "depth"
threshold = "6 um"
[life]
cycles = 100000
checkpoint_every = 1000
"#
    );
    SceneSource::parse(&text, "rig").expect("valid").nominal().clone()
}

#[test]
fn issue_a_mistyped_wear_coefficient_ended_in_a_panic() {
    for wear in [1e-9, 3e-9, 1e-8, 3e-8, 1e-7, 1e-6] {
        for friction in [0.05, 0.02] {
            let found = simulate(&scene(wear, friction), &Accuracy::draft(), SimulateOptions::default());
            assert!(
                matches!(
                    found,
                    Err(SimulationFailure::WearStep { .. } | SimulationFailure::WornTooDeep { .. })
                ),
                "{wear} {friction}: {:?}",
                found.map(|evaluation| evaluation.histories)
            );
        }
    }
}
