//! Mechanisms that pass positions in which their ideal joints are dependent: the N-four-bar mechanism of the IFToMM library (A02).

use common::accuracy::Accuracy;
use common::failure::SimulationFailure;
use common::outputs::Evaluation;
use common::scene::{Scene, SceneSource};
use std::fmt::Write;
use std::time::Instant;
use worker::simulate::{LaneWidth, SimulateOptions, SimulationInput, simulate, simulate_side_by_side};

const GRAVITY: f64 = 9.81;

/// N-four-bar mechanisms: N + 1 cranks upright on the ground 1 m apart and N couplers between their tops, rods of 1 m and 1 kg.
struct FourBars {
    n: usize,
    /// Speed of the tops at the start [m/s].
    speed: f64,
    /// Gravity `(2,)` [m/s^2].
    gravity: [f64; 2],
    /// Length by which the last crank is longer [m].
    excess: f64,
    /// Duration of the motion [s].
    seconds: f64,
}

/// The benchmark A02: tops at 1 m/s, 10 s.
fn benchmark(n: usize) -> FourBars {
    FourBars { n, speed: 1.0, gravity: [0.0, -GRAVITY], excess: 0.0, seconds: 10.0 }
}

fn scene(of: &FourBars) -> Scene {
    let FourBars { n, speed, gravity: [gx, gy], excess, seconds } = *of;
    let mut text = format!(
        "gravity = [\"{gx} m/s^2\", \"{gy} m/s^2\"]\n[scene]\nname = \"n-four-bar\"\n\
         [life]\nperiod = \"{seconds} s\"\ncycles = 1\ncheckpoint_every = 1\nsettle_cycles = 0\n\
         [[outputs]]\nname = \"parallel\"\ntype = \"angle-difference\"\na = {{ body = \"crank0\" }}\nb = {{ body = \"crank1\" }}\n\
         [[bodies]]\nname = \"frame\"\nmotion = \"fixed\"\n[bodies.points]\n"
    );
    for k in 0..=n {
        writeln!(text, "hinge{k} = [\"{k} m\", \"0 m\"]").unwrap();
    }
    let mut body = |name: String, [x, y]: [usize; 2], along: [f64; 2], motion: &str| {
        let [a, b] = along;
        writeln!(
            text,
            "[[bodies]]\nname = \"{name}\"\nmotion = \"free\"\nmass = \"1 kg\"\ninertia = \"{} kg m^2\"\n\
             centre_of_mass = [\"{} m\", \"{} m\"]\nstart_position = [\"{x} m\", \"{y} m\"]\nstart_angle = \"0 deg\"\n{motion}\n\
             [bodies.points]\nfoot = [\"0 m\", \"0 m\"]\ntip = [\"{a} m\", \"{b} m\"]",
            1.0 / 12.0,
            0.5 * a,
            0.5 * b
        )
        .unwrap();
    };
    for k in 0..=n {
        let length = if k == n { 1.0 + excess } else { 1.0 };
        // With other lengths the first crank's speed gives all others.
        let motion = if excess == 0.0 || k == 0 {
            format!("start_speed = \"{} rad/s\"", -speed)
        } else {
            String::new()
        };
        body(format!("crank{k}"), [k, 0], [0.0, length], &motion);
    }
    for k in 0..n {
        let motion = if excess == 0.0 {
            format!("start_velocity = [\"{speed} m/s\", \"0 m/s\"]")
        } else {
            String::new()
        };
        body(format!("coupler{k}"), [k, 1], [1.0, 0.0], &motion);
    }
    let mut joint = |name: String, a: (String, &str), b: (String, String)| {
        writeln!(
            text,
            "[[joints]]\nname = \"{name}\"\ntype = \"revolute\"\na = {{ body = \"{}\", point = \"{}\" }}\n\
             b = {{ body = \"{}\", point = \"{}\" }}",
            a.0, a.1, b.0, b.1
        )
        .unwrap();
    };
    for k in 0..=n {
        joint(format!("foot{k}"), (format!("crank{k}"), "foot"), ("frame".into(), format!("hinge{k}")));
    }
    for k in 0..n {
        joint(format!("left{k}"), (format!("coupler{k}"), "foot"), (format!("crank{k}"), "tip".into()));
        joint(format!("right{k}"), (format!("coupler{k}"), "tip"), (format!("crank{}", k + 1), "tip".into()));
    }
    SceneSource::parse(&text, "n-four-bar").expect("valid").nominal().clone()
}

