//! Faults of joints, drives, tables, loads, outputs and life: each named by file, key, value and what is allowed.

mod conditions;
mod drives;
mod joints;
mod life;
mod outputs;

use common::scene::SceneSource;
use proptest::prelude::*;

const EVERYTHING: &str = include_str!("../../scenes/everything.toml");

/// The faults after replacing one piece of the scene's text, where it stands first after `place`.
fn faults(place: &str, from: &str, to: &str) -> Vec<String> {
    let start = EVERYTHING.find(place).unwrap_or_else(|| panic!("the scene has no {place}"));
    let (before, after) = EVERYTHING.split_at(start);
    assert!(after.contains(from), "the scene has no {from} after {place}");
    let text = format!("{before}{}", after.replacen(from, to, 1));
    match SceneSource::parse(&text, "my.toml") {
        Ok(_) => panic!("{to} was accepted"),
        Err(faults) => {
            assert!(faults.0.iter().all(|fault| fault.location.is_some()), "without a place: {faults}");
            faults.0.iter().map(ToString::to_string).collect()
        }
    }
}

/// One fault, which is this one, after a replacement in the row of this name.
#[track_caller]
fn one_fault(place: &str, from: &str, to: &str, expected: &str) {
    let found = faults(&format!("name = \"{place}\""), from, to);
    assert_eq!(found.len(), 1, "{found:#?}");
    assert!(found[0].contains(expected), "found    {}\nexpected {expected}", found[0]);
    assert!(found[0].starts_with("my.toml: "), "{}", found[0]);
}

#[test]
fn every_row_of_the_table_is_one_fault() {
    for [place, from, to, expected] in crate::rows("one fault of everything") {
        one_fault(place, from, to, expected);
    }
}

#[test]
fn computed_values_are_shown_in_readable_units() {
    let source = SceneSource::parse(EVERYTHING, "my.toml").unwrap();
    let wall = source.parse_setting("joints.worn.wall = -0.2 cm").unwrap();
    let found = source.resolve_with(&[wall]).unwrap_err().to_string();
    assert!(
        found.contains("joints.worn.wall: -2 mm (set from outside) is out of range, allowed: > 0"),
        "{found}"
    );
}

#[test]
fn faults_of_all_parts_at_once() {
    let text = EVERYTHING
        .replacen("\"20 ms\"", "\"20 N\"", 1)
        .replacen("axis = \"15 deg\"", "axis = \"15 N\"", 1)
        .replacen("restitution = 0.9", "restitution = 2", 1)
        .replacen("no_load_speed = \"-3000 r/min\"", "no_load_speed = \"0 r/min\"", 1)
        .replacen(
            "type = \"driving-torque\"\nbody = \"crank\"",
            "type = \"driving-torque\"\nbody = \"rod\"",
            1,
        )
        .replacen("settle_cycles = 3", "settle_cycles = -3", 1);
    let found = SceneSource::parse(&text, "my.toml").unwrap_err();
    let keys: Vec<_> = found.0.iter().map(|fault| fault.key.as_str()).collect();
    let expected = [
        "bodies.wheel.speed.at.2",
        "joints.guide.axis",
        "joints.unworn.contact_damping.restitution",
        "loads.motor.no_load_speed",
        "outputs.torque.body",
        "life.settle_cycles",
    ];
    assert_eq!(keys, expected);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(100))]

    /// Lines moved into other rows, lost, and cut short.
    #[test]
    fn no_mutilated_scene_panics(lost in 0usize..360, one in 0usize..360, other in 0usize..360, end in 0usize..7600) {
        let mut lines: Vec<&str> = EVERYTHING.lines().collect();
        let last = lines.len() - 1;
        lines.swap(one.min(last), other.min(last));
        lines.remove(lost.min(last));
        let text = lines.join("\n");
        let _ = SceneSource::parse(&text, "mutilated");
        let _ = SceneSource::parse(text.get(..end).unwrap_or(&text), "mutilated");
    }

    /// Entries of lists replaced, lost, and doubled: arguments out of order, lists of another length, other kinds.
    #[test]
    fn no_mutilated_table_panics(line in 0usize..20, from in 0usize..8, entry in "\"-?[0-9]{1,3} (s|deg|N|r/min)\"|") {
        let tables: Vec<&str> = EVERYTHING.lines().filter(|line| line.contains("over = ")).collect();
        let table = tables[line % tables.len()];
        let mut pieces: Vec<&str> = table.split(", ").collect();
        let at = from % pieces.len();
        pieces[at] = &entry;
        let _ = SceneSource::parse(&EVERYTHING.replacen(table, &pieces.join(", "), 1), "mutilated");
    }
}
