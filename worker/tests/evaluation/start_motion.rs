//! Positions and velocities at the start: what is given holds, or is a failure that names it.

use crate::scenes::shared;
use common::accuracy::Accuracy;
use common::failure::SimulationFailure;
use common::scene::{JointKind, Motion, Scene};
use worker::mechanism::{Pose, ideal_cycle};
use worker::simulate::{SimulateOptions, simulate};

fn start(scene: &Scene) -> Result<Pose, SimulationFailure> {
    ideal_cycle(scene, 2, &mut 0).map(|mut poses| poses.swap_remove(0))
}

/// Angular velocity of a body at the start [rad/s].
fn speed(scene: &Scene, pose: &Pose, body: &str) -> f64 {
    pose.v[index(scene, body)].expect("free")[2]
}

fn index(scene: &Scene, body: &str) -> usize {
    scene.bodies.iter().position(|b| b.name == body).expect("a body of the scene")
}

fn peak_force(scene: &Scene) -> (f64, f64) {
    let found = simulate(scene, &Accuracy::balanced(), SimulateOptions::default()).expect("it moves");
    (found.histories[0][0], found.errors[0][0])
}

const PLACES: [[f64; 2]; 5] = [[0.0, 0.0], [1.0, 0.0], [5.0, 0.0], [1.0, -7.0], [1000.0, 0.0]];

#[test]
fn issue_start_speeds_depended_on_the_place_of_the_frame() {
    let (pendulum, slider_crank) = (shared("double-pendulum"), shared("free-slider-crank"));
    // Closed form: the wrist stays on its line.
    let rod = |pose: &Pose| {
        let q = |body: &str| pose.q[index(&slider_crank, body)].expect("free")[2];
        -0.3 * 150.0 * q("crank").cos() / q("rod").cos()
    };
    for by in PLACES {
        let moved = pendulum.moved(by);
        let pose = start(&moved).expect("it closes");
        assert!((speed(&moved, &pose, "upper") - 10.0).abs() < 1e-9, "{by:?}: {pose:?}");
        assert!(speed(&moved, &pose, "lower").abs() < 1e-9, "{by:?}: {pose:?}");
        let moved = slider_crank.moved(by);
        let pose = start(&moved).expect("it closes");
        assert!((speed(&moved, &pose, "crank") - 150.0).abs() < 1.5e-7, "{by:?}: {pose:?}");
        assert!((speed(&moved, &pose, "rod") / rod(&pose) - 1.0).abs() < 1e-9, "{by:?}: {pose:?}");
    }
}

/// Right values: integrations of these mechanisms in minimal coordinates by an explicit method of eighth order.
#[test]
fn issue_peak_forces_depended_on_the_place_of_the_frame() {
    for (name, right, to) in [("double-pendulum", 46.0645, 1e-3), ("free-slider-crank", 289.777, 2e-2)] {
        for by in [[0.0, 0.0], [5.0, 0.0]] {
            let (force, error) = peak_force(&shared(name).moved(by));
            assert!((force - right).abs() < to, "{name} at {by:?}: {force} +- {error}");
        }
    }
}

/// A bar hinged to a mass on a guide, whose speed V across the bar is given. Speeds of the centre of the bar, V + l w, and its angular velocity w are
/// as small as they can be in the metric of m and I: w = -m l V / (I + m l^2).
#[test]
fn speeds_that_are_not_given_are_smallest_in_the_metric_of_the_masses() {
    let mut scene = shared("free-slider-crank");
    let (mass, inertia, arm, given) = (0.15, 0.000125, 0.04, 2.0);
    let piston = index(&scene, "piston");
    let rod = index(&scene, "rod");
    scene.joints.retain(|joint| joint.name == "cylinder" || joint.name == "wrist");
    if let Motion::Free { start_velocity, start_position, .. } = &mut scene.bodies[piston].motion {
        (*start_velocity, *start_position) = (Some([given, 0.0]), [0.1, 0.0]);
    }
    // The reference point is the centre of mass; the wrist is below it.
    if let Motion::Free { centre_of_mass, start_position, start_angle, .. } = &mut scene.bodies[rod].motion {
        (*centre_of_mass, *start_position, *start_angle) = ([0.0; 2], [0.1, arm], 0.0);
    }
    for joint in scene.joints.iter_mut().filter(|joint| joint.name == "wrist") {
        joint.journal.position = [0.0, -arm];
    }
    let crank = index(&scene, "crank");
    if let Motion::Free { start_speed, .. } = &mut scene.bodies[crank].motion {
        *start_speed = None;
    }
    for by in PLACES {
        let moved = scene.moved(by);
        let pose = start(&moved).expect("it closes");
        // A bar above its hinge: its centre moves by V - arm w.
        let right = mass * arm * given / (inertia + mass * arm * arm);
        let found = speed(&moved, &pose, "rod");
        assert!((found / right - 1.0).abs() < 1e-9, "{by:?}: {found} rad/s, right {right}");
        let v = pose.v[index(&moved, "piston")].expect("free");
        assert!((v[0] - given).abs() < 1e-9 && speed(&moved, &pose, "crank").abs() < 1e-9, "{by:?}: {v:?}");
    }
}

