//! The JSON Schemas that the program prints, against the reader of scenes and the results of a study.

use common::scene::{FaultKind, SceneSource};
use jsonschema::error::ValidationErrorKind;
use jsonschema::{Validator, draft202012};
use serde_json::{Value, json};
use std::collections::BTreeSet;

const EVERYTHING: &str = include_str!("../../../common/tests/scenes/everything.toml");
const MEASURED: &str = include_str!("../../../common/tests/scenes/measured.toml");
const BEAM: &str = "scene = { name = \"beam\" }\nsimulator = { program = [\"python3\", \"beam.py\"], timeout = \"2 min\" }\n\
                    [[outputs]]\nname = \"deflection\"\nunit = \"mm\"\nvalues = 1\n[[limit_states]]\nname = \"bent\"\n\
                    output = \"deflection\"\nthreshold = 12.5\nfails = \"below\"\n[[variables]]\nname = \"load\"\nmean = \"2 kN\"\n\
                    std = \"5 %\"\n";

const CYCLE: &str = include_str!("../../../common/tests/scenes/cycle.toml");

fn scene_schema() -> (Value, Validator) {
    let schema = crate::json(&["schema"]);
    let validator = draft202012::new(&schema).unwrap();
    (schema, validator)
}

/// A scene as the JSON that editors check.
fn as_json(text: &str) -> Value {
    serde_json::to_value(text.parse::<toml::Table>().unwrap()).unwrap()
}

/// What the schema says against a scene, with the places.
fn objections(validator: &Validator, scene: &Value) -> Vec<String> {
    validator.iter_errors(scene).map(|error| format!("{}: {error}", error.instance_path())).collect()
}

#[test]
fn the_schemas_are_schemas() {
    for arguments in [&["schema"][..], &["schema", "--results"]] {
        let schema = crate::json(arguments);
        assert!(draft202012::meta::is_valid(&schema), "{arguments:?}");
        assert!(schema["$schema"].as_str().unwrap().ends_with("2020-12/schema"));
    }
}

#[test]
fn every_valid_scene_is_valid() {
    let (_, validator) = scene_schema();
    let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../common/scenes");
    let built_in = SceneSource::builtin_names().into_iter().map(|name| {
        (name, std::fs::read_to_string(folder.join(format!("{name}.toml"))).expect("a built-in scene"))
    });
    let template = include_str!("../../src/cli/init.toml").replace("@name@", "press");
    let own = [("everything", EVERYTHING.to_owned()), ("beam", BEAM.to_owned()), ("init", template)];
    let own = own.into_iter().chain([("measured", MEASURED.to_owned()), ("cycle", CYCLE.to_owned())]);
    let mut count = 0;
    for (name, text) in built_in.chain(own) {
        // Two scenes name files beside them.
        let alone = !["flapping-wing-tolerances", "measured"].contains(&name);
        assert!(!alone || SceneSource::parse(&text, name).is_ok(), "{name}");
        assert_eq!(objections(&validator, &as_json(&text)), [""; 0], "{name}");
        count += 1;
    }
    assert!(count > 9);
    // As it is sent and stored, without CSV files.
    let folder =
        std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../common/tests/scenes/measured.toml");
    let measured = SceneSource::load(folder.to_str().unwrap()).unwrap();
    assert_eq!(objections(&validator, &as_json(measured.text())), [""; 0]);
}

