//! The picture at the head of the README is the figure that the program draws from the numbers in the same folder.
//!
//! All come from `coordinator run flapping-wing --out study`: `study/figures/reliability.svg`, `study/reliability.csv`, and
//! of `study/summary.json` what the figure needs.

use coordinator::presentation::report::{reliability_figure, standalone};
use coordinator::results::summary::StudySummary;

const PICTURE: &str = include_str!("../../doc/reliability.svg");
const NUMBERS: &str = include_str!("../../doc/reliability.csv");
const SUMMARY: &str = include_str!("../../doc/reliability.json");

#[test]
fn the_picture_is_drawn_from_its_numbers() {
    let study: StudySummary = serde_json::from_str(SUMMARY).unwrap();
    assert_eq!((study.limit_states.len(), study.reliability.len()), (2, 72));
    let figure = reliability_figure(&study).unwrap();
    assert!(standalone(&figure) == PICTURE, "coordinator/doc/reliability.svg is not what its numbers give");
}

#[test]
fn the_table_has_the_numbers_of_the_picture() {
    let study: StudySummary = serde_json::from_str(SUMMARY).unwrap();
    let mut lines = NUMBERS.lines().map(|line| line.split(',').collect::<Vec<_>>());
    let head = lines.next().unwrap();
    for (row, line) in study.reliability.iter().zip(lines) {
        for (name, reliability) in &row.reliability {
            let column = head.iter().position(|column| *column == format!("R_{name}")).unwrap();
            assert_eq!(line[column].parse::<f64>().unwrap(), *reliability, "{name} at {}", row.cycles);
        }
    }
}