#[test]
fn issue_a_given_speed_that_cannot_hold_was_changed_silently() {
    let mut scene = shared("free-slider-crank");
    let rod = index(&scene, "rod");
    let give = |scene: &mut Scene, speed: f64| {
        if let Motion::Free { start_speed, .. } = &mut scene.bodies[rod].motion {
            *start_speed = Some(speed);
        }
    };
    give(&mut scene, 0.0);
    let refused = [
        start(&scene).map(|_| ()),
        simulate(&scene, &Accuracy::draft(), SimulateOptions::default()).map(|_| ()),
    ];
    for refused in refused {
        match refused {
            Err(SimulationFailure::StartVelocity { key, given, needed }) => {
                assert_eq!((&*key, given), ("bodies.rod.start_speed", 0.0));
                assert!((needed + 41.7335).abs() < 1e-3, "{needed}");
                give(&mut scene, needed);
            }
            other => panic!("{other:?}"),
        }
    }
    start(&scene).expect("the value that is needed holds");
    // A drive leaves a rocker no speed to give.
    let mut driven = shared("ideal-four-bar");
    let rocker = index(&driven, "rocker");
    if let Motion::Free { start_velocity, .. } = &mut driven.bodies[rocker].motion {
        *start_velocity = Some([0.0, 0.1]);
    }
    match start(&driven) {
        Err(SimulationFailure::StartVelocity { key, needed, .. }) => {
            assert_eq!(key, "bodies.rocker.start_velocity.y");
            assert!(needed.abs() < 1e-9, "{needed}");
        }
        other => panic!("{other:?}"),
    }
}

#[test]
fn issue_start_positions_depended_on_the_place_of_the_frame() {
    let mut scene = shared("free-slider-crank");
    let piston = index(&scene, "piston");
    if let Motion::Free { start_position, .. } = &mut scene.bodies[piston].motion {
        start_position[0] += 4e-3;
    }
    let of = |scene: &Scene| start(scene).expect("it closes").q[index(scene, "crank")].expect("free")[2];
    let right = of(&scene);
    for by in PLACES {
        let found = of(&scene.moved(by));
        assert!((found - right).abs() < 1e-9, "{by:?}: {found} rad, {right}");
    }
}

#[test]
fn issue_a_change_point_was_valid_in_one_command_and_a_step_too_small_in_another() {
    let scene = shared("parallelogram");
    let verdicts = [
        ideal_cycle(&scene, 2, &mut 0).map(|_| ()),
        simulate(&scene, &Accuracy::balanced(), SimulateOptions::default()).map(|_| ()),
        ideal_cycle(&scene.moved([30.0, 0.0]), 50, &mut 0).map(|_| ()),
    ];
    for verdict in verdicts {
        match verdict {
            Err(SimulationFailure::ChangePoint { body, angle, .. }) => {
                assert_eq!(body, "crank");
                assert!((angle.to_degrees() - 180.0).abs() < 1e-3, "{} deg", angle.to_degrees());
            }
            other => panic!("{other:?}"),
        }
    }
    // With a crank a millimetre shorter it passes beside it.
    let mut near = scene.clone();
    for joint in near.joints.iter_mut().filter(|joint| joint.name == "A") {
        joint.bushing.position[0] -= 1e-3;
    }
    ideal_cycle(&near, 2, &mut 0).expect("it goes round");
}

#[test]
fn issue_an_open_linkage_blamed_an_innocent_joint() {
    let mut welded = shared("ideal-four-bar");
    let mut weld = welded.joints[0].clone();
    (weld.name, weld.kind) = ("weld".into(), JointKind::Fixed { angle: 0.0 });
    welded.joints.push(weld);
    match start(&welded) {
        Err(SimulationFailure::CannotAssemble { joint, gap, angle }) => {
            assert_eq!(joint, "weld");
            assert!(gap < 1e-12 && (angle.to_degrees() - 29.0).abs() < 1e-9, "{gap} m, {angle} rad");
        }
        other => panic!("{other:?}"),
    }
    // A ground longer than crank, coupler and rocker together.
    let mut short = shared("ideal-four-bar");
    short.joints[2].bushing.position[0] = 4.0;
    if let Motion::Free { start_position, .. } = &mut short.bodies[3].motion {
        start_position[0] = 4.0;
    }
    match start(&short) {
        Err(SimulationFailure::CannotAssemble { joint, gap, .. }) => {
            assert_eq!(joint, "B");
            assert!((2.0..4.0).contains(&gap), "{gap} m");
        }
        other => panic!("{other:?}"),
    }
}

#[test]
fn issue_a_body_held_by_no_joint_was_not_named() {
    let mut scene = crate::scenes::scene("slider-crank", &[]);
    let mut loose = scene.bodies.iter().find(|body| body.name == "rod").expect("in the scene").clone();
    loose.name = "loose".into();
    scene.bodies.push(loose);
    match simulate(&scene, &Accuracy::draft(), SimulateOptions::default()) {
        Err(SimulationFailure::NotModelled { what }) => {
            assert!(what.contains("slider_error, since body loose is held by no joint"), "{what}");
        }
        other => panic!("{other:?}"),
    }
}

#[test]
fn issue_short_steps_without_contact_advised_contact_damping() {
    let failure =
        |joint| SimulationFailure::StepTooSmall { cycle: 0, time: 0.0, joint, step: 1e-14, error: 2.0 };
    assert!(!failure(None).to_string().contains("damping"), "{}", failure(None));
    assert!(failure(Some("pin".into())).to_string().contains("contact_damping"));
}
