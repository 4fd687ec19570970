//! Backlash against closed forms: levers, a four-bar, a slider in its guide, and worn bores.

use crate::scenes::{scene, short};
use common::accuracy::Accuracy;
use common::failure::SimulationFailure;
use common::outputs::Evaluation;
use common::scene::*;
use std::f64::consts::TAU;
use worker::simulate::{SimulateOptions, simulate};

fn run(scene: &Scene) -> Result<Evaluation, SimulationFailure> {
    simulate(scene, &Accuracy::draft(), SimulateOptions::default())
}

fn body(scene: &Scene, name: &str) -> usize {
    scene.bodies.iter().position(|body| body.name == name).expect("there")
}

/// Only these outputs, and no study of them.
fn with_outputs(mut scene: Scene, outputs: Vec<OutputKind>) -> Scene {
    let named = outputs.into_iter().enumerate();
    scene.outputs = named.map(|(k, kind)| Output { name: format!("output {k}"), kind }).collect();
    (scene.limit_states, scene.variables) = (vec![], vec![]);
    scene
}

/// The clearances of the joints that wear stay new.
fn unworn(scene: &mut Scene) {
    crate::scenes::every_joint(scene, |clearance| clearance.wear_coefficient = 0.0);
}

const GROUND: f64 = 0.07;
const CRANK: f64 = 0.02;
const COUPLER: f64 = 0.06;
const ROCKER: f64 = 0.05;
const CLEARANCE: f64 = 30e-6;

/// Sine of the transmission angle of `four-bar` at the angle `phi` of its crank.
fn transmission(phi: f64) -> f64 {
    let diagonal = GROUND * GROUND + CRANK * CRANK - 2.0 * GROUND * CRANK * phi.cos();
    let cosine = (COUPLER * COUPLER + ROCKER * ROCKER - diagonal) / (2.0 * COUPLER * ROCKER);
    (1.0 - cosine * cosine).sqrt()
}

/// Backlash of the rocker of `four-bar` with its crank at `phi`.
fn of_rocker(scene: &Scene, phi: Option<f64>) -> OutputKind {
    let held = phi.map(|angle| HeldInput { body: body(scene, "crank"), angle });
    OutputKind::Backlash { body: body(scene, "rocker"), held }
}

#[test]
fn a_lever_on_one_hinge_has_twice_the_clearance_over_its_arm() {
    // At this angle the coupler is perpendicular to the rocker, and only its hinge there has clearance.
    let phi = (-800.0_f64 / 2800.0).acos();
    assert!((transmission(phi) - 1.0).abs() < 1e-12);
    let mut scene = scene("four-bar", &[]);
    unworn(&mut scene);
    scene.joints[0].kind = JointKind::Revolute;
    scene.joints[2].kind = JointKind::Revolute;
    // Whole turns do not count.
    let outputs = vec![of_rocker(&scene, Some(phi)), of_rocker(&scene, Some(phi - 3.0 * TAU))];
    let evaluation = run(&with_outputs(scene, outputs)).expect("simulated");
    for k in 0..2 {
        let (found, stated) = (evaluation.histories[k][0], evaluation.errors[k][0]);
        println!("{found:e} rad against {:e}, stated error {stated:e}", 2.0 * CLEARANCE / ROCKER);
        assert!((found / (2.0 * CLEARANCE / ROCKER) - 1.0).abs() < 1e-9, "{found}");
        assert!(stated < 1e-8 * found, "{stated}");
    }
}

