//! Mechanisms with ideal joints against published solutions and closed forms.

use crate::scenes::{scene, shown as run};
use common::accuracy::Accuracy;
use common::failure::SimulationFailure;
use common::outputs::{BodyMotion, Evaluation};
use common::scene::{JointKind, Motion, Scene};
use worker::integrate::Dynamics;
use worker::mechanism::{Island, ideal_cycle, islands};
use worker::simulate::{SimulateOptions, simulate};

fn motion<'e>(evaluation: &'e Evaluation, body: &str) -> &'e BodyMotion {
    let cycle = evaluation.first_cycle.as_ref().expect("asked for");
    cycle.motion.iter().find(|m| m.body == body).expect("the body moves")
}

/// IFToMM library A01: m = 1, L = 1, g = 9.81, released from the horizontal at x = -1. Closed form by elliptic
/// functions; period 2.367841947576237 s.
#[test]
fn pendulum_is_where_the_closed_form_has_it() {
    let scene = scene("pendulum", &[]);
    for (accuracy, bound) in [(Accuracy::reference(), 1e-6), (Accuracy::balanced(), 1e-5)] {
        let evaluation = run(&scene, &accuracy);
        let angle = &motion(&evaluation, "pendulum").angle;
        // The mass hangs at (sin, -cos) of the angle. 1001 values over 10 s: number 500 is that at 5 s.
        for (k, x, y) in
            [(500, -0.9423054350437567, -0.3347543384140022), (1000, -0.275087462576117, -0.961419205099125)]
        {
            let off = (angle[k].sin() - x).hypot(-angle[k].cos() - y);
            assert!(off < bound, "{off} at value {k}");
        }
        // A whole number of periods later the mass is back at rest where it began.
        let at_period: f64 = 2.367841947576237 * 100.0;
        let (k, s) = (at_period as usize, at_period.fract());
        let back = angle[k] + s * (angle[k + 1] - angle[k]);
        assert!((back - angle[0]).abs() < 1e-4, "{back}");
        // Tension m (v^2 / L + g cos): 3 m g below the hinge.
        let peak = evaluation.histories[0][0];
        assert!((peak / (3.0 * 9.81) - 1.0).abs() < 1e-5, "{peak} N");
        let energy = evaluation.diagnostics.energy.expect("asked for");
        assert!(energy.stored.abs() < 1e-5 * 9.81, "{} J", energy.stored);
        assert!(evaluation.diagnostics.constraint_drift < 1e-9);
    }
}

/// IFToMM library A03 and the IVP test set: Andrews' squeezer mechanism after 0.03 s.
#[test]
fn squeezer_is_where_the_reference_solution_has_it() {
    let scene = scene("andrews-squeezer", &[]);
    let evaluation = run(&scene, &Accuracy::reference());
    let last = |values: &[f64]| *values.last().expect("a cycle has values");
    let (mut angle, mut speed) = ([0.0; 7], [0.0; 7]);
    for k in 0..7 {
        let body = motion(&evaluation, &format!("K{}", k + 1));
        (angle[k], speed[k]) = (last(&body.angle), last(&body.speed));
    }
    // The test set counts K2, K4 and K6 from K1, K5 and K7.
    let relative = |x: [f64; 7]| [x[0], x[1] - x[0], x[2], x[3] - x[4], x[4], x[5] - x[6], x[6]];
    let q = [
        15.81077119629904,
        -15.75637105984298,
        0.04082224013073101,
        -0.5347301163226948,
        0.5244099658805304,
        0.5347301163226948,
        1.048080741042263,
    ];
    let qdot = [
        1139.920302151208,
        -1424.379294994111,
        11.03291221937134,
        19.29337464421385,
        0.5735699284790808,
        -19.29337464421385,
        0.3231791658026955,
    ];
    for (k, (found, published)) in relative(angle).iter().zip(q).enumerate() {
        assert!((found - published).abs() < 1e-6, "angle {k}: {found} against {published}");
    }
    for (k, (found, published)) in relative(speed).iter().zip(qdot).enumerate() {
        assert!((found - published).abs() < 1e-5 * 1424.0, "speed {k}: {found} against {published}");
    }
}

