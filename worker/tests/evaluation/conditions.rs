//! Operating conditions on the same bores, against closed forms and against single conditions.

use crate::scenes::short;
use common::accuracy::Accuracy;
use common::outputs::Evaluation;
use common::scene::{Condition, Scene, SceneSource};
use std::collections::BTreeMap;
use std::f64::consts::TAU;
use worker::simulate::{LaneWidth, SimulateOptions, SimulationInput, simulate, simulate_side_by_side};

const JOURNAL: f64 = 9.95e-3;
const BORE: f64 = 10e-3;
const WIDTH: f64 = 20e-3;
const COEFFICIENT: f64 = 1e-13;
const CYCLES: f64 = 1000.0;

/// A block hung on a turning shaft, with these `[[conditions]]`.
fn hung(conditions: &str) -> Scene {
    let text = include_str!("scenes/hung-block.toml").replace("@conditions@", conditions);
    SceneSource::parse(&text, "hung block").expect("valid").nominal().clone()
}

fn run(scene: &Scene) -> Evaluation {
    simulate(scene, &scene.accuracy.accuracy, SimulateOptions::default()).expect("simulated")
}

/// Worn volume [m^3].
fn volume(evaluation: &Evaluation) -> f64 {
    let depth = &evaluation.joints[0].wear_depth;
    let area: f64 = depth.iter().map(|h| 0.5 * ((BORE + h).powi(2) - BORE * BORE)).sum();
    area * TAU / depth.len() as f64 * WIDTH
}

/// Volume K F s of a force [N] over the cycles.
fn archard(coefficient: f64, force: f64) -> f64 {
    coefficient * force * TAU * JOURNAL * CYCLES
}

#[test]
fn worn_volumes_add_up_with_the_shares_of_the_cycles() {
    // Half the weight at four times the speed, and a wear coefficient of three times the other: cycles count, whatever time they take.
    let scene = hung(
        r#"[[conditions]]
name = "heavy"
share = 0.7
[[conditions]]
name = "fast"
share = 0.3
changes = { "gravity.y" = "0.5 * 9.81 m/s^2", parameters.shaft_speed = "4 * shaft_speed", joints.hub.wear_coefficient = "3e-13 1/Pa" }
"#,
    );
    let periods: Vec<f64> = scene.conditions.iter().map(|condition| condition.scene.life.period).collect();
    assert!((periods[0] - 0.2).abs() < 1e-15 && (periods[1] - 0.05).abs() < 1e-15, "{periods:?}");
    let both = run(&scene);
    let exact = 0.7 * archard(COEFFICIENT, 9.81) + 0.3 * archard(3.0 * COEFFICIENT, 0.5 * 9.81);
    let ratio = volume(&both) / exact;
    println!("volume over the weighted sum of K F s: {ratio:.6}");
    assert!((ratio - 1.0).abs() < 2e-3, "{ratio}");
    // On the unworn bores, the worst of the conditions by themselves.
    let alone: Vec<_> = scene.conditions.iter().map(|condition| run(&condition.scene).start[1]).collect();
    assert!(alone[0] > alone[1] && both.start[1] == alone[0], "{alone:?} and {:?}", both.start);
    // Contacts on opposite sides wear one spot each.
    let scene = hung(
        r#"[[conditions]]
name = "up"
share = 0.75
[[conditions]]
name = "down"
share = 0.25
changes = { "gravity.y" = "-9.81 m/s^2" }
"#,
    );
    let both = run(&scene);
    let depth = &both.joints[0].wear_depth;
    // Where gravity pulls to +y, the journal presses on the side of -y.
    let half = |from: usize| depth[from..from + 18].iter().sum::<f64>();
    let (up, down) = (half(18), half(0));
    println!("share of the wear of the first condition: {:.5}", up / (up + down));
    assert!((up / (up + down) - 0.75).abs() < 1e-3, "{up} and {down}");
    let ratio = volume(&both) / archard(COEFFICIENT, 9.81);
    assert!((ratio - 1.0).abs() < 2e-3, "{ratio}");
}

/// The scene with two conditions that change nothing.
fn twice(scene: &Scene, share: f64) -> Scene {
    let alike = |name: &str, share| Condition {
        name: name.into(),
        share,
        scene: scene.clone(),
        parameters: BTreeMap::new(),
    };
    Scene { conditions: vec![alike("one", share), alike("other", 1.0 - share)], ..scene.clone() }
}

#[test]
fn two_equal_conditions_are_one() {
    for (name, accuracy) in [("four-bar", Accuracy::balanced()), ("flapping-wing", Accuracy::draft())] {
        let one = short(name, &[], 2000);
        let simulate =
            |scene: &Scene| simulate(scene, &accuracy, SimulateOptions::default()).expect("simulated");
        let (single, double) = (simulate(&one), simulate(&twice(&one, 0.4)));
        for (k, output) in one.outputs.iter().enumerate() {
            let pairs = single.histories[k].iter().zip(&double.histories[k]);
            for ((a, b), stated) in pairs.zip(&single.errors[k]) {
                println!(
                    "{name} {}: {a:e}, as two equal conditions {:e} off, stated error {stated:e}",
                    output.name,
                    a - b
                );
                assert!((a - b).abs() < 0.1 * stated, "{name}, {}: {a:e} and {b:e}, {stated:e}", output.name);
            }
            for (a, b) in single.errors[k].iter().zip(&double.errors[k]) {
                assert!((a / b - 1.0).abs() < 0.05, "{name}, {}: errors {a:e} and {b:e}", output.name);
            }
        }
        assert_eq!(double.diagnostics.simulated_cycles, 2 * single.diagnostics.simulated_cycles);
        assert_eq!(double.diagnostics.quasi_static, single.diagnostics.quasi_static);
    }
}

#[test]
fn a_duty_cycle_does_not_depend_on_lanes() {
    let mut scene = short("flapping-wing", &[], 1000);
    let slow = short("flapping-wing", &[("parameters.crank_speed", 40.0)], 1000);
    let condition = |name: &str, share, scene: &Scene| Condition {
        name: name.into(),
        share,
        scene: scene.clone(),
        parameters: BTreeMap::new(),
    };
    scene.conditions = vec![condition("fast", 0.6, &scene), condition("slow", 0.4, &slow)];
    let accuracy = Accuracy::draft();
    let alone = simulate(&scene, &accuracy, SimulateOptions::default());
    assert!(alone.is_ok());
    let input = SimulationInput { scene, accuracy, options: SimulateOptions::default() };
    let mut inputs = vec![input.clone(), input].into_iter();
    let mut outcomes = vec![];
    simulate_side_by_side(LaneWidth::Widest, 2, &mut || inputs.next().map(Ok), &mut |_, outcome, _| {
        outcomes.push(outcome)
    });
    assert_eq!(outcomes, [alone.clone(), alone]);
}
