//! Friction of ideal joints: its derivatives against differences, and the moment on the crank of a slider-crank against statics.

use super::derivative::{check, everything, states};
use crate::integrate::Dynamics;
use crate::mechanism::{ideal_cycle, islands};
use common::scene::*;
use std::f64::consts::TAU;

const CRANK: f64 = 0.05;
const ROD: f64 = 0.12;
const SPEED: f64 = 3.0;
/// Force on the slider towards the crank [N].
const LOAD: f64 = 100.0;
/// Coefficient, regularisation speed and radius or length at the pin of the crank, that of the slider, and the guide.
const PIN: [IdealFriction; 3] = [
    IdealFriction { coefficient: 0.1, speed: 1e-2, size: 0.008 },
    IdealFriction { coefficient: 0.15, speed: 1e-2, size: 0.006 },
    IdealFriction { coefficient: 0.2, speed: 1e-2, size: 0.03 },
];

/// A slider-crank of bodies as good as without mass, with friction in every joint.
fn slider_crank() -> Scene {
    let mut scene = SceneSource::builtin("pendulum").expect("built in").nominal().clone();
    let free = |x: f64| Motion::Free {
        mass: 1e-9,
        inertia: 1e-13,
        centre_of_mass: [0.0; 2],
        start_position: [x, 0.0],
        start_angle: 0.0,
        start_velocity: None,
        start_speed: None,
    };
    let drive = Drive::ConstantSpeed { start_angle: 0.0, speed: SPEED };
    let body = |name: &str, motion| Body { name: name.into(), motion, points: vec![] };
    scene.bodies = vec![
        body("frame", Motion::Fixed),
        body("crank", Motion::Driven { position: [0.0; 2], drive, inertia: None }),
        body("rod", free(CRANK + 0.5 * ROD)),
        body("slider", free(CRANK + ROD)),
    ];
    let at = |body: usize, x: f64| Attachment { body, position: [x, 0.0] };
    let joint = |name: &str, journal, bushing, kind, friction| Joint {
        name: name.into(),
        journal,
        bushing,
        kind,
        friction: Some(friction),
    };
    let slide = JointKind::Prismatic { axis: 0.0, angle: 0.0 };
    scene.joints = vec![
        joint("crank", at(2, -0.5 * ROD), at(1, CRANK), JointKind::Revolute, PIN[0]),
        joint("slider", at(3, 0.0), at(2, 0.5 * ROD), JointKind::Revolute, PIN[1]),
        joint("guide", at(3, 0.0), at(0, 0.0), slide, PIN[2]),
    ];
    scene.loads = vec![Load::ConstantForce { name: "load".into(), at: at(3, 0.0), force: [-LOAD, 0.0] }];
    scene.gravity = [0.0; 2];
    scene.life.period = TAU / SPEED;
    scene
}

/// Moment of the rod on the crank at the crank angle `theta`, from statics; one if the slider bears on the ends of its guide, else zero.
///
/// The force S that the rod transmits to the slider is turned from the rod's line by the moments of friction M in its pins, as a tangent
/// of the friction circles is: l |S| sin(beta - psi) = M_crank + M_slider. Along the guide S_x = LOAD + mu N.
fn moment_on_crank(theta: f64) -> (f64, usize) {
    let pin = [CRANK * theta.cos(), CRANK * theta.sin()];
    let psi = (-pin[1] / ROD).asin();
    let rod_speed = -CRANK * SPEED * theta.cos() / (ROD * psi.cos());
    let slider_speed = -pin[1] * SPEED - ROD * psi.sin() * rod_speed;
    // Moments on the rod over |S|, against its rotation on either pin, and the ratio F / N of the guide.
    let ratio = |k: usize, v: f64| PIN[k].coefficient * (v / PIN[k].speed).tanh();
    let on_rod = [
        -PIN[0].size * ratio(0, PIN[0].size * (rod_speed - SPEED)),
        -PIN[1].size * ratio(1, PIN[1].size * rod_speed),
    ];
    let beta = psi + ((on_rod[0] + on_rod[1]) / ROD).asin();
    let (one_side, ends) = (beta.sin().abs(), 2.0 * on_rod[1].abs() / PIN[2].size);
    let force = LOAD / (beta.cos() - ratio(2, slider_speed) * one_side.max(ends));
    let moment = -force * (pin[0] * beta.sin() - pin[1] * beta.cos()) - force * on_rod[0];
    (moment, usize::from(ends > one_side))
}

#[test]
fn the_moment_on_the_crank_is_that_of_statics_with_friction() {
    let scene = slider_crank();
    let poses = ideal_cycle(&scene, 73, &mut 0).expect("it goes round");
    let mut found = islands(&scene).expect("it is modelled");
    let [island] = found.as_mut_slice() else { panic!("one island") };
    let crank = island.touched.iter().position(|body| *body == 1).expect("driven");
    let (mut without, mut on_ends) = (0.0_f64, 0);
    for pose in &poses {
        let pick = |from: &[Option<[f64; 3]>]| -> Vec<f64> {
            island.bodies.iter().flat_map(|&b| from[b].expect("free")).collect()
        };
        let (q, v) = (pick(&pose.q), pick(&pose.v));
        let mut at = island.linearised();
        island.linearise(pose.time, &q, &v, &mut at);
        let theta = SPEED * pose.time;
        let (exact, ends) = moment_on_crank(theta);
        let moment = at.prescribed[crank][2];
        assert!((moment - exact).abs() < 1e-7, "{moment} N m against {exact} N m at {theta}");
        on_ends += ends;
        let psi = (-CRANK * theta.sin() / ROD).asin();
        without = without.max((exact - LOAD * CRANK * (theta - psi).sin() / psi.cos()).abs());
    }
    assert!(without > 0.3, "friction changes the moment by up to {without} N m");
    assert!((4..40).contains(&on_ends), "{on_ends} positions on the ends of the guide");
}

/// [`everything`] with friction in every joint that slides, on pins and in the guide, at speeds where tanh bends.
fn everything_rubs() -> Scene {
    let mut scene = everything();
    for (joint, coefficient, size) in [(0, 0.15, 0.02), (1, 0.3, 0.015), (2, 0.2, 0.08), (3, 0.25, 0.01)] {
        scene.joints[joint].friction = Some(IdealFriction { coefficient, speed: 0.4, size });
    }
    scene
}

#[test]
fn derivatives_with_friction_in_ideal_joints_agree_with_differences() {
    let (mut on_ends, mut on_one_side) = (0, 0);
    for length in [0.01, 0.02, 0.08, 0.4] {
        let mut scene = everything_rubs();
        if let Some(friction) = &mut scene.joints[2].friction {
            friction.size = length;
        }
        let mut found = islands(&scene).expect("it is modelled");
        let [island] = found.as_mut_slice() else { panic!("one island") };
        for state in states(&scene, island) {
            check(island, &state, [1e-7, 1e-6, 1e-5, 1e-4, 1e-6], 1e-4, "friction");
            let mut at = island.linearised();
            island.clone().linearise(state.0, &state.1, &state.2, &mut at);
            assert_eq!((at.balanced, at.friction.len()), (Some(1.0), 4));
            assert!(at.friction.iter().all(|[force, speed]| force * speed > 0.0), "{:?}", at.friction);
            // The guide's rows follow those of two pins.
            let tilted = 2.0 * at.lambda[5].abs() > length * at.lambda[4].abs();
            *(if tilted { &mut on_ends } else { &mut on_one_side }) += 1;
        }
    }
    assert!(
        on_ends > 2 && on_one_side > 2,
        "{on_ends} states on the guide's ends, {on_one_side} on one side"
    );
}
