//! Values at checkpoints between the simulated lives.

use common::accuracy::Accuracy;
use common::scene::SceneSource;
use worker::simulate::{SimulateOptions, simulate};

/// A crank that drives a loaded piston; the bore of its rod wears. Blocks end after 5, 10, 20, 40 and 80 cycles.
const PRESS: &str = include_str!("scenes/press.toml");

#[test]
fn issue_worn_volumes_within_a_block_were_off_by_several_stated_errors() {
    let scene = SceneSource::parse(PRESS, "press").expect("valid").nominal().clone();
    let evaluation = simulate(&scene, &Accuracy::draft(), SimulateOptions::default()).expect("simulated");
    let (values, errors) = (&evaluation.histories[0], &evaluation.errors[0]);
    // Under the contact history of a block the volume grows by K F S in every cycle: on a straight line from 40 to 80 cycles.
    assert_eq!(evaluation.cycles, [10, 20, 30, 40, 50, 60, 70, 80]);
    for k in 4..7 {
        let line = values[3] + (values[7] - values[3]) * 0.25 * (k - 3) as f64;
        let off = (values[k] - line).abs();
        println!("{off:e} of {line:e} +- {:e}", errors[k]);
        assert!(off < 2e-5 * line && off < errors[k], "{off:e} of {line:e} +- {:e}", errors[k]);
    }
}
