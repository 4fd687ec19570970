//! Loads, drives, ideal joints and outputs against closed forms.

use crate::scenes::{RPM, every_joint, reference_shown as run, scene};
use common::accuracy::Accuracy;
use common::outputs::Evaluation;
use common::scene::*;
use std::f64::consts::TAU;
use worker::simulate::{SimulateOptions, simulate};

const INERTIA: f64 = 0.02;
const MASS: f64 = 0.5;

/// One body on a frame by one ideal joint at its centre of mass, seen from its start for `period` [s].
fn one_body(kind: JointKind, start_position: [f64; 2], loads: Vec<Load>, period: f64) -> Scene {
    let mut scene = scene("pendulum", &[]);
    scene.gravity = [0.0; 2];
    scene.bodies[1].motion = Motion::Free {
        mass: MASS,
        inertia: INERTIA,
        centre_of_mass: [0.0; 2],
        start_position,
        start_angle: 0.0,
        start_velocity: None,
        start_speed: None,
    };
    scene.joints[0].kind = kind;
    scene.loads = loads;
    scene.life.period = period;
    scene
}

fn rotor(loads: Vec<Load>, period: f64) -> Scene {
    one_body(JointKind::Revolute, [0.0; 2], loads, period)
}

/// With time steps short enough for an energy balance within 1e-6.
fn run_finely(scene: &Scene) -> Evaluation {
    let reference = Accuracy::reference();
    let accuracy = Accuracy {
        step_tolerance: 1e-2 * reference.step_tolerance,
        largest_step: 0.1 * reference.largest_step,
        ..reference
    };
    simulate(scene, &accuracy, SimulateOptions::WITH_FIRST_CYCLE).expect("simulated")
}

/// Every (time, angle, x) of the body.
fn history(evaluation: &Evaluation) -> Vec<(f64, f64, f64)> {
    let cycle = evaluation.first_cycle.as_ref().expect("asked for");
    let body = &cycle.motion[0];
    let values = cycle.time.iter().zip(&body.angle).zip(&body.position);
    values.map(|((&t, &angle), x)| (t, angle, x[0])).collect()
}

#[test]
fn a_motor_brings_its_rotor_up_to_speed() {
    let (stall_torque, no_load_speed) = (0.3, 40.0);
    let motor = Load::Motor { name: "motor".into(), body: 1, stall_torque, no_load_speed };
    let tau = INERTIA * no_load_speed / stall_torque;
    for (t, angle, _) in history(&run(&rotor(vec![motor], 5.0))) {
        let exact = no_load_speed * (t - tau * (1.0 - (-t / tau).exp()));
        assert!((angle - exact).abs() < 1e-6 * (1.0 + exact), "{angle} against {exact} at {t}");
    }
}

/// x'' + 2 d x' + w^2 x = 0 from x = 1 at rest.
fn damped(t: f64, decay: f64, frequency: f64) -> f64 {
    let w = (frequency * frequency - decay * decay).sqrt();
    (-decay * t).exp() * ((w * t).cos() + decay / w * (w * t).sin())
}

#[test]
fn a_torsion_spring_swings_and_settles() {
    let (stiffness, damping, free_angle) = (1.5, 0.01, 0.4);
    let spring = Load::TorsionSpring { name: "spring".into(), a: 1, b: 0, stiffness, damping, free_angle };
    let (decay, frequency) = (damping / (2.0 * INERTIA), (stiffness / INERTIA).sqrt());
    for (t, angle, _) in history(&run(&rotor(vec![spring], 2.0))) {
        let exact = free_angle * (1.0 - damped(t, decay, frequency));
        assert!((angle - exact).abs() < 1e-7, "{angle} against {exact} at {t}");
    }
}

