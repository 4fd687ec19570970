//! The expected cost of an evaluation against the time it takes.

use crate::scenes::{every_joint, scene};
use common::accuracy::Accuracy;
use common::scene::{ContactLaw, SceneSource};
use std::time::Instant;
use worker::simulate::{SimulateOptions, first_look, simulate};

///     cargo test --release -p worker --test evaluation expected_cost -- --ignored --nocapture
#[test]
#[ignore = "measures time: for a machine that does nothing else"]
fn the_expected_time_is_within_a_factor_of_one_and_a_half() {
    let mut wrong = vec![];
    for accuracy in [Accuracy::draft(), Accuracy::balanced()] {
        for name in SceneSource::builtin_names() {
            for law in [ContactLaw::LocalHertz, ContactLaw::Foundation] {
                let mut scene = scene(name, &[]);
                every_joint(&mut scene, |clearance| clearance.contact_law = law);
                let expected = first_look(&scene, &accuracy).expect("the first cycle").expected.as_secs_f64();
                let begun = Instant::now();
                let result = simulate(&scene, &accuracy, SimulateOptions::default());
                let taken = begun.elapsed().as_secs_f64();
                let ratio = expected / taken;
                println!("{name} {law:?}: expected {expected:.3} s, taken {taken:.3} s, ratio {ratio:.2}");
                // Evaluations of some milliseconds are too short to tell.
                let is_right = (1.0 / 1.5..1.5).contains(&ratio) || taken < 0.05 || result.is_err();
                if !is_right {
                    wrong.push(format!("{name} {law:?}: expected {expected} s, taken {taken} s"));
                }
            }
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}
