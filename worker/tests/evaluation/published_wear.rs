//! The published forms of the wear over a life.

use crate::scenes::{at, scene, short};
use common::accuracy::Accuracy;
use common::scene::{BlockStep, BoreSpline, WearDistribution, WearModel};
use worker::simulate::{SimulateOptions, simulate};

/// Largest wear after 1000 cycles as published: that of one explicit step from the unworn bores, which grows evenly.
#[test]
fn the_drive_as_published_wears_by_one_explicit_step_of_a_thousand_cycles() {
    let mut drive = short("flapping-wing-as-published", &[], 2000);
    drive.life.checkpoint_every = 500;
    let evaluation = simulate(&drive, &Accuracy::draft(), SimulateOptions::default()).expect("simulated");
    let wear = |cycles| at(&evaluation, 0, cycles);
    assert_eq!(wear(500), 0.5 * wear(1000));
    // New bores wear fastest, so that the first step of this length wears too much.
    assert!(wear(2000) - wear(1000) < 0.9 * wear(1000), "{} and {} m", wear(1000), wear(2000));
    let mut controlled = drive.clone();
    controlled.wear = WearModel::default();
    let controlled =
        simulate(&controlled, &Accuracy::draft(), SimulateOptions::default()).expect("simulated");
    assert!(wear(1000) > 1.3 * at(&controlled, 0, 1000), "{} m", wear(1000));
}

#[test]
fn every_choice_of_the_wear_model_changes_the_wear() {
    let of = |wear: WearModel| {
        let mut drive = short("flapping-wing", &[], 2000);
        drive.wear = wear;
        let evaluation = simulate(&drive, &Accuracy::draft(), SimulateOptions::default());
        at(&evaluation.expect("simulated"), 0, 2000)
    };
    let default = WearModel::default();
    let explicit = WearModel { explicit_step: BlockStep::Explicit(1000), ..default };
    let inside = WearModel { distribution: WearDistribution::PointsInside, ..explicit };
    let approximating = WearModel { spline: BoreSpline::Approximating, ..default };
    let found = [default, explicit, inside, approximating].map(of);
    for other in &found[1..] {
        assert!((other / found[0] - 1.0).abs() > 0.01, "{found:?}");
    }
    assert_ne!(found[1], found[2]);
}

#[test]
fn a_scene_without_choices_is_the_drive_as_it_stands() {
    assert_eq!(scene("flapping-wing", &[]).wear, WearModel::default());
}
