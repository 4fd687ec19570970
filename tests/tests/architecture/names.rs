//! One type name, one meaning within a crate.

use super::{crate_sources, none};
use std::collections::BTreeMap;

/// Type names that stand twice in a crate, with the reason. At most five.
const TWICE: [(&str, &str, &str); 0] = [];

#[test]
fn a_type_name_has_one_meaning_in_a_crate() {
    assert!(TWICE.len() <= 5, "{} exceptions", TWICE.len());
    let mut found = Vec::new();
    for name in ["common", "worker", "coordinator"] {
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
