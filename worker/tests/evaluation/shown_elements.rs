//! The scenes that show couplings, ropes, stops and motors, through a cycle: closed forms of the mechanism with ideal joints.

use crate::scenes::shared;
use common::accuracy::Accuracy;
use common::outputs::{BodyMotion, CycleHistory};
use std::f64::consts::{PI, TAU};
use worker::simulate::{SimulateOptions, simulate};

/// Settled first cycle of a shared scene.
fn first_cycle(name: &str) -> CycleHistory {
    let mut scene = shared(name);
    (scene.life.cycles, scene.life.checkpoint_every) = (1, 1);
    let found = simulate(&scene, &Accuracy::balanced(), SimulateOptions::WITH_FIRST_CYCLE);
    found.expect("simulated").first_cycle.expect("asked for")
}

fn motion<'c>(cycle: &'c CycleHistory, body: &str) -> &'c BodyMotion {
    cycle.motion.iter().find(|motion| motion.body == body).expect("a body of this name")
}

fn force<'c>(cycle: &'c CycleHistory, joint: &str) -> &'c [f64] {
    &cycle.joint_force.iter().find(|(name, _)| name == joint).expect("a joint of this name").1
}

#[track_caller]
fn near(found: f64, exact: f64, error: f64) {
    assert!((found - exact).abs() <= error, "{found} against {exact}");
}

#[test]
fn a_motor_drives_a_ring_gear_at_the_speed_of_its_line() {
    let cycle = first_cycle("drive-train");
    // The tooth force from brake and bearing friction at 10 mm, then the torque of the motor through belt and pinion, 1 : 9.
    let teeth = 7.2 / (0.06 * 20f64.to_radians().cos() - 0.05 * 0.01);
    let torque = (7.2 + 0.05 * 0.01 * teeth) / 9.0;
    let speed = 150.0 * (1.0 - torque / 4.0);
    for (k, time) in cycle.time.iter().enumerate() {
        near(force(&cycle, "teeth")[k], teeth, 1e-3 * teeth);
        near(force(&cycle, "belt")[k], torque / 0.02, 1e-3 * torque / 0.02);
        near(motion(&cycle, "ring").speed[k], speed / 9.0, 1e-3 * speed);
        near(motion(&cycle, "rotor").angle[k] - motion(&cycle, "rotor").angle[0], speed * time, 1e-3 * TAU);
    }
}

#[test]
fn a_pin_in_a_slot_moves_a_table_whose_rack_turns_a_pinion() {
    let cycle = first_cycle("feeder");
    for (k, time) in cycle.time.iter().enumerate() {
        let cos = (TAU * time).cos();
        near(motion(&cycle, "table").position[k][0], 0.04 * cos, 1e-7);
        // The rack lies above the pinion; up to the clearance of 20 um in the bearing, over the radius.
        let turned = 0.04 / 0.025 * (1.0 - cos);
        near(motion(&cycle, "pinion").angle[k], turned, 2.0 * 20e-6 / 0.025);
    }
    // Largest force in the slot: the inertia of the table, and drag and inertia of the pinion, d^2 + J^2 as amplitudes of a quarter turn apart.
    let per_radius = 1.0 / (0.025 * 0.025);
    let inertia = (3.0 + 4e-4 * per_radius) * 0.04 * TAU * TAU;
    let drag = 0.5 * per_radius * 0.04 * TAU;
    // The friction of the bearing under the force of the teeth acts at its radius.
    let exact = inertia.hypot(drag) / (1.0 - 0.05 * 0.01 / (0.025 * 20f64.to_radians().cos()));
    let largest = force(&cycle, "slot").iter().copied().fold(0.0, f64::max);
    near(largest, exact, 0.002 * exact);
}

#[test]
fn a_rope_lifts_a_flap_and_lets_it_down_on_its_stop() {
    let cycle = first_cycle("flap");
    let angle = &motion(&cycle, "flap").angle;
    let half = cycle.time.len() / 2;
    // On the stop: its torque balances the weight.
    near(angle[0], -9.81 * 0.15 / 500.0, 1e-4);
    // At the top of the crank the tip hangs at the end of the rope, 400 mm and its stretch below the eye.
    let end = |angle: f64| (0.3 - 0.3 * angle.cos()).hypot(0.46 - 0.3 * angle.sin());
    let stretch = 9.81 / 2.0 / 20_000.0;
    near(end(angle[half]), 0.4 + stretch, 1e-4);
}

#[test]
fn a_roller_follows_its_cam_under_spring_weight_and_inertia() {
    let cycle = first_cycle("roller-cam");
    let (speed, rise, over) = (10.0 * PI, 0.01, TAU / 3.0);
    let largest = force(&cycle, "roller").iter().copied().fold(0.0, f64::max);
    let cam = &motion(&cycle, "cam").angle;
    for (k, angle) in cam.iter().enumerate() {
        let angle = angle.rem_euclid(TAU);
        let fall = angle - PI;
        let share = |x: f64| x / over - (TAU * x / over).sin() / TAU;
        let bend = |x: f64| TAU / (over * over) * (TAU * x / over).sin();
        let (lift, second) = match angle {
            x if x < over => (share(x), bend(x)),
            x if x < PI => (1.0, 0.0),
            _ if fall < over => (1.0 - share(fall), -bend(fall)),
            _ => (0.0, 0.0),
        };
        let exact = 0.5 * (9.81 + rise * second * speed * speed) + 2000.0 * (0.01 + rise * lift);
        near(force(&cycle, "roller")[k], exact, 0.02 * largest);
    }
}
