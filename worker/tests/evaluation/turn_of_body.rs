//! A machine under a motor whose cycle is one turn of its crank, or a time that is no turn.

use crate::scenes::shared;
use crate::settling::run;
use common::accuracy::Accuracy;
use common::outputs::Evaluation;
use std::f64::consts::TAU;
use worker::simulate::{SimulateOptions, simulate};

/// Worn volume per time of the settled machine [m^3/s], by an independent integration (DOP853, ideal joints, K F v).
const WEAR_RATE: f64 = 1.3231e-12;

/// Worn volume per time and its stated error [m^3/s], and the length of a cycle [s].
fn wear_rate(evaluation: &Evaluation, accuracy_period: f64) -> (f64, f64) {
    let life = 1000.0 * accuracy_period;
    (evaluation.histories[0][0] / life, evaluation.errors[0][0] / life)
}

#[test]
fn issue_an_undriven_machine_could_not_take_a_turn_of_a_body_as_its_period() {
    let turning = shared("motor-driven");
    let evaluation =
        simulate(&turning, &Accuracy::draft(), SimulateOptions::WITH_FIRST_CYCLE).expect("simulated");
    let first = evaluation.first_cycle.as_ref().expect("asked for");
    let period = first.time[first.time.len() - 1];
    let crank = first.motion.iter().find(|motion| motion.body == "crank").expect("moves");
    let turned = crank.angle[crank.angle.len() - 1] - crank.angle[0];
    assert!((turned / TAU - 1.0).abs() < 1e-6, "{turned} in {period} s");
    let (rate, error) = wear_rate(&evaluation, period);
    println!("period {period} s: {rate:e} +- {error:e} m^3/s, {:?}", evaluation.diagnostics);
    assert!((rate - WEAR_RATE).abs() < error + 1e-4 * WEAR_RATE, "{rate:e} +- {error:e}");
    assert!(error < 0.02 * WEAR_RATE, "{error:e}");
    assert_eq!(evaluation.diagnostics.unsettled, None);
}

#[test]
fn issue_a_cycle_that_is_no_turn_was_taken_for_one_that_repeats() {
    let mut timed = shared("motor-driven");
    (timed.life.period, timed.life.turn_of) = (0.04, None);
    let evaluation = run(&timed, &Accuracy::draft());
    let unsettled = evaluation.diagnostics.unsettled.as_ref().expect("pointed out");
    let (body, angle) = unsettled.turning.as_ref().expect("turns");
    println!("{unsettled:?}, turns {} deg", angle.to_degrees());
    assert!(body == "crank" && (angle.to_degrees() - 329.5).abs() < 25.0, "{body} {angle}");
    let (rate, error) = wear_rate(&evaluation, 0.04);
    println!("{rate:e} +- {error:e} m^3/s");
    assert!((rate - WEAR_RATE).abs() < error, "{rate:e} +- {error:e}");
}
