//! Friction of ideal joints against closed forms: a block on a slope, a pendulum, a wedge that holds its load, and one that locks itself.

use crate::scenes::{reference_shown as run, scene};
use common::accuracy::Accuracy;
use common::failure::SimulationFailure;
use common::outputs::{EnergyBalance, Evaluation};
use common::scene::*;
use worker::simulate::{SimulateOptions, simulate};

const GRAVITY: f64 = 9.81;

fn friction(coefficient: f64, speed: f64, size: f64) -> Option<IdealFriction> {
    Some(IdealFriction { coefficient, speed, size })
}

fn body(name: &str, mass: f64, inertia: f64, start: [f64; 2], angle: f64, velocity: [f64; 2]) -> Body {
    let motion = Motion::Free {
        mass,
        inertia,
        centre_of_mass: [0.0; 2],
        start_position: start,
        start_angle: angle,
        start_velocity: (velocity != [0.0; 2]).then_some(velocity),
        start_speed: None,
    };
    Body { name: name.into(), motion, points: vec![] }
}

fn place(body: usize, position: [f64; 2]) -> Attachment {
    Attachment { body, position }
}

/// A mechanism under gravity, seen from its start for `period` [s].
fn mechanism(bodies: Vec<Body>, joints: Vec<Joint>, period: f64) -> Scene {
    let mut scene = scene("pendulum", &[]);
    scene.bodies.truncate(1);
    scene.bodies.extend(bodies);
    scene.joints = joints;
    scene.gravity = [0.0, -GRAVITY];
    scene.life.period = period;
    scene
}

fn guide(name: &str, slider: usize, on: usize, axis: f64, friction: Option<IdealFriction>) -> Joint {
    let kind = JointKind::Prismatic { axis, angle: 0.0 };
    Joint {
        name: name.into(),
        journal: place(slider, [0.0; 2]),
        bushing: place(on, [0.0; 2]),
        kind,
        friction,
    }
}

/// Every (time, x, y, angle) of body `k` of the free ones.
fn history(evaluation: &Evaluation, k: usize) -> Vec<[f64; 4]> {
    let cycle = evaluation.first_cycle.as_ref().expect("asked for");
    let motion = &cycle.motion[k];
    let values = cycle.time.iter().zip(&motion.position).zip(&motion.angle);
    values.map(|((&t, x), &angle)| [t, x[0], x[1], angle]).collect()
}

fn energy(evaluation: &Evaluation) -> EnergyBalance {
    evaluation.diagnostics.energy.expect("of a displayed cycle")
}

/// Checks that input, stored and dissipated energy balance to `bound` of the turnover.
fn balances(evaluation: &Evaluation, bound: f64) {
    let EnergyBalance { input, stored, dissipated, turnover, .. } = energy(evaluation);
    let off = (input - stored - dissipated).abs();
    assert!(off < bound * turnover, "off by {off} J of {turnover} J");
}

/// A block on a slope of this angle [rad], along which it starts at `speed` [m/s], downwards positive. It bears on 0.2 m of the slope,
/// 0.05 m below its centre of mass: the moment of the friction moves the force within these 0.2 m.
fn block(slope: f64, mu: f64, speed: f64, period: f64) -> Scene {
    let (sin, cos) = slope.sin_cos();
    let block = body("block", 2.0, 0.01, [0.0; 2], 0.0, [-cos * speed, -sin * speed]);
    let mut slope = guide("slope", 1, 0, slope, friction(mu, 1e-4, 0.2));
    let below = [0.05 * sin, -0.05 * cos];
    (slope.journal.position, slope.bushing.position) = (below, below);
    mechanism(vec![block], vec![slope], period)
}

/// Way down a slope in every state of a block.
fn way(evaluation: &Evaluation) -> Vec<(f64, f64)> {
    history(evaluation, 0).iter().map(|[t, x, y, _]| (*t, x.hypot(*y))).collect()
}

#[test]
fn a_block_slides_down_a_slope_as_in_closed_form() {
    for (slope, mu) in [(0.5_f64, 0.2), (0.3, 0.4)] {
        // It starts at 3 m/s, so fast that tanh is one, and does not stop.
        let a = GRAVITY * (slope.sin() - mu * slope.cos());
        let evaluation = run(&block(slope, mu, 3.0, 1.0));
        for (t, s) in way(&evaluation) {
            let exact = 3.0 * t + 0.5 * a * t * t;
            assert!((s - exact).abs() < 1e-9 * (1.0 + exact), "{s} against {exact} at {t}");
        }
        // Force of the guide, N and F together; the heat is that of F over the way.
        let normal = 2.0 * GRAVITY * slope.cos();
        let force = evaluation.histories[0][0];
        assert!((force / (normal * (1.0 + mu * mu).sqrt()) - 1.0).abs() < 1e-9, "{force} N");
        let heat = mu * normal * (3.0 + 0.5 * a);
        assert!((energy(&evaluation).dissipated / heat - 1.0).abs() < 1e-5, "{:?}", energy(&evaluation));
        balances(&evaluation, 1e-5);
    }
}

