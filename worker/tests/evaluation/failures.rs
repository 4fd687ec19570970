//! What cannot be simulated is said by name, within a bounded number of steps.

use crate::scenes::{every_joint, scene};
use crate::standalone::standalone;
use common::accuracy::Accuracy;
use common::failure::SimulationFailure;
use common::scene::{Load, Scene, SceneSource};
use worker::simulate::{SimulateOptions, simulate};
use worker::simulator::simulator;

fn failure(scene: &Scene, accuracy: &Accuracy) -> SimulationFailure {
    simulate(scene, accuracy, SimulateOptions::default()).expect_err("this cannot be simulated")
}

#[test]
fn too_few_steps_are_reported_with_their_bound() {
    let few = Accuracy { steps_bound: 40, ..Accuracy::draft() };
    let found = failure(&scene("flapping-wing", &[]), &few);
    assert!(
        matches!(found, SimulationFailure::TooManySteps { cycle: 0, bound: 40, joint: Some(_), .. }),
        "{found:?}"
    );
}

#[test]
fn an_unreachable_tolerance_is_reported_with_its_step() {
    let exact = Accuracy { step_tolerance: 1e-30, ..Accuracy::draft() };
    match failure(&scene("flapping-wing", &[]), &exact) {
        SimulationFailure::StepTooSmall { cycle: 0, step, error, joint: Some(_), .. } => {
            assert!(step > 0.0 && step < 1e-9 && error > 1.0, "step {step}, error {error}");
        }
        other => panic!("{other:?}"),
    }
}

#[test]
fn a_journal_pressed_through_its_bore_is_reported_with_its_joint() {
    let mut scene = scene("four-bar", &[]);
    for load in &mut scene.loads {
        if let Load::ConstantTorque { torque, .. } = load {
            *torque *= 1e5;
        }
    }
    every_joint(&mut scene, |c| {
        c.journal_material.elastic_modulus *= 1e-3;
        c.bushing_material.elastic_modulus *= 1e-3;
    });
    match failure(&scene, &Accuracy::draft()) {
        SimulationFailure::OutOfRange { joint, penetration, .. } => {
            assert!(scene.joints.iter().any(|j| j.name == joint));
            assert!(penetration > 4e-4, "penetration {penetration}");
        }
        other => panic!("{other:?}"),
    }
}

#[test]
fn a_joint_between_given_bodies_is_not_modelled_and_says_so() {
    let mut scene = scene("four-bar", &[]);
    let crank = scene.joints[0].journal;
    scene.joints[2].bushing = crank;
    match failure(&scene, &Accuracy::draft()) {
        SimulationFailure::NotModelled { what } => assert!(what.contains("rocker"), "{what}"),
        other => panic!("{other:?}"),
    }
}

#[test]
fn a_linkage_that_does_not_close_is_not_simulated() {
    let found = failure(&scene("flapping-wing", &[("parameters.rod_length", 15e-3)]), &Accuracy::draft());
    assert!(matches!(found, SimulationFailure::CannotAssemble { .. }), "{found:?}");
}

#[test]
fn an_invalid_sample_is_an_outcome() {
    let source = SceneSource::builtin("flapping-wing").expect("built in");
    let simulator = simulator();
    let mut sample = source.means();
    sample[0] = 1.4e-3;
    for sample in [sample, vec![1.0]] {
        let found = simulator.simulate(&standalone(source.text(), &sample, Accuracy::draft()));
        assert!(matches!(found, Err(SimulationFailure::InvalidSample { .. })), "{found:?}");
    }
}
