//! A drag link: the crank drives a rocker that turns fully too. Angles between the two are those of the ideal linkage, whatever the
//! number of cycles before the measured one.

use crate::scenes::draft as run;
use common::accuracy::Accuracy;
use common::scene::{Curve, Load, Motion, OutputKind, Over, Scene, SceneSource, SignedBody, Table};
use std::f64::consts::TAU;
use worker::simulate::{SimulateOptions, simulate};

/// Lengths of frame, crank, coupler and rocker [m]: the frame is the shortest, 20 + 60 < 50 + 55, so both cranks turn.
const LENGTHS: [f64; 4] = [0.020, 0.050, 0.060, 0.055];
const CRANK: usize = 1;
const COUPLER: usize = 2;
const ROCKER: usize = 3;

const DRAG_LINK: &str = include_str!("scenes/drag-link.toml");

const LAG: usize = 2;
const FORCE: usize = 3;

/// The drag link that settles for some cycles; without wear unless it `wears`.
fn drag_link(settle_cycles: u32, wears: bool) -> Scene {
    let mut scene = SceneSource::parse(DRAG_LINK, "drag-link").expect("valid").nominal().clone();
    scene.life.settle_cycles = settle_cycles;
    if !wears {
        crate::scenes::every_joint(&mut scene, |clearance| clearance.wear_coefficient = 0.0);
    }
    scene
}

/// Largest difference of the angles of rocker and crank of the linkage with ideal joints [rad], from its closed form.
fn exact_lag() -> f64 {
    let [ground, crank, coupler, rocker] = LENGTHS;
    let lag = |angle: f64| {
        // From the rocker's axis to the crank pin; cosine rule for the rocker's angle off that line.
        let (x, y) = (crank * angle.cos() - ground, crank * angle.sin());
        let d = x.hypot(y);
        let off = ((rocker * rocker + d * d - coupler * coupler) / (2.0 * rocker * d)).acos();
        (y.atan2(x) + off - angle).rem_euclid(TAU)
    };
    (0..36_000).map(|k| lag(TAU * f64::from(k) / 36_000.0)).fold(0.0, f64::max)
}

#[test]
fn issue_a_body_that_turned_fully_gained_a_turn_with_every_settling_cycle() {
    let exact = exact_lag();
    for settle in [0, 1, 3] {
        let evaluation = run(&drag_link(settle, false));
        let (lag, error) = (evaluation.histories[LAG][0], evaluation.errors[LAG][0]);
        assert!((lag - exact).abs() < 0.01, "{lag} against {exact} after {settle} cycles");
        assert!(error < 1e-3, "{error}");
    }
}

#[test]
fn issue_a_body_that_turned_fully_gained_turns_through_life() {
    let exact = exact_lag();
    for settle in [0, 1, 3] {
        let evaluation = run(&drag_link(settle, true));
        for (lag, error) in evaluation.histories[LAG].iter().zip(&evaluation.errors[LAG]) {
            assert!((lag - exact).abs() < 0.02, "{lag} against {exact} after {settle} cycles");
            assert!(*error < 0.02, "{error}");
        }
    }
    // Wear alone, by the quasi-static model: the state in which it starts the dynamics has the same turns.
    let mut wear = drag_link(1, true);
    wear.outputs.truncate(1);
    let quasi_static = run(&wear);
    let dynamic = simulate(
        &wear,
        &Accuracy { tier: common::accuracy::Tier::Dynamic, ..Accuracy::draft() },
        SimulateOptions::default(),
    );
    let (found, expected) = (quasi_static.histories[0][1], dynamic.expect("simulated").histories[0][1]);
    assert!((found / expected - 1.0).abs() < 0.03, "{found} against {expected}");
}

/// Peak force in a hinge of the rocker after some settling cycles, with a load added [N].
fn force_with(load: Load, settle: u32, wears: bool) -> f64 {
    let mut scene = drag_link(settle, wears);
    scene.loads.push(load);
    run(&scene).histories[FORCE][0]
}

#[test]
fn issue_a_torsion_spring_wound_up_with_every_settling_cycle() {
    let spring = || {
        let (name, stiffness, damping) = ("spring".into(), 0.3, 0.0);
        Load::TorsionSpring { name, a: ROCKER, b: CRANK, stiffness, damping, free_angle: 1.0 }
    };
    let forces = [1, 3].map(|settle| force_with(spring(), settle, false));
    assert!((forces[1] / forces[0] - 1.0).abs() < 1e-3, "{forces:?}");
    let worn = force_with(spring(), 1, true);
    assert!((worn / forces[0] - 1.0).abs() < 0.05, "{worn} against {forces:?}");
}

#[test]
fn issue_a_torque_over_the_angle_of_a_body_that_turns_was_past_its_end() {
    let torque = |repeat: bool| {
        let at = (0..=8).map(|k| TAU * (f64::from(k) / 8.0 + 0.1)).collect();
        let value = vec![0.0, 0.5, 1.0, 0.5, 0.0, -0.5, -1.0, -0.5, 0.0];
        let torque = Curve { over: Over::Angle(ROCKER), table: Table { at, value, repeat } };
        Load::VariableTorque { name: "cam".into(), body: ROCKER, torque }
    };
    let (once, repeated) = (force_with(torque(false), 2, false), force_with(torque(true), 2, false));
    let none = run(&drag_link(2, false)).histories[FORCE][0];
    assert!((once / repeated - 1.0).abs() < 0.02, "{once} against {repeated}");
    assert!((once / none - 1.0).abs() > 0.1, "{once} is that without the torque");
}

#[test]
fn angles_that_differ_from_cycle_to_cycle_are_refused() {
    let refused = |scene: &Scene| {
        let failure = simulate(scene, &Accuracy::draft(), SimulateOptions::default()).unwrap_err();
        failure.to_string()
    };
    // Between the rocker and the frame a spring is wound up by a turn a cycle.
    let mut wound = drag_link(1, false);
    let (name, stiffness, damping) = ("coil".into(), 0.01, 0.0);
    wound.loads.push(Load::TorsionSpring { name, a: ROCKER, b: 0, stiffness, damping, free_angle: 0.0 });
    let message = refused(&wound);
    assert!(message.contains("coil between rocker and frame") && message.contains("360 deg"), "{message}");
    wound.life = common::scene::Life { cycles: 1, checkpoint_every: 1, settle_cycles: 0, ..wound.life };
    assert!(run(&wound).histories[FORCE][0] > 0.0, "one cycle by itself has no cycle before it");

    // Without the coupler the drives leave open how the rocker turns.
    let mut open = drag_link(1, false);
    open.joints.remove(1);
    let signed = |body, label: &str| SignedBody { body, sign: 1.0, label: label.into() };
    open.outputs[LAG].kind =
        OutputKind::AngleDifference { a: signed(ROCKER, "rocker"), b: signed(COUPLER, "coupler") };
    assert!(!refused_or_run(&open).contains("left open"), "two free bodies keep their angles");
    open.outputs[LAG].kind =
        OutputKind::AngleDifference { a: signed(ROCKER, "rocker"), b: signed(CRANK, "crank") };
    assert!(matches!(open.bodies[ROCKER].motion, Motion::Free { .. }));
    let message = refused(&open);
    assert!(message.contains("output lag") && message.contains("left open by the drives"), "{message}");
}

/// The failure of a simulation, if any, in words.
fn refused_or_run(scene: &Scene) -> String {
    let result = simulate(scene, &Accuracy::draft(), SimulateOptions::default());
    result.err().map_or_else(String::new, |failure| failure.to_string())
}
