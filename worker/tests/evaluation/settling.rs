//! Motions that settle slowly, or never, or fall into the bore that wear has deepened.

use common::accuracy::Accuracy;
use common::outputs::Evaluation;
use common::scene::{Scene, SceneSource};
use std::f64::consts::TAU;
use worker::simulate::{SimulateOptions, simulate};

pub fn scene(text: &str) -> Scene {
    SceneSource::parse(text, "scene").expect("valid").nominal().clone()
}

pub fn run(scene: &Scene, accuracy: &Accuracy) -> Evaluation {
    simulate(scene, accuracy, SimulateOptions::default()).expect("simulated")
}

/// Speed of the crank that shakes a sprung mass [rad/s], crank and rod [m].
const SPEED: f64 = 20.0 * std::f64::consts::PI;
const CRANK: f64 = 0.02;
const ROD: f64 = 0.2;
/// The mass [kg], on a spring of 13.7 Hz [N/m].
const MASS: f64 = 0.5;
const STIFFNESS: f64 = 3704.852;

/// A driven slider-crank of ideal joints whose slider shakes a sprung mass with this damping [N s/m].
fn shaker(damping: f64) -> Scene {
    scene(&format!(
        r#"
[scene]
name = "shaker"
[[bodies]]
name = "frame"
motion = "fixed"
[bodies.points]
o = ["0 m", "0 m"]
[[bodies]]
name = "crank"
motion = "driven"
position = ["0 m", "0 m"]
start_angle = "0 rad"
speed = "{SPEED} rad/s"
[bodies.points]
p = ["{CRANK} m", "0 m"]
[[bodies]]
name = "rod"
motion = "free"
mass = "0.05 kg"
inertia = "1e-4 kg m^2"
centre_of_mass = ["0.08 m", "0 m"]
start_position = ["{CRANK} m", "0 m"]
start_angle = "0 rad"
[bodies.points]
a = ["0 m", "0 m"]
b = ["{ROD} m", "0 m"]
[[bodies]]
name = "slider"
motion = "free"
mass = "0.2 kg"
inertia = "1e-4 kg m^2"
centre_of_mass = ["0 m", "0 m"]
start_position = ["0.22 m", "0 m"]
start_angle = "0 rad"
[bodies.points]
p = ["0 m", "0 m"]
s = ["0.01 m", "0 m"]
[[bodies]]
name = "mass"
motion = "free"
mass = "{MASS} kg"
inertia = "1e-4 kg m^2"
centre_of_mass = ["0 m", "0 m"]
start_position = ["0.52 m", "0 m"]
start_angle = "0 rad"
[bodies.points]
p = ["0 m", "0 m"]
s = ["0.01 m", "0 m"]
[[joints]]
name = "big"
type = "revolute"
a = {{ body = "rod", point = "a" }}
b = {{ body = "crank", point = "p" }}
[[joints]]
name = "g1"
type = "prismatic"
a = {{ body = "slider", point = "p" }}
b = {{ body = "frame", point = "o" }}
axis = "0 rad"
angle = "0 rad"
[[joints]]
name = "g2"
type = "prismatic"
a = {{ body = "mass", point = "p" }}
b = {{ body = "frame", point = "o" }}
axis = "0 rad"
angle = "0 rad"
[[joints]]
name = "wrist"
type = "revolute"
a = {{ body = "rod", point = "b" }}
b = {{ body = "slider", point = "p" }}
[[loads]]
name = "spring"
type = "spring"
a = {{ body = "mass", point = "p" }}
b = {{ body = "slider", point = "p" }}
stiffness = "{STIFFNESS} N/m"
free_length = "0.3 m"
damping = "{damping} N s/m"
[[outputs]]
name = "acceleration"
type = "acceleration"
at = {{ body = "mass", point = "p" }}
[life]
cycles = 1
checkpoint_every = 1
settle_cycles = 1
"#
    ))
}

/// Largest acceleration of the settled mass [m/s^2]: the Fourier series of the slider's motion, each harmonic times the transfer function
/// (k + i c w) / (k - m w^2 + i c w) of a base excitation.
fn settled_acceleration(damping: f64) -> f64 {
    const N: usize = 4096;
    let slider = |angle: f64| CRANK * angle.cos() + (ROD * ROD - (CRANK * angle.sin()).powi(2)).sqrt();
    // The motion is even in the angle: cosines alone.
    let harmonics: Vec<(f64, f64, f64)> = (1..12)
        .map(|n| {
            let n = f64::from(n);
            let sum: f64 = (0..N).map(|k| TAU * k as f64 / N as f64).map(|a| slider(a) * (n * a).cos()).sum();
            let (omega, amplitude) = (n * SPEED, 2.0 * sum / N as f64);
            let (re, im) = (STIFFNESS, damping * omega);
            let (below_re, below_im) = (STIFFNESS - MASS * omega * omega, damping * omega);
            let below = below_re * below_re + below_im * below_im;
            let transfer = ((re * below_re + im * below_im) / below, (im * below_re - re * below_im) / below);
            let scale = -omega * omega * amplitude;
            (n, scale * transfer.0, scale * transfer.1)
        })
        .collect();
    let at = |angle: f64| -> f64 {
        harmonics.iter().map(|(n, re, im)| re * (n * angle).cos() - im * (n * angle).sin()).sum()
    };
    (0..20_000).map(|k| at(TAU * f64::from(k) / 20_000.0).abs()).fold(0.0, f64::max)
}