fn ideal_slider_crank() -> Scene {
    let mut scene = scene("slider-crank", &[]);
    for joint in &mut scene.joints {
        if matches!(joint.kind, JointKind::Clearance(_)) {
            joint.kind = JointKind::Revolute;
        }
    }
    scene.outputs.retain(|output| output.name == "crank_torque" || output.name == "pin_force");
    (scene.limit_states, scene.variables) = (vec![], vec![]);
    scene
}

/// Coordinates and rates of an island at the start of the ideal motion.
fn start(scene: &Scene, island: &Island) -> (Vec<f64>, Vec<f64>) {
    let pose = ideal_cycle(scene, 2, &mut 0).expect("it closes").swap_remove(0);
    let pick =
        |from: &[Option<[f64; 3]>]| island.bodies.iter().flat_map(|&b| from[b].expect("free")).collect();
    (pick(&pose.q), pick(&pose.v))
}

/// omega^2 r (1 + r / l) at inner dead centre, Flores' dimensions.
#[test]
fn ideal_slider_crank_has_the_acceleration_of_the_closed_form() {
    let scene = ideal_slider_crank();
    let mut found = islands(&scene).expect("it is modelled");
    let island = &mut found[0];
    let (q, v) = start(&scene, island);
    let mut at = island.linearised();
    island.linearise(0.0, &q, &v, &mut at);
    let slider = island.bodies.iter().position(|&b| scene.bodies[b].name == "slider").expect("it has one");
    let Motion::Free { mass, .. } = scene.bodies[island.bodies[slider]].motion else { panic!("free") };
    let acceleration = -at.f[3 * slider] / mass;
    let omega = 5000.0 * std::f64::consts::TAU / 60.0;
    let closed = omega * omega * 0.05 * (1.0 + 0.05 / 0.12);
    assert!((acceleration / closed - 1.0).abs() < 1e-12, "{acceleration} against {closed}");
    assert!((closed - 1.942e4).abs() < 5.0);
}

/// Of a rigid mechanism without losses the drive gives and takes the kinetic energy, nothing else.
#[test]
fn ideal_slider_crank_follows_its_kinematics_and_balances_its_energy() {
    let scene = ideal_slider_crank();
    let evaluation = run(&scene, &Accuracy::reference());
    let (crank, slider) = (motion(&evaluation, "crank"), motion(&evaluation, "slider"));
    for (angle, position) in crank.angle.iter().zip(&slider.position) {
        let x = 0.05 * angle.cos() + (0.12 * 0.12 - (0.05 * angle.sin()).powi(2)).sqrt();
        assert!((position[0] - x).abs() < 1e-11 && position[1].abs() < 1e-13, "{position:?} against {x}");
    }
    let energy = evaluation.diagnostics.energy.expect("asked for");
    assert!(energy.residual().abs() < 1e-4 * energy.turnover, "{energy:?}");
    assert!(energy.turnover > 100.0, "{energy:?}");
}

#[test]
fn a_change_of_point_is_a_dead_point() {
    // A parallelogram: coupler as long as the ground, crank as long as the rocker. At 180 deg all four lie in line.
    let settings = [
        ("parameters.rocker_length", 20e-3),
        ("parameters.coupler_length", 70e-3),
        ("parameters.crank_length", 20e-3),
    ];
    let mut scene = scene("four-bar", &settings);
    for body in &mut scene.bodies {
        if let Motion::Free { start_position, start_angle, .. } = &mut body.motion {
            (*start_angle, *start_position) = match body.name.as_str() {
                "coupler" => (0.0, [20e-3 * 1f64.cos(), 20e-3 * 1f64.sin()]),
                _ => (1.0, *start_position),
            };
        }
        if let Motion::Driven { drive: common::scene::Drive::ConstantSpeed { start_angle, .. }, .. } =
            &mut body.motion
        {
            *start_angle = 1.0;
        }
    }
    match ideal_cycle(&scene, 2, &mut 0) {
        Err(SimulationFailure::DeadPoint { body, angle, .. }) => {
            assert_eq!(body, "crank");
            assert!((angle.to_degrees() - 180.0).abs() < 0.01, "{} deg", angle.to_degrees());
        }
        other => panic!("{other:?}"),
    }
}

