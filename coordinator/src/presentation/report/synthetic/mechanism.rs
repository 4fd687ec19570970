//! The made-up mechanism: a rod that goes round with a crank on six pins, its motion and its bores from closed forms.

use common::outputs::{BodyMotion, BodyTrace, CycleHistory, WornLife};
use std::f64::consts::TAU;

/// Places of the six pins on the crank, and of their bores on the rod that goes round with it [m].
pub const PINS: [[f64; 2]; 6] =
    [[0.01, 0.0], [0.02, 0.0], [0.03, 0.0], [0.01, 0.01], [0.02, 0.01], [0.03, 0.01]];

/// Where the journals are in their bores, in the rod's frame [m].
pub fn eccentricity(time: f64) -> [f64; 2] {
    let (sin, cos) = (TAU * time / 0.125).sin_cos();
    [-2.4e-5 * cos, 2e-5 * sin]
}

pub fn first_cycle() -> CycleHistory {
    let time: Vec<f64> = (0..=250).map(|k| 0.125 * k as f64 / 250.0).collect();
    let body = |label: &str, phase: f64| BodyTrace {
        label: label.into(),
        angle: time.iter().map(|t| (29.7 * (TAU * (t / 0.125 + phase)).sin()).to_radians()).collect(),
        speed: time
            .iter()
            .map(|t| 29.7f64.to_radians() * TAU / 0.125 * (TAU * (t / 0.125 + phase)).cos())
            .collect(),
    };
    let force = |k: usize| {
        let peak = if k > 4 { 9.27 } else { 5.94 };
        let bump = |t: f64| (-((t - 0.1 + 0.0008 * (k % 2) as f64) / 0.014).powi(2)).exp();
        (k.to_string(), time.iter().map(|t| 0.3 + (peak - 0.3) * bump(*t)).collect())
    };
    let turning: Vec<f64> = time.iter().map(|t| TAU * t / 0.125).collect();
    let moving = |name: &str, position: Vec<[f64; 2]>| BodyMotion {
        body: name.into(),
        position,
        angle: turning.clone(),
        speed: vec![TAU / 0.125; time.len()],
    };
    // Both turn alike; the rod lags by the eccentricity.
    let behind = |(t, angle): (&f64, &f64)| {
        let ([x, y], (sin, cos)) = (eccentricity(*t), angle.sin_cos());
        [0.02 - cos * x + sin * y, 0.01 - sin * x - cos * y]
    };
    CycleHistory {
        bodies: vec![body("right", 0.0), body("left", 0.005)],
        motion: vec![
            moving("crank", vec![[0.02, 0.01]; time.len()]),
            moving("rod", time.iter().zip(&turning).map(behind).collect()),
        ],
        joint_force: (1..=6).map(force).collect(),
        time,
    }
}

/// Wear depth of joint `k`, counted from 1 `(36,)` [m].
pub fn depth(k: usize) -> Vec<f64> {
    let at = |p: usize| {
        let angle = TAU * p as f64 / 36.0;
        let bump = |centre: f64, width: f64| (-(1.0 - (angle - centre).cos()) / width).exp();
        1e-6 * ([31.0, 30.0, 11.0, 12.0, 19.0, 18.0][k - 1] * bump(1.9, 0.12) + 8.0 * bump(5.4, 0.1))
    };
    (0..36).map(at).collect()
}

/// Depths that grow with life in proportion, and a last cycle like the first.
pub fn worn() -> WornLife {
    let cycles: Vec<u32> = (0..=18).map(|k| 4000 * k).collect();
    let at = |life: &u32| {
        let share = f64::from(*life) / 72_000.0;
        (1..=6).map(|k| depth(k).into_iter().map(|d| share * d).collect()).collect()
    };
    WornLife { wear_depth: cycles.iter().map(at).collect(), cycles, last_cycle: Some(first_cycle()) }
}
