//! Wear driven by the gaps alone against wear driven by the dynamics, and when the dynamics is taken after all.

use crate::scenes::{evaluate, every_joint, scene, short};
use common::accuracy::{Accuracy, Tier};
use common::outputs::Evaluation;
use common::scene::{ContactLaw, OutputKind, Scene};

/// The scene with its wear outputs alone, and the limit states on them.
fn wear_alone(mut scene: Scene) -> Scene {
    let kept: Vec<usize> = (0..scene.outputs.len())
        .filter(|&k| matches!(scene.outputs[k].kind, OutputKind::LargestWear { .. }))
        .collect();
    scene.limit_states.retain_mut(|limit| match kept.iter().position(|&k| k == limit.output) {
        Some(output) => {
            limit.output = output;
            true
        }
        None => false,
    });
    scene.outputs = kept.iter().map(|&k| scene.outputs[k].clone()).collect();
    scene
}

/// The dynamics finer than balanced in step, history, block and wear step.
fn fine() -> Accuracy {
    Accuracy {
        step_tolerance: 1e-4,
        largest_step: 1.0 / 1400.0,
        wear_samples: 2000,
        cycle_jump: 1000,
        wear_tolerance: 5e-3,
        tier: Tier::Dynamic,
        ..Accuracy::balanced()
    }
}

fn dynamic() -> Accuracy {
    Accuracy { tier: Tier::Dynamic, ..Accuracy::balanced() }
}

/// Largest relative difference of the first output over the checkpoints, and over its reported error.
fn difference(found: &Evaluation, exact: &Evaluation) -> (f64, f64) {
    let values = found.histories[0].iter().zip(&exact.histories[0]).zip(&found.errors[0]);
    values.fold((0.0, 0.0), |(relative, reported), ((a, b), error)| {
        let off = (a - b).abs();
        (f64::max(relative, off / b), f64::max(reported, off / error))
    })
}

#[test]
fn gaps_alone_wear_as_the_dynamics_does() {
    // Of all dynamic cycles of a life three remain: the two first ones and the last.
    for (name, saved) in [("four-bar", 2), ("flapping-wing", 5)] {
        let scene = wear_alone(scene(name, &[]));
        let found = evaluate(&scene, &Accuracy::balanced());
        assert!(found.diagnostics.quasi_static, "{name}");
        let (off, over_reported) = difference(&found, &evaluate(&scene, &fine()));
        println!("{name}: off by {off}, {over_reported} of the error reported");
        // The goal is 1 % at the end of life; 0.3 % is what is found over all checkpoints.
        assert!(off < 5e-3, "{name}: {off}");
        assert!(over_reported < 1.0, "{name}: {over_reported} of the error reported");
        let forces = evaluate(&scene, &dynamic()).diagnostics.force_evaluations;
        let work = found.diagnostics.force_evaluations;
        println!("{name}: {work} force evaluations against {forces}");
        assert!(saved * work < forces, "{name}: {work} force evaluations against {forces}");
    }
}

#[test]
fn a_joint_without_film_is_held_by_its_contact() {
    let mut scene = wear_alone(short("four-bar", &[], 4000));
    every_joint(&mut scene, |c| c.film_damping = 0.0);
    let found = evaluate(&scene, &Accuracy::balanced());
    assert!(found.diagnostics.quasi_static);
    let (off, _) = difference(&found, &evaluate(&scene, &dynamic()));
    println!("without film: off by {off}");
    assert!(off < 1e-2, "{off}");
}

#[test]
fn the_same_scene_gives_the_same_bits() {
    let scene = wear_alone(short("four-bar", &[], 2000));
    let found = evaluate(&scene, &Accuracy::balanced());
    assert!(found.diagnostics.quasi_static);
    assert_eq!(found, evaluate(&scene, &Accuracy::balanced()));
}

#[test]
fn an_output_of_the_motion_asks_for_the_dynamics() {
    let scene = short("four-bar", &[], 2000);
    let found = evaluate(&scene, &Accuracy::balanced());
    assert!(!found.diagnostics.quasi_static);
    assert_eq!(found, evaluate(&scene, &dynamic()));
}