#[test]
fn a_block_below_the_angle_of_friction_comes_to_rest_and_creeps() {
    // mu tanh(v / v_0) = tan(slope) at the creeping speed; stopping from 1 m/s takes 1 / (2 (mu cos - sin) g) m.
    let (slope, mu) = (0.3_f64, 0.5);
    let evaluation = run(&block(slope, mu, 1.0, 2.0));
    let found = way(&evaluation);
    let (last, before) = (found[found.len() - 1], found[found.len() - 200]);
    let creep = 1e-4 * (slope.tan() / mu).atanh();
    let speed = (last.1 - before.1) / (last.0 - before.0);
    assert!((speed / creep - 1.0).abs() < 1e-4, "{speed} m/s against {creep} m/s");
    let stop = 0.5 / (GRAVITY * (mu * slope.cos() - slope.sin()));
    assert!((last.1 - stop).abs() < 3.0 * creep, "{} m against {stop} m", last.1);
    balances(&evaluation, 1e-4);
}

/// Square of the angular velocity of a pendulum with a mass point, over g / l, at `angle` in a swing in the direction `sign` that began at
/// rest at `start`: w' + k w = -2 sin - k cos with k = 2 e `sign`, e the friction's moment over the length and the tension of the rod.
fn swing(angle: f64, start: f64, sign: f64, e: f64) -> f64 {
    let k = 2.0 * e * sign;
    let particular = |x: f64| (-3.0 * k * x.sin() + (2.0 - k * k) * x.cos()) / (1.0 + k * k);
    particular(angle) - particular(start) * (-k * (angle - start)).exp()
}

/// Angle at which such a swing ends, by bisection beyond the lowest point.
fn end_of_swing(start: f64, sign: f64, e: f64) -> f64 {
    let (mut moving, mut still) = (0.0, -start);
    for _ in 0..100 {
        let middle = 0.5 * (moving + still);
        if swing(middle, start, sign, e) > 0.0 { moving = middle } else { still = middle }
    }
    moving
}

#[test]
fn the_swings_of_a_pendulum_shrink_as_in_closed_form() {
    let (mu, radius, length, start) = (0.2, 0.05, 1.5, 1.2_f64);
    // As good as a mass point: the inertia changes w by 1e-7 of itself.
    let mut scene = scene(
        "pendulum",
        &[
            ("parameters.length", length),
            ("bodies.pendulum.start_angle", start),
            ("bodies.pendulum.inertia", 1e-7),
        ],
    );
    scene.joints[0].friction = friction(mu, 1e-4, radius);
    let evaluation = run(&scene);
    // The pin also bears the force along the path that holds the friction's moment: |N| is the tension over sqrt(1 - (mu r / l)^2).
    let moment = mu * radius / length;
    let e = moment / (1.0 - moment * moment).sqrt();
    let angle = &evaluation.first_cycle.as_ref().expect("asked for").motion[0].angle;
    let (mut from, mut sign, mut swings) = (start, -1.0, 0);
    for x in angle.windows(3).filter(|x| (x[1] - x[0]) * (x[2] - x[1]) < 0.0) {
        // The vertex of the parabola through three angles.
        let (slope, bend) = (0.5 * (x[2] - x[0]), x[2] - 2.0 * x[1] + x[0]);
        let turned = x[1] - 0.5 * slope * slope / bend;
        (from, sign, swings) = (end_of_swing(from, sign, e), -sign, swings + 1);
        assert!((turned - from).abs() < 2e-6, "{turned} against {from} after {swings} swings");
    }
    assert!(swings == 7 && from.abs() < start - 0.1, "{swings} swings to {from}");
    balances(&evaluation, 1e-5);
}

/// tan of the slope of the wedge, and friction on it.
const SLOPE: f64 = 0.1;
const MU: f64 = 0.3;
const SLOW: f64 = 1e-4;

/// A load of mass `load` [kg] in a vertical guide, on a wedge of 1 kg that it drives out sidewards from the speed `start` [m/s], with
/// friction between the two: the shoe of the load slides on the wedge as a nut on a thread.
fn jack(load: f64, start: f64, period: f64) -> Scene {
    let down = [0.0, -start * SLOPE];
    let bodies = vec![
        body("wedge", 1.0, 0.01, [0.0; 2], 0.0, [start, 0.0]),
        body("load", load, 0.01, [0.0; 2], 0.0, down),
        body("shoe", 1e-6, 1e-9, [0.0; 2], 0.0, down),
    ];
    let hinge = Joint {
        name: "hinge".into(),
        journal: place(3, [0.0; 2]),
        bushing: place(2, [0.0; 2]),
        kind: JointKind::Revolute,
        friction: None,
    };
    let up = std::f64::consts::FRAC_PI_2;
    // The rail lies below the wedge.
    let mut rail = guide("rail", 1, 0, 0.0, None);
    (rail.journal.position, rail.bushing.position) = ([0.0, -0.05], [0.0, -0.05]);
    let joints = vec![
        rail,
        guide("column", 2, 0, up, None),
        guide("thread", 3, 1, SLOPE.atan(), friction(MU, SLOW, 0.05)),
        hinge,
    ];
    mechanism(bodies, joints, period)
}

