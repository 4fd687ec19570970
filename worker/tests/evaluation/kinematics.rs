//! The linkage in the limit of vanishing clearance, and linkages that cannot go round.

use crate::scenes::{RPM, published, scene};
use common::accuracy::Accuracy;
use common::failure::SimulationFailure;
use common::scene::{OutputKind, Scene};
use worker::mechanism::ideal_cycle;
use worker::simulate::{SimulateOptions, simulate};

struct Rockers {
    lowest: f64,
    highest: f64,
    angle_difference: f64,
    speed_difference: f64,
}

/// Extremes over a cycle of the two rockers an output of the scene compares [deg, r/min].
fn rockers(scene: &Scene) -> Rockers {
    let (a, b) = scene
        .outputs
        .iter()
        .find_map(|o| match &o.kind {
            OutputKind::AngularVelocityDifference { a, b } => Some((a, b)),
            _ => None,
        })
        .expect("the scene compares two bodies");
    let mut r = Rockers { lowest: f64::MAX, highest: f64::MIN, angle_difference: 0.0, speed_difference: 0.0 };
    for pose in ideal_cycle(scene, 2001, &mut 0).expect("the linkage goes round") {
        let [(x, vx), (y, vy)] = [a, b].map(|s| {
            let (q, v) = (pose.q[s.body].expect("free"), pose.v[s.body].expect("free"));
            ((s.sign * q[2]).to_degrees(), s.sign * v[2] / RPM)
        });
        r.lowest = r.lowest.min(x).min(y);
        r.highest = r.highest.max(x).max(y);
        r.angle_difference = r.angle_difference.max((x - y).abs());
        r.speed_difference = r.speed_difference.max((vx - vy).abs());
    }
    r
}

#[test]
fn vanishing_clearance_gives_the_published_rocker_motion() {
    let r = rockers(&scene("flapping-wing", &[]));
    let [lowest, highest] =
        ["rocker_lowest_right", "rocker_highest"].map(|name| published(name).to_degrees());
    assert!((r.lowest - lowest).abs() < 0.01, "lowest {}", r.lowest);
    assert!((r.highest - highest).abs() < 0.01, "highest {}", r.highest);
    assert!((r.angle_difference / 0.927 - 1.0).abs() < 0.01, "{} deg", r.angle_difference);
    assert!((r.speed_difference / 20.33 - 1.0).abs() < 0.01, "{} r/min", r.speed_difference);
}

#[test]
fn a_longer_rod_lowers_the_asymmetry() {
    // 50 mm in the plane instead of 40, the frame pins 10 mm higher: the rockers swing about the same mean.
    let rod = 50e-3 / 3.0_f64.to_radians().cos();
    let r = rockers(&scene("flapping-wing", &[("rod_length", rod), ("parameters.pivot_height", 49.951e-3)]));
    assert!((r.angle_difference / 0.744 - 1.0).abs() < 0.01, "{} deg", r.angle_difference);
    assert!((r.speed_difference / 16.15 - 1.0).abs() < 0.01, "{} r/min", r.speed_difference);
}

#[test]
fn a_linkage_that_cannot_be_assembled_is_named() {
    for rod in [15e-3, 80e-3] {
        let scene = scene("flapping-wing", &[("parameters.rod_length", rod)]);
        match ideal_cycle(&scene, 2, &mut 0) {
            Err(SimulationFailure::CannotAssemble { joint, gap, angle }) => {
                assert!(scene.joints.iter().any(|j| j.name == joint), "joint {joint}");
                assert_eq!(angle, 0.0);
                assert!(gap > 1e-3, "gap {gap}");
            }
            other => panic!("rod {rod}: {other:?}"),
        }
    }
}

#[test]
fn a_linkage_that_locks_on_its_way_is_named_with_its_time() {
    // A four-bar against Grashof: the crank starts, then the coupler cannot follow.
    let scene = scene("four-bar", &[("parameters.crank_length", 45e-3)]);
    match simulate(&scene, &Accuracy::draft(), SimulateOptions::default()) {
        Err(SimulationFailure::DeadPoint { time, body, angle, joint }) => {
            assert!(time > 0.0 && time < scene.life.period, "time {time}");
            assert!(scene.joints.iter().any(|j| j.name == joint) && body == "crank");
            // Coupler and rocker stretched: 60 + 50 mm across from the rocker pin, cosine rule on 70 and 45 mm.
            let (far, ground, crank) = (110e-3_f64, 70e-3_f64, 45e-3_f64);
            let cosine = (ground * ground + crank * crank - far * far) / (2.0 * ground * crank);
            assert!((angle - cosine.acos()).abs() < 1e-5, "{} deg", angle.to_degrees());
        }
        other => panic!("{other:?}"),
    }
}