#[test]
fn a_motion_forbidden_twice_is_over_constrained() {
    let mut scene = ideal_slider_crank();
    let mut twice = scene.joints.iter().find(|j| j.name == "guide").expect("it has one").clone();
    twice.name = "second guide".into();
    scene.joints.push(twice);
    match simulate(&scene, &Accuracy::draft(), SimulateOptions::default()) {
        Err(SimulationFailure::OverConstrained { joint }) => assert_eq!(joint, "second guide"),
        other => panic!("{other:?}"),
    }
}

/// Cycles of nearly the same slider-crank, over which its free flight is averaged.
const CHAOTIC_CYCLES: u32 = 8;

/// Flores, Ambrosio, Claro and Lankarani (2008), a slider-crank with a dry revolute joint of 0.5 mm clearance: three
/// modes of motion between journal and bushing (free flight, impact, following), forces well above those of the
/// ideal joint. Their results are curves and the motion is chaotic: this is about behaviour, not digits.
#[test]
fn slider_crank_with_clearance_flies_strikes_and_follows() {
    let ideal = ideal_slider_crank();
    let output = |scene: &Scene, name: &str| {
        scene.outputs.iter().position(|o| o.name == name).expect("it is asked for")
    };
    let ideal_peak = run(&ideal, &Accuracy::balanced()).histories[output(&ideal, "pin_force")][0];
    for accuracy in [Accuracy::balanced(), Accuracy::reference()] {
        // The share of free flight of one cycle is chance: lengths that differ by 1e-13 give from 0 to 5 %. So it is the mean over
        // several of them.
        let mut flights = Vec::new();
        for k in 0..CHAOTIC_CYCLES {
            let crank_length = 50e-3 * (1.0 + 1e-13 * f64::from(k));
            let mut scene = scene("slider-crank", &[("parameters.crank_length", crank_length)]);
            for joint in &mut scene.joints {
                if let JointKind::Clearance(clearance) = &mut joint.kind {
                    clearance.wear_coefficient = 0.0;
                }
            }
            let evaluation = run(&scene, &accuracy);
            let (_, flight) = &evaluation.diagnostics.free_flight_fraction[0];
            flights.push(*flight);
            let cycle = evaluation.first_cycle.as_ref().expect("asked for");
            let (_, force) =
                cycle.joint_force.iter().find(|(name, _)| name == "piston_pin").expect("it has one");
            let peak = evaluation.histories[output(&scene, "pin_force")][0];
            // Neighbouring values are a thousandth of the cycle, 12 us, apart.
            let steepest = force.windows(2).map(|w| (w[1] - w[0]).abs()).fold(0.0, f64::max);
            let mut following: (usize, usize) = (0, 0);
            for &f in force {
                following.0 = if f > 0.0 { following.0 + 1 } else { 0 };
                following.1 = following.1.max(following.0);
            }
            println!(
                "ideal {ideal_peak:.0} N, peak {peak:.0} N, rise {steepest:.0} N, flight {flight:.4}, following {following:?}"
            );
            assert!(*flight < 0.2, "free flight for {flight} of the cycle");
            // Without clearance it is 2 pi / 1000 of the peak.
            assert!(steepest > 0.1 * ideal_peak, "impact: the force changes by {steepest} N within 12 us");
            assert!(following.1 > 100, "following: in contact for {} thousandths of the cycle", following.1);
            assert!(peak > 1.2 * ideal_peak, "{peak} N against {ideal_peak} N without clearance");
            // The slider strays by little more than the clearance.
            let strayed = evaluation.histories[output(&scene, "slider_error")][0];
            assert!((0.5e-3..0.7e-3).contains(&strayed), "{strayed} m");
        }
        let mean = flights.iter().sum::<f64>() / flights.len() as f64;
        assert!(mean > 1e-3, "free flight for {mean} of the cycle in the mean");
    }
}
