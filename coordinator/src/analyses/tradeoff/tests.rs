//! Comparison and pages of made-up histories.

use super::measure::Measurement;
use super::*;
use crate::farm::evaluate::Finished;
use common::accuracy::NamedAccuracy;
use common::failure::SimulationFailure;
use common::outputs::{Diagnostics, Evaluation};
use common::scene::{Scene, SceneSource};

fn finished(wall: f64, outcome: Result<Evaluation, SimulationFailure>) -> Finished {
    Finished { id: 0, outcome, worker: String::new(), wall }
}

fn measured(seconds: f64, history: &[f64], stated: f64) -> Finished {
    let evaluation = Evaluation {
        cycles: (1..=history.len() as u32).map(|k| 1000 * k).collect(),
        histories: vec![history.to_vec(); 2],
        errors: vec![vec![stated; history.len()]; 2],
        joints: vec![],
        first_cycle: None,
        worn: None,
        start: vec![],
        diagnostics: Diagnostics { steps: 100, ..Diagnostics::default() },
    };
    finished(seconds, Ok(evaluation))
}

/// Two outputs, one of them with a limit that nothing reaches.
fn scene() -> Scene {
    let mut scene = SceneSource::builtin("flapping-wing").expect("built in").nominal().clone();
    (scene.limit_states[0].threshold, scene.limit_states[1].threshold) = (2.5, 100.0);
    scene
}

fn reference() -> NamedAccuracy {
    "reference".parse().expect("a preset")
}

fn three() -> Vec<NamedAccuracy> {
    settings(["draft", "balanced", "jump-250"]).expect("names of settings")
}

/// At the nominal point and at a random one, where everything is one higher.
fn measurement() -> Measurement {
    let two_points = |seconds: f64, history: [f64; 4], stated: f64| {
        let higher: Vec<f64> = history.iter().map(|x| x + 1.0).collect();
        vec![measured(seconds, &history, stated), measured(seconds, &higher, stated)]
    };
    Measurement {
        reference: two_points(9.0, [1.0, 2.0, 3.0, 4.0], 0.01),
        settings: vec![
            // Half a unit too high: 2.5 is reached 500 cycles early.
            two_points(1.0, [1.5, 2.5, 3.5, 4.5], 0.3),
            // Slower and worse.
            two_points(2.0, [2.0, 3.0, 4.0, 5.0], 1.0),
            // Wrong only when all is over.
            two_points(3.0, [1.0, 2.0, 3.0, 4.25], 0.1),
        ],
    }
}

#[test]
fn errors_lives_and_the_front_are_those_of_made_up_histories() {
    let rows = compare(&scene(), &three(), &measurement());
    let first = rows[0].outputs[0];
    assert_eq!((first.relative, first.until_limit, first.life), (0.2, 0.2, Some(500.0)));
    assert_eq!((first.stated.within, first.stated.within_twice), (0.0, 1.0));
    assert_eq!(rows[0].outputs[1].life, None, "nothing reaches 100");
    let last = rows[2].outputs[0];
    assert_eq!((last.relative, last.until_limit), (0.1, 0.0));
    assert_eq!((last.stated.within, last.stated.points_missed), (0.75, 2));
    assert_eq!(rows.iter().map(|r| r.efficient).collect::<Vec<_>>(), [true, false, true]);

    // The random point reaches 2.5 with its second value, 3; with the second setting already with its first, 3.
    let wear = |k: usize| rows[k].lives.iter().find(|l| l.limit_state == "wear").expect("a limit state");
    assert_eq!((wear(0).changed, wear(2).changed), (1.0, 0.0));
    assert_eq!((wear(1).largest.cycles, wear(1).largest.difference()), (1000, -1.0));
    let states: Vec<&str> = rows[0].lives.iter().map(|l| l.limit_state.as_str()).collect();
    assert_eq!(states, ["wear", "asymmetry", "total"]);
}

#[test]
fn the_reference_is_shown_with_the_error_it_states_of_itself() {
    let row = reference_row(&scene(), &reference(), &measurement());
    assert!((row.outputs[0].relative - 0.01 / 2.5).abs() < 1e-12);
    assert_eq!((row.seconds, row.setting.name.as_str()), (9.0, "reference"));
}

#[test]
fn table_and_csv_contain_all_results() {
    let (scene, measurement) = (scene(), measurement());
    let rows = compare(&scene, &three(), &measurement);
    let answer = answer(&scene, &rows, &reference_row(&scene, &reference(), &measurement), 2);
    let table = answer.text();
    for part in ["500 cycles", "| **draft** * |", "| -1.00 |", "DOES NOT HOLD"] {
        assert!(table.contains(part), "no {part:?} in\n{table}");
    }
    let lines = |text: &str| text.lines().count();
    let file = |name: &str| &answer.files.iter().find(|file| file.0 == name).expect("a file").1;
    let csv = file("tradeoff.csv");
    assert_eq!(lines(csv), 4);
    let columns: Vec<usize> = csv.lines().map(|line| line.split(',').count()).collect();
    assert!(columns.iter().all(|n| *n == columns[0]), "{columns:?}");
    assert!(table.contains("against `reference`") && table.contains("have the control points of the scene"));
    let finer = reference_row(&scene, &"reference+points-x4".parse().unwrap(), &measurement);
    let title = super::answer(&scene, &rows, &finer, 2).text();
    assert!(
        title.contains("against `reference+points-x4`") && !title.contains("points of the scene"),
        "{title}"
    );
    // A line a setting, point, output and checkpoint.
    assert_eq!(lines(&values_csv(&scene, &three(), &measurement)), 1 + 3 * 2 * 2 * 4);
}

#[test]
fn a_setting_that_fails_everywhere_has_no_errors_and_is_on_no_front() {
    let scene = scene();
    let failure = SimulationFailure::NotModelled { what: "this".into() };
    let measurement = Measurement { settings: vec![vec![finished(0.1, Err(failure)); 2]], ..measurement() };
    let rows = compare(&scene, &three()[..1], &measurement);
    assert_eq!((rows[0].failures, rows[0].outputs.len(), rows[0].efficient), (2, 0, false));
    assert!(rows[0].lives.is_empty());
    let answer = answer(&scene, &rows, &reference_row(&scene, &reference(), &measurement), 2);
    assert!(answer.text().contains("failed"));
    let csv = answer.files.iter().find(|file| file.0 == "tradeoff.csv").expect("a table");
    assert_eq!(csv.1.lines().count(), 2);
}
