//! A shaft that turns in a block on a rail, with wear coefficients that only a mistyped unit has.

use common::accuracy::Accuracy;
use common::failure::SimulationFailure;
use common::scene::{Scene, SceneSource};
use worker::simulate::{SimulateOptions, simulate};

fn scene(wear: f64, friction: f64) -> Scene {
    let text = include_str!("scenes/mistyped-wear.toml")
        .replace("@wear@", &wear.to_string())
        .replace("@friction@", &friction.to_string());
    SceneSource::parse(&text, "rig").expect("valid").nominal().clone()
}

#[test]
fn issue_a_mistyped_wear_coefficient_ended_in_a_panic() {
    for wear in [1e-9, 3e-9, 1e-8, 3e-8, 1e-7, 1e-6] {
        for friction in [0.05, 0.02] {
            let found = simulate(&scene(wear, friction), &Accuracy::draft(), SimulateOptions::default());
            assert!(
                matches!(
                    found,
                    Err(SimulationFailure::WearStep { .. } | SimulationFailure::WornTooDeep { .. })
                ),
                "{wear} {friction}: {:?}",
                found.map(|evaluation| evaluation.histories)
            );
        }
    }
}