#[test]
fn issue_a_vibration_that_had_not_settled_entered_the_life() {
    for ratio in [0.01, 0.003, 0.001] {
        let damping = 2.0 * ratio * (STIFFNESS * MASS).sqrt();
        let exact = settled_acceleration(damping);
        let evaluation = run(&shaker(damping), &Accuracy::balanced());
        let (found, error) = (evaluation.histories[0][0], evaluation.errors[0][0]);
        println!("damping ratio {ratio}: {found} +- {error}, exact {exact}, {:?}", evaluation.diagnostics);
        assert!((found - exact).abs() < error + 1e-6 * exact, "{found} +- {error}, exact {exact}");
        assert!(error < 1e-4 * exact, "{error}");
        assert_eq!(evaluation.diagnostics.unsettled, None);
    }
}

/// A rotor of 1.5 kg under its weight in one bearing, turned through an Oldham coupling.
fn rotor(law: &str) -> Scene {
    scene(&format!(
        r#"
gravity = ["0 m/s^2", "-9.81 m/s^2"]
[scene]
name = "rotor"
[[bodies]]
name = "frame"
motion = "fixed"
[bodies.points]
o = ["0 m", "0 m"]
[[bodies]]
name = "hub"
motion = "driven"
position = ["0 m", "0 m"]
start_angle = "0 rad"
speed = "50 rad/s"
mass = "0.5 kg"
inertia = "5e-4 kg m^2"
centre_of_mass = ["0 m", "0 m"]
[bodies.points]
p = ["0 m", "0 m"]
[[bodies]]
name = "disc"
motion = "free"
mass = "0.001 kg"
inertia = "1e-7 kg m^2"
centre_of_mass = ["0 m", "0 m"]
start_position = ["0 m", "0 m"]
start_angle = "0 rad"
[bodies.points]
p = ["0 m", "0 m"]
q = ["0.02 m", "0 m"]
[[bodies]]
name = "rotor"
motion = "free"
mass = "1.5 kg"
inertia = "0.002 kg m^2"
centre_of_mass = ["0 m", "0 m"]
start_position = ["0 m", "0 m"]
start_angle = "0 rad"
[bodies.points]
o = ["0 m", "0 m"]
q = ["0.05 m", "0 m"]
[[joints]]
name = "h1"
type = "prismatic"
a = {{ body = "disc", point = "p" }}
b = {{ body = "hub", point = "p" }}
axis = "0 rad"
angle = "0 rad"
[[joints]]
name = "h2"
type = "prismatic"
a = {{ body = "disc", point = "p" }}
b = {{ body = "rotor", point = "o" }}
axis = "90 deg"
angle = "0 rad"
[materials.s]
elastic_modulus = "206 GPa"
poisson_ratio = 0.3
[materials.b]
elastic_modulus = "105 GPa"
poisson_ratio = 0.34
[[joints]]
name = "main"
type = "clearance"
journal = {{ body = "rotor", point = "o" }}
bushing = {{ body = "frame", point = "o" }}
journal_radius = "10 mm"
radial_clearance = "30 um"
width = "20 mm"
journal_material = "s"
bushing_material = "b"
contact_law = "{law}"
contact_damping = {{ hunt_crossley = "2 s/m" }}
film_damping = "300 N s/m"
friction = 0.05
friction_speed = "0.005 m/s"
wear_coefficient = "1e-13 1/Pa"
[[outputs]]
name = "force"
type = "peak-joint-force"
joints = ["main"]
[[outputs]]
name = "torque"
type = "driving-torque"
body = "hub"
[life]
cycles = 2000
checkpoint_every = 2000
"#
    ))
}

#[test]
fn issue_peaks_were_those_of_the_fall_into_the_deepened_bore() {
    // Statics: the rotor's and half of nothing of the disc's weight, and their friction on the journal.
    let (weight, arm) = (1.501 * 9.81, 0.05 / (1.0 + 0.05 * 0.05_f64).sqrt() * 0.01);
    for law in ["local-hertz", "foundation"] {
        for accuracy in [Accuracy::draft(), Accuracy::balanced()] {
            let evaluation = run(&rotor(law), &accuracy);
            for (k, exact) in [weight, arm * weight].into_iter().enumerate() {
                let (found, error) = (evaluation.histories[k][0], evaluation.errors[k][0]);
                println!("{law}: {found} +- {error}, statics {exact}");
                assert!(
                    (found - exact).abs() < 0.01 * exact + error,
                    "{law}: {found} +- {error}, statics {exact}"
                );
                assert!(error < 0.02 * exact, "{law}: {error}");
            }
        }
    }
}