#[test]
fn the_clearances_of_a_four_bar_add_up_by_the_force_in_its_coupler() {
    // A unit moment on the rocker goes through all three hinges as the force 1 / (r sin mu) along the coupler.
    let mut scene = scene("four-bar", &[]);
    unworn(&mut scene);
    let angles = [20.0_f64, 120.0, 260.0].map(f64::to_radians);
    let mut outputs: Vec<OutputKind> = angles.iter().map(|phi| of_rocker(&scene, Some(*phi))).collect();
    outputs.push(of_rocker(&scene, None));
    let evaluation = run(&with_outputs(scene, outputs)).expect("simulated");
    let exact = |phi: f64| 6.0 * CLEARANCE / (ROCKER * transmission(phi));
    for (k, phi) in angles.into_iter().enumerate() {
        let found = evaluation.histories[k][0];
        assert!((found / exact(phi) - 1.0).abs() < 1e-9, "{found} against {}", exact(phi));
    }
    // Over the cycle it is largest where the transmission angle is farthest from a right angle, on the line of the frame.
    let largest = exact(0.0).max(exact(TAU / 2.0));
    let found = evaluation.histories[3][0];
    assert!((found / largest - 1.0).abs() < 1e-5, "{found} against {largest}");
}

/// `four-bar` with clearance in the hinge between crank and coupler alone, worn for 2000 cycles under this law: its bore, in the coupler, is
/// pressed along the coupler. The growth of the backlash as a play along the coupler [m], and the evaluation.
fn worn_along_the_coupler(law: ContactLaw) -> (f64, Evaluation) {
    let mut scene = short("four-bar", &[], 2000);
    scene.joints[1].kind = JointKind::Revolute;
    scene.joints[2].kind = JointKind::Revolute;
    crate::scenes::every_joint(&mut scene, |clearance| clearance.contact_law = law);
    let phi = 1.0;
    let outputs = vec![of_rocker(&scene, Some(phi))];
    let evaluation = run(&with_outputs(scene, outputs)).expect("simulated");
    let history = &evaluation.histories[0];
    assert!(history[0] < history[1], "{history:?}");
    ((history[1] - evaluation.start[0].expect("known")) * ROCKER * transmission(phi), evaluation)
}

#[test]
fn a_worn_bore_adds_its_depth_along_the_coupler() {
    let (growth, evaluation) = worn_along_the_coupler(ContactLaw::Foundation);
    let depth = &evaluation.joints[0].wear_depth;
    let along = depth[0] + depth[depth.len() / 2];
    println!("play grown by {growth:e} m, worn along the coupler {along:e} m");
    assert!(along > 1e-6, "{depth:?}");
    // The elastic contact leaves a groove of some hundredths of its depth, less than what counts.
    assert!((growth / along - 1.0).abs() < 0.03, "{growth} against {along}");
    assert_eq!(evaluation.diagnostics.narrow_grooves, vec![]);
}

#[test]
fn a_groove_narrower_than_its_journal_is_reported_and_adds_less() {
    // The arc of `local-hertz` wears evenly, without regard to the curvature of the ground: a journal of 4 mm does not fit in the groove.
    let (growth, evaluation) = worn_along_the_coupler(ContactLaw::LocalHertz);
    let depth = &evaluation.joints[0].wear_depth;
    let along = depth[0] + depth[depth.len() / 2];
    let [groove] = &evaluation.diagnostics.narrow_grooves[..] else {
        panic!("{:?}", evaluation.diagnostics.narrow_grooves);
    };
    println!("play grown by {growth:e} m, worn along the coupler {along:e} m, {groove:?}");
    let deepest = (0..depth.len()).fold(0, |best, k| if depth[k] > depth[best] { k } else { best });
    let away = (groove.angle - TAU * deepest as f64 / depth.len() as f64).rem_euclid(TAU);
    assert!(away.min(TAU - away) < 0.2, "{groove:?}, deepest at point {deepest}");
    assert_eq!(groove.joint, "crank");
    assert!(groove.since <= 2000 && groove.width > 0.1 && groove.width < 2.0, "{groove:?}");
    assert!(groove.open > 0.01 * CLEARANCE && groove.open < along, "{groove:?}");
    // What stays open is missing in the play.
    assert!((along - growth - groove.open).abs() < 0.1 * groove.open, "{along} - {growth}, {groove:?}");
}

