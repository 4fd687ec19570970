//! Accelerations of the ideal mechanism against differences of its velocities.

use crate::mechanism::{ideal_accelerations, ideal_cycle};
use common::scene::{Drive, Motion, Scene, SceneSource, Table};

/// Largest difference between the accelerations and the central differences of the velocities, relative to
/// the largest acceleration of the same kind, over a cycle.
fn worst(scene: &Scene) -> f64 {
    const SAMPLES: usize = 4001;
    let poses = ideal_cycle(scene, SAMPLES, &mut 0).expect("the linkage closes");
    let a = ideal_accelerations(scene, &poses).expect("the motion is determined");
    let h = scene.life.period / (SAMPLES - 1) as f64;
    let (mut off, mut largest) = ([0.0_f64; 2], [0.0_f64; 2]);
    for k in 1..SAMPLES - 1 {
        for (body, a) in a[k].iter().enumerate() {
            let (Some(a), Some(low), Some(high)) = (a, poses[k - 1].v[body], poses[k + 1].v[body]) else {
                continue;
            };
            for c in 0..3 {
                let difference = (high[c] - low[c]) / (2.0 * h);
                off[c / 2] = off[c / 2].max((a[c] - difference).abs());
                largest[c / 2] = largest[c / 2].max(a[c].abs());
            }
        }
    }
    (off[0] / largest[0]).max(off[1] / largest[1])
}

#[test]
fn accelerations_are_the_rates_of_the_velocities() {
    // Central differences at 4000 points a cycle miss (2 pi k / 4000)^2 / 6 of the k-th harmonic: 1e-5 of
    // the fifth.
    for name in ["four-bar", "flapping-wing"] {
        let mut scene = SceneSource::builtin(name).expect("built in").nominal().clone();
        let off = worst(&scene);
        assert!(off < 2e-5, "{name}: {off}");
        // An uneven drive: a full turn with a second harmonic in it, spline of 64 intervals.
        let tau = std::f64::consts::TAU;
        let at: Vec<f64> = (0..=64).map(|k| scene.life.period * f64::from(k) / 64.0).collect();
        let value =
            (0..=64).map(|k| f64::from(k) / 64.0).map(|s| tau * s + 0.1 * (2.0 * tau * s).sin()).collect();
        for body in &mut scene.bodies {
            if let Motion::Driven { drive, .. } = &mut body.motion {
                *drive = Drive::Angle(Table { at: at.clone(), value, repeat: true });
                break;
            }
        }
        let off = worst(&scene);
        assert!(off < 2e-4, "{name}, uneven: {off}");
    }
}

#[test]
fn a_freedom_is_no_motion_to_follow() {
    let mut scene = SceneSource::builtin("four-bar").expect("built in").nominal().clone();
    let poses = ideal_cycle(&scene, 3, &mut 0).expect("the linkage closes");
    scene.joints.pop();
    assert_eq!(ideal_accelerations(&scene, &poses), None);
}
