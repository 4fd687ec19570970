//! Guides and sliders that wear, through whole lives: closed forms, energy on worn faces, convergence, backlash.

use crate::scenes::evaluate as run;
use common::accuracy::Accuracy;
use common::outputs::Evaluation;
use common::scene::*;
use worker::simulate::{SimulateOptions, simulate};

/// A crank moves a slider of 60 by 20 mm to and fro by 40 mm in a guide of 120 mm, pressed down by a force in its middle.
pub(crate) const PRESSED: &str = include_str!("scenes/pressed-slider.toml");

const FORCE: f64 = 300.0;
const STROKE: f64 = 0.04;
const LENGTH: f64 = 0.06;
const WIDTH: f64 = 0.02;
const COEFFICIENTS: [f64; 2] = [1e-13, 5e-14];
/// Index of the joint.
const RAIL: usize = 2;

fn parsed(text: &str) -> Scene {
    SceneSource::parse(text, "scene").expect("valid").nominal().clone()
}

pub(crate) fn pressed(change: impl Fn(&mut GuideClearance)) -> Scene {
    let mut scene = parsed(PRESSED);
    let JointKind::Guide(guide) = &mut scene.joints[RAIL].kind else { panic!("it is a guide") };
    change(guide);
    scene
}

fn wear(guide: &mut GuideClearance) -> &mut GuideWear {
    guide.wear.as_mut().expect("it wears")
}

fn output<'e>(scene: &Scene, evaluation: &'e Evaluation, name: &str) -> (&'e [f64], &'e [f64]) {
    let k = scene.outputs.iter().position(|output| output.name == name).expect("its output");
    (&evaluation.histories[k], &evaluation.errors[k])
}

/// Value and stated error at the end of life.
fn last(scene: &Scene, evaluation: &Evaluation, name: &str) -> [f64; 2] {
    let (values, errors) = output(scene, evaluation, name);
    [values[values.len() - 1], errors[errors.len() - 1]]
}

/// Both surfaces lose Archard's volume K F S.
#[test]
fn a_pressed_slider_loses_archards_volume() {
    let scene = pressed(|guide| guide.friction = 0.0);
    let evaluation = run(&scene, &Accuracy::balanced());
    let (volumes, _) = output(&scene, &evaluation, "volume");
    for (k, volume) in volumes.iter().enumerate() {
        let cycles = 1000.0 * (k + 1) as f64;
        let expected = (COEFFICIENTS[0] + COEFFICIENTS[1]) * FORCE * 2.0 * STROKE * cycles;
        assert!((volume / expected - 1.0).abs() < 5e-3, "{cycles}: {volume:e} {expected:e}");
    }
}

/// The guide wears a trough in which the slider settles. With h_g and h_s the largest depths, the clearance on this side grows by their sum, and
/// over the middle of the trough, which the slider never leaves, hand estimates by Archard's law bound the guide's: all of its volume within the
/// trough of the length l + S, or within l.
#[test]
fn the_clearance_grows_by_both_surfaces() {
    let scene = pressed(|_| {});
    let evaluation = run(&scene, &Accuracy::balanced());
    let [guide, slider, growth, largest] =
        ["guide_wear", "slider_wear", "growth", "wear"].map(|name| last(&scene, &evaluation, name)[0]);
    assert!((growth - guide - slider).abs() < 1e-12 * growth && largest == guide.max(slider));
    let work = FORCE * 2.0 * STROKE * 20_000.0;
    let within = |length: f64| COEFFICIENTS[0] * work / (length * WIDTH);
    println!(
        "guide {guide:e} m, between {:e} and {:e}; slider {slider:e}",
        within(LENGTH + STROKE),
        within(LENGTH)
    );
    assert!(guide > within(LENGTH + STROKE) && guide < within(LENGTH), "{guide:e}");
    assert!(slider > 0.9 * COEFFICIENTS[1] * work / (LENGTH * WIDTH), "{slider:e}");
    let depths = &evaluation.joints[RAIL].wear_depth;
    assert_eq!(depths.len(), 82);
    // Pressed on the right face, and symmetric about the middle of the stroke but for the inclination of the rod.
    assert!(depths[..41].iter().all(|h| *h == 0.0) && depths[41 + 20] > 0.5 * guide && depths[41] == 0.0);
}

/// On worn faces, too, what the drive puts in is dissipated or stored.
#[test]
fn energy_is_balanced_on_worn_faces() {
    let scene = pressed(|guide| guide.friction = 0.1);
    let options = SimulateOptions::WITH_FIRST_CYCLE;
    let evaluation = simulate(&scene, &Accuracy::balanced(), options).expect("simulated");
    let [growth, _] = last(&scene, &evaluation, "growth");
    assert!(growth > 2e-5, "worn by more than the first clearance: {growth:e}");
    for energy in [evaluation.diagnostics.energy, evaluation.diagnostics.worn_energy] {
        let energy = energy.expect("asked for");
        println!("off by {:e} of the turnover, {energy:?}", energy.residual() / energy.turnover);
        assert!(energy.residual().abs() < 2e-3 * energy.turnover && energy.dissipated > 0.0, "{energy:?}");
        assert!(energy.unphysical < 1e-6 * energy.turnover, "{energy:?}");
        // Friction on a straight way: mu F times the way.
        let friction = 0.1 * FORCE * 2.0 * STROKE;
        assert!((energy.dissipated / friction - 1.0).abs() < 0.05, "{energy:?} against {friction}");
    }
    let worn = evaluation.worn.expect("asked for");
    assert_eq!(worn.wear_depth[worn.wear_depth.len() - 1][RAIL].len(), 82);
}

