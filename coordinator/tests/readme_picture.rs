//! The picture at the head of the README is the figure that the program draws from the numbers in the same folder.
//!
//! Both come from `coordinator run --scene flapping-wing --out study`: `study/figures/reliability.svg` and
//! `study/reliability.csv`.

use common::accuracy::Accuracy;
use coordinator::presentation::report::{reliability_figure, standalone};
use coordinator::results::summary::StudySummary;
use serde_json::{Map, Value, json};

const PICTURE: &str = include_str!("../doc/reliability.svg");
const NUMBERS: &str = include_str!("../doc/reliability.csv");

/// The part of a study that its `reliability.csv` holds.
fn study() -> StudySummary {
    let mut lines = NUMBERS.lines().map(|line| line.split(',').collect::<Vec<_>>());
    let head = lines.next().unwrap();
    let states: Vec<&str> = head.iter().filter_map(|name| name.strip_prefix("R_")).collect();
    let row = |line: Vec<&str>| {
        let number = |name: String| -> f64 {
            line[head.iter().position(|column| *column == name).unwrap()].parse().unwrap()
        };
        let mut row: Map<String, Value> =
            states.iter().map(|state| ((*state).to_owned(), number(format!("R_{state}")).into())).collect();
        let errors: Map<String, Value> =
            states.iter().map(|state| ((*state).to_owned(), number(format!("se_{state}")).into())).collect();
        row.insert("cycles".into(), line[0].parse::<u32>().unwrap().into());
        row.insert("standard_error".into(), errors.into());
        Value::Object(row)
    };
    let states_alone: Vec<&&str> = states.iter().filter(|state| **state != "total").collect();
    let study = json!({
        "scene": "flapping-wing", "version": "", "seed": 1, "method": "ak", "accuracy": "balanced",
        "accuracy_settings": Accuracy::balanced(), "max_error": null, "population": 100_000,
        "evaluations": { "total": 0, "initial": 0, "added": 0, "failed": 0 },
        "limit_states": states_alone, "reliability": lines.map(row).collect::<Vec<_>>(), "moments": [], "sensitivity": [],
        "convergence": { "stopped_because": "", "targets_met": true, "rounds": [] },
        "timing_s": { "total": 0.0, "simulation": 0.0, "surrogate": 0.0, "idle": 0.0 }, "workers": [],
    });
    serde_json::from_value(study).unwrap()
}

#[test]
fn the_picture_is_drawn_from_its_numbers() {
    let study = study();
    assert_eq!((study.limit_states.len(), study.reliability.len()), (2, 72));
    let figure = reliability_figure(&study).unwrap().expect("there is a life to draw");
    assert!(standalone(&figure) == PICTURE, "coordinator/doc/reliability.svg is not what its numbers give");
}