#[test]
fn a_spring_moves_a_slider_along_its_guide() {
    let (stiffness, damping, free_length, start) = (80.0, 1.0, 0.3, 0.5);
    let place = |body| Attachment { body, position: [0.0; 2] };
    let spring =
        Load::Spring { name: "spring".into(), a: place(1), b: place(0), stiffness, damping, free_length };
    let guide = JointKind::Prismatic { axis: 0.0, angle: 0.0 };
    let (decay, frequency) = (damping / (2.0 * MASS), (stiffness / MASS).sqrt());
    let evaluation = run(&one_body(guide, [start, 0.0], vec![spring], 2.0));
    for (t, angle, x) in history(&evaluation) {
        let exact = free_length + (start - free_length) * damped(t, decay, frequency);
        assert!((x - exact).abs() < 1e-8 && angle.abs() < 1e-12, "{x} against {exact} at {t}");
    }
    // Nothing is pressed sideways against the guide.
    assert!(evaluation.histories[0][0] < 1e-9);
}

#[test]
fn a_torque_over_the_angle_does_the_work_of_its_table() {
    let at: Vec<f64> = (0..=72).map(|k| TAU * f64::from(k) / 72.0).collect();
    let value = at.iter().map(|x| 0.1 + 0.05 * x.cos()).collect();
    let table = Table { at, value, repeat: true };
    let torque = Curve { over: Over::Angle(1), table };
    let load = Load::VariableTorque { name: "torque".into(), body: 1, torque };
    let evaluation = run(&rotor(vec![load], 4.0));
    let body = &evaluation.first_cycle.as_ref().expect("asked for").motion[0];
    assert!(body.angle[1000] > TAU, "more than one turn");
    for (angle, speed) in body.angle.iter().zip(&body.speed) {
        let (kinetic, work) = (0.5 * INERTIA * speed * speed, 0.1 * angle + 0.05 * angle.sin());
        // The table's cubics are flat at its extrema: up to 1e-4 of its range off in the mean.
        assert!((kinetic - work).abs() < 1e-4 * 0.05 * TAU + 1e-4 * work, "{kinetic} against {work} J");
    }
}

#[test]
fn a_force_over_time_gives_its_impulse() {
    // A straight ramp up and down: its monotone cubic has the same area by symmetry.
    let table = Table { at: vec![0.0, 0.5, 1.0], value: vec![0.0, 2.0, 0.0], repeat: false };
    let size = Curve { over: Over::Time, table };
    let at = Attachment { body: 1, position: [0.0; 2] };
    let push = Load::VariableForce { name: "push".into(), at, direction: [1.0, 0.0], size };
    let guide = JointKind::Prismatic { axis: 0.0, angle: 0.0 };
    let evaluation = run(&one_body(guide, [0.0; 2], vec![push], 2.0));
    let found = history(&evaluation);
    let speed = (found[1000].2 - found[600].2) / (found[1000].0 - found[600].0);
    assert!((speed - 1.0 / MASS).abs() < 1e-6, "{speed} m/s after 1 N s");
}

/// A slider that starts with `start` [m/s] in a medium that flows at `flow` [m/s], both along its guide.
fn dragged(start: f64, [linear, quadratic]: [f64; 2], flow: f64, factor: Option<Curve>) -> Scene {
    let (name, at, direction) = ("air".into(), Attachment { body: 1, position: [0.0; 2] }, [1.0, 0.0]);
    let drag = Load::Drag { name, at, direction, linear, quadratic, flow, factor };
    let guide = JointKind::Prismatic { axis: 0.0, angle: 0.0 };
    let mut scene = one_body(guide, [0.0; 2], vec![drag], 2.0);
    if let Motion::Free { start_velocity, .. } = &mut scene.bodies[1].motion {
        *start_velocity = Some([start, 0.0]);
    }
    scene
}

