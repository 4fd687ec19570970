//! One type name, one meaning within a crate.

use super::{CRATES, crate_sources, none, root};
use std::collections::BTreeMap;

/// Type names that stand twice in a crate, with the reason. At most five.
const TWICE: [(&str, &str, &str); 0] = [];

#[test]
fn a_type_name_has_one_meaning_in_a_crate() {
    assert!(TWICE.len() <= 5, "{} exceptions", TWICE.len());
    let mut found = Vec::new();
    for name in CRATES {
        let mut places: BTreeMap<String, Vec<String>> = BTreeMap::new();
        for (file, source) in crate_sources(name) {
            for type_name in &source.types {
                places.entry(type_name.clone()).or_default().push(file.display().to_string());
            }
        }
        assert!(places.len() > 50, "{name}: only {} types were read", places.len());
        let excepted =
            |type_name: &str| TWICE.iter().any(|(krate, twice, _)| *krate == name && *twice == type_name);
        found.extend(
            places
                .iter()
                .filter(|(type_name, files)| files.len() > 1 && !excepted(type_name))
                .map(|(type_name, files)| format!("{name}: {type_name} in {}", files.join(", "))),
        );
        for (_, twice, reason) in TWICE.iter().filter(|(krate, ..)| *krate == name) {
            if places.get(*twice).is_none_or(|files| files.len() < 2) {
                found.push(format!("{name}: {twice} stands once: its exception ({reason}) can go"));
            }
        }
    }
    none(&found);
}

/// `is_...` and `has_...` answer a question: they change nothing.
#[test]
fn predicates_do_not_act() {
    let mut found = Vec::new();
    let mut read = 0;
    for name in CRATES {
        for file in crate_sources(name).into_keys() {
            let path = format!("{name}/src/{}", file.display());
            let text = std::fs::read_to_string(root().join(&path)).unwrap();
            for predicate in ["fn is_", "fn has_"].iter().flat_map(|start| text.match_indices(start)) {
                let signature = text[predicate.0..].split(['{', ';']).next().unwrap();
                read += 1;
                if signature.contains("&mut ") {
                    found.push(format!("{path}: {}", signature.trim()));
                }
            }
        }
    }
    assert!(read > 40, "only {read} predicates were read");
    none(&found);
}