/// Faults of structure: another type, an unknown word, a missing key.
#[test]
fn faults_of_structure_are_found() {
    let (_, validator) = scene_schema();
    for [from, to] in crate::rows("faults_of_structure_are_found") {
        assert!(EVERYTHING.contains(from), "{from}");
        let text = EVERYTHING.replacen(from, to, 1);
        assert!(SceneSource::parse(&text, "my.toml").is_err(), "the program takes {to}");
        assert!(!validator.is_valid(&as_json(&text)), "the schema takes {to}");
    }
    for (from, to) in [
        ("samples = { csv = \"measured-friction.csv\" }", "samples = { file = \"measured-friction.csv\" }"),
        ("fit = \"lognormal\"", "fit = \"lognormel\""),
        ("fit = \"lognormal\"", "distribution = \"lognormal\""),
        ("\"angle\", \"torque\"]", "\"angle\"]"),
    ] {
        let text = MEASURED.replacen(from, to, 1);
        assert!(text != MEASURED && SceneSource::parse(&text, "my.toml").is_err(), "the program takes {to}");
        assert!(!validator.is_valid(&as_json(&text)), "the schema takes {to}");
    }
    for (from, to) in [
        ("program = [", "umbridge = \"http://h:1\", program = ["),
        ("unit = \"mm\"", "type = \"largest-wear\""),
    ] {
        let text = BEAM.replacen(from, to, 1);
        assert!(SceneSource::parse(&text, "my.toml").is_err(), "the program takes {to}");
        assert!(!validator.is_valid(&as_json(&text)), "the schema takes {to}");
    }
}

/// Of the mistakes that the reader is tested with, those are left that a schema cannot express: names of other elements, terms of expressions, and
/// values that depend on others.
#[test]
fn three_quarters_of_the_mistakes_are_marked() {
    let (_, validator) = scene_schema();
    let (tables, four_bar) = (
        include_str!("../../../common/tests/scene/cases.txt"),
        include_str!("../../../common/scenes/four-bar.toml"),
    );
    let (mut marked, mut all) = (0, 0);
    for (section, scene) in [("bad four-bar", four_bar), ("bad everything", EVERYTHING)] {
        for [from, to] in crate::rows::rows(tables, section) {
            // Faults of TOML itself are found by any editor.
            let Ok(table) = scene.replacen(from, to, 1).parse::<toml::Table>() else { continue };
            marked += usize::from(!validator.is_valid(&serde_json::to_value(table).unwrap()));
            all += 1;
        }
    }
    println!("{marked} of {all}");
    assert!(all > 60 && 4 * marked >= 3 * all, "{marked} of {all}");
}

#[test]
fn faults_of_a_program_that_gives_cycles_are_found() {
    let (_, validator) = scene_schema();
    for [from, to] in crate::rows("faults_of_a_program_that_gives_cycles_are_found") {
        assert!(CYCLE.contains(from), "{from}");
        let text = CYCLE.replacen(from, to, 1);
        assert!(SceneSource::parse(&text, "my.toml").is_err(), "the program takes {to}");
        assert!(!validator.is_valid(&as_json(&text)), "the schema takes {to}");
    }
}

/// Every table of a value with its path, as a JSON pointer.
fn tables(value: &Value, path: &str, into: &mut Vec<String>) {
    match value {
        Value::Object(fields) => {
            into.push(path.to_owned());
            fields.iter().for_each(|(key, value)| tables(value, &format!("{path}/{key}"), into));
        }
        Value::Array(items) => {
            items.iter().enumerate().for_each(|(k, value)| tables(value, &format!("{path}/{k}"), into));
        }
        _ => {}
    }
}

/// Every key that the schema has anywhere.
fn keys_of(schema: &Value, into: &mut BTreeSet<String>) {
    match schema {
        Value::Object(fields) => {
            if let Some(Value::Object(properties)) = fields.get("properties") {
                into.extend(properties.keys().cloned());
            }
            fields.values().for_each(|value| keys_of(value, into));
        }
        Value::Array(items) => items.iter().for_each(|item| keys_of(item, into)),
        _ => {}
    }
}