#[test]
fn quadratic_drag_slows_a_slider_as_in_closed_form() {
    // m dv/dt = -c |v| v: v = v_0 / (1 + c |v_0| t / m), forward and backward.
    let c = 0.7;
    for start in [3.0, -3.0_f64] {
        let evaluation = run_finely(&dragged(start, [0.0, c], 0.0, None));
        for (t, _, x) in history(&evaluation) {
            let exact = MASS / c * (c * start.abs() * t / MASS).ln_1p() * start.signum();
            assert!((x - exact).abs() < 1e-8, "{x} against {exact} at {t}");
        }
        // What the body loses is dissipated, nothing is put in.
        let energy = evaluation.diagnostics.energy.expect("asked for");
        let end = start / (1.0 + c * start.abs() * 2.0 / MASS);
        let lost = 0.5 * MASS * (start * start - end * end);
        println!("lost {lost} J, dissipated {} J, put in {:e} J", energy.dissipated, energy.input);
        assert!(
            (energy.dissipated / lost - 1.0).abs() < 1e-6 && energy.input.abs() < 1e-6 * lost,
            "{energy:?}"
        );
        assert!(energy.residual().abs() < 1e-6 * lost, "{energy:?}");
    }
    // With a linear part: dv/dt = -(b + c v) v / m has v = b / ((b / v_0 + c) exp(b t / m) - c), half of it by the factor.
    let (b, start) = (0.4, 3.0);
    let table = Table { at: vec![0.0, 1.0], value: vec![0.5, 0.5], repeat: true };
    let factor = Some(Curve { over: Over::Time, table });
    let evaluation = run_finely(&dragged(start, [2.0 * b, 2.0 * c], 0.0, factor));
    let speed_at_end = (b / start + c) * (b * 2.0 / MASS).exp() - c;
    let energy = evaluation.diagnostics.energy.expect("asked for");
    let lost = 0.5 * MASS * (start * start - (b / speed_at_end).powi(2));
    assert!((energy.dissipated / lost - 1.0).abs() < 1e-6, "{} against {lost} J", energy.dissipated);
}

#[test]
fn a_flow_takes_a_slider_along() {
    // From rest, u = v - w obeys m du/dt = -c |u| u: v = w (1 - 1 / (1 + c w t / m)).
    let (c, w) = (0.7, 4.0);
    let evaluation = run_finely(&dragged(0.0, [0.0, c], w, None));
    for (t, _, x) in history(&evaluation) {
        let exact = w * t - MASS / c * (c * w * t / MASS).ln_1p();
        assert!((x - exact).abs() < 1e-8, "{x} against {exact} at {t}");
    }
    // The medium puts in F w, which is w times the momentum gained.
    let energy = evaluation.diagnostics.energy.expect("asked for");
    let end = w * (1.0 - 1.0 / (1.0 + c * w * 2.0 / MASS));
    assert!((energy.input / (MASS * end * w) - 1.0).abs() < 1e-6, "{energy:?}");
    assert!((energy.stored / (0.5 * MASS * end * end) - 1.0).abs() < 1e-6, "{energy:?}");
    assert!(energy.residual().abs() < 1e-6 * energy.input, "{energy:?}");
}

#[test]
fn quadratic_drag_slows_a_rotor_as_in_closed_form() {
    let (c, start) = (0.002, -60.0_f64);
    let drag = Load::RotationalDrag { name: "fan".into(), body: 1, linear: 0.0, quadratic: c, factor: None };
    let mut scene = rotor(vec![drag], 2.0);
    if let Motion::Free { start_speed, .. } = &mut scene.bodies[1].motion {
        *start_speed = Some(start);
    }
    for (t, angle, _) in history(&run(&scene)) {
        let exact = -INERTIA / c * (c * start.abs() * t / INERTIA).ln_1p();
        assert!((angle - exact).abs() < 1e-7 * (1.0 + exact.abs()), "{angle} against {exact} at {t}");
    }
}

/// Two bodies fixed to each other swing as the one they make.
#[test]
fn a_fixed_joint_makes_one_body_of_two() {
    let base = scene("pendulum", &[]);
    let mut two = base.clone();
    let body = |mass: f64, inertia: f64, down: f64| Motion::Free {
        mass,
        inertia,
        centre_of_mass: [0.0, -down],
        start_position: [0.0; 2],
        start_angle: -TAU / 4.0,
        start_velocity: None,
        start_speed: None,
    };
    two.bodies[1].motion = body(0.6, 0.02, 0.8);
    two.bodies.push(Body { name: "second".into(), motion: body(0.4, 0.01, 1.1), points: vec![] });
    let at = |body, down: f64| Attachment { body, position: [0.0, -down] };
    two.joints.push(Joint {
        name: "weld".into(),
        journal: at(2, 0.5),
        bushing: at(1, 0.5),
        kind: JointKind::Fixed { angle: 0.0 },
        friction: None,
    });
    let mut one = base;
    let centre = 0.6 * 0.8 + 0.4 * 1.1;
    let about = |inertia: f64, mass: f64, down: f64| inertia + mass * (down - centre) * (down - centre);
    one.bodies[1].motion = body(1.0, about(0.02, 0.6, 0.8) + about(0.01, 0.4, 1.1), centre);
    let (a, b) = (history(&run(&one)), history(&run(&two)));
    for ((t, one, _), (_, two, _)) in a.iter().zip(&b) {
        assert!((one - two).abs() < 1e-6, "{one} against {two} at {t}");
    }
}