/// A scene with the conservative contact law.
fn conservative(mut scene: Scene) -> Scene {
    every_joint(&mut scene, |c| c.contact_law = ContactLaw::Foundation);
    scene
}

#[test]
fn under_a_conservative_law_outputs_of_the_motion_come_from_a_few_dynamic_cycles() {
    for (name, cycles, cycle_jump) in [("flapping-wing", 24_000, 1000), ("four-bar", 4000, 200)] {
        let scene = conservative(short(name, &[], cycles));
        let automatic = Accuracy { cycle_jump, ..Accuracy::draft() };
        let found = evaluate(&scene, &automatic);
        let exact = evaluate(&scene, &Accuracy { tier: Tier::Dynamic, ..automatic });
        assert!(found.diagnostics.quasi_static && !exact.diagnostics.quasi_static, "{name}");
        for (k, output) in scene.outputs.iter().enumerate() {
            let values = found.histories[k].iter().zip(&exact.histories[k]).zip(&found.errors[k]);
            let worst = values.map(|((a, b), error)| (a - b).abs() / error).fold(0.0, f64::max);
            println!("{name}, {}: {worst} of the stated error", output.name);
            assert!(worst < 1.0, "{name}, {}: {worst}", output.name);
        }
        let [few, many] = [&found, &exact].map(|e| e.diagnostics.force_evaluations);
        println!("{name}: {few} force evaluations against {many}");
        assert!(5 * few < 3 * many, "{name}: {few} force evaluations against {many}");
    }
}

#[test]
fn a_motion_that_does_not_repeat_itself_is_left_to_the_dynamics() {
    let mut scene = conservative(short("flapping-wing", &[], 2000));
    every_joint(&mut scene, |c| c.friction = 0.5);
    let found = evaluate(&scene, &Accuracy::draft());
    assert!(!found.diagnostics.quasi_static);
}

/// The four-bar without its load: the journals fly from side to side, for a tenth of the cycle out of contact.
fn rattling(film: bool) -> Scene {
    let mut scene = wear_alone(scene("four-bar", &[]));
    scene.loads.clear();
    if !film {
        every_joint(&mut scene, |c| c.film_damping = 0.0);
    }
    scene
}

#[test]
fn a_mechanism_that_rattles_is_left_to_the_dynamics() {
    // On the unworn bores the largest rates differ by 33 %, where 2 % are allowed.
    let scene = rattling(false);
    let found = evaluate(&scene, &Accuracy::balanced());
    let exact = evaluate(&scene, &dynamic());
    let free = &exact.diagnostics.free_flight_fraction;
    assert!(free.iter().any(|(_, share)| *share > 0.05), "{free:?}");
    assert!(!found.diagnostics.quasi_static);
    assert_eq!(found.histories, exact.histories);
    assert_eq!((&found.errors, &found.joints), (&exact.errors, &exact.joints));
    // What the attempt took is counted.
    let (with, without) = (&found.diagnostics, &exact.diagnostics);
    assert_eq!(with.simulated_cycles, without.simulated_cycles + 1);
    assert!(with.newton_iterations > without.newton_iterations && with.steps > without.steps);
}

#[test]
fn a_mechanism_that_rattles_in_a_film_keeps_its_stated_error_without_the_dynamics() {
    let scene = rattling(true);
    let found = evaluate(&scene, &Accuracy::balanced());
    let exact = evaluate(&scene, &dynamic());
    let free = &exact.diagnostics.free_flight_fraction;
    assert!(free.iter().any(|(_, share)| *share > 0.05), "{free:?}");
    let (off, over_reported) = difference(&found, &exact);
    println!("rattling in a film: off by {off}, {over_reported} of the error reported");
    assert!(found.diagnostics.quasi_static && off < 0.02 && over_reported < 1.0, "{off}, {over_reported}");
}
