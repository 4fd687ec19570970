//! The mechanism of the fixture: a rod that turns with the crank on six pins, its motion and its bores in closed form.

use common::outputs::{BodyMotion, BodyTrace, CycleHistory, WornLife};
use common::scene::{Attachment, Motion, OutputKind, Scene};
use std::f64::consts::TAU;

/// Duration of a cycle [s].
const PERIOD: f64 = 0.125;

/// Pivot of the crank [m].
const PIVOT: [f64; 2] = [0.02, 0.01];

/// Positions of the six pins on the crank, and of their bores on the rod [m].
const PINS: [[f64; 2]; 6] = [[0.01, 0.0], [0.02, 0.0], [0.03, 0.0], [0.01, 0.01], [0.02, 0.01], [0.03, 0.01]];

/// Replaces the bodies and joints of the drive by the rod on its pins.
pub fn rod_on_pins(scene: &mut Scene) {
    scene.loads.clear();
    scene.bodies.truncate(3);
    scene.bodies[2].name = "rod".into();
    for body in &mut scene.bodies {
        body.points.clear();
        if let Motion::Driven { position, .. } = &mut body.motion {
            *position = PIVOT;
        }
    }
    for (joint, position) in scene.joints.iter_mut().zip(PINS) {
        joint.journal = Attachment { body: 1, position };
        joint.bushing = Attachment { body: 2, position };
    }
    for output in &mut scene.outputs {
        if let OutputKind::AngularVelocityDifference { a, b } = &mut output.kind {
            (a.body, b.body) = (1, 2);
        }
    }
}

/// Centres of the journals relative to their bores, in the frame of the rod [m].
pub fn eccentricity(time: f64) -> [f64; 2] {
    let (sin, cos) = (TAU * time / PERIOD).sin_cos();
    [-2.4e-5 * cos, 2e-5 * sin]
}

pub fn first_cycle() -> CycleHistory {
    let time: Vec<f64> = (0..=250).map(|k| PERIOD * k as f64 / 250.0).collect();
    let amplitude = 29.7f64.to_radians();
    let body = |label: &str, phase: f64| {
        let angles = time.iter().map(|t| TAU * (t / PERIOD + phase));
        BodyTrace {
            label: label.into(),
            angle: angles.clone().map(|angle| amplitude * angle.sin()).collect(),
            speed: angles.map(|angle| amplitude * TAU / PERIOD * angle.cos()).collect(),
        }
    };
    let force = |k: usize| {
        let peak = if k > 4 { 9.3 } else { 5.9 };
        let bump = |t: f64| (-((t - 0.1 + 0.0008 * (k % 2) as f64) / 0.014).powi(2)).exp();
        (k.to_string(), time.iter().map(|t| 0.3 + (peak - 0.3) * bump(*t)).collect())
    };
    let turning: Vec<f64> = time.iter().map(|t| TAU * t / PERIOD).collect();
    let moving = |name: &str, position: Vec<[f64; 2]>| BodyMotion {
        body: name.into(),
        position,
        angle: turning.clone(),
        speed: vec![TAU / PERIOD; time.len()],
    };
    // The rod lags behind the crank by the eccentricity.
    let behind = |(t, angle): (&f64, &f64)| {
        let ([x, y], (sin, cos)) = (eccentricity(*t), angle.sin_cos());
        [PIVOT[0] - cos * x + sin * y, PIVOT[1] - sin * x - cos * y]
    };
    CycleHistory {
        bodies: vec![body("right", 0.0), body("left", 0.005)],
        motion: vec![
            moving("crank", vec![PIVOT; time.len()]),
            moving("rod", time.iter().zip(&turning).map(behind).collect()),
        ],
        joint_force: (1..=6).map(force).collect(),
        time,
        ..CycleHistory::default()
    }
}

/// Wear depth of joint `k`, counted from 1 `(36,)` [m].
pub fn depth(k: usize) -> Vec<f64> {
    let deepest = [31.0, 30.0, 11.0, 12.0, 19.0, 18.0][k - 1];
    let bump = |angle: f64, centre: f64, width: f64| (-(1.0 - (angle - centre).cos()) / width).exp();
    let angles = (0..36).map(|p| TAU * p as f64 / 36.0);
    angles.map(|angle| 1e-6 * (deepest * bump(angle, 1.9, 0.12) + 8.0 * bump(angle, 5.4, 0.1))).collect()
}

/// Depths proportional to life, and a last cycle equal to the first.
pub fn worn() -> WornLife {
    let cycles: Vec<u32> = (0..=18).map(|k| 4000 * k).collect();
    let depths = |life: &u32| {
        let share = f64::from(*life) / 72_000.0;
        (1..=6).map(|k| depth(k).into_iter().map(|d| share * d).collect()).collect()
    };
    WornLife { wear_depth: cycles.iter().map(depths).collect(), cycles, last_cycle: Some(first_cycle()) }
}
