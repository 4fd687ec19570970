//! The built-in scenes at time zero: every joint nearly closes, those of the benchmarks to the last digit.

use common::scene::*;

/// Where a local point of a body stands at time zero, as the scene estimates it, and the body's angle.
fn at_start(scene: &Scene, place: Attachment) -> ([f64; 2], f64) {
    let (origin, angle): ([f64; 2], f64) = match scene.bodies[place.body].motion {
        Motion::Fixed => ([0.0; 2], 0.0),
        Motion::Driven { position, drive: Drive::ConstantSpeed { start_angle, .. }, .. } => {
            (position, start_angle)
        }
        Motion::Driven { .. } => panic!("{} does not turn at constant speed", scene.bodies[place.body].name),
        Motion::Free { start_position, start_angle, .. } => (start_position, start_angle),
    };
    let (sin, cos) = angle.sin_cos();
    let [x, y] = place.position;
    ([origin[0] + cos * x - sin * y, origin[1] + sin * x + cos * y], angle)
}

/// By how much a joint is open at time zero: in length [m] and in angle [rad].
fn open(scene: &Scene, joint: &Joint) -> (f64, f64) {
    let ((a, angle_a), (b, angle_b)) = (at_start(scene, joint.journal), at_start(scene, joint.bushing));
    let gap = [a[0] - b[0], a[1] - b[1]];
    let turned = |angle: f64| (angle_a - angle_b - angle).abs();
    match joint.kind {
        JointKind::Revolute | JointKind::Clearance(_) => (gap[0].hypot(gap[1]), 0.0),
        JointKind::Prismatic { axis, angle } | JointKind::Guide(GuideClearance { axis, angle, .. }) => {
            let (sin, cos) = (angle_b + axis).sin_cos();
            ((gap[1] * cos - gap[0] * sin).abs(), turned(angle))
        }
        JointKind::Fixed { angle } => (gap[0].hypot(gap[1]), turned(angle)),
        _ => panic!("no built-in scene has one: {joint:?}"),
    }
}

#[test]
fn start_positions_nearly_close_every_joint() {
    for name in SceneSource::builtin_names() {
        let scene = SceneSource::builtin(name).unwrap().nominal().clone();
        for joint in &scene.joints {
            let (gap, turned) = open(&scene, joint);
            assert!(gap < 2e-6 && turned < 1e-6, "{name}, joint {}: {gap} m, {turned} rad", joint.name);
        }
    }
}

/// The published start values close the published lengths, so that an open joint is a slip in the scene.
#[test]
fn the_squeezing_mechanism_closes_its_ten_hinges() {
    let scene = SceneSource::builtin("andrews-squeezer").unwrap().nominal().clone();
    let free = scene.bodies.iter().filter(|body| matches!(body.motion, Motion::Free { .. })).count();
    assert_eq!((free, scene.joints.len()), (7, 10));
    for joint in &scene.joints {
        let (gap, _) = open(&scene, joint);
        assert!(gap < 1e-9, "joint {}: gap {gap} m", joint.name);
    }
    // Points C and D as the literature gives them, from gamma at the start: the spring is pressed to 52.67 mm.
    let Some(Load::Spring { a, b, free_length, .. }) = scene.loads.get(1) else { panic!() };
    let ((a, _), (b, _)) = (at_start(&scene, *a), at_start(&scene, *b));
    let (sin, cos) = 0.455_279_819_163_070_37_f64.sin_cos();
    let d = [-0.03635 + 0.02 * cos + 0.018 * sin, 0.03273 + 0.02 * sin - 0.018 * cos];
    assert!((a[0] - d[0]).hypot(a[1] - d[1]) < 1e-15 && b == [0.014, 0.072], "{a:?}, {b:?}");
    let length = (d[0] - b[0]).hypot(d[1] - b[1]);
    assert!((length - 0.0526725).abs() < 1e-7 && (free_length - 0.07785).abs() < 1e-16, "{length}");
}

/// The mass hangs 1 m from its hinge and is let go on its left.
#[test]
fn the_pendulum_starts_from_the_horizontal() {
    let scene = SceneSource::builtin("pendulum").unwrap().nominal().clone();
    let Motion::Free { mass, centre_of_mass, start_velocity, start_speed, .. } = scene.bodies[1].motion
    else {
        panic!()
    };
    let ([x, y], _) = at_start(&scene, Attachment { body: 1, position: centre_of_mass });
    assert!((x + 1.0).abs() < 1e-15 && y.abs() < 1e-15, "({x}, {y})");
    assert_eq!((mass, start_velocity, start_speed), (1.0, None, None));
    assert_eq!(scene.gravity, [0.0, -9.81]);
    let expected = Life { period: 10.0, cycles: 1, checkpoint_every: 1, settle_cycles: 0, turn_of: None };
    assert_eq!(scene.life, expected);
}

#[test]
fn the_slider_crank_has_the_numbers_of_its_source() {
    let scene = SceneSource::builtin("slider-crank").unwrap().nominal().clone();
    let Motion::Driven { drive: Drive::ConstantSpeed { speed, .. }, inertia: Some(crank), .. } =
        scene.bodies[1].motion
    else {
        panic!()
    };
    assert!((scene.life.period - 0.012).abs() < 1e-17 && speed > 0.0);
    assert_eq!((crank.mass, crank.inertia, crank.centre_of_mass), (0.3, 1e-5, [0.0; 2]));
    let masses: Vec<f64> = scene
        .bodies
        .iter()
        .filter_map(|body| match body.motion {
            Motion::Free { mass, .. } => Some(mass),
            _ => None,
        })
        .collect();
    assert_eq!(masses, [0.21, 0.14]);
    let JointKind::Clearance(pin) = &scene.joints[2].kind else { panic!() };
    assert!((pin.bushing_radius - 0.01).abs() < 1e-17 && (pin.radial_clearance() - 0.0005).abs() < 1e-17);
    let law = RestitutionLaw::LankaraniNikravesh;
    let damping = ContactDamping::Restitution { law, coefficient: 0.9, least_speed: 0.001 };
    assert_eq!((pin.contact_damping, pin.film_damping), (damping, 0.0));
    assert_eq!((scene.outputs.len(), scene.limit_states.len(), scene.variables.len()), (4, 1, 5));
}

#[test]
fn issue_an_undriven_machine_could_not_take_a_turn_of_a_body_as_its_cycle() {
    let pendulum = SceneSource::builtin("pendulum").unwrap().text().to_owned();
    let read = |period: &str, speed: &str| {
        let text = pendulum.replacen("period = \"10 s\"", &format!("period = \"{period}\""), 1);
        let text =
            text.replacen("start_angle = \"-90 deg\"", &format!("start_angle = \"-90 deg\"{speed}"), 1);
        SceneSource::parse(&text, "my.toml").map(|source| source.nominal().life)
    };
    let life = read("turn of pendulum", "\nstart_speed = \"-5 rad/s\"").unwrap();
    assert_eq!(life.turn_of, Some(1));
    assert!((life.period - std::f64::consts::TAU / 5.0).abs() < 1e-15);
    for (period, said) in [
        ("turn of pendulum", "bodies.pendulum.start_speed"),
        ("turn of pendlum", "did you mean"),
        ("turn of frame", "is fixed"),
    ] {
        let faults = read(period, "").unwrap_err().to_string();
        assert!(faults.contains(said), "{period}: {faults}");
    }
}
