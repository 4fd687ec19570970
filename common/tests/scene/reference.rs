//! The reference of the scene language, `common/scenes/README.md`: it names every key, every word and every unit that the
//! readers know, and no other key.

use common::scene::SceneSource;
use common::scene::quantity::UNITS;
use std::collections::BTreeSet;
use toml::{Table, Value};

const REFERENCE: &str = include_str!("../../scenes/README.md");
const EVERYTHING: &str = include_str!("../scenes/everything.toml");
/// Every key of what is read from CSV files beside the scene.
const MEASURED: &str = include_str!("../scenes/measured.toml");

/// Every key of a scene with an external simulator, program and server.
const SIMULATORS: [&str; 2] = [
    r#"
    [scene]
    name = "program"
    [simulator]
    program = ["beam"]
    folder = "."
    results = "results.out"
    templates = ["beam.inp"]
    files = ["mesh.inp"]
    timeout = "10 s"
    version = "1"
    [life]
    cycles = 2
    checkpoint_every = 1
    [[outputs]]
    name = "deflection"
    unit = "mm"
    values = 2
    [[limit_states]]
    name = "bent"
    output = "deflection"
    threshold = 1
    fails = "below"
    "#,
    r#"
    [scene]
    name = "server"
    [simulator]
    umbridge = "http://127.0.0.1:4242"
    model = "forward"
    config = {}
    [[outputs]]
    name = "deflection"
    "#,
];

/// Every key of a scene whose simulator gives cycles.
const CYCLE: &str = include_str!("../scenes/cycle.toml");

/// Keys whose value is one of a few words.
const WORD_KEYS: [&str; 11] = [
    "gives",
    "tier",
    "type",
    "motion",
    "law",
    "contact_law",
    "contact_damping",
    "over",
    "distribution",
    "fails",
    "measure",
];

/// The texts in backquotes of a piece of Markdown without its blocks of code.
fn quoted(text: &str) -> impl Iterator<Item = &str> {
    text.split("```").step_by(2).flat_map(|prose| prose.split('`').skip(1).step_by(2))
}

/// Keys and words in a text: letters, `_` and `-`.
fn words(text: &str) -> impl Iterator<Item = String> {
    let of_words = |c: char| c.is_ascii_alphabetic() || c == '_' || c == '-';
    text.split(move |c| !of_words(c)).filter(|word| !word.is_empty()).map(str::to_owned)
}

/// Words in the cells of the columns that list keys, types and distributions.
fn key_cells() -> BTreeSet<String> {
    let listed = ["key", "`type`", "`motion`", "`distribution`", "required", "optional"];
    let mut found = BTreeSet::new();
    let mut heads: Vec<&str> = Vec::new();
    for line in REFERENCE.lines().filter(|line| !line.starts_with("|---")) {
        let Some(row) = line.strip_prefix('|') else {
            heads.clear();
            continue;
        };
        let cells: Vec<&str> = row.split('|').map(str::trim).collect();
        if heads.is_empty() {
            heads = cells;
            continue;
        }
        let keys = heads.iter().zip(&cells).filter(|(head, _)| listed.contains(head)).map(|(_, cell)| *cell);
        found.extend(keys.flat_map(quoted).flat_map(words));
    }
    found
}

/// Keys of a scene, and the words that some of them take; names that an author chooses are left out.
fn language(table: &Table, path: &str, found: &mut BTreeSet<String>) {
    let chosen = ["parameters", "materials", "points", "config"].contains(&path);
    for (key, value) in table {
        if !chosen {
            found.insert(key.clone());
        }
        match value {
            // Their keys are paths and names.
            Value::Table(_) if key == "changes" || key == "map" => {}
            Value::Table(inner) => language(inner, key, found),
            Value::Array(rows) => {
                rows.iter().filter_map(Value::as_table).for_each(|row| language(row, key, found))
            }
            Value::String(word) if WORD_KEYS.contains(&key.as_str()) => {
                found.insert(word.clone());
            }
            _ => {}
        }
    }
}

/// The example of an FMU.
const FMU: &str = include_str!("../../../deploy/python/examples/fmu/slider-crank.toml");

fn known() -> BTreeSet<String> {
    // Keys that exclude one of these scenes.
    let mut known = BTreeSet::from(
        ["extends", "without", "above", "source", "levels", "level_cost", "finest_is_exact", "python"]
            .map(str::to_owned),
    );
    for text in SIMULATORS.into_iter().chain([EVERYTHING, CYCLE, FMU]) {
        SceneSource::parse(text, "scene").unwrap();
        language(&text.parse().unwrap(), "", &mut known);
    }
    // Read with its files in `scene_csv.rs`.
    language(&MEASURED.parse().unwrap(), "", &mut known);
    known
}

#[test]
fn the_reference_names_every_key_and_word_of_the_language() {
    let named: BTreeSet<String> = quoted(REFERENCE).flat_map(words).collect();
    let missing: Vec<_> = known().into_iter().filter(|word| !named.contains(word)).collect();
    assert!(missing.is_empty(), "the reference does not name {missing:?}");
}

#[test]
fn the_reference_names_no_other_key() {
    let (known, cells) = (known(), key_cells());
    assert!(cells.len() > 70, "{cells:?}");
    let unknown: Vec<_> = cells.iter().filter(|word| !known.contains(*word)).collect();
    assert!(unknown.is_empty(), "no scene has {unknown:?}");
}

#[test]
fn the_reference_names_every_unit() {
    let (_, units) = REFERENCE.split_once("\n### Units\n").unwrap();
    let (units, _) = units.split_once("\n## ").unwrap();
    let named: BTreeSet<&str> = quoted(units).collect();
    // The micro sign and the letter mu look alike.
    let missing: Vec<_> =
        UNITS.iter().map(|(symbol, _)| *symbol).filter(|s| !named.contains(s) && *s != "\u{3bc}m").collect();
    assert!(missing.is_empty(), "the reference does not name the units {missing:?}");
}
