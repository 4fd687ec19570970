//! Accelerations, errors of a function generator and impacts against closed forms.

use crate::scenes::scene;
use common::accuracy::Accuracy;
use common::outputs::Evaluation;
use common::scene::*;
use std::f64::consts::TAU;
use worker::simulate::{SimulateOptions, simulate};

fn run(scene: &Scene) -> Evaluation {
    simulate(scene, &Accuracy::reference(), SimulateOptions::default()).expect("simulated")
}

fn output(name: &str, kind: OutputKind) -> Output {
    Output { name: name.into(), kind }
}

/// Checks the first value of an output, which must lie within its stated error or `tolerance` of itself from `exact`.
fn check(evaluation: &Evaluation, k: usize, exact: f64, tolerance: f64) {
    let (found, stated) = (evaluation.histories[k][0], evaluation.errors[k][0]);
    println!("output {k}: {found:.6e} against {exact:.6e}, stated error {stated:.1e}");
    assert!((found - exact).abs() < tolerance * exact.abs(), "output {k}: {found} against {exact}");
    assert!(stated < 10.0 * tolerance * exact.abs(), "output {k}: stated error {stated}");
}

#[test]
fn accelerations_of_a_pendulum_let_go_from_the_horizontal() {
    // g along the path at the start, 2 g towards the hinge at the bottom; twice that at twice the length.
    let mut scene = scene("pendulum", &[]);
    let point =
        |length: f64| OutputKind::Acceleration { at: Attachment { body: 1, position: [0.0, -length] } };
    scene.outputs = vec![
        output("mass", point(1.0)),
        output("beyond", point(2.0)),
        output("angle", OutputKind::AngularAcceleration { body: 1 }),
    ];
    let evaluation = run(&scene);
    check(&evaluation, 0, 2.0 * 9.81, 1e-3);
    check(&evaluation, 1, 4.0 * 9.81, 1e-3);
    check(&evaluation, 2, 9.81, 1e-3);
}

/// The slider-crank with ideal joints and these outputs.
fn ideal_slider_crank(outputs: Vec<Output>) -> Scene {
    let mut scene = scene("slider-crank", &[]);
    scene.joints[2].kind = JointKind::Revolute;
    (scene.outputs, scene.limit_states, scene.variables) = (outputs, vec![], vec![]);
    scene
}

const CRANK: f64 = 0.05;
const ROD: f64 = 0.12;

/// Root mean square over a turn.
fn root_mean_square(f: impl Fn(f64) -> f64) -> f64 {
    let n = 10_000;
    ((0..n).map(|k| f(TAU * f64::from(k) / f64::from(n)).powi(2)).sum::<f64>() / f64::from(n)).sqrt()
}

#[test]
fn errors_of_a_slider_crank_as_a_generator_of_a_cosine() {
    // x = r cos phi + sqrt(l^2 - r^2 sin^2 phi) against r cos phi + l; the rod's angle -asin(r sin phi / l) against zero.
    let body = |scene: &Scene, name: &str| scene.bodies.iter().position(|b| b.name == name).expect("there");
    let (crank, rod, slider) = {
        let scene = scene("slider-crank", &[]);
        (body(&scene, "crank"), body(&scene, "rod"), body(&scene, "slider"))
    };
    let at: Vec<f64> = (0..=72).map(|k| TAU * f64::from(k) / 72.0).collect();
    let mut value: Vec<f64> = at.iter().map(|phi| CRANK * phi.cos() + ROD).collect();
    value[72] = value[0];
    let cosine = Curve { over: Over::Angle(crank), table: Table { at, value, repeat: true } };
    let zero =
        Curve { over: Over::Time, table: Table { at: vec![0.0, 1.0], value: vec![0.0, 0.0], repeat: false } };
    let place = Attachment { body: slider, position: [0.0; 2] };
    let mut outputs = Vec::new();
    for (name, measure) in [("largest", ErrorMeasure::Largest), ("rms", ErrorMeasure::RootMeanSquare)] {
        let position = |wanted| OutputKind::PositionError { at: place, wanted, measure };
        let angle = |wanted| OutputKind::AngleError { body: rod, wanted, measure };
        outputs.push(output(&format!("x_{name}"), position([Some(cosine.clone()), None])));
        outputs.push(output(&format!("xy_{name}"), position([Some(cosine.clone()), Some(zero.clone())])));
        outputs.push(output(&format!("angle_{name}"), angle(Some(zero.clone()))));
        outputs.push(output(&format!("ideal_position_{name}"), position([None, None])));
        outputs.push(output(&format!("ideal_angle_{name}"), angle(None)));
    }
    let evaluation = run(&ideal_slider_crank(outputs));
    let shortfall = |phi: f64| ROD - (ROD * ROD - (CRANK * phi.sin()).powi(2)).sqrt();
    let tilt = |phi: f64| (CRANK * phi.sin() / ROD).asin();
    let quarter = TAU / 4.0;
    for (first, x, angle) in
        [(0, shortfall(quarter), tilt(quarter)), (5, root_mean_square(shortfall), root_mean_square(tilt))]
    {
        check(&evaluation, first, x, 1e-5);
        check(&evaluation, first + 1, x, 1e-5);
        check(&evaluation, first + 2, angle, 1e-5);
        // With ideal joints nothing strays but by the error of the integration.
        let [position, angle] = [3, 4].map(|k| evaluation.histories[first + k][0]);
        assert!(position < 1e-7 && angle < 1e-6, "{position} m, {angle} rad");
    }
}

const BALL: &str = include_str!("scenes/ball.toml");

/// Restitution of an impact with the damping factor D of Flores at the coefficient `e`, D v = 8 (1 - e) / (5 e): the root r of
/// D v - ln(1 + D v) = -r D v - ln(1 - r D v), by which the elastic work of both halves of the impact is the same.
fn restitution(e: f64) -> f64 {
    let a = 8.0 * (1.0 - e) / (5.0 * e);
    let (mut low, mut high) = (0.0, 1.0 / a);
    for _ in 0..60 {
        let r = 0.5 * (low + high);
        if -r * a - (1.0 - r * a).ln() < a - (1.0 + a).ln() { low = r } else { high = r }
    }
    low
}

#[test]
fn a_ball_in_a_bore_bounces_with_the_energies_of_its_falls() {
    // It falls by the clearance c to the bottom and bounces there, centred: impacts at sqrt(2 c / g) = 10.1 ms, then after flights of
    // 2 r^k sqrt(2 c / g), at 21.8, 28.5 and 32.4 ms, with the energies m g c r^2k. The law takes the speed of an impact from the end of
    // the first time step in contact, a little less than that of the approach.
    let scene =
        SceneSource::parse(BALL, "ball").unwrap_or_else(|faults| panic!("{faults}")).nominal().clone();
    let evaluation = run(&scene);
    let (first, r2) = (0.2 * 9.81 * 0.5e-3, restitution(0.6).powi(2));
    assert_eq!(evaluation.histories[0][0], 3.0);
    check(&evaluation, 1, first * (1.0 + r2 + r2 * r2), 0.01);
    check(&evaluation, 2, first, 2e-3);
}