#[test]
fn a_jack_slows_its_load_down_as_in_closed_form_and_holds_it() {
    let (sin, cos) = SLOPE.atan().sin_cos();
    let evaluation = run(&jack(5.0, 1.0, 2.0));
    // Normal force N of 5 kg on a wedge of 1 kg, accelerated by N (sin - mu cos).
    let normal = 5.0 * GRAVITY / (5.0 * SLOPE * (sin - MU * cos) + cos + MU * sin);
    let a = normal * (sin - MU * cos);
    let stopped = -1.0 / a;
    let found = history(&evaluation, 0);
    for [t, x, ..] in found.iter().take_while(|at| at[0] < 0.99 * stopped) {
        let exact = t + 0.5 * a * t * t;
        assert!((x - exact).abs() < 1e-6, "{x} m against {exact} m at {t}");
    }
    // It creeps where mu tanh is the tangent of the slope; the wedge moves by the cosine of the way on it.
    let (last, before) = (found[found.len() - 1], found[found.len() - 200]);
    let (creep, speed) = (SLOW * (SLOPE / MU).atanh() * cos, (last[1] - before[1]) / (last[0] - before[0]));
    assert!((speed / creep - 1.0).abs() < 1e-4, "{speed} m/s against {creep} m/s");
    balances(&evaluation, 1e-4);
}

fn locks(scene: &Scene) -> (f64, String) {
    match simulate(scene, &Accuracy::balanced(), SimulateOptions { first_cycle: false }) {
        Err(SimulationFailure::SelfLocking { time, joint, .. }) => (time, joint),
        other => panic!("{other:?}"),
    }
}

#[test]
fn a_load_that_drives_a_self_locking_jack_is_refused_by_name() {
    // The normal force of the closed form is negative from 51.5 kg on: nothing balances a moving load.
    assert_eq!(locks(&jack(100.0, 1.0, 1.0)), (0.0, "thread".into()));
    // At rest the same load is held.
    let found = history(&run(&jack(100.0, 0.0, 1.0)), 0);
    let (creep, way) = (SLOW * (SLOPE / MU).atanh() * SLOPE.atan().cos(), found[found.len() - 1][1]);
    assert!((way / creep - 1.0).abs() < 1e-2, "{way} m against {creep} m");
}

#[test]
fn a_slider_crank_whose_guide_locks_it_is_refused_at_that_angle() {
    // A rod that pulls at the angle psi to the guide: R (cos - mu sin) = F has no solution beyond tan psi = 1 / mu.
    let (crank, rod, mu, speed) = (0.09, 0.1, 0.6_f64, 0.5);
    let mut bodies = vec![
        body("rod", 1e-3, 1e-6, [crank + 0.5 * rod, 0.0], 0.0, [0.0; 2]),
        body("slider", 1e-3, 1e-6, [crank + rod, 0.0], 0.0, [0.0; 2]),
    ];
    let drive = Drive::ConstantSpeed { start_angle: 0.0, speed };
    let motion = Motion::Driven { position: [0.0; 2], drive, inertia: None };
    bodies.push(Body { name: "crank".into(), motion, points: vec![] });
    let hinge = |name: &str, a, b| Joint {
        name: name.into(),
        journal: a,
        bushing: b,
        kind: JointKind::Revolute,
        friction: None,
    };
    let joints = vec![
        hinge("crank_pin", place(1, [-0.5 * rod, 0.0]), place(3, [crank, 0.0])),
        hinge("slider_pin", place(2, [0.0; 2]), place(1, [0.5 * rod, 0.0])),
        guide("guide", 2, 0, 0.0, friction(mu, 1e-5, 0.05)),
    ];
    let mut scene = mechanism(bodies, joints, std::f64::consts::TAU / speed);
    scene.gravity = [0.0; 2];
    scene.loads =
        vec![Load::ConstantForce { name: "pull".into(), at: place(2, [0.0; 2]), force: [50.0, 0.0] }];
    let (time, joint) = locks(&scene);
    let psi = (1.0 / mu).atan();
    let exact = (rod * psi.sin() / crank).asin() / speed;
    assert_eq!(joint, "guide");
    assert!((time / exact - 1.0).abs() < 1e-5, "{time} s against {exact} s");
}