/// Inertia and moment of weight of the mechanism about its one freedom, the common angle of the cranks [kg m^2, N m].
fn pendulum(n: usize) -> (f64, f64) {
    let n = n as f64;
    ((n + 1.0) / 3.0 + n, GRAVITY * ((n + 1.0) / 2.0 + n))
}

/// Angle from upright of the mechanism after `seconds`: I theta'' = W sin(theta), by the classical Runge-Kutta method in steps so short
/// that its error is that of rounding [rad].
fn angle_after(n: usize, speed: f64, seconds: f64) -> f64 {
    let (inertia, weight) = pendulum(n);
    let steps = (seconds * 1e4).round() as usize;
    let (h, rate) = (seconds / steps as f64, |y: [f64; 2]| [y[1], weight / inertia * y[0].sin()]);
    let mut y = [0.0, speed];
    for _ in 0..steps {
        let ahead = |k: [f64; 2], s: f64| [y[0] + s * k[0], y[1] + s * k[1]];
        let k1 = rate(y);
        let k2 = rate(ahead(k1, 0.5 * h));
        let k3 = rate(ahead(k2, 0.5 * h));
        let k4 = rate(ahead(k3, h));
        for i in 0..2 {
            y[i] += h / 6.0 * (k1[i] + 2.0 * (k2[i] + k3[i]) + k4[i]);
        }
    }
    y[0]
}

/// Largest deviation from the initial energy over the recorded motion [J], and of the cranks from parallel [rad].
fn deviations(n: usize, speed: f64, evaluation: &Evaluation) -> (f64, f64) {
    let (inertia, weight) = pendulum(n);
    let motion = &evaluation.first_cycle.as_ref().expect("asked for").motion;
    let crank = |k: usize| motion.iter().find(|m| m.body == format!("crank{k}")).expect("it moves");
    let first = crank(0);
    let energy = |k: usize| 0.5 * inertia * first.speed[k].powi(2) + weight * first.angle[k].cos();
    let start = 0.5 * inertia * speed * speed + weight;
    let lost = (0..first.angle.len()).map(|k| (energy(k) - start).abs()).fold(0.0, f64::max);
    let apart = (1..=n).flat_map(|c| crank(c).angle.iter().zip(&first.angle).map(|(a, b)| (a - b).abs()));
    (lost, apart.fold(0.0, f64::max))
}

/// Simulates the benchmark and compares it with the pendulum that the mechanism is; prints a row of the table. Returns the processor time
/// of a step [s].
fn check(n: usize) -> f64 {
    let scene = scene(&benchmark(n));
    let start = Instant::now();
    let evaluation =
        simulate(&scene, &Accuracy::reference(), SimulateOptions::WITH_FIRST_CYCLE).expect("it goes through");
    let seconds = start.elapsed().as_secs_f64();
    let (lost, apart) = deviations(n, 1.0, &evaluation);
    let motion = &evaluation.first_cycle.as_ref().expect("asked for").motion;
    let last = motion.iter().find(|m| m.body == "crank0").and_then(|m| m.angle.last()).expect("it moves");
    let off = (-last - angle_after(n, 1.0, 10.0)).abs();
    let diagnostics = &evaluation.diagnostics;
    let kept = diagnostics.energy.expect("asked for").stored.abs();
    let tried = diagnostics.steps + diagnostics.rejected_steps;
    println!(
        "| {n} | {kept:.0e} | {lost:.0e} | {off:.0e} | {apart:.0e} | {} | {} | {seconds:.2} | {:.2} |",
        diagnostics.steps,
        diagnostics.rejected_steps,
        1e3 * seconds / tried as f64
    );
    assert!(kept < ENERGY_BOUND, "{kept} J");
    assert!(lost < ENERGY_BOUND, "{lost} J");
    assert!(off < 1e-4, "{off} rad");
    assert!(apart < 1e-4, "{apart} rad");
    assert!(diagnostics.constraint_drift < 1e-8);
    seconds / tried as f64
}