#[test]
fn the_pin_of_a_slider_crank_moves_slider_and_rod() {
    // The rod is inclined by beta: the slider moves by 2 c / cos(beta), the rod turns by 2 c / (l cos(beta)).
    let (crank, rod, clearance) = (0.05, 0.12, 0.5e-3);
    let phi = 1.1_f64;
    let mut scene = scene("slider-crank", &[]);
    unworn(&mut scene);
    (scene.life.cycles, scene.life.checkpoint_every) = (1, 1);
    let held = Some(HeldInput { body: body(&scene, "crank"), angle: phi });
    let at = Attachment { body: body(&scene, "slider"), position: [0.0; 2] };
    let outputs = vec![
        OutputKind::PositionBacklash { at, direction: 0.0, held },
        OutputKind::PositionBacklash { at, direction: TAU / 4.0, held },
        OutputKind::Backlash { body: body(&scene, "rod"), held },
    ];
    let evaluation = run(&with_outputs(scene, outputs)).expect("simulated");
    let cosine = (1.0 - (crank * phi.sin() / rod).powi(2)).sqrt();
    let found: Vec<f64> = evaluation.histories.iter().map(|history| history[0]).collect();
    assert!((found[0] * cosine / (2.0 * clearance) - 1.0).abs() < 1e-9, "{found:?}");
    assert!(found[1] < 1e-15, "the guide is ideal: {found:?}");
    assert!((found[2] * rod * cosine / (2.0 * clearance) - 1.0).abs() < 1e-9, "{found:?}");
}

#[test]
fn a_slider_moves_and_tilts_in_its_guide() {
    // The published slider-crank with its crank driven: only the guide has clearance, on a slider of 100 mm.
    let (clearance, length) = (1e-3, 0.1);
    let mut scene = SceneSource::parse(crate::guides::PUBLISHED, "guided").expect("valid").nominal().clone();
    let crank = body(&scene, "crank");
    scene.joints.remove(0);
    scene.bodies[crank].motion = Motion::Driven {
        position: [0.0; 2],
        drive: Drive::ConstantSpeed { start_angle: 0.0, speed: 150.0 },
        inertia: None,
    };
    let held = Some(HeldInput { body: crank, angle: 0.8 });
    let slider = body(&scene, "slider");
    let offset = Attachment { body: slider, position: [0.0; 2] };
    let corner = Attachment { body: slider, position: [0.5 * length, 0.0] };
    let across = |at| OutputKind::PositionBacklash { at, direction: TAU / 4.0, held };
    let outputs = vec![across(offset), across(corner), OutputKind::Backlash { body: slider, held }];
    let evaluation = run(&with_outputs(scene, outputs)).expect("simulated");
    let found: Vec<f64> = evaluation.histories.iter().map(|history| history[0]).collect();
    for (found, exact) in found.iter().zip([2.0 * clearance, 2.0 * clearance, 4.0 * clearance / length]) {
        assert!((found / exact - 1.0).abs() < 1e-9, "{found} against {exact}");
    }
}

#[test]
fn issue_a_backlash_that_the_mechanism_does_not_determine_is_refused() {
    let pendulum = scene("pendulum", &[]);
    let outputs = vec![OutputKind::Backlash { body: body(&pendulum, "pendulum"), held: None }];
    let failure = run(&with_outputs(pendulum, outputs)).expect_err("free to swing");
    let message = failure.to_string();
    assert!(
        message.contains(": output") && message.contains("drives leave the ideal motion open"),
        "{failure}"
    );
    // A crank that rocks by 20 degrees does not pass 90 degrees.
    let mut rocking = scene("four-bar", &[]);
    let crank = body(&rocking, "crank");
    let table = Table { at: vec![0.0, 0.03, 0.06], value: vec![0.0, 0.35, 0.0], repeat: true };
    if let Motion::Driven { drive, .. } = &mut rocking.bodies[crank].motion {
        *drive = Drive::Angle(table);
    }
    rocking.life.period = 0.06;
    let outputs = vec![of_rocker(&rocking, Some(TAU / 4.0))];
    let failure = run(&with_outputs(rocking, outputs)).expect_err("not passed");
    assert!(
        failure.to_string().contains("crank of 90.000000 deg, which its drive does not pass"),
        "{failure}"
    );
}
