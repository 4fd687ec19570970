//! The page of result files names every file, field, column and table of a real study.

use crate::markdown::{assert_none, quoted, read};
use crate::quick_study::followed;
use common::accuracy::{Accuracy, KNOBS};
use serde_json::Value;
use std::collections::BTreeSet;
use std::process::Command;
use tests::skipped;

/// Words between backquotes on a page, taken apart at what is no part of a name.
fn named(page: &str) -> BTreeSet<String> {
    let text = read(page);
    let names =
        quoted(&text).into_iter().flat_map(|span| span.split([',', ' ', ':', '='])).map(str::to_owned);
    names.filter(|name| !name.is_empty()).collect()
}

/// Every key of a JSON value, at any depth.
fn keys(value: &Value, into: &mut BTreeSet<String>) {
    match value {
        Value::Object(fields) => fields.iter().for_each(|(key, value)| {
            into.insert(key.clone());
            keys(value, into);
        }),
        Value::Array(items) => items.iter().for_each(|item| keys(item, into)),
        _ => {}
    }
}

#[test]
fn every_result_has_its_place_on_the_page() {
    let known = named("coordinator/doc/results.md");
    let folder = &followed().folder;
    let mut found: BTreeSet<String> = std::fs::read_dir(folder)
        .unwrap()
        .map(|entry| {
            let entry = entry.unwrap();
            let name = entry.file_name().into_string().unwrap();
            if entry.file_type().unwrap().is_dir() { format!("{name}/") } else { name }
        })
        .collect();
    let mut summary: Value =
        serde_json::from_str(&std::fs::read_to_string(folder.join("summary.json")).unwrap()).unwrap();
    // Settings have a page of their own; limit states and outputs are the scene's.
    summary["accuracy_settings"] = Value::Null;
    keys(&summary, &mut found);
    let connection = rusqlite::Connection::open(folder.join("campaign.db")).unwrap();
    let mut columns = connection
        .prepare(
            "SELECT m.name, c.name FROM sqlite_master m, pragma_table_info(m.name) c WHERE m.type = 'table'",
        )
        .unwrap();
    let rows = columns.query_map([], |row| Ok([row.get::<_, String>(0)?, row.get::<_, String>(1)?])).unwrap();
    found.extend(rows.flat_map(|row| row.unwrap()));
    let of_the_scene = [
        "wear",
        "wear_mean_m",
        "wear_std_m",
        "wear_coefficient",
        "load_torque",
        "clearance_crank",
        "friction",
        "max_wear_depth",
        "coupler_joint_speed",
    ];
    found.retain(|name| !of_the_scene.contains(&name.as_str()));
    let csv = |file: &str| std::fs::read_to_string(folder.join(file)).unwrap();
    for column in csv("reliability.csv").lines().next().unwrap().split(',') {
        found.insert(column.replace("total", "STATE").replace("wear", "STATE"));
    }
    for column in csv("samples.csv").lines().next().unwrap().split(',') {
        if !column.contains('@') && !of_the_scene.contains(&column) {
            found.insert(column.to_owned());
        }
    }
    let missing: Vec<String> = found.difference(&known).cloned().collect();
    assert_none(&missing);
}

#[test]
fn every_setting_of_the_accuracy_has_its_place_on_the_page() {
    let known = named("coordinator/doc/accuracy.md");
    let mut found: BTreeSet<String> = Accuracy::NAMES.iter().map(|name| (*name).to_owned()).collect();
    keys(&serde_json::to_value(Accuracy::balanced()).unwrap(), &mut found);
    let knobs = KNOBS.split(';').filter_map(|knob| knob.trim().split([':', ' ']).next());
    found.extend(knobs.map(str::to_owned));
    let missing: Vec<String> = found.difference(&known).cloned().collect();
    assert_none(&missing);
}

/// The Python of the page reads the study of the front page.
#[test]
fn the_python_of_the_page_reads_a_study() {
    let page = read("coordinator/doc/results.md");
    let block = page.split("```python\n").nth(1).and_then(|rest| rest.split("```").next()).unwrap();
    let folder = followed().folder.parent().unwrap();
    let total = "total = __import__('json').load(open('study/summary.json'))['evaluations']['total']";
    let checked =
        format!("{block}\n{total}\nassert len(curve) == 8 and len(depth) == total, (len(curve), len(depth))");
    match Command::new("python3").args(["-c", &checked]).current_dir(folder).output() {
        Ok(output) => {
            assert!(output.status.success(), "{block}\n{}", String::from_utf8_lossy(&output.stderr))
        }
        Err(error) => skipped("Python of the page of results", &error.to_string()),
    }
}