/// A torque holds the slider at two opposite corners while it slides: each wears a facet of the volume w delta^2 / (2 tan theta), with the
/// tilt theta of the clearance and both facets.
#[test]
fn a_twisted_slider_wears_two_facets() {
    let mut scene = pressed(|guide| {
        let of_guide = wear(guide);
        (of_guide.wears, of_guide.control_points) = (WearingSurfaces::Journal, 65);
    });
    let body = scene.bodies.iter().position(|body| body.name == "slider").expect("there");
    let torque = 6.0;
    scene.loads = vec![Load::ConstantTorque { name: "twist".into(), body, torque }];
    scene.life.cycles = 8000;
    let evaluation = run(&scene, &Accuracy::balanced());
    let depths = &evaluation.joints[RAIL].journal_wear_depth;
    let (left, right) = depths.split_at(depths.len() / 2);
    let found = [left[left.len() - 1], right[0]];
    let half = 0.5 * LENGTH;
    let (clearance, cycles) = (2e-5, 8000.0);
    // As the tilt grows with the facets, the pressure on one of the length x falls from the corner inwards as 1 - y / (l / 2): the couple acts at
    // the distance of its resultant. The cycles that a depth takes are the integral of dV / (K force 2 S).
    let tan = |delta: f64| (clearance + delta) / half;
    let volume = |delta: f64| WIDTH * delta * delta / (2.0 * tan(delta));
    let force = |delta: f64| {
        let x = delta / tan(delta);
        let inside = (0.5 * x * x - x.powi(3) / (3.0 * half)) / (x - x * x / (2.0 * half));
        torque / (2.0 * (half - inside))
    };
    let (mut delta, mut taken, step) = (0.0, 0.0, 1e-8);
    while taken < cycles {
        let worn = volume(delta + step) - volume(delta);
        taken += worn / (COEFFICIENTS[0] * force(delta + 0.5 * step) * 2.0 * STROKE);
        delta += step;
    }
    println!("facets {found:?} m, closed form {delta:e}, over {:e} m", delta / tan(delta));
    for depth in found {
        assert!((depth / delta - 1.0).abs() < 0.005, "{depth:e} against {delta:e}");
    }
    assert!((found[0] / found[1] - 1.0).abs() < 0.02, "{found:?}");
    assert!(left[0] == 0.0 && right[right.len() - 1] == 0.0);
}

/// Depths converge with the control points and the blocks; the difference is within the stated error.
#[test]
fn depths_converge_and_stated_errors_hold() {
    let at = |points: usize, jump: u32| {
        let scene = pressed(|guide| {
            wear(guide).control_points = points;
            guide.friction = 0.05;
        });
        let scene = Scene { life: Life { cycles: 10_000, ..scene.life }, ..scene };
        let accuracy = Accuracy { cycle_jump: jump, ..Accuracy::balanced() };
        let evaluation = run(&scene, &accuracy);
        ["guide_wear", "slider_wear"].map(|name| last(&scene, &evaluation, name))
    };
    let cases = [(21, 2000), (61, 2000), (41, 4000)];
    // On two processors.
    let (exact, all) = std::thread::scope(|scope| {
        let exact = scope.spawn(|| at(91, 1000));
        let all = cases.map(|(points, jump)| at(points, jump));
        (exact.join().expect("simulated"), all)
    });
    for ((points, jump), found) in cases.into_iter().zip(all) {
        for k in 0..2 {
            let [value, stated] = found[k];
            let off = value - exact[k][0];
            println!(
                "{points} points, blocks of {jump}, surface {k}: {:.3} um, off by {:.3} um, stated {:.3} um",
                1e6 * value,
                1e6 * off,
                1e6 * stated
            );
            assert!(off.abs() <= stated + exact[k][1], "{points} {jump} {k}: {off:e} {stated:e}");
        }
    }
}

/// A slider alone wears evenly by K p S under the force in its middle, and its backlash across the guide grows by that depth.
#[test]
fn the_backlash_of_a_worn_guide_grows() {
    let mut scene = pressed(|guide| wear(guide).wears = WearingSurfaces::Journal);
    let at = Attachment { body: 3, position: [0.0; 2] };
    let kind = OutputKind::PositionBacklash { at, direction: std::f64::consts::FRAC_PI_2, held: None };
    scene.outputs.push(Output { name: "play".into(), kind });
    let evaluation = run(&scene, &Accuracy::balanced());
    let k = scene.outputs.len() - 1;
    let unworn = evaluation.start[k].expect("a value");
    let worn = last(&scene, &evaluation, "play")[0];
    let depth = last(&scene, &evaluation, "slider_wear")[0];
    println!("backlash {unworn:e}, worn {worn:e}, slider worn by {depth:e}");
    assert!((unworn - 4e-5).abs() < 1e-9, "{unworn:e}");
    assert!((worn - unworn - depth).abs() < 0.02 * depth, "{worn:e} {unworn:e} {depth:e}");
    let [found, stated] = last(&scene, &evaluation, "slider_wear");
    let even = COEFFICIENTS[0] * FORCE / (LENGTH * WIDTH) * 2.0 * STROKE * 20_000.0;
    println!("slider alone {found:e} +- {stated:e}, even {even:e}, {:?}", evaluation.diagnostics);
    let [left, right] = {
        let depths = &evaluation.joints[RAIL].journal_wear_depth;
        let (left, right) = depths.split_at(depths.len() / 2);
        [left, right]
    };
    assert!(left.iter().all(|h| *h == 0.0) && evaluation.joints[RAIL].wear_depth.iter().all(|h| *h == 0.0));
    assert!(right.iter().all(|h| (h / even - 1.0).abs() < 0.01), "{right:?} against {even:e}");
    assert!((found / even - 1.0).abs() < 0.01 && stated < 0.05 * even, "{found:e} {even:e} {stated:e}");
}
