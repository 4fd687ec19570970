//! Evaluations side by side in lanes: each as if it were alone, in lanes of any width.

use crate::scenes::{RPM, every_joint, short};
use common::accuracy::Accuracy;
use common::failure::SimulationFailure;
use common::outputs::Evaluation;
use common::scene::Scene;
use worker::simulate::{Order, Width, simulate, simulate_together};

type Outcome = Result<Evaluation, SimulationFailure>;

/// The outcomes of these orders, `most` of them side by side.
fn together(width: Width, most: usize, orders: &[Result<Order, SimulationFailure>]) -> Vec<Outcome> {
    let mut outcomes = vec![None; orders.len()];
    let mut orders = orders.iter().cloned();
    simulate_together(width, most, &mut || orders.next(), &mut |number, outcome, _| {
        assert!(outcomes[number].replace(outcome).is_none(), "number {number} ends once");
    });
    outcomes.into_iter().map(|outcome| outcome.expect("all come to their end")).collect()
}

fn order(scene: Scene, accuracy: Accuracy, with_first_cycle: bool) -> Order {
    Order { scene, accuracy, with_first_cycle }
}

/// Lives of a thousand cycles that have little in common.
fn mixed() -> Vec<Order> {
    let wing = |setting: (&str, f64)| short("flapping-wing", &[setting], 1000);
    let mut hard = short("flapping-wing", &[], 1000);
    every_joint(&mut hard, |joint| joint.friction = 0.2);
    let mut few = Accuracy::draft();
    few.steps_bound = 2000;
    vec![
        order(wing(("parameters.crank_speed", 460.0 * RPM)), Accuracy::draft(), false),
        order(short("four-bar", &[], 1000), Accuracy::balanced(), true),
        order(hard, Accuracy::draft(), false),
        order(wing(("bushing_radius_2", 1.5237e-3)), Accuracy::balanced(), true),
        order(short("flapping-wing", &[], 1000), few, false),
        order(short("flapping-wing-tolerances", &[], 1000), Accuracy::draft(), false),
    ]
}

#[test]
fn nobody_is_touched_by_those_beside() {
    let orders = mixed();
    let alone: Vec<Outcome> =
        orders.iter().map(|o| simulate(&o.scene, &o.accuracy, o.with_first_cycle)).collect();
    assert!(matches!(alone[4], Err(SimulationFailure::TooManySteps { .. })), "{:?}", alone[4]);
    assert_eq!(alone.iter().filter(|outcome| outcome.is_ok()).count(), 5);
    let mut orders: Vec<_> = orders.into_iter().map(Ok).collect();
    assert_eq!(together(Width::Widest, 6, &orders), alone);
    // In another order and in other company.
    let mut backwards = alone;
    orders.reverse();
    backwards.reverse();
    assert_eq!(together(Width::Widest, 3, &orders), backwards);
}

#[test]
fn lanes_of_any_width_give_the_same_bits() {
    let orders: Vec<_> = mixed().into_iter().map(Ok).collect();
    assert_eq!(together(Width::One, 2, &orders), together(Width::Widest, 4, &orders));
}

#[test]
fn what_is_no_order_comes_back_in_its_place() {
    let wrong = SimulationFailure::InvalidSample { faults: "made up".into() };
    let sound = order(short("four-bar", &[], 1000), Accuracy::draft(), false);
    let outcomes = together(Width::Widest, 2, &[Err(wrong.clone()), Ok(sound), Err(wrong.clone())]);
    assert_eq!(outcomes[0], Err(wrong.clone()));
    assert!(outcomes[1].is_ok());
    assert_eq!(outcomes[2], Err(wrong));
}
