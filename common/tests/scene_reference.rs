//! The reference of the language in the README: it names every word of the language, and no other.

use std::collections::BTreeSet;
use toml::{Table, Value};

const README: &str = include_str!("../../README.md");
const EVERYTHING: &str = include_str!("scenes/everything.toml");

/// What the reference says in backquotes, cut into words.
fn reference() -> BTreeSet<String> {
    let (_, section) = README.split_once("\n### The language of scenes\n").unwrap();
    let (section, _) = section.split_once("\n## ").unwrap();
    section.split('`').skip(1).step_by(2).flat_map(words).collect()
}

/// Names and words; neither numbers nor the units that follow them.
fn words(text: &str) -> Vec<String> {
    let units = ["s", "m"];
    let of_words = |c: char| c.is_ascii_alphabetic() || c == '_' || c == '-';
    text.split(|c| !of_words(c)).filter(|w| !w.is_empty() && !units.contains(w)).map(str::to_owned).collect()
}

/// Keys of the language, and the words that some of them take. Names that an author chooses are left out.
fn language(table: &Table, path: &str, found: &mut BTreeSet<String>) {
    let chosen = ["parameters", "materials", "points"].contains(&path);
    for (key, value) in table {
        if !chosen {
            found.insert(key.clone());
        }
        match value {
            Value::Table(inner) => language(inner, key, found),
            Value::Array(rows) => {
                rows.iter().filter_map(Value::as_table).for_each(|row| language(row, key, found))
            }
            Value::String(word)
                if ["type", "motion", "law", "contact_law", "contact_damping", "over", "distribution"]
                    .contains(&key.as_str()) =>
            {
                found.insert(word.clone());
            }
            _ => {}
        }
    }
}

#[test]
fn the_reference_names_every_word_of_the_language_and_no_other() {
    let mut known = BTreeSet::new();
    language(&EVERYTHING.parse().unwrap(), "", &mut known);
    // Tables that the reference speaks of without their names in brackets.
    let in_prose = ["bodies", "loads", "outputs", "limit_states"];
    let named = reference();
    let untold: Vec<_> =
        known.iter().filter(|word| !named.contains(*word) && !in_prose.contains(&word.as_str())).collect();
    assert!(untold.is_empty(), "the README does not name {untold:?}");
    // Names and tolerance classes of the examples, and what only a scene that changes another one has.
    let examples = ["steel", "crank", "push", "false", "extends", "loads", "H", "e"];
    let unknown: Vec<_> =
        named.iter().filter(|word| !known.contains(*word) && !examples.contains(&word.as_str())).collect();
    assert!(unknown.is_empty(), "no scene knows {unknown:?}");
}
