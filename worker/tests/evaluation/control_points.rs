//! What the number of control points changes, and the stated errors.

use crate::scenes::{every_joint, short};
use common::accuracy::Accuracy;
use common::outputs::Evaluation;
use common::scene::{ContactLaw, ControlPoints, Scene};
use worker::simulate::{SimulateOptions, simulate};

/// An evaluation at `draft` with this many control points, which are no part of the model.
fn with_points(scene: &Scene, law: ContactLaw, points: usize) -> Evaluation {
    let mut scene = scene.clone();
    scene.control_points_of_model = false;
    every_joint(&mut scene, |clearance| {
        (clearance.contact_law, clearance.control_points) = (law, ControlPoints::Number(points));
    });
    simulate(&scene, &Accuracy::draft(), SimulateOptions::default()).expect("simulated")
}

/// Largest distance of the values of `output` in both evaluations, over the stated error of those in the first [1].
fn largest_ratio(output: usize, of: &Evaluation, finer: &Evaluation) -> f64 {
    let values = of.histories[output].iter().zip(&finer.histories[output]);
    let ratios = values.zip(&of.errors[output]).map(|((own, finer), error)| (own - finer).abs() / error);
    ratios.fold(0.0, f64::max)
}

#[test]
fn issue_the_asymmetry_of_the_drive_was_stated_as_if_it_converged_with_the_control_points() {
    let scene = short("flapping-wing", &[], 72_000);
    let [own, four_times] = [36, 144].map(|points| with_points(&scene, ContactLaw::LocalHertz, points));
    let ratios = [0, 1].map(|output| largest_ratio(output, &own, &four_times));
    println!("over the stated error {ratios:?}");
    assert!(ratios.iter().all(|ratio| *ratio < 2.0), "{ratios:?}");
    let [found] = &own.diagnostics.control_points[..] else { panic!("one output of the motion") };
    assert!(!found.converges && found.stated && found.error > 0.1 * found.values[0], "{found:?}");
    // Where the points are a part of the model, an evaluation that shows its first cycle has the size of the error beside its values.
    let of_model = |options| simulate(&scene, &Accuracy::draft(), options).expect("simulated");
    let (plain, shown) = (of_model(SimulateOptions::default()), of_model(SimulateOptions::WITH_FIRST_CYCLE));
    assert_eq!((&plain.histories, &plain.errors), (&shown.histories, &shown.errors));
    assert!(plain.diagnostics.control_points.is_empty());
    let [found] = &shown.diagnostics.control_points[..] else { panic!("one output of the motion") };
    assert!(!found.stated && found.error > 0.1 * found.values[0], "{found:?}");
}