/// Numbers N.
const CASES: [usize; 4] = [1, 2, 10, 40];
/// Largest deviation of the energy, in the recorded motion and at its end [J].
const ENERGY_BOUND: f64 = 1e-3;

#[test]
fn four_bars_pass_their_singular_positions() {
    for n in CASES {
        check(n);
    }
}

#[test]
#[ignore = "measures times: prints the table of the documents"]
fn the_time_of_four_bars_grows_linearly() {
    println!(
        "| N | energy at the end [J] | in the history [J] | angle [rad] | cranks apart [rad] | steps | refused | time [s] | time of a step [ms] |"
    );
    let times = CASES.map(check);
    assert!(times[3] < 8.0 * times[2], "{times:?}");
}

/// With a crank that is 1 mm longer the rods cannot all lie in line: one of the cranks turns back shortly before, the other goes on.
#[test]
fn a_linkage_of_slightly_other_lengths_turns_away_before_the_position() {
    let of = FourBars { excess: 1e-3, seconds: 3.0, ..benchmark(1) };
    let evaluation =
        simulate(&scene(&of), &Accuracy::reference(), SimulateOptions::WITH_FIRST_CYCLE).expect("it moves");
    let (_, apart) = deviations(1, 1.0, &evaluation);
    let stored = evaluation.diagnostics.energy.expect("asked for").stored;
    assert!(apart > 1.0, "the cranks stay parallel to {apart} rad");
    assert!(stored.abs() < 1e-3, "{stored} J");
    assert!(evaluation.diagnostics.constraint_drift < 1e-8);
}

/// Weight along the ground and a start with just the energy that the mechanism has at rest with its rods in line: it comes to rest there, where
/// it may go on in more than one way.
#[test]
fn a_mechanism_that_comes_to_rest_in_the_position_is_refused() {
    let (inertia, weight) = pendulum(1);
    let speed = (2.0 * weight / inertia).sqrt();
    let of = FourBars { speed, gravity: [-GRAVITY, 0.0], ..benchmark(1) };
    match simulate(&scene(&of), &Accuracy::balanced(), SimulateOptions::default()) {
        Err(SimulationFailure::Branching { time, joint, .. }) => {
            assert!((0.5..5.0).contains(&time), "at {time} s");
            assert_eq!(joint, "foot0", "the last joint of the loop in the order of the elimination");
        }
        other => panic!("{other:?}"),
    }
}

/// Mechanisms that pass the position at other times than their neighbours, turn away before it, or end in it, by steps of either kind.
#[test]
fn lanes_next_to_each_other_pass_the_position_with_the_bits_of_one_alone() {
    let (inertia, weight) = pendulum(1);
    let stop = FourBars { speed: (2.0 * weight / inertia).sqrt(), gravity: [-GRAVITY, 0.0], ..benchmark(1) };
    let mechanisms = [
        FourBars { seconds: 3.0, ..benchmark(1) },
        FourBars { seconds: 3.0, speed: 1.3, ..benchmark(1) },
        FourBars { seconds: 3.0, excess: 1e-3, ..benchmark(1) },
        FourBars { seconds: 3.0, ..benchmark(2) },
        stop,
        FourBars { seconds: 2.5, speed: 0.8, ..benchmark(1) },
        FourBars { seconds: 2.0, ..benchmark(12) },
    ];
    let (accuracy, options) = (Accuracy::balanced(), SimulateOptions::WITH_FIRST_CYCLE);
    let scenes = mechanisms.map(|of| scene(&of));
    let alone = scenes.each_ref().map(|scene| simulate(scene, &accuracy, options));
    assert_eq!(alone.iter().filter(|result| result.is_err()).count(), 1, "one ends in the position");
    for (width, most) in [(LaneWidth::Widest, 7), (LaneWidth::Holding(4), 4)] {
        let mut inputs =
            scenes.iter().map(|scene| Ok(SimulationInput { scene: scene.clone(), accuracy, options }));
        let mut compared = 0;
        simulate_side_by_side(width, most, &mut || inputs.next(), &mut |number, result, _| {
            assert!(result == alone[number], "mechanism {number} differs");
            compared += 1;
        });
        assert_eq!(compared, scenes.len());
    }
}