fn ideal(mut scene: Scene) -> Scene {
    for joint in &mut scene.joints {
        if matches!(joint.kind, JointKind::Clearance(_)) {
            joint.kind = JointKind::Revolute;
        }
    }
    scene.outputs.retain(|o| !matches!(o.kind, OutputKind::LargestWear { .. }));
    (scene.limit_states, scene.variables) = (vec![], vec![]);
    scene
}

/// Constant speed: the drive's torque is dT/dtheta of the kinetic energy, here from the kinematics alone.
#[test]
fn driving_torque_is_the_rate_of_the_kinetic_energy() {
    let mut scene = ideal(scene("slider-crank", &[]));
    scene.outputs.retain(|o| o.name == "crank_torque");
    scene.loads.clear();
    let (r, l, omega) = (0.05, 0.12, 5000.0 * RPM);
    let mass = |name: &str| match scene.bodies.iter().find(|b| b.name == name).expect("a body").motion {
        Motion::Free { mass, inertia, .. } => (mass, inertia),
        _ => panic!("free"),
    };
    let ((rod, rod_inertia), (slider, _)) = (mass("rod"), mass("slider"));
    // Rod angle phi: r sin theta + l sin phi = 0; centre of mass in the middle of the rod.
    let kinetic = |theta: f64| {
        let sin_phi = -r * theta.sin() / l;
        let cos_phi = (1.0 - sin_phi * sin_phi).sqrt();
        let phi_rate = -r * omega * theta.cos() / (l * cos_phi);
        let pin = [-r * omega * theta.sin(), r * omega * theta.cos()];
        let of = |s: f64| [pin[0] - s * phi_rate * sin_phi, pin[1] + s * phi_rate * cos_phi];
        let (centre, end) = (of(0.5 * l), of(l));
        0.5 * rod * (centre[0] * centre[0] + centre[1] * centre[1])
            + 0.5 * rod_inertia * phi_rate * phi_rate
            + 0.5 * slider * end[0] * end[0]
    };
    let torque = |theta: f64| (kinetic(theta + 1e-5) - kinetic(theta - 1e-5)) / 2e-5;
    let angles = (0..20_000).map(|k| TAU * f64::from(k) / 20_000.0);
    let largest = angles.map(|theta| torque(theta).abs()).fold(0.0, f64::max);
    let evaluation = run(&scene);
    let found = evaluation.histories[0][0];
    assert!((found / largest - 1.0).abs() < 1e-5, "{found} against {largest} N m");
    // Over the cycle, with its sign.
    let cycle = evaluation.first_cycle.expect("it is shown");
    let [(body, shown)] = &cycle.driving_torque[..] else { panic!("one driven body") };
    let crank = cycle.motion.iter().find(|motion| motion.body == *body).expect("it turns");
    assert_eq!((body.as_str(), shown.len()), ("crank", cycle.time.len()));
    for (found, angle) in shown.iter().zip(&crank.angle) {
        assert!((found - torque(*angle)).abs() < 1e-3 * largest, "{found} at {angle}, {}", torque(*angle));
    }
}