/// Keys that the schema refuses in the table at `path`, whatever their values.
fn refused_keys(validator: &Validator, scene: &Value, path: &str) -> BTreeSet<String> {
    let mut refused = BTreeSet::new();
    for error in validator.iter_errors(scene) {
        let at = error.instance_path().to_string();
        match error.kind() {
            ValidationErrorKind::AdditionalProperties { unexpected } if at == path => {
                refused.extend(unexpected.iter().cloned());
            }
            ValidationErrorKind::PropertyNames { error } if at == path => {
                refused.extend(error.instance().as_str().map(str::to_owned));
            }
            _ => {}
        }
    }
    refused
}

/// Keys that decide which other keys a table has, and those that only some of these allow.
const DECIDING: [&str; 15] = [
    "control_points_of_model",
    "extends",
    "without",
    "simulator",
    "program",
    "fmu",
    "umbridge",
    "folder",
    "model",
    "config",
    "distribution",
    "fit",
    "samples",
    "diameter",
    "capability",
];

/// In every table of the scene with every word of the language, the schema knows exactly the keys that the program knows.
#[test]
fn schema_and_program_know_the_same_keys() {
    let (schema, validator) = scene_schema();
    let mut all = BTreeSet::new();
    keys_of(&schema, &mut all);
    assert!(all.len() > 90, "{all:?}");
    let mut checked = 0;
    for text in [EVERYTHING, BEAM] {
        let scene = as_json(text);
        let mut paths = Vec::new();
        tables(&scene, "", &mut paths);
        for path in paths {
            // Their keys are names; curves of a kind and dampings are alternatives, whose faults have no single place.
            let named = ["/parameters", "/materials"].contains(&path.as_str())
                || path.ends_with("/points")
                || path.contains("/changes");
            let alternative = [
                "/size",
                "/torque",
                "/factor",
                "/speed",
                "/angle",
                "/over",
                "/contact_damping",
                "/a",
                "/b",
                "/length",
            ];
            if named || alternative.iter().any(|end| path.ends_with(end)) {
                continue;
            }
            let mut probe = scene.clone();
            let table = probe.pointer_mut(&path).unwrap().as_object_mut().unwrap();
            table.insert("xyzzy".to_owned(), json!("1 mm"));
            let faulty = toml::to_string(&probe).unwrap();
            let faults = SceneSource::parse(&faulty, "my.toml").unwrap_err();
            let known: BTreeSet<String> = faults
                .0
                .iter()
                .find_map(|fault| match &fault.kind {
                    FaultKind::UnknownKey { known, .. } if fault.key.ends_with("xyzzy") => {
                        Some(known.iter().cloned().collect())
                    }
                    _ => None,
                })
                .unwrap_or_else(|| panic!("{path}: {faults}"));
            // All other keys there are, at once.
            let table = probe.pointer_mut(&path).unwrap().as_object_mut().unwrap();
            for key in all.iter().filter(|key| !DECIDING.contains(&key.as_str())) {
                table.entry(key.clone()).or_insert_with(|| json!("1 mm"));
            }
            let refused = refused_keys(&validator, &probe, &path);
            let taken: BTreeSet<String> = all.iter().filter(|key| !refused.contains(*key)).cloned().collect();
            let differ = taken.symmetric_difference(&known);
            let differ: Vec<_> = differ.filter(|key| !DECIDING.contains(&key.as_str())).collect();
            assert!(differ.is_empty(), "{path}: {differ:?}\nprogram {known:?}\nschema {taken:?}");
            checked += 1;
        }
    }
    assert!(checked > 60, "{checked}");
}

#[test]
fn a_summary_is_described_completely() {
    let summary = crate::finished_summary();
    let validator = draft202012::new(&crate::json(&["schema", "--results"])).unwrap();
    assert_eq!(objections(&validator, &summary), [""; 0]);
    // It is closed: a new key needs its description, a lost one is missed.
    let mut more = summary.clone();
    more["xyzzy"] = json!(1);
    assert!(!validator.is_valid(&more));
    let mut less = summary;
    less.as_object_mut().unwrap().remove("lives");
    less["evaluations"].as_object_mut().unwrap().remove("failed");
    assert!(!validator.is_valid(&less));
}