/// A pull holds the pin at the far side of its bore: the rod is longer by clearance and penetration.
#[test]
fn errors_of_a_pulled_slider_are_those_of_a_longer_rod() {
    const PULL: f64 = 100.0;
    let mut scene = scene("slider-crank", &[("bodies.crank.speed", 30.0 * RPM)]);
    every_joint(&mut scene, |c| {
        (c.friction, c.film_damping, c.wear_coefficient) = (0.0, 200.0, 0.0);
        c.contact_damping = ContactDamping::None;
    });
    for body in &mut scene.bodies {
        if let Motion::Free { mass, inertia, .. } = &mut body.motion {
            (*mass, *inertia) = (*mass * 1e-2, *inertia * 1e-2);
        }
    }
    let slider = scene.bodies.iter().position(|b| b.name == "slider").expect("it has one");
    let at = Attachment { body: slider, position: [0.0; 2] };
    scene.loads.push(Load::ConstantForce { name: "pull".into(), at, force: [PULL, 0.0] });
    let rod = scene.bodies.iter().position(|b| b.name == "rod").expect("it has one");
    let measures = [ErrorMeasure::Largest, ErrorMeasure::RootMeanSquare];
    let wanted = || [None, None];
    scene.outputs = measures
        .iter()
        .flat_map(|&measure| {
            [
                OutputKind::PositionError { at, wanted: wanted(), measure },
                OutputKind::AngleError { body: rod, wanted: None, measure },
            ]
        })
        .enumerate()
        .map(|(k, kind)| Output { name: format!("error_{k}"), kind })
        .collect();
    (scene.limit_states, scene.variables) = (vec![], vec![]);
    let evaluation = simulate(&scene, &Accuracy::balanced(), SimulateOptions::default()).expect("simulated");
    let clearance = scene.joints.iter().find_map(|j| match &j.kind {
        JointKind::Clearance(c) => Some(c.clone()),
        _ => None,
    });
    let clearance = clearance.expect("it has one");
    let stiffness = worker::contact::hertz_stiffness(&clearance);
    let (r, l) = (0.05_f64, 0.12_f64);
    let errors: Vec<[f64; 2]> = (0..3600)
        .map(|k| TAU * f64::from(k) / 3600.0)
        .map(|theta| {
            let side = r * theta.sin();
            let force = PULL / (1.0 - side * side / (l * l)).sqrt();
            let longer = l + clearance.radial_clearance() + (force / stiffness).powf(2.0 / 3.0);
            let position = (longer * longer - side * side).sqrt() - (l * l - side * side).sqrt();
            [position, (side / l).asin() - (side / longer).asin()]
        })
        .collect();
    for quantity in 0..2 {
        let all = || errors.iter().map(|error| error[quantity].abs());
        let largest = all().fold(0.0, f64::max);
        let rms = (all().map(|e| e * e).sum::<f64>() / 3600.0).sqrt();
        for (k, exact) in [(quantity, largest), (2 + quantity, rms)] {
            let found = evaluation.histories[k][0];
            assert!((found / exact - 1.0).abs() < 1e-4, "output {k}: {found} against {exact}");
        }
    }
}

/// Published for the drive with vanishing clearances: 0.927 deg and 20.33 r/min.
#[test]
fn the_flapping_wing_with_ideal_joints_has_the_published_asymmetry() {
    let mut scene = ideal(scene("flapping-wing", &[]));
    let OutputKind::AngularVelocityDifference { a, b } = scene.outputs[0].kind.clone() else {
        panic!("the asymmetry")
    };
    scene.outputs.push(Output { name: "angle".into(), kind: OutputKind::AngleDifference { a, b } });
    let evaluation = run(&scene);
    let (speed, angle) = (evaluation.histories[0][0] / RPM, evaluation.histories[1][0].to_degrees());
    assert!((speed / 20.33 - 1.0).abs() < 0.01 && (angle / 0.927 - 1.0).abs() < 0.01, "{speed} {angle}");
    assert!(evaluation.diagnostics.constraint_drift < 1e-9);
    // The same turn by a table of angles, which a spline of equal steps has exactly.
    let period = scene.life.period;
    for body in &mut scene.bodies {
        if let Motion::Driven { drive, .. } = &mut body.motion {
            let at: Vec<f64> = (0..=12).map(|k| period * f64::from(k) / 12.0).collect();
            let value = (0..=12).map(|k| TAU * f64::from(k) / 12.0).collect();
            *drive = Drive::Angle(Table { at, value, repeat: true });
        }
    }
    let table = run(&scene);
    for (a, b) in evaluation.histories.iter().zip(&table.histories) {
        assert!((a[0] / b[0] - 1.0).abs() < 1e-9, "{a:?} against {b:?}");
    }
}
